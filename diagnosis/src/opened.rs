//! Units and values of a nominal model as a user names them, and what the orchestrator refused as an error of ours.

use crate::error::Error;
use orchestrator::{Fmu, UnitPath};
use std::path::Path;

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
    let path = found
        .ok_or_else(|| Error::Nominal(format!("unit {name} not found (looked in {:?})", units.folders())))?;
    units.open(&path).map_err(model)
}
