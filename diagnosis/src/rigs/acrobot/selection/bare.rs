//! The model without an effect: what others would explain in its place, along their columns there, before any of them is fitted.

use super::classes::HOPELESS;
use super::evaluation::{Evaluation, all_probes};
use super::screen::{Screen, screen};
use crate::error::Error;
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::selection::policy::SELECTION;

/// The model without an effect, with the columns of all who might stand in its place.
pub(super) struct Bare {
    at: Evaluation,
    found: Screen,
}

/// What is known of another before it is fitted.
pub(super) enum Opinion {
    /// So far from the effect that a fit won't bring it near.
    Forlorn,
    /// What a fit would find: the other's coordinate, and what is lost by it.
    Straight { x: f64, loss: f64 },
    /// Only a fit can tell.
    Fit,
}

impl Bare {
    /// Takes the effect away and looks at all others, quickly.
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
        let probes = all_probes(candidates, &point, &|candidate| cut.sees(candidate), &others);
        let at = Evaluation::chord(cut, &point, &probes)?;
        let found = screen(&at, candidates, &others);
        Ok(Self { at, found })
    }

    /// What another would do in the place of the effect, whose fit has the deviance `own`.
    pub(super) fn opinion(
        &self,
        candidates: &[Candidate],
        (effect, index): (usize, usize),
        own: f64,
        temper: f64,
    ) -> Opinion {
        let explained = self.at.deviance() - own;
        let hit = |index: usize| self.found.hits.iter().find(|hit| hit.candidate == index);
        let gain = |index: usize| hit(index).map_or(0.0, |hit| hit.gain);
        // against what the effect's own columns promise from here: a large effect gives more than that
        let (promised, missed) = (gain(effect), gain(effect) - gain(index));
        if missed > HOPELESS * temper && missed > SELECTION.forlorn * promised {
            return Opinion::Forlorn;
        }
        let candidate = &candidates[index];
        if explained > SELECTION.small * temper || candidate.nonlinear || candidate.is_discrete() {
            return Opinion::Fit;
        }
        match hit(index).map(|hit| (self.at.point[index] + hit.displacement, explained - hit.gain)) {
            Some((x, loss)) if x >= candidate.range.0 && x <= candidate.range.1 => {
                Opinion::Straight { x, loss }
            }
            _ => Opinion::Forlorn,
        }
    }
}
