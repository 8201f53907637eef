//! The files of a diagnosis.

use crate::diagnosis::Diagnosis;
use crate::error::Error;
use std::path::Path;

/// All files that a diagnosis may write: an earlier one's next experiment or inputs must not stand beside a new one's.
pub const FILES: [&str; 6] = [
    "diagnosis.json",
    "amended.toml",
    "report.html",
    "next_experiment.toml",
    crate::general::INPUTS,
    crate::general::INPUT_LINES,
];

/// How a scenario that a run writes begins; one of a diagnosis says so instead.
const BY_A_RUN: &str = "# Written by the run: every value that was used.";
const BY_A_DIAGNOSIS: &str = "# Written by the diagnosis: every value that a run of it uses.";

/// A scenario that nobody has run yet.
fn written_here(scenario: &str) -> String {
    scenario.replacen(BY_A_RUN, BY_A_DIAGNOSIS, 1)
}

impl Diagnosis {
    /// `diagnosis.json` as text.
    pub fn to_json(&self) -> String {
        // floats that are not finite become null; nothing else can fail here
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    /// Writes `diagnosis.json`, `amended.toml`, the next experiment's scenario if there is one, and `report.html`.
    ///
    /// # Errors
    /// The folder or a file can't be written.
    pub fn write(&self, folder: &Path) -> Result<(), Error> {
        let put = |name: &str, text: &str| {
            let path = folder.join(name);
            std::fs::write(&path, text).map_err(|source| Error::Io { path, source })
        };
        std::fs::create_dir_all(folder).map_err(|source| Error::Io { path: folder.to_owned(), source })?;
        put("diagnosis.json", &(self.to_json() + "\n"))?;
        put("amended.toml", &written_here(&self.amended))?;
        self.attachments.iter().try_for_each(|(name, text)| put(name, text))?;
        if let Some(experiment) = &self.experiment {
            put("next_experiment.toml", &written_here(experiment))?;
        }
        put("report.html", &crate::report_page::html(self)?)
    }
}

#[cfg(test)]
mod tests {
    use crate::diagnosis::{
        Closing, Correction, Diagnosis, Effect, Gap, Member, NextExperiment, RunTrace, Separation, Term,
        Unknown, Where,
    };
    use crate::error::Notice;
    use crate::provenance::{Provenance, Used};
    use serde_json::Value;

    #[test]
    fn law_an_amended_scenario_is_not_said_to_come_from_a_run() {
        let writer = include_str!("../../orchestrator/src/scenario/write.rs");
        assert!(writer.contains(super::BY_A_RUN), "as it begins there");
        let text = super::written_here(&format!("# fed with a log.\n{}\nformat = 1\n", super::BY_A_RUN));
        assert_eq!(text, format!("# fed with a log.\n{}\nformat = 1\n", super::BY_A_DIAGNOSIS));
    }

    fn effect() -> Effect {
        Effect {
            name: "box.C".into(),
            class: vec!["box.C".into()],
            value: 2.0,
            ci95: [1.0, 3.0],
            probability: 0.9,
            members: vec![Member { name: "box.C".into(), probability: 0.9 }],
            phrase: "heat capacity".into(),
            unit: "J/K".into(),
            off: 1.0,
            at_end: false,
            unbounded: false,
        }
    }

    fn next() -> NextExperiment {
        let line = Separation {
            experiment: "step box.u".into(),
            loss: Some(12.0),
            pair: vec!["box.C".into(), "box.k".into()],
            certainty: None,
            problem: None,
        };
        NextExperiment {
            what: "step box.u".into(),
            separates: vec!["box.C".into(), "box.k".into()],
            scenario: None,
            leaves_open: Vec::new(),
            separation: vec![line],
            told: 4.0,
            planned: None,
        }
    }

    fn correction() -> Correction {
        let (name, measure, phrase) = ("spring".into(), "N·m".into(), "a spring".into());
        Correction {
            label: "a labelled correction".into(),
            unit: "residual".into(),
            terms: vec![Term { name, value: 1.0, ci95: [0.0, 2.0], measure, phrase }],
            gap: Closing { before: 1.0, after: 0.5, floor: 0.1, closed: 0.8, held_out_runs: Vec::new() },
            supersedes: Vec::new(),
            parameters: Vec::new(),
            usual: 0.5,
            left: Vec::new(),
        }
    }

    /// With at least one entry in each list of records.
    fn diagnosis() -> Diagnosis {
        let runs = vec![Used { run: "a.csv".into(), rows: [("T".to_owned(), 3)].into() }];
        let (signal, region) = ("box.T".to_owned(), "1 of 2 windows".to_owned());
        let traces = vec![RunTrace { run: "a.csv".into(), trace: vec![[0.0, 1.0]] }];
        Diagnosis {
            provenance: Provenance { runs, ..Provenance::default() },
            effects: vec![effect()],
            place: vec![Where { signal, share: 1.0, from: 0.0, to: 1.0, region }],
            unknown: Some(Unknown { traces, ..Unknown::default() }),
            correction: Some(correction()),
            next_experiment: Some(next()),
            minimum_detectable: [("box.k".to_owned(), 0.1)].into(),
            gaps: vec![Gap::default()],
            cross_validation: vec![Gap::default()],
            notices: vec![Notice { file: "a.csv".into(), line: 1, message: "a hole".into() }],
            ..Diagnosis::default()
        }
    }

    /// Paths of all keys, `effects[].name`. Names of variables and logs are no keys.
    fn paths(value: &Value, above: &str, all: &mut Vec<String>) {
        match value {
            Value::Array(entries) => entries.iter().for_each(|one| paths(one, &format!("{above}[]"), all)),
            Value::Object(entries) if above != "minimum_detectable" && !above.ends_with(".rows") => {
                for (key, value) in entries {
                    let path = if above.is_empty() { key.clone() } else { format!("{above}.{key}") };
                    paths(value, &path, all);
                    all.push(path);
                }
            }
            _ => {}
        }
    }

    #[test]
    fn every_key_stands_on_its_page_and_no_other() {
        let page = include_str!("../../docs/diagnosis-json.md");
        let (mut all, value) = (Vec::new(), serde_json::to_value(diagnosis()).expect("it can be written"));
        paths(&value, "", &mut all);
        all.sort();
        all.dedup();
        let rows = page.lines().filter(|line| line.starts_with("| `"));
        let told: Vec<&str> = rows.flat_map(|row| row.split('`').skip(1).step_by(2)).collect();
        let missing: Vec<&String> = all.iter().filter(|path| !told.contains(&path.as_str())).collect();
        assert!(missing.is_empty(), "docs/diagnosis-json.md lacks {missing:?}");
        let heads = page.lines().filter_map(|line| line.strip_prefix("| ")?.split(" | ").next());
        let gone: Vec<&str> = heads
            .flat_map(|head| head.split('`').skip(1).step_by(2))
            .filter(|path| all.iter().all(|known| known != path))
            .collect();
        assert!(gone.is_empty(), "no diagnosis has {gone:?}");
    }

    #[test]
    fn law_the_page_says_when_two_names_are_told_apart_and_what_counts_later() {
        let html = |diagnosis: &Diagnosis| crate::report_page::html(diagnosis).expect("it can be drawn");
        let full = diagnosis();
        let page = html(&full);
        assert!(page.contains("below 4 they count as not told"), "as the room of experiments has it");
        assert!(page.contains("NEW-DATA --after"));
        // a later diagnosis weighs names, and this one has none
        let nameless = Diagnosis { effects: Vec::new(), ..full };
        assert!(!html(&nameless).contains("NEW-DATA --after"));
    }
}
