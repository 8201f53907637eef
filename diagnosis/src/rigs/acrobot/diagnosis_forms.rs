//! Our own rig in the words of any diagnosis: where it comes from, and an effect that goes by one name.

use super::candidates::Candidate;
use super::dataset::DataSet;
use crate::diagnosis::{Effect, Member};
use crate::provenance::{Provenance, Used};

impl Provenance {
    /// Where a diagnosis of this data set comes from.
    pub fn of(data: &DataSet) -> Self {
        let runs = data.runs.iter().map(|run| {
            let logs =
                [("camera.csv", &run.camera), ("controller.csv", &run.controller), ("plant.csv", &run.plant)];
            let rows =
                logs.into_iter().filter_map(|(file, log)| Some((file.to_owned(), log.as_ref()?.len())));
            Used { run: run.name.clone(), rows: rows.collect() }
        });
        Self {
            data: data.path.display().to_string(),
            nominal: data.manifest.scenario.clone(),
            set: data.manifest.set.iter().map(|(name, value)| format!("{name} = {value}")).collect(),
            runs: runs.collect(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            command: format!("acroscope diagnose {}", data.path.display()),
        }
    }
}

impl Effect {
    /// An effect that is what it is: no other candidate does the same.
    pub(crate) fn alone(candidate: &Candidate, value: f64, ci95: [f64; 2], probability: f64) -> Self {
        let name = candidate.name.to_owned();
        Self {
            class: vec![name.clone()],
            members: vec![Member { name: name.clone(), probability }],
            name,
            value,
            ci95,
            probability,
            phrase: candidate.phrase.to_owned(),
            unit: String::new(),
            off: candidate.value(candidate.off),
            at_end: false,
            unbounded: false,
        }
    }
}
