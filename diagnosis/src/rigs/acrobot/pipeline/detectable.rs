//! The smallest size of each candidate that would have been found: in 39 of 40 such data sets, since noise adds to what a size shows as often as it
//! takes away. At a size that shows just what a name takes half would be.

use super::compare::Part;
use super::effects::doubt_of;
use super::policy::PIPELINE;
use crate::rigs::acrobot::candidates::{Candidate, Motion, Side};
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::statistics::levels::WITHIN;
use std::collections::BTreeMap;

/// Adds the smallest size that would have been found, for each candidate that a part sees.
pub(super) fn add_detectable(
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
        let size = match free.iter().position(|other| other == index) {
            Some(place) => {
                covariance.as_ref().map(|covariance| threshold * covariance[(place, place)].sqrt())
            }
            None => detectable_by_steps(part, (*index, candidate), &differs, threshold),
        };
        let surely = match candidate.motion {
            // the smaller a limit, the more it shows
            Motion::Saturation { .. } => 1.0,
            _ => 1.0 + WITHIN / threshold,
        };
        // a smaller one is taken for the log's clock
        let size = size.map(|size| {
            (surely * size).max(PIPELINE.misses * doubt_of(doubts, *index).hypot(size / threshold))
        });
        let size = size.and_then(|size| in_whole_numbers(candidate, size));
        if let Some(size) = size.filter(|size| size.is_finite() && *size > 0.0) {
            into.insert(candidate.name.to_owned(), size);
        }
    }
}

/// The smallest size of a candidate that isn't on, by the steps that it was tried with. `differs` are standard deviations of their sizes
/// by what right renderers differ by.
fn detectable_by_steps(
    part: &Part,
    (index, candidate): (usize, &Candidate),
    differs: &[f64],
    threshold: f64,
) -> Option<f64> {
    let columns = part.study.last.perturbations.iter().zip(&part.study.screen.errors).zip(differs);
    let own =
        columns.filter(|((perturbation, error), _)| perturbation.candidate == index && error.is_finite());
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
        _ => clear_at(own.map(|(step, error)| (step.by.abs(), error)).collect(), threshold),
    }
}

/// A size as the candidate can have it: a count is at least 1, a switch is on or off.
fn in_whole_numbers(candidate: &Candidate, size: f64) -> Option<f64> {
    match candidate.motion {
        Motion::Count { .. } if candidate.is_discrete() => Some(size.ceil().max(1.0)),
        _ if candidate.is_discrete() => (size <= 1.0).then_some(1.0),
        _ => Some(size),
    }
}

/// The size at which a candidate is so many standard deviations clear, by its steps with the errors that a value has along each. Between
/// two steps what shows grows as a straight line, so that an effect that bends is not promised below the step that shows it.
fn clear_at(mut steps: Vec<(f64, f64)>, threshold: f64) -> Option<f64> {
    steps.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut known = (0.0, 0.0);
    for (by, error) in &steps {
        let clear = by / error;
        if clear >= threshold {
            return Some(known.0 + (by - known.0) * (threshold - known.1) / (clear - known.1));
        }
        known = (*by, clear);
    }
    steps.last().map(|(_, error)| threshold * error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_what_bends_is_promised_where_its_steps_show_it() {
        // what is linear is clear at threshold times its error, within its steps and beyond
        for steps in [vec![(1.0, 0.5)], vec![(0.1, 0.5), (100.0, 0.5)]] {
            assert_eq!(clear_at(steps, 5.0), Some(2.5));
        }
        // the square of a size: 0.04 standard deviations at 0.02, 4 at 0.2 and 49 at 0.7
        let square = vec![(0.7, 0.7 / 49.0), (0.02, 0.5), (0.2, 0.05)];
        let size = clear_at(square, 5.0).expect("it shows");
        assert!((size - (0.2 + 0.5 / 45.0)).abs() < 1e-12, "{size}");
        assert_eq!(clear_at(Vec::new(), 5.0), None);
    }
}
