//! What an effect loses to another in its place, by their columns alone.

use super::evaluation::Evaluation;
use crate::rigs::acrobot::candidates::{Candidate, Motion};
use crate::rigs::acrobot::residual::Perturbation;
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::statistics::linear::{solve, submatrix, subvector};
use nalgebra::{DMatrix, DVector};

/// Loss if the effect's column were replaced by another's, its own gain times sin² of the angle between them, halved
/// since columns are tangents and bend over a finite size; and that gain.
pub(super) fn predicted_loss(
    last: &Evaluation,
    others: &[usize],
    effect: usize,
    index: usize,
    candidates: &[Candidate],
) -> Option<(f64, f64)> {
    if candidates[effect].is_discrete() {
        return Some((0.0, 0.0));
    }
    let own = *last.places(&[effect]).first()?;
    let places = last.places(others);
    let gram = &last.total.gram;
    let gram_oo = submatrix(gram, &places);
    let across = |column: usize| DVector::from_fn(places.len(), |i, _| gram[(places[i], column)]);
    let weights = if places.is_empty() { DVector::zeros(0) } else { solve(&gram_oo, &across(own))? };
    let length = gram[(own, own)] - weights.dot(&across(own));
    let size = last.point[effect] - candidates[effect].off;
    let nonlinear = matches!(candidates[effect].motion, Motion::Saturation { .. });
    last.perturbations
        .iter()
        .enumerate()
        .filter(|(_, perturbation)| perturbation.candidate == index)
        .map(|(column, _)| {
            let there = across(column);
            let product = gram[(own, column)] - weights.dot(&there);
            let theirs = gram[(column, column)]
                - if places.is_empty() {
                    0.0
                } else {
                    solve(&gram_oo, &there).map_or(0.0, |w| w.dot(&there))
                };
            let cosine = if theirs > 0.0 { product * product / (length * theirs) } else { 0.0 };
            let loss = size * size * length * (1.0 - cosine.min(1.0));
            if nonlinear { 0.1 * loss } else { 0.5 * loss }
        })
        .min_by(f64::total_cmp)
        .map(|loss| (loss, size * size * length))
}

/// Another column in the place of an effect's.
pub(super) struct Replaced {
    /// By how much the deviance rises.
    pub(super) loss: f64,
    /// The value that the other would take.
    pub(super) x: f64,
    /// The two columns.
    pub(super) own: usize,
    pub(super) other: usize,
}

/// Variance, in that of the noise, that right renderers add along what tells two columns apart.
pub(super) fn tolerance(
    last: &Evaluation,
    offsets: &DMatrix<f64>,
    others: &[usize],
    own: usize,
    other: usize,
) -> f64 {
    let gram = &last.total.gram;
    let mut rest = last.places(others);
    rest.push(other);
    let across = DVector::from_fn(rest.len(), |i, _| gram[(rest[i], own)]);
    let Some(weights) = solve(&submatrix(gram, &rest), &across) else { return 0.0 };
    let length = gram[(own, own)] - weights.dot(&across);
    let off = offsets.row(own) - weights.transpose() * offsets.select_rows(&rest);
    if length > 0.0 { off.norm_squared() / length } else { 0.0 }
}

/// A loss by columns of the image, less what is not known of these: what right renderers differ by, in variances of the noise, a share of all that
/// the effect explains, and a larger one of what tells a blur (`bent`) from a delay.
pub fn allowed_loss(loss: f64, tolerance: f64, strength: f64, bent: bool) -> f64 {
    let blur = if bent { SELECTION.blur * SELECTION.blur * loss.max(0.0) } else { 0.0 };
    loss / (1.0 + tolerance + SELECTION.column * SELECTION.column * strength + blur)
}

/// The linear loss of a replacement (negative where the other is better), and the value that the other would take: the
/// best of its columns.
pub(super) fn linear_loss(
    last: &Evaluation,
    others: &[usize],
    effect: usize,
    index: usize,
    candidates: &[Candidate],
) -> Option<Replaced> {
    let size = last.point[effect] - candidates[effect].off;
    // all of the effect at once, where that column is there; else its derivative
    let whole = |perturbation: &Perturbation| perturbation.candidate == effect && perturbation.by == -size;
    let own = last.perturbations.iter().position(whole).or(last.places(&[effect]).first().copied())?;
    let rest = last.places(others);
    let (gram, score) = (&last.total.gram, &last.total.score);
    let across = |column: usize| DVector::from_fn(rest.len(), |i, _| gram[(rest[i], column)]);
    // how the effects beside it follow a column: they are fitted again in both cases
    let followed = |column: usize| match rest.is_empty() {
        true => Some(DVector::zeros(0)),
        false => solve(&submatrix(gram, &rest), &across(column)),
    };
    let own_followed = followed(own)?;
    let aa = gram[(own, own)] - own_followed.dot(&across(own));
    // what the residual would still take of a column, less what those beside it would take of that: where they resemble it, a value
    // that is a hundredth of a standard error off asks for much of either and for nothing of their difference
    let asks = |followed: &DVector<f64>, column: usize, along: f64| {
        size * along + score[column] - followed.dot(&subvector(score, &rest))
    };
    let own_asks = asks(&own_followed, own, aa);
    let columns =
        last.perturbations.iter().enumerate().filter(|(_, perturbation)| perturbation.candidate == index);
    columns
        .filter_map(|(other, _)| {
            let followed = followed(other)?;
            let bb = gram[(other, other)] - followed.dot(&across(other));
            let other_asks = asks(&followed, other, gram[(own, other)] - own_followed.dot(&across(other)));
            let loss = own_asks * own_asks / aa - other_asks * other_asks / bb;
            let x = candidates[index].off + other_asks / bb;
            let steps = candidates[index].steps.iter().fold(0.0, |most: f64, step| most.max(step.abs()));
            let straight = (other_asks / bb).abs() <= SELECTION.classes_straight * steps;
            (bb > 0.0 && straight && x >= candidates[index].range.0 && x <= candidates[index].range.1)
                .then_some(Replaced { loss, x, own, other })
        })
        .min_by(|a, b| a.loss.total_cmp(&b.loss))
}
