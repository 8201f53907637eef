//! An earlier diagnosis of the same machine: what its data told apart counts for the new data, too.
//!
//! Runs after an experiment are other data, so probabilities of the members of a class multiply: a principal point that is off
//! looks like a pan with one mount, and like a tilt with the mount turned, and only one name fits both.

use crate::error::Error;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// File of a diagnosis.
const FILE: &str = "diagnosis.json";

/// For each effect that was found, the members of its class with their probabilities.
#[derive(Debug, Clone, PartialEq)]
pub struct Earlier {
    pub(crate) effects: Vec<BTreeMap<String, f64>>,
}

#[derive(serde::Deserialize)]
struct Said {
    effects: Vec<SaidEffect>,
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
        let path: PathBuf = if path.is_dir() { path.join(FILE) } else { path.to_owned() };
        let text = orchestrator::plain::read_text(&path)
            .map_err(|source| Error::Io { path: path.clone(), source })?;
        let said: Said = serde_json::from_str(&text)
            .map_err(|error| Error::Earlier { path: path.clone(), problem: error.to_string() })?;
        let class =
            |effect: SaidEffect| effect.members.into_iter().map(|m| (m.name, m.probability)).collect();
        Ok(Self { effects: said.effects.into_iter().map(class).collect() })
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
}
