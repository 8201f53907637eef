//! Reads the folder of a run: `resolved.toml`, `results.csv` (`rows.rs`), `summary.json` where there is one, and pictures.

use crate::Error;
use crate::frames::{self, Frame};
use crate::rows::{self, Column, Rows};
use orchestrator::Scenario;
use std::collections::BTreeMap;
use std::path::Path;

/// A run as it lies in its folder.
pub struct Results {
    /// What it is about: the title of its page, or the scenario's description.
    pub title: String,
    /// The verdict in words, where the run left one.
    pub verdict: Option<String>,
    /// What was run.
    pub scenario: Scenario,
    /// Time of each row, s.
    pub times: Vec<f64>,
    /// The other columns.
    pub columns: Vec<Column>,
    /// What a person should know.
    pub notes: Vec<String>,
    /// Physical units of columns, where the run said them.
    pub units: BTreeMap<String, String>,
    /// Pictures that were kept, in order.
    pub frames: Vec<Frame>,
}

impl Results {
    /// Reads a folder.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        for lacks in ["results.csv", "resolved.toml"] {
            if !folder.join(lacks).is_file() {
                return Err(Error::NoResult { folder: folder.to_owned(), lacks });
            }
        }
        let scenario = Scenario::load(folder.join("resolved.toml"))?;
        let path = folder.join("results.csv");
        let Rows { times, columns, note } = rows::read(&path)?;
        let notes = note.into_iter().chain(strangers(&path, &scenario, &columns)).collect();
        let summary = summary(&folder.join("summary.json"))?;
        let said = |path: &str| summary.pointer(path).and_then(|value| value.as_str()).map(str::to_owned);
        let title = said("/title").unwrap_or_else(|| scenario.description.clone());
        let units = summary.get("units").and_then(|units| units.as_object()).into_iter().flatten();
        let units =
            units.filter_map(|(name, unit)| Some((name.clone(), unit.as_str()?.to_owned()))).collect();
        let frames = frames::read(&folder.join("frames"))?;
        Ok(Self { title, verdict: said("/verdict/words"), scenario, times, columns, notes, units, frames })
    }

    /// The time at which it failed by its scenario's own rule.
    pub fn failed(&self) -> Option<f64> {
        let rule = self.scenario.report.get("verdict")?.get("fails_when")?.as_str()?;
        let row = self.column(rule)?.iter().position(|value| *value == 1.0)?;
        Some(self.times[row])
    }

    /// A recorded variable.
    pub fn recorded(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// The values of a recorded variable.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.recorded(name).map(|column| column.values.as_slice())
    }
}

fn summary(path: &Path) -> Result<serde_json::Value, Error> {
    if !path.is_file() {
        return Ok(serde_json::Value::Null);
    }
    let refused = |why: String| Error::File { path: path.to_owned(), why };
    let text = std::fs::read_to_string(path).map_err(|why| refused(why.to_string()))?;
    serde_json::from_str(&text).map_err(|why| refused(why.to_string()))
}

/// Columns that no unit of the scenario has, and signals that its page shows and the file lacks: a name was changed in one of the two.
fn strangers(path: &Path, scenario: &Scenario, columns: &[Column]) -> Vec<String> {
    let is_known = |name: &str| {
        let unit = name.split_once('.').map(|(unit, _)| unit);
        unit.is_some_and(|unit| scenario.units.iter().any(|known| known.name == unit))
    };
    let file = path.display();
    let units: Vec<&str> = scenario.units.iter().map(|unit| unit.name.as_str()).collect();
    let unknown = columns.iter().map(|column| &column.name).filter(|name| !is_known(name));
    let unknown = unknown.map(|name| {
        format!("{file}: column {name:?} is of no unit of resolved.toml; expected UNIT.VARIABLE with a unit of {}", units.join(", "))
    });
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    let lacking = shown(scenario).into_iter().filter(|signal| !names.contains(signal));
    let lacking = lacking.map(|signal| {
        let hint = orchestrator::nearest(signal, names.iter().copied());
        format!("{file}: it has no column {signal:?}, which [report] of resolved.toml shows: {hint}")
    });
    unknown.chain(lacking).collect()
}

/// The signals of the graphs that the scenario asks for, each once.
fn shown(scenario: &Scenario) -> Vec<&str> {
    let graphs = scenario.report.get("graphs").and_then(|graphs| graphs.as_array());
    let lines = graphs.into_iter().flatten().filter_map(|graph| graph.get("lines")?.as_array()).flatten();
    let mut names: Vec<&str> = lines
        .flat_map(|line| ["signal", "minus"].into_iter().filter_map(move |key| line.get(key)?.as_str()))
        .collect();
    names.sort_unstable();
    names.dedup();
    names
}
