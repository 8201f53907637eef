//! Reads the folder of a run: `resolved.toml`, `results.csv`, `summary.json` where there is one, and pictures.

use crate::Error;
use crate::frames::{self, Frame};
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
    /// Names and values of the other columns. What is no number is NaN.
    pub columns: Vec<(String, Vec<f64>)>,
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
        let (times, columns) = rows(&folder.join("results.csv"))?;
        let summary = summary(&folder.join("summary.json"))?;
        let said = |path: &str| summary.pointer(path).and_then(|value| value.as_str()).map(str::to_owned);
        let title = said("/title").unwrap_or_else(|| scenario.description.clone());
        let units = summary.get("units").and_then(|units| units.as_object()).into_iter().flatten();
        let units =
            units.filter_map(|(name, unit)| Some((name.clone(), unit.as_str()?.to_owned()))).collect();
        let frames = frames::read(&folder.join("frames"))?;
        Ok(Self { title, verdict: said("/verdict/words"), scenario, times, columns, units, frames })
    }

    /// The time at which it failed by its scenario's own rule.
    pub fn failed(&self) -> Option<f64> {
        let rule = self.scenario.report.get("verdict")?.get("fails_when")?.as_str()?;
        let row = self.column(rule)?.iter().position(|value| *value == 1.0)?;
        Some(self.times[row])
    }

    /// The values of a recorded variable.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|(known, _)| known == name).map(|(_, values)| values.as_slice())
    }
}

type Columns = Vec<(String, Vec<f64>)>;

fn rows(path: &Path) -> Result<(Vec<f64>, Columns), Error> {
    let refused = |why: String| Error::File { path: path.to_owned(), why };
    let mut reader = csv::Reader::from_path(path).map_err(|why| refused(why.to_string()))?;
    let head = reader.headers().map_err(|why| refused(why.to_string()))?.clone();
    if head.get(0) != Some("time") {
        let found = head.get(0).unwrap_or_default();
        return Err(refused(format!("line 1: the first column is {found:?}; it must be \"time\"")));
    }
    let mut times: Vec<f64> = Vec::new();
    let mut columns: Columns = head.iter().skip(1).map(|name| (name.to_owned(), Vec::new())).collect();
    let mut record = csv::StringRecord::new();
    loop {
        match reader.read_record(&mut record) {
            Ok(true) => {}
            Ok(false) => break,
            // The last line of a run that was cut off in the middle of a row.
            Err(error) if matches!(error.kind(), csv::ErrorKind::UnequalLengths { .. }) => break,
            Err(error) => return Err(refused(error.to_string())),
        }
        let line = record.position().map_or(0, csv::Position::line);
        let time = record.get(0).and_then(|cell| cell.parse::<f64>().ok()).filter(|time| time.is_finite());
        let after = |time: &f64| times.last().is_none_or(|last| time > last);
        let Some(time) = time.filter(after) else {
            let cell = record.get(0).unwrap_or_default();
            return Err(refused(format!(
                "line {line}: time {cell:?} is no number after that of the row before"
            )));
        };
        times.push(time);
        for ((_, values), cell) in columns.iter_mut().zip(record.iter().skip(1)) {
            values.push(cell.parse().unwrap_or(f64::NAN));
        }
    }
    if times.len() < 2 {
        return Err(refused("it has fewer than two rows: there is nothing to look at".to_owned()));
    }
    Ok((times, columns))
}

fn summary(path: &Path) -> Result<serde_json::Value, Error> {
    if !path.is_file() {
        return Ok(serde_json::Value::Null);
    }
    let refused = |why: String| Error::File { path: path.to_owned(), why };
    let text = std::fs::read_to_string(path).map_err(|why| refused(why.to_string()))?;
    serde_json::from_str(&text).map_err(|why| refused(why.to_string()))
}

#[cfg(test)]
mod tests {
    use super::rows;

    #[test]
    fn law_wrong_rows_are_told_by_their_line() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("results.csv");
        let told = |text: &str| {
            std::fs::write(&path, text).expect("written");
            rows(&path).map(|(times, _)| times).map_err(|error| error.to_string())
        };
        assert_eq!(told("time,a.b\n0,1\n1,NaN\n2"), Ok(vec![0.0, 1.0]), "a line that was cut off is none");
        let wrong = told("time,a.b\n0,1\nx,2\n").expect_err("no number");
        assert!(wrong.contains("line 3") && wrong.contains("\"x\""), "{wrong}");
        assert!(told("time,a.b\n1,1\n0,2\n").expect_err("goes back").contains("line 3"));
        assert!(told("t,a.b\n1,1\n").expect_err("no time").contains("\"t\""));
        assert!(told("time,a.b\n1,1\n").expect_err("one row").contains("two rows"));
    }
}
