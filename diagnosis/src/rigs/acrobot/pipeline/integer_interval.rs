//! Whole numbers: which others fit as well, and where what can be tried ends.

use crate::rigs::acrobot::candidates::{Candidate, Motion};
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::selection::{Evaluation, Study};
use crate::statistics::levels::{HALF, WITHIN};

/// What is known of a whole number.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct IntegerInterval {
    pub(super) candidate: usize,
    /// Between which numbers it lies, each of which is the nearest of all half a number about it.
    pub(super) ends: [f64; 2],
    /// It may be larger still: with the next number the model's camera loses frames, in which nothing can be compared.
    pub(super) beyond: bool,
}

/// What is known of the whole numbers that were found: their neighbours are weighed beside them.
pub(super) fn integer_intervals(
    cut: &mut Tracked,
    list: &[Candidate],
    study: &Study,
) -> Vec<IntegerInterval> {
    let counts = |index: &usize| matches!(list[*index].motion, Motion::Count { .. });
    let found: Vec<usize> = study.active.iter().copied().filter(counts).collect();
    let mut left = |index: usize, by: f64| {
        let mut there = study.last.point.clone();
        there[index] += by;
        cut.restore_linearised();
        let deviance = Evaluation::chord(cut, &there, &[]).ok()?.deviance();
        Some((deviance, cut.unseen))
    };
    let judged = |index: usize| {
        let (at, own) = (study.last.point[index], left(index, 0.0)?);
        let [below, above] = [-1.0, 1.0].map(|by| left(index, by).filter(|(_, unseen)| *unseen <= own.1));
        let fits = |other: Option<(f64, usize)>| other.is_some_and(|other| other.0 < own.0 + WITHIN * WITHIN);
        let beyond = above.is_none();
        let far = |fits: bool| HALF + f64::from(u8::from(fits));
        let high = if beyond { list[index].range.1.max(at) } else { at } + far(fits(above));
        Some(IntegerInterval { candidate: index, ends: [at - far(fits(below)), high], beyond })
    };
    let all = found.into_iter().filter_map(judged).collect();
    cut.restore_linearised();
    all
}
