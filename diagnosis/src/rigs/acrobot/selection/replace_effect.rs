//! The best of a class put into the model: a name and a value that are told are those of a model that was fitted through the units, and so
//! are the gap and the values of the effects beside them.

use super::classes::Alternative;
use super::search::linearise;
use super::settle::settle;
use super::{Evaluation, Study};
use crate::error::Error;
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::residual::Tracked;

/// Fits another in the place of an effect, and leaves it there if that raises the deviance by no more than `most`. Whether it did.
///
/// # Errors
/// A unit failed at the model that stands.
pub fn replace_effect(
    cut: &mut Tracked,
    candidates: &[Candidate],
    study: &mut Study,
    effect: usize,
    other: &Alternative,
    most: f64,
) -> Result<bool, Error> {
    let place = |index: &usize| if *index == effect { other.candidate } else { *index };
    let replaced: Vec<usize> = study.active.iter().map(place).collect();
    let mut point = study.last.point.clone();
    point[effect] = candidates[effect].off;
    point[other.candidate] = other.x;
    let kept = cut.nuisances.clone();
    match fit_exactly(cut, candidates, &replaced, &mut point) {
        Some(there) if there.deviance() - study.last.under(&there).deviance() <= most => {
            (study.active, study.last, study.class) = (replaced, there, None);
            for step in &mut study.steps {
                step.accepted.iter_mut().chain(&mut step.together).for_each(|index| *index = place(index));
            }
            Ok(true)
        }
        _ => {
            cut.restore(&kept);
            // columns and frames of the model that stands are those that others are compared by
            study.last = linearise(cut, candidates, &study.last.point, &study.active)?;
            Ok(false)
        }
    }
}

/// The model with exactly these effects, where each of them is needed there.
fn fit_exactly(
    cut: &mut Tracked,
    candidates: &[Candidate],
    effects: &[usize],
    point: &mut Vec<f64>,
) -> Option<Evaluation> {
    let mut active = effects.to_vec();
    let dropped = settle(cut, candidates, &mut active, point).ok()?;
    if dropped.is_empty() { linearise(cut, candidates, point, &active).ok() } else { None }
}
