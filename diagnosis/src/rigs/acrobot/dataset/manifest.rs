//! `dataset.toml`: which nominal model, what is known of the noise, how the logs count, which runs.

use super::lines;
use super::stated_log::Stated;
use crate::error::Error;
use crate::rigs::acrobot::channels::CHANNELS;
use orchestrator::plain::leaves;
use orchestrator::suggest::nearest;
use std::collections::BTreeMap;
use std::path::Path;
use toml::Value;

/// What a `[[run]]` holds: those behind `dir` are notes for people, and so is any other key that is none of these mistyped.
const RUN_KEYS: [&str; 3] = ["dir", "description", "excitation"];
/// How advice begins where a name is near to a known one.
const MEANT: &str = "did you mean";

/// What the file may hold at its top.
const KEYS: [&str; 6] = ["format", "scenario", "set", "noise", "log", "run"];

/// The head of a data set.
#[derive(Debug, Clone, PartialEq)]
pub struct Manifest {
    /// Stem of a shipped scenario, or a path.
    pub scenario: String,
    /// Nominal values that differ from the scenario, `instance.variable`.
    pub set: BTreeMap<String, Value>,
    /// Known standard deviations, `instance.variable`.
    pub noise: BTreeMap<String, f64>,
    /// How the logs count, where it isn't our way.
    pub stated: Stated,
    /// Folders of the runs.
    pub runs: Vec<String>,
}

impl Manifest {
    /// Reads `dataset.toml`.
    ///
    /// # Errors
    /// The file can't be read, isn't TOML, lacks something, or has something that nobody would read; the message names the line.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let text = orchestrator::plain::read_text(path)
            .map_err(|source| Error::Io { path: path.to_owned(), source })?;
        let file = File { path, text: &text };
        let root: toml::Table = text.parse().map_err(|error: toml::de::Error| {
            let at = error.span().map_or(0, |span| span.start);
            file.wrong(text[..at.min(text.len())].lines().count().max(1), error.message().to_string())
        })?;
        file.format(&root)?;
        if let Some(key) = root.keys().find(|key| !KEYS.contains(&key.as_str())) {
            let problem =
                format!("`{key}` is nothing that a data set has; {}", nearest(key, KEYS.into_iter()));
            return Err(file.wrong(file.line_of(key), problem));
        }
        for (line, key) in lines::strange_keys(&text, &RUN_KEYS) {
            let advice = nearest(&key, RUN_KEYS.into_iter());
            if advice.starts_with(MEANT) {
                return Err(file.wrong(line, format!("`{key}` is nothing that a [[run]] has; {advice}")));
            }
        }
        let scenario = match root.get("scenario") {
            Some(Value::String(name)) => name.clone(),
            Some(_) => return Err(file.wrong(file.line_of("scenario"), "scenario must be a string".into())),
            None => {
                let problem = "`scenario = \"visual-servo\"` (the nominal model) is missing";
                return Err(file.wrong(1, problem.into()));
            }
        };
        let mut set = BTreeMap::new();
        flatten(root.get("set"), "", &mut set);
        let stated = match root.get("log") {
            None => Stated::default(),
            Some(Value::Table(table)) => Stated::read(table)
                .map_err(|(key, problem)| file.wrong(file.line_of(&key), format!("[log] {problem}")))?,
            Some(_) => return Err(file.wrong(file.line_of("log"), "[log] must be a table".into())),
        };
        Ok(Self { scenario, set, noise: file.noise(&root)?, stated, runs: file.runs(&root)? })
    }
}

/// The text with its place.
struct File<'a> {
    path: &'a Path,
    text: &'a str,
}

