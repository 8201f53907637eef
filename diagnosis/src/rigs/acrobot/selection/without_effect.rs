//! The model without an effect: what others would explain in its place, along their columns there, before any of them is fitted.

use super::classes::HOPELESS;
use super::evaluation::{Evaluation, all_perturbations};
use super::screen::{Screen, screen};
use crate::error::Error;
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::selection::policy::SELECTION;

/// The model without an effect, with the columns of all who might stand in its place.
pub(super) struct WithoutEffect {
    found: Screen,
}

impl WithoutEffect {
    /// Takes the effect away, leaves the others beside it where they are, and linearises all there by a chord step.
    ///
    /// # Errors
    /// A unit failed.
    pub(super) fn of(
        cut: &mut Tracked,
        candidates: &[Candidate],
        last: &Evaluation,
        others: &[usize],
        effect: usize,
    ) -> Result<Self, Error> {
        let mut point = last.point.clone();
        point[effect] = candidates[effect].off;
        cut.restore_linearised();
        let perturbations = all_perturbations(candidates, &point, &|candidate| cut.sees(candidate), others);
        let at = Evaluation::chord(cut, &point, &perturbations)?;
        Ok(Self { found: screen(&at, candidates, others) })
    }

    /// Whether another is so far from the effect that a fit won't bring it near.
    pub(super) fn is_hopeless(&self, effect: usize, index: usize, temper: f64) -> bool {
        let hit = |index: usize| self.found.hits.iter().find(|hit| hit.candidate == index);
        let gain = |index: usize| hit(index).map_or(0.0, |hit| hit.gain);
        // against what the effect's own columns predict from here: a large effect gives more than that
        let (predicted, missed) = (gain(effect), gain(effect) - gain(index));
        missed > HOPELESS * temper && missed > SELECTION.forlorn * predicted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::selection::examples::{found, hit};

    #[test]
    fn value_another_is_hopeless_where_it_misses_much_and_a_part_of_all() {
        let hopeless = |own: f64, other: f64, temper: f64| {
            WithoutEffect { found: found(vec![hit(0, own), hit(1, other)]) }.is_hopeless(0, 1, temper)
        };
        // 12 of deviance, of a small effect, and as many times as the likelihood overstates
        assert_eq!([9.0, 7.0].map(|other| hopeless(20.0, other, 1.0)), [false, true]);
        assert_eq!([17.0, 15.0].map(|other| hopeless(40.0, other, 2.0)), [false, true]);
        // 0.3 of a large one
        assert_eq!([710.0, 690.0].map(|other| hopeless(1000.0, other, 1.0)), [false, true]);
    }
}
