//! Values with which a unit can't be run. They are no way to go: there, a parameter explains nothing, and that is told.

use super::linearise::{Chord, Engine};
use crate::error::{Error, Notice};

impl Engine {
    /// What a chord changes, or nothing where the unit can't be run at its other end.
    ///
    /// # Errors
    /// Time is up.
    pub(super) fn or_refused<T>(
        &self,
        chord: &Chord,
        there: Result<T, Error>,
        nothing: impl FnOnce() -> T,
    ) -> Result<T, Error> {
        match there {
            Err(Error::Model(said)) => {
                if let Ok(mut refused) = self.refused.lock() {
                    refused.entry(chord.parameter).or_insert((chord.to, said));
                }
                Ok(nothing())
            }
            other => other,
        }
    }

    /// Which parameters explained nothing since the unit couldn't be run with them.
    pub fn refusal_notices(&self) -> Vec<Notice> {
        let Ok(refused) = self.refused.lock() else { return Vec::new() };
        let told = refused.iter().map(|(place, (value, said))| Notice {
            file: "dataset.toml".into(),
            line: 0,
            message: format!(
                "with {} = {value} the unit can't be run ({said}): there, it was taken to explain nothing",
                self.machine.parameters[*place].name
            ),
        });
        told.collect()
    }
}
