//! Units and values of a nominal model as a user names them, and what the orchestrator refused as an error of ours.

use crate::error::Error;
use orchestrator::{Fmu, UnitPath, nearest};
use std::path::{Path, PathBuf};

/// A value of `[set]` as `Scenario::set` reads it.
pub(crate) fn text(value: &toml::Value) -> String {
    match value {
        toml::Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// What the orchestrator refused, as an error of ours.
pub(crate) fn model(error: orchestrator::Error) -> Error {
    if error.is_input() { Error::Nominal(error.to_string()) } else { Error::Model(error.to_string()) }
}

/// Opens a unit: beside the scenario, then on the unit path.
pub(crate) fn open(name: &str, beside: &Path, units: &UnitPath) -> Result<Fmu, Error> {
    let folders = std::iter::once(beside.to_owned()).chain(units.folders().iter().cloned());
    let found = folders.map(|folder| folder.join(name)).find(|path| path.is_file());
    let path = found.ok_or_else(|| Error::Nominal(missing(name, beside, units)))?;
    units.open(&path).map_err(model)
}

/// What to say of a unit that isn't there.
fn missing(name: &str, beside: &Path, units: &UnitPath) -> String {
    let folders = || std::iter::once(beside).chain(units.folders().iter().map(PathBuf::as_path));
    let entries = folders().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".fmu")).collect();
    names.sort();
    let looked: Vec<String> = folders().map(|folder| folder.display().to_string()).collect();
    let near = nearest(name, names.iter().map(String::as_str));
    format!("unit {name} not found: {near} (looked in {})", looked.join(", "))
}
