//! Two effects that explain together what neither does by itself: an area that is larger and an inflow that is, too. Either alone gains little,
//! since process noise takes up what the other lacks; held against a model without process noise both gain nearly all of it.

use super::Search;
use super::screen::{Screen, Screened, is_allowed, linearised};
use crate::error::Error;
use crate::infer::likelihood::reduced;
use crate::infer::{Fit, Noise};
use crate::statistics::levels::HALF;
use crate::statistics::linear::{Reduced, solve, submatrix, subvector};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeSet;

/// Two effects, and the deviance that they gain together.
#[derive(Debug, Clone, Copy)]
struct Pair {
    both: [Screened; 2],
    gain: f64,
}

/// Whether two that gain so much in the linear model may be all of what process noise gains.
fn may_explain(gain: f64, evidence: f64) -> bool {
    gain > HALF * evidence
}

impl Search<'_> {
    /// The effects with the two that gain most beside them, fitted; `None` where no two may explain what process noise gains (`evidence`).
    ///
    /// # Errors
    /// A unit failed.
    pub fn with_pair(
        &mut self,
        effects: &[usize],
        here: &Fit,
        evidence: f64,
    ) -> Result<Option<(Vec<usize>, Fit)>, Error> {
        // there must be room for both
        if effects.len() + 1 >= self.policy.most {
            return Ok(None);
        }
        let screen = linearised(self.engine, here, &self.others(effects))?;
        let pairs = self.pairs(here, &screen, evidence);
        let tried: Vec<&[Screened]> = pairs.iter().map(|pair| &pair.both[..]).collect();
        let found = self.best_of(effects, here, &screen, &tried);
        if let Some((with, fit)) = &found {
            let names: Vec<&str> = with[effects.len()..].iter().map(|one| self.name(*one)).collect();
            let gained = here.deviance - fit.deviance;
            self.story.push(format!(
                "{} were tried together: they gain {gained:.0} of deviance",
                names.join(" and ")
            ));
        }
        Ok(found)
    }

    /// The best pairs that may explain what process noise gains, once each, as many as are fitted.
    fn pairs(&self, here: &Fit, screen: &Screen, evidence: f64) -> Vec<Pair> {
        let exact = self.sizes.with_pinned(vec![true; self.engine.machine.order()]);
        let noise = exact.quieted(Noise { disturbance: None, ..here.at.noise.clone() });
        let all: Vec<usize> = (0..screen.chords.len()).collect();
        let beside = Beside::new(&reduced(&screen.runs, &noise, &all), here.free.len());
        let mut pairs: Vec<Pair> = Vec::new();
        for (second, chord) in screen.chords.iter().enumerate().skip(here.free.len()) {
            for (first, other) in screen.chords.iter().enumerate().take(second).skip(here.free.len()) {
                let Some((gain, amounts)) = beside.gain(first, second) else { continue };
                let allowed = |chord, amount| is_allowed(self.engine, &here.at.theta, chord, amount);
                if other.parameter == chord.parameter
                    || !may_explain(gain, evidence)
                    || !allowed(other, amounts[0])
                    || !allowed(chord, amounts[1])
                {
                    continue;
                }
                let screened = |chord, amount| Screened { chord, gain, amount };
                pairs.push(Pair { both: [screened(*other, amounts[0]), screened(*chord, amounts[1])], gain });
            }
        }
        pairs.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let mut known = BTreeSet::new();
        pairs.retain(|pair| known.insert(pair.both.map(|one| one.chord.parameter)));
        pairs.truncate(self.policy.fitted);
        pairs
    }
}

/// Gram matrix and score of the columns that are tried, what the model's own parameters take over eliminated.
struct Beside {
    gram: DMatrix<f64>,
    score: DVector<f64>,
    own: usize,
}

impl Beside {
    fn new(whole: &Reduced, own: usize) -> Self {
        let columns = whole.score.len();
        let (mine, rest): (Vec<usize>, Vec<usize>) = ((0..own).collect(), (own..columns).collect());
        let mut gram = submatrix(&whole.gram, &rest);
        let mut score = subvector(&whole.score, &rest);
        let across = DMatrix::from_fn(own, rest.len(), |i, j| whole.gram[(i, own + j)]);
        if let Some(inverse) = submatrix(&whole.gram, &mine).try_inverse().filter(|_| own > 0) {
            gram -= across.tr_mul(&(&inverse * &across));
            score -= across.tr_mul(&(inverse * subvector(&whole.score, &mine)));
        }
        Self { gram, score, own }
    }

    /// What two columns gain together, and how much of each.
    fn gain(&self, first: usize, second: usize) -> Option<(f64, [f64; 2])> {
        let places = [first - self.own, second - self.own];
        let score = subvector(&self.score, &places);
        let amounts = solve(&submatrix(&self.gram, &places), &score)?;
        Some((amounts.dot(&score), [amounts[0], amounts[1]]))
    }
}

#[cfg(test)]
mod tests {
    use super::{Beside, may_explain};
    use crate::statistics::linear::Reduced;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn law_two_gain_beside_the_models_own_what_all_columns_together_do() {
        // three columns of three rows and what they are to give; the first is the model's own
        let columns =
            DMatrix::from_row_slice(4, 3, &[1.0, 0.2, 0.3, 0.5, 1.0, 0.9, 0.1, 0.4, 1.0, 0.3, 0.2, 0.1]);
        let wanted = DVector::from_row_slice(&[0.3, -1.0, 0.7, 0.2]);
        let (gram, score) = (columns.tr_mul(&columns), columns.tr_mul(&wanted));
        let whole = Reduced { gram, score, square: wanted.norm_squared(), log_det: 0.0, freedom: 4.0 };
        let shift = whole.gram.clone().try_inverse().expect("independent") * &whole.score;
        let own = whole.score[0] * whole.score[0] / whole.gram[(0, 0)];
        let (gain, amounts) = Beside::new(&whole, 1).gain(1, 2).expect("independent");
        assert!((gain - (shift.dot(&whole.score) - own)).abs() < 1e-12);
        assert!((amounts[0] - shift[1]).abs() < 1e-12 && (amounts[1] - shift[2]).abs() < 1e-12);
    }

    #[test]
    fn value_two_are_tried_where_they_may_be_all_that_is_left() {
        assert!(may_explain(4_000.0, 7_000.0) && !may_explain(3_000.0, 7_000.0));
    }
}
