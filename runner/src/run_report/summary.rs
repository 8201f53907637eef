//! `summary.json`: what came of a run and where it comes from, for programs.

use report::{Provenance, Verdict};
use serde::Serialize;
use std::collections::BTreeMap;

/// The file, field by field.
#[derive(Debug, Serialize)]
pub struct Summary {
    /// Of this file.
    pub format: u32,
    /// Title of the page.
    pub title: String,
    /// How the run ended.
    pub ended: Ended,
    /// Rows of `results.csv`.
    pub rows: u64,
    /// Simulated time at which the run failed by the scenario's own rule, s.
    pub failed_at: Option<f64>,
    /// What came of it.
    pub verdict: Verdict,
    /// Physical units of the columns of `results.csv` that have one.
    pub units: BTreeMap<String, String>,
    /// Where it comes from.
    pub provenance: Provenance,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ended {
    /// In a word.
    pub how: How,
    /// Simulated time of the last row, s.
    pub time: f64,
    /// The error's text.
    pub error: Option<String>,
}

/// How a run ended, in a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum How {
    /// At its stop time.
    Stop,
    /// By a unit that wanted the end.
    Unit,
    /// By a signal.
    Interrupted,
    /// By an error.
    Error,
}

impl Summary {
    /// As text.
    pub fn to_json(&self) -> String {
        // Floats that are not finite become null; nothing else can fail here.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }
}
