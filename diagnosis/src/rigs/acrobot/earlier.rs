//! An earlier diagnosis of the same machine: what its data told apart counts for the new data, too.
//!
//! Runs after an experiment are other data, so probabilities of the members of a class multiply: a principal point that is off
//! looks like a pan with one mount, and like a tilt with the mount turned, and only one name fits both.

use crate::error::Error;
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::selection::{Alternative, CLASS};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// File of a diagnosis.
const FILE: &str = "diagnosis.json";

/// For each effect that was found, the members of its class with their probabilities.
#[derive(Debug, Clone, PartialEq)]
pub struct Earlier {
    effects: Vec<BTreeMap<String, f64>>,
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
        let text =
            std::fs::read_to_string(&path).map_err(|source| Error::Io { path: path.clone(), source })?;
        let said: Said = serde_json::from_str(&text)
            .map_err(|error| Error::Earlier { path: path.clone(), problem: error.to_string() })?;
        let class =
            |effect: SaidEffect| effect.members.into_iter().map(|m| (m.name, m.probability)).collect();
        Ok(Self { effects: said.effects.into_iter().map(class).collect() })
    }

    /// Weighs the alternatives of an effect (best first, by their losses) with what was known of it. Answers the class that was
    /// known, where it is one.
    pub fn weigh(&self, list: &[Candidate], alternatives: &mut [Alternative]) -> Option<Vec<String>> {
        let name = |other: &Alternative| list[other.candidate].name;
        // the effect that most of the evidence is about
        let shared = |known: &&BTreeMap<String, f64>| {
            let open = alternatives.iter().filter(|other| other.loss < CLASS);
            open.filter_map(|other| Some(known.get(name(other))? * libm::exp(-0.5 * other.loss))).sum::<f64>()
        };
        let known = self.effects.iter().max_by(|a, b| shared(a).total_cmp(&shared(b)))?;
        if shared(&known) <= 0.0 {
            return None;
        }
        let best = known.values().copied().fold(0.0, f64::max);
        for other in alternatives.iter_mut() {
            other.loss += match known.get(list[other.candidate].name) {
                Some(probability) => (-2.0 * libm::log(probability / best)).min(CLASS),
                None => POLICY.excluded,
            };
        }
        alternatives.sort_by(|a, b| a.loss.total_cmp(&b.loss));
        let least = alternatives.first().map_or(0.0, |first| first.loss);
        alternatives.iter_mut().for_each(|other| other.loss -= least);
        Some(known.keys().cloned().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::candidates::{Motion, Side};

    fn candidate(name: &'static str) -> Candidate {
        let motion = Motion::Real { steps: &[1.0], range: (-1.0, 1.0) };
        let (side, phrase, off, steps, range) = (Side::Camera, "", 0.0, vec![1.0], (-1.0, 1.0));
        Candidate { name, side, phrase, motion, off, steps, range, nonlinear: false, attributes: &[] }
    }

    fn open(list: &[Candidate], all: &[Alternative]) -> Vec<&'static str> {
        all.iter().filter(|other| other.loss < CLASS).map(|other| list[other.candidate].name).collect()
    }

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
    fn every_class_is_what_fits_both() {
        let list = ["camera.pan", "camera.tilt", "camera.u0", "camera.v0"].map(candidate);
        let known =
            |names: [(&str, f64); 2]| names.into_iter().map(|(name, p)| (name.to_owned(), p)).collect();
        let earlier = Earlier {
            effects: vec![
                known([("camera.u0", 0.4), ("camera.pan", 0.6)]),
                known([("camera.v0", 0.5), ("camera.scale", 0.5)]),
            ],
        };
        let found = |losses: [f64; 4]| {
            let other = |(candidate, loss)| Alternative { candidate, x: 0.1, loss };
            let mut all: Vec<Alternative> = losses.into_iter().enumerate().map(other).collect();
            all.sort_by(|a, b| a.loss.total_cmp(&b.loss));
            all
        };
        // with the mount turned u0 looks like a tilt
        let mut all = found([40.0, 0.0, 1.0, 50.0]);
        assert!(earlier.weigh(&list, &mut all).is_some());
        assert_eq!(open(&list, &all), ["camera.u0"]);
        // an effect that nothing was known of
        let mut all = found([40.0, 0.0, 50.0, 50.0]);
        assert_eq!(earlier.weigh(&list, &mut all), None);
        assert_eq!(open(&list, &all), ["camera.tilt"]);
        // both data sets leave both open, and lean to one
        let mut all = found([0.0, 40.0, 1.0, 50.0]);
        assert_eq!(earlier.weigh(&list, &mut all), Some(vec!["camera.pan".into(), "camera.u0".into()]));
        assert_eq!(open(&list, &all), ["camera.pan", "camera.u0"]);
        // of losses 0 and 1, and 2 ln(0.6/0.4)
        assert!((all[1].loss - (1.0 + 2.0 * libm::log(1.5))).abs() < 1e-12);
    }
}
