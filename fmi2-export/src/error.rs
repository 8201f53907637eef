//! Why a call was refused, with the values that made it so. Each one becomes `fmi2Error` and a log line.

use crate::model::ModelError;

/// Why the shell or the model answers `fmi2Error`.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs)] // the messages say what each value is
pub enum Error {
    #[error("not allowed in the state \"{mode}\"")]
    Illegal { mode: &'static str },
    #[error("value reference {reference} does not exist: 0 to {last} do")]
    Reference { reference: u32, last: usize },
    #[error("variable {name} (value reference {reference}) is of type {is}")]
    Type { name: &'static str, reference: u32, is: &'static str },
    #[error("variable {name} is {what} and can't be set in the state \"{mode}\"")]
    NotSettable { name: &'static str, what: &'static str, mode: &'static str },
    #[error("variable {name} = {value}: a finite number is needed")]
    NotFinite { name: &'static str, value: f64 },
    #[error("variable {name} = {value} is outside {min} to {max}")]
    Range { name: &'static str, value: f64, min: f64, max: f64 },
    #[error("variable {name} = {value}: fmi2False (0) or fmi2True (1) is needed")]
    NotBoolean { name: &'static str, value: i32 },
    #[error("variable {name}: the string is not UTF-8")]
    NotUtf8 { name: &'static str },
    #[error("variable {name}: the unit's string holds a zero byte")]
    ZeroByte { name: &'static str },
    #[error("variable {name}: a null pointer instead of a string")]
    NullString { name: &'static str },
    #[error("argument {argument} is a null pointer")]
    Null { argument: &'static str },
    #[error("argument {argument} has an impossible length: {length}")]
    Length { argument: &'static str, length: usize },
    #[error("argument {argument} = {value}: {expected}")]
    Argument { argument: &'static str, value: f64, expected: String },
    #[error("fmi2SetupExperiment must be called first")]
    NoExperiment,
    #[error("log category \"{0}\" is not declared in modelDescription.xml")]
    Category(String),
    #[error("order {order} of input {name}: only the first derivative can be used")]
    Order { name: &'static str, order: i32 },
    #[error("variable {name} is {what}, not an input")]
    NotInput { name: &'static str, what: &'static str },
    #[error("variable {name} is {what}, not an output")]
    NotOutput { name: &'static str, what: &'static str },
    #[error("the derivative of order {order} of {name} is not provided: no variable is declared as such")]
    NoOutputDerivative { name: &'static str, order: i32 },
    #[error("the derivative of {unknown} with respect to {known} is not provided")]
    NoDerivative { unknown: &'static str, known: &'static str },
    #[error("steps are never asynchronous, so none can be cancelled")]
    NotPending,
    #[error("the state {0:#x} is not one of this unit's: it was freed, or belongs to another")]
    UnknownState(usize),
    #[error("the buffer has {given} bytes, the state needs {needed}")]
    Buffer { given: usize, needed: usize },
    #[error("serialised state: {0}")]
    Bytes(&'static str),
    #[error("the state could not be serialised: {0}")]
    Serialise(String),
    #[error("panicked: {0}")]
    Panic(String),
    #[error(transparent)]
    Model(#[from] ModelError),
}
