//! Score test for the next candidate: linear, all at once, with active ones and nuisances projected out.

use super::evaluation::Evaluation;
use crate::rigs::acrobot::candidates::{Candidate, Side};
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::statistics::bootstrap::{Null, Scores};
use crate::statistics::linear::{solve, submatrix, subvector};
use nalgebra::{DMatrix, DVector};

/// What a column of one candidate predicts.
#[derive(Debug, Clone, PartialEq)]
pub struct Hit {
    /// Index of the candidate.
    pub candidate: usize,
    /// Place of the column.
    pub column: usize,
    /// Decrease of the sum of squares.
    pub gain: f64,
    /// Standardised score.
    pub statistic: f64,
    /// Displacement of x that the column asks for.
    pub displacement: f64,
}

impl Hit {
    /// Whether fits are to judge it: a blur shows in the few blocks of quick motion, and bends there, so that its statistic over blocks
    /// says little of it.
    pub(super) fn shows_seldom(&self, candidates: &[Candidate]) -> bool {
        let own = &candidates[self.candidate];
        own.side == Side::Camera && own.nonlinear && self.gain > SELECTION.seldom
    }
}

/// All candidates, screened.
#[derive(Debug, Clone)]
pub struct Screen {
    /// Best column of each candidate, largest gain first.
    pub hits: Vec<Hit>,
    /// Null distribution of the largest statistic.
    pub null: Null,
    /// Standard error of each perturbation's displacement, once the active ones are fitted too.
    pub errors: Vec<f64>,
    /// Probability that the best is chance.
    pub p_value: f64,
}

/// What the columns of all perturbations predict, each by itself beside the active ones.
struct Columns {
    scores: Scores,
    /// Decrease of the sum of squares.
    gains: Vec<f64>,
    /// Displacement of x that each asks for.
    displacements: Vec<f64>,
    /// Standard error of that.
    errors: Vec<f64>,
}

/// Screens every column that is not active.
pub fn screen(evaluation: &Evaluation, candidates: &[Candidate], active: &[usize]) -> Screen {
    let columns = score_columns(evaluation, candidates, active);
    let null = Null::of(&columns.scores);
    let hits = best_columns(evaluation, &columns);
    let best = hits.iter().map(|hit| hit.statistic).fold(0.0, f64::max);
    let p_value = null.p_value(best);
    Screen { hits, null, errors: columns.errors, p_value }
}

/// Scores each column that is not active, block by block.
fn score_columns(evaluation: &Evaluation, candidates: &[Candidate], active: &[usize]) -> Columns {
    let total = &evaluation.total;
    let count = evaluation.perturbations.len();
    let places = evaluation.places(active);
    let gram_aa = submatrix(&total.gram, &places);
    let score_a = subvector(&total.score, &places);
    let mut columns = Columns {
        scores: Scores {
            blocks: DMatrix::zeros(evaluation.reduced.len(), count),
            total: DVector::zeros(count),
            deviation: DVector::zeros(count),
            sided: vec![0; count],
        },
        gains: vec![0.0; count],
        displacements: vec![0.0; count],
        errors: vec![f64::INFINITY; count],
    };
    let integrated =
        evaluation.blocks.iter().flat_map(|block| &block.cells).all(|cell| cell.floor.is_empty());
    let excited = if integrated { SELECTION.excited } else { SELECTION.excited_torque };
    for (column, perturbation) in evaluation.perturbations.iter().enumerate() {
        if active.contains(&perturbation.candidate) {
            continue;
        }
        let across = DVector::from_fn(places.len(), |i, _| total.gram[(places[i], column)]);
        let weights = if places.is_empty() { Some(DVector::zeros(0)) } else { solve(&gram_aa, &across) };
        let Some(weights) = weights else { continue };
        let length = total.gram[(column, column)] - weights.dot(&across);
        // a column that active ones explain to rounding has nothing of its own, and one that a whole step of the
        // candidate hardly moves is the integrator's rounding: nothing excites it
        let moved = perturbation.by * perturbation.by * length;
        if length.is_nan() || length <= 1e-7 * total.gram[(column, column)] || moved < excited * excited {
            continue;
        }
        let score = total.score[column] - weights.dot(&score_a);
        columns.gains[column] = score * score / length;
        columns.displacements[column] = score / length;
        let scores = &mut columns.scores;
        let squares = score_blocks(evaluation, (column, score / length), &places, &weights, scores);
        scores.total[column] = score;
        scores.deviation[column] = squares.max(length).sqrt();
        columns.errors[column] = scores.deviation[column] / length;
        let x = evaluation.point[perturbation.candidate];
        scores.sided[column] = sided(&candidates[perturbation.candidate], x, perturbation.by);
    }
    columns
}

