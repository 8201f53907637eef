//! The smallest size of each candidate that would have been found.

use super::effects::doubt;
use super::*;
use crate::rigs::acrobot::candidates::Motion;
use crate::rigs::acrobot::pipeline::policy::PIPELINE;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::selection::policy::SELECTION;
use std::collections::BTreeMap;

/// Smallest size that would have been found, for each candidate of a part.
pub(super) fn detectable(
    part: &Part,
    list: &[Candidate],
    free: &[usize],
    doubts: &[(usize, f64)],
    into: &mut BTreeMap<String, f64>,
) {
    let threshold = part.study.screen.null.threshold(SELECTION.alpha);
    let last = &part.study.last;
    let covariance = last.covariance(free);
    let differs = last.systematic_beside(free, &part.signals);
    for index in &part.study.seen {
        let candidate = &list[*index];
        if candidate.side.is_of_log() {
            continue;
        }
        let size = if let Some(place) = free.iter().position(|other| other == index) {
            covariance.as_ref().map(|covariance| threshold * covariance[(place, place)].sqrt())
        } else {
            let columns = last.perturbations.iter().zip(&part.study.screen.errors).zip(&differs);
            let own = columns
                .filter(|((perturbation, error), _)| perturbation.candidate == *index && error.is_finite());
            // what an image shows must be more than right renderers differ by
            let own = own.map(|((perturbation, error), differs)| match candidate.side {
                Side::Camera => (perturbation, error.max(POLICY.clear * error.hypot(*differs) / threshold)),
                _ => (perturbation, *error),
            });
            match candidate.motion {
                // a tangent says nothing of a saturation: it has none above the largest torque
                Motion::Saturation { .. } => own
                    .filter(|(perturbation, error)| perturbation.by.abs() >= threshold * error)
                    .map(|(perturbation, _)| perturbation.by.abs())
                    .min_by(f64::total_cmp)
                    .map(|by| 1.0 / by),
                _ => own.map(|(_, error)| threshold * error).min_by(f64::total_cmp),
            }
        };
        // a smaller one is taken for the log's clock
        let size = size.map(|size| size.max(PIPELINE.misses * doubt(doubts, *index).hypot(size / threshold)));
        let size = match (candidate.is_discrete(), size) {
            (true, Some(size)) if matches!(candidate.motion, Motion::Count { .. }) => {
                Some(size.ceil().max(1.0))
            }
            (true, Some(size)) => (size <= 1.0).then_some(1.0),
            (_, size) => size,
        };
        if let Some(size) = size.filter(|size| size.is_finite() && *size > 0.0) {
            into.insert(candidate.name.to_owned(), size);
        }
    }
}
