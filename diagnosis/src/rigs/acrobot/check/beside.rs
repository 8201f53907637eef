//! Laws that no candidate gives, each held against what a model leaves beside the effects that are on: how many standard deviations of it
//! the data tell (a score test).

use crate::rigs::acrobot::residual::{Perturbation, Signal};
use crate::rigs::acrobot::selection::Evaluation;
use crate::statistics::levels::ROUNDING;
use crate::statistics::linear::Cell;
use nalgebra::DMatrix;
use std::ops::Range;

/// Some laws, by their numbers.
#[derive(Clone)]
pub(super) struct Laws<'a> {
    /// What each changes a cell's rows by, for a size of 1: a column a law.
    pub(super) columns: &'a dyn Fn(&Cell) -> DMatrix<f64>,
    /// Those that are asked for.
    pub(super) asked: Range<usize>,
    /// Those that may have any size beside them.
    pub(super) free: Range<usize>,
}

/// The law that the data tell most surely, and by how many standard deviations, noise and what renderers differ by counted.
pub(super) fn surest(
    at: &Evaluation,
    active: &[usize],
    signals: &[Signal],
    laws: &Laws<'_>,
) -> Option<(usize, f64)> {
    let beside = with_laws(at, active, laws);
    let listed = beside.perturbations.len() - count(laws);
    let free: Vec<usize> = active.iter().copied().chain(laws.free.clone().map(candidate_of)).collect();
    let own = beside.places(&free);
    let off = beside.systematic_beside(&free, signals);
    let sure = |law: usize| {
        let column = listed + law;
        let (length, score) = beside.total.beside(&own, column)?;
        let told = length > ROUNDING * beside.total.gram[(column, column)];
        told.then(|| (law, score / length / (1.0 / length + off[column] * off[column]).sqrt()))
    };
    laws.asked.clone().filter_map(sure).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}

/// The same evaluation with the columns of the effects that are on, and one for each law.
fn with_laws(at: &Evaluation, active: &[usize], laws: &Laws<'_>) -> Evaluation {
    let on = at.places(active);
    let columns = |cell: &Cell| {
        let mut all = cell.columns.select_columns(&on).resize_horizontally(on.len() + count(laws), 0.0);
        all.columns_mut(on.len(), count(laws)).copy_from(&(laws.columns)(cell));
        all
    };
    let law = |law| Perturbation { candidate: candidate_of(law), by: 1.0 };
    let perturbations = on.iter().map(|place| at.perturbations[*place]).chain((0..count(laws)).map(law));
    at.with_columns(perturbations.collect(), columns)
}

/// How many laws have columns.
fn count(laws: &Laws<'_>) -> usize {
    laws.asked.end.max(laws.free.end)
}

/// The number that a law has among candidates: no candidate's.
fn candidate_of(law: usize) -> usize {
    usize::MAX - law
}
