//! Values between Python and the master.

use orchestrator::Value;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyInt, PyString};

/// A value as a person would type it after `--set NAME=`: the scenario knows the variable's type.
pub fn text(value: &Bound<'_, PyAny>) -> PyResult<String> {
    if let Ok(truth) = value.extract::<bool>() {
        return Ok(truth.to_string());
    }
    Ok(value.str()?.to_string())
}

/// A value in its own type. Floats of NumPy are floats, its integers and Booleans ours.
pub fn value(given: &Bound<'_, PyAny>) -> PyResult<Value> {
    if given.is_instance_of::<PyString>() {
        return Ok(Value::String(given.extract()?));
    }
    if let Ok(truth) = given.extract::<bool>() {
        return Ok(Value::Boolean(truth));
    }
    match given.extract::<i32>() {
        Ok(number) => Ok(Value::Integer(number)),
        Err(_) => Ok(Value::Real(given.extract()?)),
    }
}

/// A value for Python.
pub fn to_python<'py>(py: Python<'py>, value: Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Real(number) => PyFloat::new(py, number).into_any(),
        Value::Integer(number) => PyInt::new(py, number).into_any(),
        Value::Boolean(truth) => PyBool::new(py, truth).to_owned().into_any(),
        Value::String(text) => PyString::new(py, &text).into_any(),
    })
}
