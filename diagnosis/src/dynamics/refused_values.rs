//! Values with which a unit can't be run. They are no way to go: there, a parameter explains nothing, and that is told.

use super::linearise::{Chord, Engine};
use crate::error::{Error, Notice};
use std::collections::BTreeMap;

/// A value of each parameter with which the unit can't be run, and what it said.
pub(crate) type Refused = BTreeMap<usize, (f64, String)>;

/// Remembers a refusal: of several of one parameter the same, whichever thread meets its own first.
fn remember(refused: &mut Refused, parameter: usize, new: (f64, String)) {
    let kept = refused.entry(parameter).or_insert_with(|| new.clone());
    if new.0.total_cmp(&kept.0).then_with(|| new.1.cmp(&kept.1)).is_lt() {
        *kept = new;
    }
}

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
                    remember(&mut refused, chord.parameter, (chord.to, said));
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

#[cfg(test)]
mod tests {
    use super::{Refused, remember};

    #[test]
    fn law_what_is_told_of_refusals_hangs_on_no_order() {
        let all =
            [(0, 2.0, "row 3"), (0, 2.0, "row 1"), (1, 5.0, "row 9"), (0, 4.0, "row 0"), (1, -1.0, "row 8")];
        let told = |order: &[usize]| {
            let mut refused = Refused::new();
            order.iter().for_each(|one| {
                let (parameter, value, said) = all[*one];
                remember(&mut refused, parameter, (value, said.to_owned()));
            });
            refused
        };
        let first = told(&[0, 1, 2, 3, 4]);
        assert_eq!((&first[&0], &first[&1]), (&(2.0, "row 1".to_owned()), &(-1.0, "row 8".to_owned())));
        assert_eq!(told(&[4, 3, 2, 1, 0]), first);
        assert_eq!(told(&[2, 0, 4, 1, 3]), first);
    }
}
