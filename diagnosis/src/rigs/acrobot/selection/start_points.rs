//! Coordinates from which an alternative is fitted in the place of an effect.

use super::evaluation::Evaluation;
use crate::rigs::acrobot::candidates::{Candidate, Motion};
use crate::statistics::linear::subvector;

/// As far as its column resembles the effect's; all whole numbers, and the likeliest saturations.
pub(super) fn starts(
    candidate: &Candidate,
    last: &Evaluation,
    effect: usize,
    index: usize,
    candidates: &[Candidate],
) -> Vec<f64> {
    if candidate.is_discrete() {
        return candidate.steps.iter().map(|step| candidate.off + step).collect();
    }
    if matches!(candidate.motion, Motion::Saturation { .. }) {
        // the two levels whose columns resemble the effect most
        let own = last.places(&[effect]).first().copied();
        let mut levels: Vec<(f64, f64)> = (last.perturbations.iter().enumerate())
            .filter(|(_, perturbation)| perturbation.candidate == index)
            .map(|(column, perturbation)| {
                let gram = &last.total.gram;
                let cosine = own.map_or(0.0, |own| gram[(own, column)].powi(2) / gram[(column, column)]);
                (if cosine.is_finite() { cosine } else { 0.0 }, candidate.off + perturbation.by)
            })
            .collect();
        levels.sort_by(|a, b| b.0.total_cmp(&a.0));
        return levels.into_iter().take(2).map(|(_, x)| x).collect();
    }
    let column = last.perturbations.iter().position(|perturbation| perturbation.candidate == index);
    let own = last.places(&[effect]).first().copied();
    let x = match (column, own) {
        (Some(column), Some(own)) => {
            let gram = &last.total.gram;
            let size = last.point[effect] - candidates[effect].off;
            candidate.off + size * gram[(own, column)] / gram[(column, column)]
        }
        (Some(column), None) => {
            candidate.off + subvector(&last.total.score, &[column])[0] / last.total.gram[(column, column)]
        }
        _ => candidate.off + candidate.steps[0],
    };
    let within = x.clamp(candidate.range.0, candidate.range.1);
    vec![if within == candidate.off { candidate.off + candidate.steps[0] } else { within }]
}
