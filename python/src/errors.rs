//! Exceptions, with the words of the command line.

use pyo3::exceptions::PyException;
use pyo3::{PyErr, create_exception};
use std::fmt::Display;

create_exception!(acroscope, Error, PyException, "What ends a command of Acroscope.");
create_exception!(acroscope, InputError, Error, "The input is wrong; the words name what would be right.");

/// An error of the orchestrator.
pub fn told(error: orchestrator::Error) -> PyErr {
    match error.is_input() {
        true => input(error),
        false => Error::new_err(error.to_string()),
    }
}

/// An error that the user can mend. A value was given in Python, and not by an option.
pub fn input(error: impl Display) -> PyErr {
    let text = error.to_string();
    InputError::new_err(text.strip_prefix("--set ").unwrap_or(&text).to_owned())
}

/// Any other error.
pub fn other(error: impl Display) -> PyErr {
    Error::new_err(error.to_string())
}
