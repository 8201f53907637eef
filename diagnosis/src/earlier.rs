//! An earlier diagnosis of the same machine: what its data told apart counts for the new data, too.
//!
//! Runs after an experiment are other data, so probabilities of the members of a class multiply: a principal point that is off
//! looks like a pan with one mount, and like a tilt with the mount turned, and only one name fits both.

use crate::error::Error;
use orchestrator::{Fmu, Scenario};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// File of a diagnosis.
const FILE: &str = "diagnosis.json";

/// For each effect that was found, the members of its class with their probabilities.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Earlier {
    pub(crate) effects: Vec<BTreeMap<String, f64>>,
    /// As it was named.
    pub(crate) folder: String,
    /// Its nominal model, as the diagnosis says it.
    pub(crate) nominal: String,
}

#[derive(serde::Deserialize)]
struct Said {
    effects: Vec<SaidEffect>,
    #[serde(default)]
    provenance: SaidProvenance,
}

#[derive(Default, serde::Deserialize)]
#[serde(default)]
struct SaidProvenance {
    nominal: String,
}

#[derive(serde::Deserialize)]
struct SaidEffect {
    members: Vec<SaidMember>,
}

#[derive(serde::Deserialize)]
struct SaidMember {
    name: String,
    probability: f64,
}

impl Earlier {
    /// Reads the folder that `acroscope diagnose` wrote, or its `diagnosis.json`.
    ///
    /// # Errors
    /// There is none, or it isn't one that we wrote.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let folder = path.display().to_string();
        let path: PathBuf = if path.is_dir() { path.join(FILE) } else { path.to_owned() };
        let text = orchestrator::plain::read_text(&path)
            .map_err(|source| Error::Io { path: path.clone(), source })?;
        let said: Said = serde_json::from_str(&text)
            .map_err(|error| Error::Earlier { path: path.clone(), problem: error.to_string() })?;
        let class =
            |effect: SaidEffect| effect.members.into_iter().map(|m| (m.name, m.probability)).collect();
        let effects = said.effects.into_iter().map(class).collect();
        Ok(Self { effects, folder, nominal: said.provenance.nominal })
    }

    /// Refuses one of another machine: the model of the new data, in words, has none of the names that were found.
    ///
    /// # Errors
    /// Says of what the earlier one is, and what it found.
    pub(crate) fn fits(&self, model: &str, has: impl Fn(&str) -> bool) -> Result<(), Error> {
        let names: Vec<&str> = self.effects.iter().flatten().map(|(name, _)| name.as_str()).collect();
        if names.is_empty() || names.iter().any(|name| has(name)) {
            return Ok(());
        }
        Err(Error::Option {
            option: "--after",
            given: self.folder.clone(),
            problem: format!(
                "it is a diagnosis of {} and found {}, of which {model}, the model of these data, has nothing; wanted is an earlier diagnosis \
                 of the same machine",
                self.nominal,
                names.join(", ")
            ),
        })
    }

    /// As [`Earlier::fits`], for any unit or scenario.
    ///
    /// # Errors
    /// The earlier one is of another machine.
    pub(crate) fn fits_model(&self, scenario: &Scenario, fmus: &[Fmu]) -> Result<(), Error> {
        let files: Vec<&str> = scenario.units.iter().map(|unit| unit.fmu.value.as_str()).collect();
        let has = |name: &str| {
            // what the master adds at a port stands after a colon
            let full = name.split(':').next().unwrap_or(name);
            let mut units = scenario.units.iter().zip(fmus);
            units.any(|(unit, fmu)| {
                let variable = full.strip_prefix(&unit.name).and_then(|rest| rest.strip_prefix('.'));
                variable.is_some_and(|variable| fmu.description().variable(variable).is_some())
            })
        };
        self.fits(&files.join(", "), has)
    }

    /// Losses (deviance over the least) of those that could stand in an effect's place, by name, after what was known of it counts, too; and
    /// the class that was known. Nothing where the earlier diagnosis found nothing of it.
    ///
    /// Beyond `class` no name is a member; `excluded` is added to a name that was none before.
    pub(crate) fn weighed(
        &self,
        others: &[(&str, f64)],
        class: f64,
        excluded: f64,
    ) -> Option<(Vec<f64>, Vec<String>)> {
        // the effect that most of the evidence is about
        let shared = |known: &&BTreeMap<String, f64>| {
            let open = others.iter().filter(|(_, loss)| *loss < class);
            open.filter_map(|(name, loss)| Some(known.get(*name)? * libm::exp(-0.5 * loss))).sum::<f64>()
        };
        let known = self.effects.iter().max_by(|a, b| shared(a).total_cmp(&shared(b)))?;
        if shared(&known) <= 0.0 {
            return None;
        }
        let best = known.values().copied().fold(0.0, f64::max);
        let both = |(name, loss): &(&str, f64)| {
            loss + match known.get(*name) {
                Some(probability) => (-2.0 * libm::log(probability / best)).min(class),
                None => excluded,
            }
        };
        let both: Vec<f64> = others.iter().map(both).collect();
        let least = both.iter().copied().fold(f64::INFINITY, f64::min);
        Some((both.iter().map(|loss| loss - least).collect(), known.keys().cloned().collect()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_that_is_no_diagnosis_is_named() {
        let folder = std::env::temp_dir().join(format!("diagnosis-earlier-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        assert!(matches!(Earlier::load(&folder), Err(Error::Io { .. })));
        std::fs::write(folder.join(FILE), "{\"effects\": 3}").expect("a file");
        let said = Earlier::load(&folder).expect_err("no list").to_string();
        assert!(said.contains(FILE) && said.contains("acroscope diagnose"), "{said}");
        let text = r#"{"effects": [{"members": [{"name": "camera.k1", "probability": 0.99}]}]}"#;
        std::fs::write(folder.join(FILE), text).expect("a file");
        assert_eq!(Earlier::load(&folder).expect("what is wanted").effects[0]["camera.k1"], 0.99);
        let _ = std::fs::remove_dir_all(&folder);
    }

    #[test]
    fn bad_input_a_diagnosis_of_another_machine_is_refused_with_what_it_is_of() {
        let found = Earlier {
            effects: vec![[("motor.b".to_owned(), 0.9)].into()],
            folder: "out/first".into(),
            nominal: "motor.fmu".into(),
        };
        let told = found.fits("heater.fmu", |name| name == "heater.Q2").expect_err("a motor's").to_string();
        let of = "--after out/first: it is a diagnosis of motor.fmu and found motor.b";
        assert!(told.starts_with(of) && told.contains("of the same machine"), "{told}");
        assert!(told.contains("of which heater.fmu, the model of these data, has nothing"), "{told}");
        assert!(found.fits("motor.fmu", |name| name == "motor.b").is_ok());
        let nothing = Earlier::default();
        assert!(nothing.fits("heater.fmu", |_| false).is_ok(), "what found nothing weighs nothing");
    }
}
