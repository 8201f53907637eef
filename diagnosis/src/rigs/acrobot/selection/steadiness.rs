//! Whether a candidate has one value in all runs and all along them, as far as its column tells.

use super::evaluation::Evaluation;
use crate::rigs::acrobot::policy::POLICY;
use crate::statistics::levels::FEW;
use crate::statistics::linear::{solve, submatrix, subvector};
use std::collections::BTreeMap;

/// What a block wants of a candidate beside where it is.
pub(super) struct BlockScore {
    pub(super) run: usize,
    pub(super) time: f64,
    pub(super) score: f64,
    pub(super) length: f64,
}

/// A candidate's values by themselves in each run, and whether they are one.
#[derive(Debug, Clone, PartialEq)]
pub struct Steadiness {
    /// Displacement of x that each run wants, beside where x is, with its standard error, by the run's index.
    pub runs: BTreeMap<usize, (f64, f64)>,
    /// The displacement that all runs want together.
    pub mean: f64,
    /// Decrease of the deviance that a displacement of its own for each run brings, and how much of it runs apart bring.
    pub decrease: f64,
    /// See `decrease`.
    pub apart: f64,
    /// What values of their own bring in each third of a run, for each of them.
    pub within: f64,
    /// What runs apart bring, however blocks scatter.
    pub squares: f64,
    /// Drift of x within the runs, a second, and how many standard errors that is.
    pub drift: (f64, f64),
    /// What that drift brings, however blocks scatter.
    pub wandering: f64,
}

impl Steadiness {
    /// Whether runs want values of their own: by far more than what thirds of one run want, which is all that a wrong model shows, since
    /// runs move differently.
    pub fn differ(&self) -> bool {
        let each = self.apart / self.runs.len().saturating_sub(1).max(1) as f64;
        each >= POLICY.runs_apart * self.within.max(1.0)
    }
}

/// Judges one candidate where the active ones are fitted. `None` where its column says nothing.
pub fn steadiness(evaluation: &Evaluation, candidate: usize, active: &[usize]) -> Option<Steadiness> {
    let block_scores = block_scores(evaluation, candidate, active)?;
    let mut sums: BTreeMap<usize, (f64, f64, f64)> = BTreeMap::new();
    for wish in &block_scores {
        let sum = sums.entry(wish.run).or_default();
        *sum = (sum.0 + wish.score, sum.1 + wish.length, sum.2 + wish.length * wish.time);
    }
    sums.retain(|_, sum| sum.1 > 0.0);
    let (score, length) = sums.values().fold((0.0, 0.0), |all, sum| (all.0 + sum.0, all.1 + sum.1));
    if length <= 0.0 {
        return None;
    }
    // blocks that scatter more than noise makes them count less
    let known = |wish: &&BlockScore| sums.contains_key(&wish.run);
    let own = |wish: &BlockScore| sums[&wish.run];
    let scatter: f64 = block_scores
        .iter()
        .filter(known)
        .map(|wish| (wish.score - wish.length * own(wish).0 / own(wish).1).powi(2))
        .sum();
    let over = (scatter / length).max(1.0);
    let (mut drift, mut spread) = (0.0, 0.0);
    for wish in block_scores.iter().filter(known) {
        let (run_score, run_length, run_time) = own(wish);
        let since = wish.time - run_time / run_length;
        drift += since * (wish.score - wish.length * run_score / run_length);
        spread += wish.length * since * since;
    }
    let wandering = if spread > 0.0 { drift * drift / spread } else { 0.0 };
    let drift = if spread > 0.0 { (drift / spread, drift / (spread * over).sqrt()) } else { (0.0, 0.0) };
    let decrease = sums.values().map(|sum| sum.0 * sum.0 / sum.1).sum::<f64>() / over;
    let runs = sums.iter().map(|(run, sum)| (*run, (sum.0 / sum.1, (over / sum.1).sqrt()))).collect();
    let apart = decrease - score * score / length / over;
    let within = gain_within_runs(&block_scores) / over;
    Some(Steadiness {
        runs,
        mean: score / length,
        decrease,
        apart,
        within,
        squares: over * apart,
        drift,
        wandering,
    })
}

/// Decrease of the deviance that a value of its own for each third of a run brings beside one for each run, for each value.
fn gain_within_runs(block_scores: &[BlockScore]) -> f64 {
    let mut spans: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
    for wish in block_scores {
        let span = spans.entry(wish.run).or_insert((wish.time, wish.time));
        *span = (span.0.min(wish.time), span.1.max(wish.time));
    }
    let mut sums: BTreeMap<(usize, usize), (f64, f64)> = BTreeMap::new();
    for wish in block_scores {
        let (from, to) = spans[&wish.run];
        let share = (wish.time - from) / (to - from).max(f64::MIN_POSITIVE);
        let third = ((FEW as f64 * share) as usize).min(FEW - 1);
        let sum = sums.entry((wish.run, third)).or_default();
        *sum = (sum.0 + wish.score, sum.1 + wish.length);
    }
    sums.retain(|_, sum| sum.1 > 0.0);
    let decrease = |sum: &(f64, f64)| sum.0 * sum.0 / sum.1;
    let mut runs: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
    for ((run, _), sum) in &sums {
        let all = runs.entry(*run).or_default();
        *all = (all.0 + sum.0, all.1 + sum.1);
    }
    let own = sums.values().map(decrease).sum::<f64>() - runs.values().map(decrease).sum::<f64>();
    own / (sums.len() - runs.len()).max(1) as f64
}

/// Score and information of a candidate in each block, the other active ones taken out; `None` where it has no column.
pub(super) fn block_scores(
    evaluation: &Evaluation,
    candidate: usize,
    active: &[usize],
) -> Option<Vec<BlockScore>> {
    let column = *evaluation.places(&[candidate]).first()?;
    let others: Vec<usize> = active.iter().copied().filter(|other| *other != candidate).collect();
    let places = evaluation.places(&others);
    let total = &evaluation.total;
    let across = subvector(&total.gram.column(column).into_owned(), &places);
    let weights = if places.is_empty() { across } else { solve(&submatrix(&total.gram, &places), &across)? };
    let wish =
        |(block, reduced): (&crate::rigs::acrobot::residual::Block, &crate::statistics::linear::Reduced)| {
            let across = subvector(&reduced.gram.column(column).into_owned(), &places);
            let own = submatrix(&reduced.gram, &places);
            BlockScore {
                run: block.run,
                time: 0.5 * (block.from + block.to),
                score: reduced.score[column] - weights.dot(&subvector(&reduced.score, &places)),
                length: reduced.gram[(column, column)] - 2.0 * weights.dot(&across)
                    + weights.dot(&(own * &weights)),
            }
        };
    Some(evaluation.blocks.iter().zip(&evaluation.reduced).map(wish).collect())
}
