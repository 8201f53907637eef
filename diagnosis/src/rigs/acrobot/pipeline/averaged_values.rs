//! Values of the plant that images alone tell, averaged over several linearisations: poses are read off frames that are rendered near by, and
//! where on the pixel lattice those lie is chance. A torque's bias of 0.00123 N·m wanted 0.0011 to 0.0012 from one linearisation to the next, where
//! noise alone makes 0.00002.

use super::compare::Part;
use super::policy::PIPELINE;
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Candidate, Motion, Side};
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::selection::{Study, linearise};

/// Puts the values of the plant where linearisations about the fit want them on average, and notes by how much these differ.
pub(super) fn average_values(cut: &mut Tracked, list: &[Candidate], part: &mut Part) -> Result<(), Error> {
    let free = part.study.continuous(list);
    let Some(covariance) = part.study.last.covariance(&free) else { return Ok(()) };
    // a saturation's windows come and go
    let plants = |index: usize| {
        list[index].side == Side::Plant && !matches!(list[index].motion, Motion::Saturation { .. })
    };
    let values: Vec<Value> = (free.iter().enumerate())
        .filter(|(_, index)| plants(**index))
        .map(|(place, index)| Value { index: *index, place, error: covariance[(place, place)].sqrt() })
        .collect();
    if values.is_empty() {
        return Ok(());
    }
    let fitted = part.study.last.point.clone();
    let Some(targets) = newton_targets(cut, list, &part.study, &free, &values)? else { return Ok(()) };
    let mut next = fitted.clone();
    for (column, value) in values.iter().enumerate() {
        let mean = targets.iter().map(|all| all[column]).sum::<f64>() / PIPELINE.linearisations as f64;
        let square: f64 = targets.iter().map(|all| (all[column] - mean).powi(2)).sum();
        next[value.index] = value.within(list, mean);
        part.rough.push((value.index, (square / (PIPELINE.linearisations - 1) as f64).sqrt()));
    }
    part.study.last = linearise(cut, list, &next, &part.study.active)?;
    values.iter().for_each(|value| move_class(list, part, value.index, fitted[value.index]));
    Ok(())
}

/// What could stand in the place of an averaged effect goes with it, by the same share of its size.
fn move_class(list: &[Candidate], part: &mut Part, effect: usize, before: f64) {
    let off = list[effect].off;
    if before == off {
        return;
    }
    let share = (part.study.last.point[effect] - off) / (before - off);
    let classes = part.classes.iter_mut().filter(|(index, _)| *index == effect);
    for other in classes.flat_map(|(_, class)| class).filter(|other| !list[other.candidate].is_discrete()) {
        let (off, (from, to)) = (list[other.candidate].off, list[other.candidate].range);
        other.x = (off + share * (other.x - off)).clamp(from, to);
    }
}

/// One that is averaged: its index in the list, its place among the fitted ones, and its standard error.
struct Value {
    index: usize,
    place: usize,
    error: f64,
}

impl Value {
    /// A coordinate, kept within the candidate's range.
    fn within(&self, list: &[Candidate], x: f64) -> f64 {
        let (from, to) = list[self.index].range;
        x.clamp(from, to)
    }
}

/// Where a Newton step from each of several linearisations about the fit has the values; `None` where one tells nothing of them.
fn newton_targets(
    cut: &mut Tracked,
    list: &[Candidate],
    study: &Study,
    free: &[usize],
    values: &[Value],
) -> Result<Option<Vec<Vec<f64>>>, Error> {
    let mut all = Vec::new();
    for round in 0..PIPELINE.linearisations {
        let mut point = study.last.point.clone();
        for value in values {
            let sign = if (round + value.place) % 2 == 0 { PIPELINE.off } else { -PIPELINE.off };
            let by = sign * (1 + round / 2) as f64 * value.error;
            point[value.index] = value.within(list, point[value.index] + by);
        }
        let Some(shift) = linearise(cut, list, &point, &study.active)?.newton_step(free) else {
            return Ok(None);
        };
        all.push(values.iter().map(|value| point[value.index] + shift[value.place]).collect());
    }
    Ok(Some(all))
}
