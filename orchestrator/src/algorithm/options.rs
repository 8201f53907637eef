//! What can be set of an algorithm, in `[experiment.options]`.

use crate::error::Error;
use crate::scenario::Placed;
use crate::suggest::nearest;

/// A number that can be set.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    pub(super) name: &'static str,
    pub(super) default: f64,
    pub(super) least: f64,
    pub(super) most: f64,
    /// Only whole numbers.
    pub(super) whole: bool,
}

/// What was set.
pub(crate) struct Options<'a> {
    pub(super) known: &'static [Known],
    pub(super) given: &'a [(String, Placed<f64>)],
}

impl Options<'_> {
    /// What was set, or the default.
    pub(super) fn get(&self, name: &str) -> f64 {
        let given = self.given.iter().find(|(given, _)| given == name).map(|(_, value)| value.value);
        let default = || self.known.iter().find(|known| known.name == name).map(|known| known.default);
        given.or_else(default).unwrap_or(f64::NAN)
    }

    /// Whether what was set is known and in its range.
    pub(super) fn check(&self, algorithm: &str) -> Result<(), Error> {
        for (name, value) in self.given {
            let wrong = |what: String, expected: String| Error::Scenario {
                place: value.place.clone(),
                what,
                expected,
            };
            let Some(known) = self.known.iter().find(|known| known.name == name) else {
                let expected = match self.known {
                    [] => "it has no options".into(),
                    known => nearest(name, known.iter().map(|known| known.name)),
                };
                return Err(wrong(format!("algorithm {algorithm:?} has no option {name:?}"), expected));
            };
            let Known { least, most, whole, .. } = *known;
            let number = value.value;
            if !(least..=most).contains(&number) || whole && number.fract() != 0.0 {
                let kind = if whole { "a whole number" } else { "a number" };
                return Err(wrong(format!("{name} = {number}"), format!("{kind} from {least} to {most}")));
            }
        }
        Ok(())
    }
}
