//! Values and types of FMI 2.0 variables, and how one type becomes another.

use std::fmt;

/// Type of a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// `fmi2Real`
    Real,
    /// `fmi2Integer` (enumerations too)
    Integer,
    /// `fmi2Boolean`
    Boolean,
    /// `fmi2String`
    String,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Real => "Real",
            Self::Integer => "Integer",
            Self::Boolean => "Boolean",
            Self::String => "String",
        })
    }
}

/// Value of a variable.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Value {
    /// `fmi2Real`
    Real(f64),
    /// `fmi2Integer`
    Integer(i32),
    /// `fmi2Boolean`
    Boolean(bool),
    /// `fmi2String`
    String(String),
}

impl Value {
    /// Its type.
    pub fn kind(&self) -> Kind {
        match self {
            Self::Real(_) => Kind::Real,
            Self::Integer(_) => Kind::Integer,
            Self::Boolean(_) => Kind::Boolean,
            Self::String(_) => Kind::String,
        }
    }

    /// As a number: Booleans are 0 and 1, strings have none.
    pub fn as_f64(&self) -> Option<f64> {
        match self {
            Self::Real(value) => Some(*value),
            Self::Integer(value) => Some(f64::from(*value)),
            Self::Boolean(value) => Some(f64::from(u8::from(*value))),
            Self::String(_) => None,
        }
    }

    /// Reads a value of a type as a person types it (`--set camera.k1=0.1`).
    pub fn parse(kind: Kind, text: &str) -> Option<Self> {
        let trimmed = text.trim();
        match kind {
            Kind::Real => trimmed.parse().ok().map(Self::Real),
            Kind::Integer => trimmed.parse().ok().map(Self::Integer),
            Kind::Boolean => match trimmed {
                "true" | "1" => Some(Self::Boolean(true)),
                "false" | "0" => Some(Self::Boolean(false)),
                _ => None,
            },
            Kind::String => Some(Self::String(text.to_owned())),
        }
    }

    /// The value as one of another type, if nothing is lost.
    pub fn cast(&self, kind: Kind) -> Option<Self> {
        match (self, kind) {
            (value, kind) if value.kind() == kind => Some(value.clone()),
            (Self::Integer(value), Kind::Real) => Some(Self::Real(f64::from(*value))),
            (Self::Boolean(value), Kind::Real) => Some(Self::Real(f64::from(u8::from(*value)))),
            (Self::Boolean(value), Kind::Integer) => Some(Self::Integer(i32::from(*value))),
            (Self::Integer(value @ (0 | 1)), Kind::Boolean) => Some(Self::Boolean(*value == 1)),
            _ => None,
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Real(value) => f.write_str(zmij::Buffer::new().format(*value)),
            Self::Integer(value) => value.fmt(f),
            Self::Boolean(value) => value.fmt(f),
            Self::String(value) => write!(f, "{value:?}"),
        }
    }
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Self::Real(value)
    }
}

impl From<i32> for Value {
    fn from(value: i32) -> Self {
        Self::Integer(value)
    }
}

impl From<bool> for Value {
    fn from(value: bool) -> Self {
        Self::Boolean(value)
    }
}

impl From<&str> for Value {
    fn from(value: &str) -> Self {
        Self::String(value.to_owned())
    }
}