impl File<'_> {
    fn wrong(&self, line: usize, problem: String) -> Error {
        Error::Manifest { path: self.path.to_owned(), line, problem }
    }

    /// The line that begins with a key, bare, quoted or as a table's head; 1 if none does.
    fn line_of(&self, key: &str) -> usize {
        let opens = |line: &str| line.trim_start().trim_start_matches(['[', '"', '\'']).starts_with(key);
        self.text.lines().position(opens).map_or(1, |place| place + 1)
    }

    /// Refuses any other format than ours.
    fn format(&self, root: &toml::Table) -> Result<(), Error> {
        let problem = match root.get("format") {
            Some(Value::Integer(1)) => return Ok(()),
            Some(Value::Integer(other)) => format!(
                "format = {other}: known are 1 (our own rig) and 2 (any unit, or a scenario with [[channel]]s)"
            ),
            Some(other) => format!("format = {other}: a whole number is wanted, without quotes: 1 or 2"),
            None => {
                let general = ["fmu", "channel", "state", "candidate", "ports"];
                let format = if general.iter().any(|key| root.contains_key(*key)) { 2 } else { 1 };
                return Err(self.wrong(1, format!("`format = {format}` is missing")));
            }
        };
        Err(self.wrong(self.line_of("format"), problem))
    }

    /// The line with some words.
    fn line_with(&self, words: &str) -> usize {
        self.text.lines().position(|line| line.contains(words)).map_or(1, |place| place + 1)
    }

    /// The standard deviations that `[noise]` states, by column.
    fn noise(&self, root: &toml::Table) -> Result<BTreeMap<String, f64>, Error> {
        let (mut noise, mut values) = (BTreeMap::new(), BTreeMap::new());
        flatten(root.get("noise"), "", &mut values);
        for (name, value) in values {
            let known = columns();
            if !known.contains(&name) {
                let suggested = nearest(&name, known.iter().map(String::as_str));
                let problem = format!("[noise] {name} is no column of a log; {suggested}");
                return Err(self.wrong(self.line_of(&name), problem));
            }
            match number(&value) {
                Some(sigma) if sigma.is_finite() && sigma >= 0.0 => drop(noise.insert(name, sigma)),
                _ => {
                    let problem = format!("[noise] {name} = {value}: a standard deviation, 0 or larger");
                    return Err(self.wrong(self.line_of(&name), problem));
                }
            }
        }
        Ok(noise)
    }

    /// The runs' folders, which must be there.
    fn runs(&self, root: &toml::Table) -> Result<Vec<String>, Error> {
        let entries = root.get("run").and_then(Value::as_array).cloned().unwrap_or_default();
        let mut runs: Vec<String> = Vec::new();
        for entry in &entries {
            let Some(dir) = entry.get("dir").and_then(Value::as_str) else {
                let problem = "a [[run]] needs `dir = \"run-01\"`";
                return Err(self.wrong(self.line_of("run]]"), problem.into()));
            };
            let line = self.line_with(&format!("\"{dir}\""));
            let folder = self.path.parent().unwrap_or(Path::new("."));
            if leaves(Path::new(dir)) {
                let problem = format!(
                    "dir = {dir:?} leads out of the data set's folder, {}: copy the run there, or put a link to it there",
                    folder.display()
                );
                return Err(self.wrong(line, problem));
            }
            if !folder.join(dir).is_dir() {
                let there = folders(folder);
                let suggested = nearest(dir, there.iter().map(String::as_str));
                let problem = format!("dir = {dir:?}: no such folder in {}; {suggested}", folder.display());
                return Err(self.wrong(line, problem));
            }
            if runs.iter().any(|known| known == dir) {
                return Err(self.wrong(line, format!("dir = {dir:?}: this run is listed twice")));
            }
            runs.push(dir.to_owned());
        }
        if runs.is_empty() {
            return Err(self.wrong(1, "no [[run]] with `dir = \"run-01\"`".into()));
        }
        Ok(runs)
    }
}

/// Every column that a log may hold, as `[noise]` names it.
fn columns() -> Vec<String> {
    CHANNELS.iter().map(|channel| format!("{}.{}", channel.file.unit(), channel.column)).collect()
}

fn folders(path: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(path).into_iter().flatten().filter_map(Result::ok);
    let named = |entry: std::fs::DirEntry| entry.file_name().into_string().ok();
    let mut all: Vec<String> = entries.filter(|entry| entry.path().is_dir()).filter_map(named).collect();
    all.sort();
    all
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
