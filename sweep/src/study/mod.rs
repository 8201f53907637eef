//! What is to be swept: the study.
//!
//! ```toml
//! format = 1
//! scenario = "visual-servo"            # a shipped one, or a file beside this one
//! stop = 5                             # s; optional
//! until = "plant.contact"              # optional: each run ends when this is true, or "plant.q2 > 2"
//! [set]                                # optional: values of all cases
//! "camera.sigma" = 5
//! [grid]                               # or [list], [random], [latin-hypercube], [sobol]
//! "camera.T_delay" = { from = 0.0, to = 0.06, step = 0.02 }
//! "camera.omega_cam" = [30, 60]
//! [scalars]
//! fell = { signal = "plant.contact", reduce = "first_true" }
//! [signals]                            # optional
//! variables = ["plant.q*"]
//! every = 0.01
//! ```

mod designs;
mod read;
mod text;
mod words;

pub use words::Words;

pub(crate) use text::Origin;

use crate::design::Design;
use crate::error::Error;
use crate::scalar::Scalar;
use orchestrator::Value;
use orchestrator::scenario::Placed;
use orchestrator::time::Rational;
use report::tally::Test;
use std::path::{Path, PathBuf};

/// Name, and text of the file. A new one is a file in `sweep/studies/` and a line here.
pub const SHIPPED: &[(&str, &str)] = &[("delay-and-rate", include_str!("../../studies/delay-and-rate.toml"))];

/// A study as it was written. Whether its names and types fit the units shows when it is planned.
#[derive(Debug, Clone)]
pub struct Study {
    /// As it was written.
    pub(crate) text: String,
    /// Its name, for titles and folders.
    pub name: String,
    /// The scenario: a shipped one, or a path.
    pub scenario: String,
    /// Where it was named.
    pub(crate) scenario_place: String,
    /// Stop time as it was typed, and where.
    pub(crate) stop: Option<(String, String)>,
    pub(crate) until: Option<Until>,
    pub(crate) set: Vec<Parameter>,
    /// What varies, in the order of the columns.
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) design: Design,
    pub(crate) scalars: Vec<Scalar>,
    pub(crate) signals: Option<Signals>,
}

/// A parameter and where it was written; in `[set]` with its value.
#[derive(Debug, Clone)]
pub(crate) struct Parameter {
    pub(crate) name: String,
    pub(crate) place: String,
    pub(crate) value: Option<Value>,
}

/// When a run ends before its stop.
#[derive(Debug, Clone)]
pub(crate) struct Until {
    pub(crate) signal: String,
    pub(crate) test: Test,
    pub(crate) place: String,
}

/// Which signals are kept.
#[derive(Debug, Clone)]
pub(crate) struct Signals {
    pub(crate) variables: Vec<Placed<String>>,
    /// Time between kept rows in s; `None`: all.
    pub(crate) every: Option<Rational>,
}

impl Study {
    /// Loads a shipped study by its name, or any other by its path.
    ///
    /// # Errors
    /// If there is none, or it says something that the format doesn't have.
    pub fn load(name: &str) -> Result<Self, Error> {
        if let Some((stem, text)) = SHIPPED.iter().find(|(stem, _)| *stem == name) {
            return Self::parse(text, Path::new(&format!("sweep/studies/{stem}.toml")));
        }
        let path = Path::new(name);
        if path.exists() {
            return Self::parse(&orchestrator::plain::read_text(path).map_err(Error::file(path))?, path);
        }
        let shipped: Vec<&str> = SHIPPED.iter().map(|(name, _)| *name).collect();
        Err(Error::Unknown {
            name: name.into(),
            shipped: shipped.join(", "),
            suggestion: match scenarios::SHIPPED.iter().any(|(known, _)| *known == name) {
                true => {
                    format!("{name} is a scenario: say what varies, e.g. --grid UNIT.VARIABLE=FROM:TO:STEP")
                }
                false => orchestrator::nearest(name, shipped.into_iter()),
            },
        })
    }

    /// Reads a study from text. Errors name `origin`; the scenario is looked for beside it.
    ///
    /// # Errors
    /// If the text says something that the format doesn't have.
    pub fn parse(text: &str, origin: &Path) -> Result<Self, Error> {
        let name = origin.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let folder = origin.parent().unwrap_or(Path::new(""));
        read::study(text, &Origin::File(origin.display().to_string()), name, folder)
    }

    /// The study that words of a command line describe.
    ///
    /// # Errors
    /// If they describe none.
    pub fn of_words(words: &Words) -> Result<Self, Error> {
        if is_study(&words.scenario) {
            return Err(Error::Study {
                place: "--grid".into(),
                what: format!("{} is a study, which says itself what varies", words.scenario),
                expected: "a scenario with --grid, or the study without it".into(),
            });
        }
        let (text, places) = words.text()?;
        let stem = PathBuf::from(&words.scenario);
        let stem = stem.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        read::study(&text, &Origin::Words(places), stem, Path::new(""))
    }
}

/// Whether it is a study where a scenario is wanted: one of the shipped ones, or a file that names its own scenario.
fn is_study(name: &str) -> bool {
    let path = Path::new(name);
    if !path.is_file() {
        return SHIPPED.iter().any(|(known, _)| *known == name);
    }
    let text = orchestrator::plain::read_text(path).unwrap_or_default();
    text.parse::<toml::Table>()
        .is_ok_and(|table| table.contains_key("scenario") && !table.contains_key("units"))
}

#[cfg(test)]
mod tests {
    use super::{Study, Words};

    #[test]
    fn bad_input_a_grid_over_a_study_is_refused_as_one() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("s.toml");
        std::fs::write(&path, "format = 1\nscenario = \"full-state\"\n").expect("writable");
        for scenario in [path.to_string_lossy().into_owned(), "delay-and-rate".into()] {
            let grid = vec!["plant.b_joint=0,1".into()];
            let refused = Study::of_words(&Words { scenario, grid, ..Words::default() }).map(drop);
            let text = refused.expect_err("a study").to_string();
            assert!(text.contains("is a study") && text.contains("a scenario with --grid"), "{text}");
        }
    }
    use crate::Reduce;

    #[test]
    fn law_the_shipped_study_takes_the_peak_of_the_torque() {
        let study = Study::load("delay-and-rate").expect("it is shipped");
        let tau = study.scalars.iter().find(|scalar| scalar.name == "tau").expect("it has one");
        // The arm is held by torques of either sign: the largest of them says nothing of how hard the motor works.
        assert!(matches!(tau.reduce, Reduce::Peak));
    }
}
