//! Where a diagnosis comes from: what was compared with what, and how to make it again. No wall clock: equal input gives equal bytes.

use serde::Serialize;
use std::collections::BTreeMap;

/// The head of a diagnosis.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Provenance {
    /// The data set's folder, as typed.
    pub data: String,
    /// The nominal scenario.
    pub nominal: String,
    /// What `[set]` changes in it, `instance.variable = value`.
    pub set: Vec<String>,
    /// The runs that were used.
    pub runs: Vec<Used>,
    /// Version of this program.
    pub version: String,
    /// The command that makes it again.
    pub command: String,
}

/// What was used of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Used {
    /// Its folder.
    pub run: String,
    /// Rows of each log.
    pub rows: BTreeMap<String, usize>,
}

impl Provenance {
    /// Its lines for people: what, and its value.
    pub fn lines(&self) -> Vec<(&'static str, String)> {
        let set = if self.set.is_empty() { String::new() } else { format!(" with {}", self.set.join(", ")) };
        let of = |used: &Used| {
            let rows: Vec<String> = used.rows.iter().map(|(file, rows)| format!("{file} {rows}")).collect();
            format!("{} ({} rows)", used.run, rows.join(", "))
        };
        vec![
            ("data set", self.data.clone()),
            ("nominal model", format!("{}{set}", self.nominal)),
            ("runs", self.runs.iter().map(of).collect::<Vec<_>>().join("; ")),
            ("made by", format!("acroscope {}", self.version)),
            ("made again by", self.command.clone()),
        ]
    }
}
