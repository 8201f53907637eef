//! From a library that [`fmi2_export`] made to an `.fmu`: what it says of itself, and how it is packed.
//!
//! `cargo fmi2 pack` is the command; `cargo xtask pack` does the same for the units of this repository, with what is the
//! repository's own (its notation page, committed descriptions, binaries of other platforms).

pub mod archive;
pub mod icon;
pub mod library;
pub mod package;
pub mod platform;
pub mod project;

use std::error::Error;
use std::path::Path;

/// What goes wrong here is told to a person and ends the command.
pub type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Says which file an input or output error concerns.
///
/// # Errors
/// The one given, with the path before it.
pub fn at<T>(path: &Path, outcome: std::io::Result<T>) -> Result<T> {
    outcome.map_err(|error| format!("{}: {error}", path.display()).into())
}
