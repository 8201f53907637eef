//! What a built library says of itself, through the symbol `fmi2_export_describe`.

#![allow(unsafe_code)] // asks a built library

use crate::Result;
use fmi2_export::abi::types::{OK, Sink, Status};
use libloading::{Library, Symbol};
use std::ffi::{c_int, c_void};
use std::path::Path;

/// The texts of a unit.
pub struct Unit {
    /// Model identifier.
    pub identifier: String,
    /// `modelDescription.xml`
    pub xml: String,
    /// `documentation/index.html`
    pub html: String,
    /// Its section of NOTATION.md.
    pub notation: String,
}

type Describe = unsafe extern "C" fn(c_int, Option<Sink>, *mut c_void) -> Status;

unsafe extern "C" fn append(context: *mut c_void, bytes: *const u8, length: usize) {
    // SAFETY: `text` passes its own vector, the library its own bytes.
    unsafe { (*context.cast::<Vec<u8>>()).extend_from_slice(std::slice::from_raw_parts(bytes, length)) }
}

fn text(describe: &Symbol<'_, Describe>, what: c_int) -> Result<String> {
    let mut bytes: Vec<u8> = Vec::new();
    // SAFETY: the library was made by `export!`, which defines this function; the sink and its context fit.
    let status = unsafe { describe(what, Some(append), (&raw mut bytes).cast()) };
    if status != OK {
        return Err(format!("fmi2_export_describe({what}) failed").into());
    }
    Ok(String::from_utf8(bytes)?)
}

/// Loads a library and reads its texts.
///
/// # Errors
/// It wasn't made by [`fmi2_export::export!`], or there are mistakes in the declaration of the unit.
pub fn describe(path: &Path) -> Result<Unit> {
    let named = |error| format!("{}: {error}", path.display());
    // SAFETY: one of our own libraries, which do nothing when loaded.
    let library = unsafe { Library::new(path) }.map_err(|error| named(error.to_string()))?;
    // SAFETY: the type is the one in `fmi2_export::export!`.
    let describe: Symbol<'_, Describe> =
        unsafe { library.get(b"fmi2_export_describe") }.map_err(|error| named(error.to_string()))?;
    let mistakes = text(&describe, 4)?;
    if !mistakes.is_empty() {
        return Err(named(format!("mistakes in the declaration of the unit:\n{mistakes}")).into());
    }
    Ok(Unit {
        identifier: text(&describe, 0)?,
        xml: text(&describe, 1)?,
        html: text(&describe, 2)?,
        notation: text(&describe, 3)?,
    })
}
