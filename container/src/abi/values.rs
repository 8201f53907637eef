//! Getting and setting values.
//!
//! # Safety
//! As in [`super`].
#![allow(clippy::missing_safety_doc)] // said once above

use super::{Inside, array, array_out, call};
use crate::error::Error;
use fmi2_export::abi::bytes;
use fmi2_export::abi::types::{Boolean, Component, Integer, OK, Real, Status, Text, ValueReference};
use orchestrator::{Kind, Value};
use std::ffi::CString;

/// Reads values of one kind into a C array.
unsafe fn get<T>(
    c: Component,
    function: &'static str,
    kind: Kind,
    references: (*const ValueReference, usize),
    out: *mut T,
    mut of: impl FnMut(&mut Inside, Value) -> Result<T, Error>,
) -> Status {
    // SAFETY: by the module's contract, here and inside.
    unsafe {
        call(c, function, |inside| {
            let references = array(references.0, references.1, "vr")?;
            let out = array_out(out, references.len(), "value")?;
            for (reference, out) in references.iter().zip(out) {
                let value = inside.instance.get(*reference, kind)?;
                out.write(of(inside, value)?);
            }
            Ok(OK)
        })
    }
}

/// `fmi2GetReal`
pub unsafe fn get_real(c: Component, vr: *const ValueReference, n: usize, out: *mut Real) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        get(c, "fmi2GetReal", Kind::Real, (vr, n), out, |_, value| match value {
            Value::Real(value) => Ok(value),
            other => Err(unexpected(&other)),
        })
    }
}

/// `fmi2GetInteger`
pub unsafe fn get_integer(c: Component, vr: *const ValueReference, n: usize, out: *mut Integer) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        get(c, "fmi2GetInteger", Kind::Integer, (vr, n), out, |_, value| match value {
            Value::Integer(value) => Ok(value),
            other => Err(unexpected(&other)),
        })
    }
}

/// `fmi2GetBoolean`
pub unsafe fn get_boolean(c: Component, vr: *const ValueReference, n: usize, out: *mut Boolean) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        get(c, "fmi2GetBoolean", Kind::Boolean, (vr, n), out, |_, value| match value {
            Value::Boolean(value) => Ok(Boolean::from(value)),
            other => Err(unexpected(&other)),
        })
    }
}

/// `fmi2GetString`: the strings stay valid until the next call of it.
pub unsafe fn get_string(c: Component, vr: *const ValueReference, n: usize, out: *mut Text) -> Status {
    let mut lent = Vec::new();
    // SAFETY: by the module's contract.
    let status = unsafe {
        get(c, "fmi2GetString", Kind::String, (vr, n), out, |_, value| match value {
            Value::String(value) => {
                let text = CString::new(value).map_err(|error| Error::Arguments(error.to_string()))?;
                let pointer = text.as_ptr(); // where it stays when the CString moves
                lent.push(text);
                Ok(pointer)
            }
            other => Err(unexpected(&other)),
        })
    };
    // SAFETY: by the module's contract.
    let kept = unsafe {
        call(c, "fmi2GetString", |inside| {
            inside.lent = lent;
            Ok(OK)
        })
    };
    status.max(kept)
}

fn unexpected(value: &Value) -> Error {
    Error::Arguments(format!("a value of type {}", value.kind()))
}

/// Sets values of one kind from a C array.
unsafe fn set<T: Copy>(
    c: Component,
    function: &'static str,
    references: (*const ValueReference, usize),
    values: *const T,
    of: impl Fn(&Inside, u32, T) -> Result<Value, Error>,
) -> Status {
    // SAFETY: by the module's contract, here and inside.
    unsafe {
        call(c, function, |inside| {
            let references = array(references.0, references.1, "vr")?;
            let values = array(values, references.len(), "value")?;
            for (&reference, &value) in references.iter().zip(values) {
                let value = of(inside, reference, value)?;
                inside.instance.set(reference, value)?;
            }
            Ok(OK)
        })
    }
}

/// `fmi2SetReal`
pub unsafe fn set_real(c: Component, vr: *const ValueReference, n: usize, values: *const Real) -> Status {
    // SAFETY: by the module's contract.
    unsafe { set(c, "fmi2SetReal", (vr, n), values, |_, _, value| Ok(Value::Real(value))) }
}

/// `fmi2SetInteger`
pub unsafe fn set_integer(
    c: Component,
    vr: *const ValueReference,
    n: usize,
    values: *const Integer,
) -> Status {
    // SAFETY: by the module's contract.
    unsafe { set(c, "fmi2SetInteger", (vr, n), values, |_, _, value| Ok(Value::Integer(value))) }
}

/// `fmi2SetBoolean`
pub unsafe fn set_boolean(
    c: Component,
    vr: *const ValueReference,
    n: usize,
    values: *const Boolean,
) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        set(c, "fmi2SetBoolean", (vr, n), values, |inside, reference, value: Boolean| match value {
            0 | 1 => Ok(Value::Boolean(value == 1)),
            other => Err(Error::Value {
                name: named(inside, reference),
                value: other.to_string(),
                expected: "fmi2False (0) or fmi2True (1) is needed",
            }),
        })
    }
}

/// `fmi2SetString`
pub unsafe fn set_string(c: Component, vr: *const ValueReference, n: usize, values: *const Text) -> Status {
    // SAFETY: by the module's contract, here and inside.
    unsafe {
        set(c, "fmi2SetString", (vr, n), values, |inside, reference, value: Text| {
            let wrong = |expected| Error::Value {
                name: named(inside, reference),
                value: "a string".to_owned(),
                expected,
            };
            let text = bytes(value).ok_or_else(|| wrong("not a null pointer"))?;
            let text = std::str::from_utf8(text).map_err(|_| wrong("UTF-8 is needed"))?;
            Ok(Value::String(text.to_owned()))
        })
    }
}

fn named(inside: &Inside, reference: u32) -> String {
    let variables = &inside.instance.interface().variables;
    variables
        .get(reference as usize)
        .map_or_else(|| format!("#{reference}"), |variable| variable.name.clone())
}
