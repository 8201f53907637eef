//! What leads into a unit's inputs without a channel: connections with what they make of a value, and signals from outside.

use crate::recorder::Slot;
use crate::source::Signal;
use crate::system::Values;
use crate::value::Value;
use std::sync::Arc;

/// How a value changes on its way through a connection.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Conversion {
    /// Not at all.
    Same,
    /// To another unit of the same quantity: gain · value + bias.
    /// A number of another type for a Real, too.
    Affine { gain: f64, bias: f64 },
    /// To another type, then perhaps to another unit.
    Type,
    /// Single Integers or Booleans to others, then perhaps to another type.
    Table(Arc<[(i32, i32)]>),
}

/// The ends of a connection.
#[derive(Debug, Clone)]
pub(crate) struct Link {
    pub(crate) from: Slot,
    pub(crate) to: Slot,
    pub(crate) conversion: Conversion,
}

impl Link {
    pub(crate) fn convert(&self, value: Value) -> Value {
        match (&self.conversion, self.to, &value) {
            (Conversion::Table(table), to, Value::Integer(_) | Value::Boolean(_)) => {
                let code = if let Value::Integer(code) = value {
                    code
                } else {
                    i32::from(value == Value::Boolean(true))
                };
                let code = table.iter().find(|(from, _)| *from == code).map_or(code, |(_, to)| *to);
                match to {
                    Slot::Boolean(_) => Value::Boolean(code != 0),
                    _ => Value::Integer(code),
                }
            }
            (Conversion::Affine { gain, bias }, ..) => {
                Value::Real(gain * value.as_f64().unwrap_or(f64::NAN) + bias)
            }
            (Conversion::Same, ..) => value,
            (_, Slot::Real(_), _) => Value::Real(value.as_f64().unwrap_or(f64::NAN)),
            (_, Slot::Integer(_), Value::Boolean(value)) => Value::Integer(i32::from(*value)),
            (_, Slot::Boolean(_), Value::Integer(value)) => Value::Boolean(*value != 0),
            _ => value,
        }
    }
}

/// A signal from outside.
#[derive(Debug, Clone)]
pub(crate) struct Feed {
    pub(crate) signal: Signal,
    pub(crate) to: Slot,
}

/// Writes a signal's value at a time into its slot.
pub(crate) fn feed_into(feed: &mut Feed, values: &mut Values, time: f64) {
    let value = feed.signal.at(time);
    match feed.to {
        Slot::Real(at) => values.reals[at as usize] = value,
        Slot::Integer(at) => values.integers[at as usize] = value as i32,
        Slot::Boolean(at) => values.integers[at as usize] = i32::from(value != 0.0),
        Slot::String(_) => {}
    }
}
