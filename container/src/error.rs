//! Why a container can't be packed, or refuses a call. In a unit each one becomes `fmi2Error` and a log line.

use std::path::PathBuf;

/// What went wrong.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what each value is
pub enum Error {
    #[error(transparent)]
    Orchestrator(#[from] orchestrator::Error),
    #[error("{}: {why}", path.display())]
    File { path: PathBuf, why: String },
    #[error("{}: no unit of its name can be made: {expected}", path.display())]
    Name { path: PathBuf, expected: String },
    #[error("fmuGUID = {given}: modelDescription.xml does not belong to this scenario, {own} does")]
    Guid { given: String, own: String },
    #[error("fmuResourceLocation = {given}: {expected}")]
    Resources { given: String, expected: String },
    #[error("not allowed in the state \"{mode}\"")]
    Illegal { mode: &'static str },
    #[error("value reference {reference} does not exist: 0 to {last} do")]
    Reference { reference: u32, last: usize },
    #[error("variable {name} (value reference {reference}) is of type {is}")]
    Type { name: String, reference: u32, is: orchestrator::Kind },
    #[error("variable {name} is {what} and can't be set in the state \"{mode}\"")]
    NotSettable { name: String, what: &'static str, mode: &'static str },
    #[error("variable {name} = {value}: {expected}")]
    Value { name: String, value: String, expected: &'static str },
    #[error("argument {argument} = {value}: {expected}")]
    Argument { argument: &'static str, value: f64, expected: String },
    #[error("argument {argument} is a null pointer")]
    Null { argument: &'static str },
    #[error("{0}")]
    Arguments(String),
    #[error("fmi2SetupExperiment must be called first")]
    NoExperiment,
    #[error("{what} is not provided: {expected}")]
    NotProvided { what: &'static str, expected: &'static str },
    #[error("the state {0:#x} is not one of this instance's: it was freed, or belongs to another")]
    UnknownState(usize),
    #[error("the buffer has {given} bytes, the state needs {needed}")]
    Buffer { given: usize, needed: usize },
    #[error("serialised state: {0}")]
    Bytes(String),
    #[error("panicked: {0}")]
    Panic(String),
}

impl Error {
    /// The user can mend it: exit status 2 of the command line.
    pub fn is_input(&self) -> bool {
        match self {
            Self::Orchestrator(error) => error.is_input(),
            Self::File { .. } | Self::Name { .. } => true,
            _ => false,
        }
    }
}
