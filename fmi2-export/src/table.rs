//! The one declaration of a unit's variables, and what is read off it.
//!
//! [`variables!`](crate::variables) declares a struct whose fields are FMI variables; [`table!`](crate::table!) puts several such structs
//! together, so that an effect can bring its own parameters in its own file. The place of a variable in the
//! whole table is its value reference.

use crate::unit::Unit;

/// FMI 2.0 section 2.2.7, attribute `causality`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Causality {
    /// Set by the master before each step.
    Input,
    /// Written by the unit at each communication point.
    Output,
    /// Chosen by the user.
    Parameter,
    /// Visible but not to be connected.
    Local,
}

/// FMI 2.0 section 2.2.7, attribute `variability`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variability {
    /// Parameter that may change between communication points.
    Tunable,
    /// Parameter that is fixed after initialisation.
    Fixed,
    /// Changes at any time (Real only).
    Continuous,
    /// Changes at communication points only.
    Discrete,
}

/// Type and start value.
#[derive(Debug, Clone, PartialEq)]
pub enum Kind {
    /// `fmi2Real`
    Real(f64),
    /// `fmi2Integer`
    Integer(i32),
    /// `fmi2Boolean`
    Boolean(bool),
    /// `fmi2String`
    String(String),
}

/// Everything the declaration says of one variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// FMI name: the paper's symbol in ASCII.
    pub name: &'static str,
    /// Field of the Rust struct.
    pub field: &'static str,
    /// The paper's symbol, for people.
    pub symbol: &'static str,
    /// What it is to a master.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// Type and start value.
    pub kind: Kind,
    /// Physical unit.
    pub unit: Unit,
    /// One sentence with its source.
    pub description: &'static str,
    /// The start value is a neutral value, at which the effect vanishes to the last bit.
    pub is_effect: bool,
    /// Smallest legal value.
    pub min: Option<f64>,
    /// Largest legal value.
    pub max: Option<f64>,
    /// FMI name of the variable of which this one is the time derivative.
    pub derivative_of: Option<&'static str>,
}

/// A value, borrowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Slot<'a> {
    /// `fmi2Real`
    Real(&'a f64),
    /// `fmi2Integer`
    Integer(&'a i32),
    /// `fmi2Boolean`
    Boolean(&'a bool),
    /// `fmi2String`
    String(&'a str),
}

/// A value, borrowed to be changed.
#[derive(Debug, PartialEq)]
pub enum SlotMut<'a> {
    /// `fmi2Real`
    Real(&'a mut f64),
    /// `fmi2Integer`
    Integer(&'a mut i32),
    /// `fmi2Boolean`
    Boolean(&'a mut bool),
    /// `fmi2String`
    String(&'a mut String),
}

/// A set of variables with a fixed order.
pub trait Table: Default + Clone + Send + 'static {
    /// How many variables there are.
    const COUNT: usize;
    /// Appends the declarations, in order.
    fn describe(into: &mut Vec<Variable>);
    /// The value at a place of the order; `None` past the end.
    fn get(&self, index: usize) -> Option<Slot<'_>>;
    /// The value at a place of the order, to be changed; `None` past the end.
    fn get_mut(&mut self, index: usize) -> Option<SlotMut<'_>>;

    /// The declarations, in order.
    fn variables() -> Vec<Variable> {
        let mut all = Vec::with_capacity(Self::COUNT);
        Self::describe(&mut all);
        all
    }
}

/// A Rust type that can be an FMI variable.
pub trait Value: Sized {
    /// Type and start value for the description.
    fn kind(start: Self) -> Kind;
    /// Borrow as a slot.
    fn slot(&self) -> Slot<'_>;
    /// Borrow as a slot, to be changed.
    fn slot_mut(&mut self) -> SlotMut<'_>;
}

macro_rules! value {
    ($type:ty, $variant:ident) => {
        impl Value for $type {
            fn kind(start: Self) -> Kind {
                Kind::$variant(start)
            }
            fn slot(&self) -> Slot<'_> {
                Slot::$variant(self)
            }
            fn slot_mut(&mut self) -> SlotMut<'_> {
                SlotMut::$variant(self)
            }
        }
    };
}
value!(f64, Real);
value!(i32, Integer);
value!(bool, Boolean);
value!(String, String);

/// Declares a struct of variables. One entry a variable:
///
/// ```
/// fmi2_export::variables! {
///     /// Friction at the joint.
///     pub struct JointFriction {
///         effect viscous: f64 = 0.0, "b_joint", "b₂", fmi2_export::unit::NEWTON_METRE_SECOND_PER_RADIAN,
///             "Viscous friction between the links, acts on dq2 - dq1.", min = 0.0;
///     }
/// }
/// use fmi2_export::Table;
/// assert_eq!(JointFriction::variables()[0].name, "b_joint");
/// ```
///
/// The first word is `input`, `output`, `local`, `parameter` (tunable), `fixed` (a parameter that is fixed after
/// initialisation), `effect` (a tunable parameter whose start value is its neutral value) or `fixed_effect`. After
/// the sentence may follow `min = …`, `max = …` and `derivative_of = "…"`. Any other first word does not compile:
///
/// ```compile_fail
/// fmi2_export::variables! {
///     pub struct Knobs { knob one: f64 = 0.0, "a", "a", fmi2_export::unit::ONE, "A knob."; }
/// }
/// ```
#[macro_export]
macro_rules! variables {
    ($(#[$meta:meta])* $vis:vis struct $Name:ident {
        $( $role:ident $field:ident : $type:ty = $start:expr, $name:literal, $symbol:literal, $unit:expr,
           $text:literal $(, $key:ident = $value:expr)* ; )*
    }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq, $crate::serde::Serialize, $crate::serde::Deserialize)]
        #[serde(crate = "fmi2_export::serde")]
        $vis struct $Name {
            $( #[doc = concat!("`", $name, "`: ", $text)] pub $field: $type, )*
        }

        impl ::core::default::Default for $Name {
            fn default() -> Self {
                Self { $( $field: $start, )* }
            }
        }

        impl $crate::Table for $Name {
            const COUNT: usize = 0 $( + { let _ = stringify!($field); 1 } )*;

            fn describe(into: &mut Vec<$crate::Variable>) {
                $(
                    #[allow(unused_mut)]
                    let mut variable = $crate::table::declared(
                        $crate::variables!(@role $role), $name, stringify!($field), $symbol, $unit, $text,
                        <$type as $crate::table::Value>::kind($start),
                    );
                    $( $crate::variables!(@attribute variable, $key, $value); )*
                    into.push(variable);
                )*
            }

            fn get(&self, index: usize) -> Option<$crate::Slot<'_>> {
                let mut _at = 0;
                $( if index == _at { return Some($crate::table::Value::slot(&self.$field)); } _at += 1; )*
                None
            }

            fn get_mut(&mut self, index: usize) -> Option<$crate::SlotMut<'_>> {
                let mut _at = 0;
                $( if index == _at { return Some($crate::table::Value::slot_mut(&mut self.$field)); } _at += 1; )*
                None
            }
        }
    };
    (@role input) => { $crate::table::Role::Input };
    (@role output) => { $crate::table::Role::Output };
    (@role local) => { $crate::table::Role::Local };
    (@role parameter) => { $crate::table::Role::Parameter };
    (@role fixed) => { $crate::table::Role::Fixed };
    (@role effect) => { $crate::table::Role::Effect };
    (@role fixed_effect) => { $crate::table::Role::FixedEffect };
    (@role $other:ident) => {
        compile_error!(concat!(
            "`", stringify!($other), "`: one of input, output, local, parameter, fixed, effect, fixed_effect is needed"
        ))
    };
    (@attribute $variable:ident, min, $value:expr) => { $variable.min = Some($value as f64); };
    (@attribute $variable:ident, max, $value:expr) => { $variable.max = Some($value as f64); };
    (@attribute $variable:ident, derivative_of, $value:expr) => { $variable.derivative_of = Some($value); };
}

