//! The model without an effect: what others would explain in its place, along their columns there, before any of them is fitted.

use super::classes::HOPELESS;
use super::evaluation::{Evaluation, all_perturbations};
use super::screen::{Screen, screen};
use crate::error::Error;
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::selection::policy::SELECTION;

/// The model without an effect, with the columns of all who might stand in its place.
pub(super) struct Bare {
    found: Screen,
}

impl Bare {
    /// Takes the effect away and linearises all others there, by a chord step.
    ///
    /// # Errors
    /// A unit failed.
    pub(super) fn of(
        cut: &mut Tracked,
        candidates: &[Candidate],
        last: &Evaluation,
        active: &[usize],
        effect: usize,
    ) -> Result<Self, Error> {
        let mut point = last.point.clone();
        point[effect] = candidates[effect].off;
        let others: Vec<usize> = active.iter().copied().filter(|index| *index != effect).collect();
        cut.restore_linearised();
        let perturbations = all_perturbations(candidates, &point, &|candidate| cut.sees(candidate), &others);
        let at = Evaluation::chord(cut, &point, &perturbations)?;
        Ok(Self { found: screen(&at, candidates, &others) })
    }

    /// Whether another is so far from the effect that a fit won't bring it near.
    pub(super) fn is_forlorn(&self, effect: usize, index: usize, temper: f64) -> bool {
        let hit = |index: usize| self.found.hits.iter().find(|hit| hit.candidate == index);
        let gain = |index: usize| hit(index).map_or(0.0, |hit| hit.gain);
        // against what the effect's own columns predict from here: a large effect gives more than that
        let (promised, missed) = (gain(effect), gain(effect) - gain(index));
        missed > HOPELESS * temper && missed > SELECTION.forlorn * promised
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::selection::examples::{found, hit};

    #[test]
    fn value_another_is_forlorn_where_it_misses_much_and_a_part_of_all() {
        let forlorn = |own: f64, other: f64, temper: f64| {
            Bare { found: found(vec![hit(0, own), hit(1, other)]) }.is_forlorn(0, 1, temper)
        };
        // 12 of deviance, of a small effect, and as many times as the likelihood overstates
        assert_eq!([9.0, 7.0].map(|other| forlorn(20.0, other, 1.0)), [false, true]);
        assert_eq!([17.0, 15.0].map(|other| forlorn(40.0, other, 2.0)), [false, true]);
        // 0.3 of a large one
        assert_eq!([710.0, 690.0].map(|other| forlorn(1000.0, other, 1.0)), [false, true]);
    }
}
