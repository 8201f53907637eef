//! Reads the folder of a run: `resolved.toml`, `results.csv` (`rows.rs`), `summary.json` where there is one, and pictures.

use crate::Error;
use crate::frames::{self, Frame};
use crate::rows::{self, Column, Rows};
use orchestrator::Scenario;
use orchestrator::scenario::Given;
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
        let mut notes: Vec<String> = note.into_iter().chain(strangers(&path, &scenario, &columns)).collect();
        let summary = summary(&folder.join("summary.json"))?;
        let said = |path: &str| summary.pointer(path).and_then(|value| value.as_str()).map(str::to_owned);
        let title = said("/title").unwrap_or_else(|| scenario.description.clone());
        let units = summary.get("units").and_then(|units| units.as_object()).into_iter().flatten();
        let units =
            units.filter_map(|(name, unit)| Some((name.clone(), unit.as_str()?.to_owned()))).collect();
        let (frames, whence) = pictures(folder, &scenario)?;
        notes.extend(whence);
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

/// Pictures of the run's folder, or else of the one that its camera was given; and a word on these, which another run may have replaced.
fn pictures(folder: &Path, scenario: &Scenario) -> Result<(Vec<Frame>, Option<String>), Error> {
    let own = frames::read(&folder.join("frames"))?;
    let Some((name, given)) = given_folder(scenario).filter(|_| own.is_empty()) else {
        return Ok((own, None));
    };
    let found = frames::read(Path::new(&given))?;
    let note = match (found.is_empty(), Path::new(&given).file_name() == Some("frames".as_ref())) {
        (false, _) => Some(format!("pictures are those of {given}, where {name} put them")),
        // the run's own folder, which has been moved, or in which no frame came
        (true, true) => None,
        (true, false) => Some(format!(
            "there are no pictures: {name} = {given:?}, and no such folder is seen from here, or it holds none"
        )),
    };
    Ok((found, note))
}

/// The parameter that says where the camera's pictures go, and its value, by `[report.picture]`.
fn given_folder(scenario: &Scenario) -> Option<(String, String)> {
    let picture = scenario.report.get("picture")?;
    let said = |key: &str| picture.get(key).and_then(|value| value.as_str());
    let (unit, parameter) = (said("unit")?, said("directory")?);
    let (_, given) = scenario
        .units
        .iter()
        .find(|entry| entry.name == unit)?
        .set
        .iter()
        .find(|(name, _)| name == parameter)?;
    let given = match &given.value {
        Given::Toml(value) => value.as_str()?.to_owned(),
        Given::Text(text) => text.clone(),
    };
    (!given.is_empty()).then(|| (format!("{unit}.{parameter}"), given))
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