/// The scores of a column in each block, beside active ones with these weights, and the sum of their squares. They are taken about the fit,
/// `shift` along the column: an effect that shows in a few blocks must not count as scatter between blocks.
fn score_blocks(
    evaluation: &Evaluation,
    (column, shift): (usize, f64),
    places: &[usize],
    weights: &DVector<f64>,
    scores: &mut Scores,
) -> f64 {
    let mut squares = 0.0;
    for (row, reduced) in evaluation.reduced.iter().enumerate() {
        let own = reduced.score[column] - weights.dot(&subvector(&reduced.score, places));
        let centred = own - shift * own_length(&reduced.gram, column, places, weights);
        scores.blocks[(row, column)] = centred;
        squares += centred * centred;
    }
    squares
}

/// The best column of each candidate, largest gain first.
fn best_columns(evaluation: &Evaluation, columns: &Columns) -> Vec<Hit> {
    let mut hits: Vec<Hit> = Vec::new();
    for (column, perturbation) in evaluation.perturbations.iter().enumerate() {
        let statistic = columns.scores.statistic(column);
        if statistic == 0.0 {
            continue;
        }
        let hit = Hit {
            candidate: perturbation.candidate,
            column,
            gain: columns.gains[column],
            statistic,
            displacement: columns.displacements[column],
        };
        match hits.iter_mut().find(|known| known.candidate == perturbation.candidate) {
            Some(known) if known.gain < hit.gain => *known = hit,
            Some(_) => {}
            None => hits.push(hit),
        }
    }
    hits.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    hits
}

/// A block's share of a column's squared length, active ones taken out.
fn own_length(gram: &DMatrix<f64>, column: usize, places: &[usize], weights: &DVector<f64>) -> f64 {
    let across = DVector::from_fn(places.len(), |i, _| gram[(places[i], column)]);
    gram[(column, column)] - 2.0 * weights.dot(&across) + weights.dot(&(submatrix(gram, places) * weights))
}

/// Which way a candidate can move from a coordinate.
fn sided(candidate: &Candidate, x: f64, by: f64) -> i8 {
    if candidate.is_discrete() {
        return if by > 0.0 { 1 } else { -1 };
    }
    let tiny = 1e-9 * candidate.steps.first().map_or(1.0, |step| step.abs());
    match (x <= candidate.range.0 + tiny, x >= candidate.range.1 - tiny) {
        (true, false) => 1,
        (false, true) => -1,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::selection::examples::{block, candidate, evaluation, hit};

    #[test]
    fn value_a_blur_that_shows_seldom_is_tried_by_its_gain() {
        let tried = |side: Side, gain: f64| hit(0, gain).shows_seldom(&[candidate(side, true)]);
        assert_eq!([195.0, 210.0].map(|gain| tried(Side::Camera, gain)), [false, true]);
        assert!(!tried(Side::Plant, 1e3) && !hit(0, 1e3).shows_seldom(&[candidate(Side::Camera, false)]));
    }

    #[test]
    fn value_a_step_that_moves_rows_by_next_to_nothing_says_nothing() {
        let says = |moved: f64, integrated: bool| {
            // a step of 0.1
            let mut last = evaluation(&[0.0], &[1e3], &[(moved / 0.1).powi(2)]);
            if !integrated {
                let mut torques = block(0.0, 1.0);
                torques.cells.iter_mut().for_each(|cell| cell.floor = vec![1.0]);
                last.blocks = vec![torques];
            }
            !screen(&last, &[candidate(Side::Plant, false)], &[]).hits.is_empty()
        };
        // 0.02 standard deviations; of torques, which nothing integrates, 0.001
        assert_eq!([0.018, 0.022].map(|moved| says(moved, true)), [false, true]);
        assert_eq!([0.0009, 0.0011].map(|moved| says(moved, false)), [false, true]);
    }
}
