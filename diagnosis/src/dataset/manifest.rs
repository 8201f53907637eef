//! `dataset.toml`: which nominal model, what is known of the noise, which runs.

use crate::error::Error;
use std::collections::BTreeMap;
use std::path::Path;
use toml::Value;

/// The head of a data set.
#[derive(Debug, Clone, PartialEq)]
pub struct Manifest {
    /// Stem of a shipped scenario, or a path.
    pub scenario: String,
    /// Nominal values that differ from the scenario, `instance.variable`.
    pub set: BTreeMap<String, Value>,
    /// Known standard deviations, `instance.variable`.
    pub noise: BTreeMap<String, f64>,
    /// Folders of the runs.
    pub runs: Vec<String>,
}

impl Manifest {
    /// Reads `dataset.toml`.
    ///
    /// # Errors
    /// The file can't be read, isn't TOML, or lacks something; the message names the line.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let text =
            std::fs::read_to_string(path).map_err(|source| Error::Io { path: path.to_owned(), source })?;
        let wrong = |line: usize, problem: String| Error::Manifest { path: path.to_owned(), line, problem };
        let line_of = |key: &str| {
            text.lines()
                .position(|line| line.trim_start().trim_start_matches('"').starts_with(key))
                .map_or(1, |i| i + 1)
        };
        let root: toml::Table = text.parse().map_err(|error: toml::de::Error| {
            let at = error.span().map_or(0, |span| span.start);
            wrong(text[..at.min(text.len())].lines().count().max(1), error.message().to_string())
        })?;
        match root.get("format").and_then(Value::as_integer) {
            Some(1) => {}
            Some(other) => {
                return Err(wrong(
                    line_of("format"),
                    format!("format = {other}: this program reads format 1"),
                ));
            }
            None => return Err(wrong(1, "`format = 1` is missing".into())),
        }
        let scenario = match root.get("scenario") {
            Some(Value::String(name)) => name.clone(),
            Some(_) => return Err(wrong(line_of("scenario"), "scenario must be a string".into())),
            None => {
                return Err(wrong(1, "`scenario = \"visual-servo\"` (the nominal model) is missing".into()));
            }
        };
        let mut set = BTreeMap::new();
        flatten(root.get("set"), "", &mut set);
        let mut noise = BTreeMap::new();
        let mut noise_values = BTreeMap::new();
        flatten(root.get("noise"), "", &mut noise_values);
        for (name, value) in noise_values {
            match number(&value) {
                Some(sigma) if sigma.is_finite() && sigma >= 0.0 => drop(noise.insert(name, sigma)),
                _ => {
                    let problem = format!("[noise] {name} = {value}: a standard deviation, 0 or larger");
                    return Err(wrong(line_of(&name), problem));
                }
            }
        }
        let entries = root.get("run").and_then(Value::as_array).cloned().unwrap_or_default();
        let mut runs = Vec::new();
        for entry in &entries {
            match entry.get("dir").and_then(Value::as_str) {
                Some(dir) => runs.push(dir.to_owned()),
                None => return Err(wrong(line_of("[[run]]"), "a [[run]] needs `dir = \"run-01\"`".into())),
            }
        }
        if runs.is_empty() {
            return Err(wrong(1, "no [[run]] with `dir = \"run-01\"`".into()));
        }
        Ok(Self { scenario, set, noise, runs })
    }
}

/// Names may be written `"plant.q1" = 1` or as a table `[set.plant]`.
fn flatten(value: Option<&Value>, prefix: &str, into: &mut BTreeMap<String, Value>) {
    let Some(Value::Table(table)) = value else { return };
    for (key, value) in table {
        let name = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
        match value {
            Value::Table(_) => flatten(Some(value), &name, into),
            other => drop(into.insert(name, other.clone())),
        }
    }
}

/// A TOML number of either type.
pub fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Float(x) => Some(*x),
        Value::Integer(i) => Some(*i as f64),
        Value::Boolean(b) => Some(f64::from(u8::from(*b))),
        _ => None,
    }
}
