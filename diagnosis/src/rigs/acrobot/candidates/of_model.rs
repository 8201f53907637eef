//! The candidates of a nominal model: neutral values, steps and ranges.

use super::{Attribute, Candidate, Cuts, Entry, LIST, Motion, names};
use crate::rigs::acrobot::model::Model;

/// The active candidates whose coordinate is continuous.
pub fn continuous(list: &[Candidate], active: &[usize]) -> Vec<usize> {
    active.iter().copied().filter(|index| !list[*index].is_discrete()).collect()
}

/// The candidates that the nominal model has, with their neutral values. `withheld` names are left out.
pub fn candidates(
    model: &Model,
    withheld: &[String],
    saturations: &dyn Fn(Cuts) -> Vec<f64>,
) -> Vec<Candidate> {
    let mut found = Vec::new();
    for entry in LIST {
        let nominal = if entry.side.is_of_log() { Some(0.0) } else { model.number(entry.name) };
        let Some(nominal) = nominal else { continue };
        if withheld.iter().any(|name| name == entry.name) {
            continue;
        }
        // a pinned arm has no ground
        if entry.is(Attribute::Ground) && pinned(model) {
            continue;
        }
        let Some((off, steps, range)) = extent(entry.motion, nominal, model, saturations) else { continue };
        if steps.is_empty() {
            continue;
        }
        // a nominal value that no search would come to is none to be pulled back
        let range = (range.0.min(off), range.1.max(off));
        let Entry { name, side, motion, nonlinear, phrase, attributes, .. } = *entry;
        found.push(Candidate { name, side, phrase, motion, off, steps, range, nonlinear, attributes });
    }
    found
}

/// The off coordinate of a candidate whose nominal value is `nominal`, the steps that are tried from there, and the range of coordinates;
/// `None` where the rig has no such part.
fn extent(
    motion: Motion,
    nominal: f64,
    model: &Model,
    saturations: &dyn Fn(Cuts) -> Vec<f64>,
) -> Option<(f64, Vec<f64>, (f64, f64))> {
    let scaled = |steps: &[f64], by: f64| steps.iter().map(|step| step * by).collect();
    Some(match motion {
        Motion::Real { steps, range } => (nominal, steps.to_vec(), range),
        Motion::Load { steps, range } => {
            let scale = model.inertia_scale();
            (nominal, scaled(steps, scale), (range.0 * scale, range.1 * scale))
        }
        // a rig without this part: there is nothing to be wrong about
        Motion::Share { .. } if nominal == 0.0 => return None,
        Motion::Share { steps, range } => {
            let ends = (range.0 * nominal, range.1 * nominal);
            (nominal, scaled(steps, nominal), (ends.0.min(ends.1), ends.0.max(ends.1)))
        }
        Motion::Saturation { .. } if nominal > 0.0 => {
            let x = 1.0 / nominal;
            (x, vec![0.1 * x, 0.5 * x], (0.0, f64::INFINITY))
        }
        Motion::Saturation { cuts } => {
            (0.0, saturations(cuts).iter().map(|level| 1.0 / level).collect(), (0.0, f64::INFINITY))
        }
        Motion::Count { tried, most } => {
            let first = nominal as i32 + 1;
            let more = first..=tried.max(first).min(most);
            let steps = (0..first - 1).rev().chain(more).map(|n| f64::from(n) - nominal).collect();
            (nominal, steps, (0.0, f64::from(most)))
        }
        Motion::Switch => (nominal, vec![1.0 - 2.0 * nominal], (0.0, 1.0)),
    })
}

/// The arm turns about a fixed pin instead of rolling.
fn pinned(model: &Model) -> bool {
    names(Attribute::Rolls).all(|name| model.number(name) == Some(0.0))
}