/// Puts tables together into one, in the order written.
///
/// ```
/// use fmi2_export::{Table, table, unit, variables};
/// variables! { pub struct Inputs { input torque: f64 = 0.0, "tau", "τ", unit::NEWTON_METRE, "Torque."; } }
/// variables! { pub struct Lag { effect time: f64 = 0.0, "T_act", "T_a", unit::SECOND, "Lag.", min = 0.0; } }
/// table! {
///     /// All variables of the unit.
///     pub struct Variables { pub inputs: Inputs, pub lag: Lag }
/// }
/// assert_eq!(Variables::variables()[1].name, "T_act");
/// ```
#[macro_export]
macro_rules! table {
    ($(#[$meta:meta])* $vis:vis struct $Name:ident { $( $(#[$inner:meta])* $fvis:vis $field:ident : $type:ty ),* $(,)? }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Default, PartialEq, $crate::serde::Serialize, $crate::serde::Deserialize)]
        #[serde(crate = "fmi2_export::serde")]
        $vis struct $Name { $( $(#[$inner])* $fvis $field: $type, )* }

        impl $crate::Table for $Name {
            const COUNT: usize = 0 $( + <$type as $crate::Table>::COUNT )*;

            fn describe(into: &mut Vec<$crate::Variable>) {
                $( <$type as $crate::Table>::describe(into); )*
            }

            fn get(&self, mut index: usize) -> Option<$crate::Slot<'_>> {
                $(
                    if index < <$type as $crate::Table>::COUNT { return self.$field.get(index); }
                    index -= <$type as $crate::Table>::COUNT;
                )*
                let _ = index;
                None
            }

            fn get_mut(&mut self, mut index: usize) -> Option<$crate::SlotMut<'_>> {
                $(
                    if index < <$type as $crate::Table>::COUNT { return self.$field.get_mut(index); }
                    index -= <$type as $crate::Table>::COUNT;
                )*
                let _ = index;
                None
            }
        }
    };
}

/// First word of an entry of [`variables!`].
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    Input,
    Output,
    Local,
    Parameter,
    Fixed,
    Effect,
    FixedEffect,
}

/// What [`variables!`] calls for each entry.
#[doc(hidden)]
pub fn declared(
    role: Role,
    name: &'static str,
    field: &'static str,
    symbol: &'static str,
    unit: Unit,
    description: &'static str,
    kind: Kind,
) -> Variable {
    let is_real = matches!(kind, Kind::Real(_));
    let signal = if is_real { Variability::Continuous } else { Variability::Discrete };
    let (causality, variability) = match role {
        Role::Input => (Causality::Input, signal),
        Role::Output => (Causality::Output, signal),
        Role::Local => (Causality::Local, signal),
        Role::Parameter | Role::Effect => (Causality::Parameter, Variability::Tunable),
        Role::Fixed | Role::FixedEffect => (Causality::Parameter, Variability::Fixed),
    };
    Variable {
        name,
        field,
        symbol,
        causality,
        variability,
        kind,
        unit,
        description,
        is_effect: matches!(role, Role::Effect | Role::FixedEffect),
        min: None,
        max: None,
        derivative_of: None,
    }
}
