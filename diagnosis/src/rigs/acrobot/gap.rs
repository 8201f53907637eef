//! How far apart, in physical units, before and after; against what noise alone leaves (`noise_floor`).

use crate::diagnosis::Gap;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::studio::{ANGLES, CENTROIDS};
use crate::rigs::acrobot::residual::torque::{growth, shrunk, torques};
use crate::rigs::acrobot::residual::{Block, Signal};
use crate::rigs::acrobot::selection::{Evaluation, Study};
use crate::statistics::linear::{bare, moved};
use nalgebra::DVector;
use std::ops::Range;

/// Sums of squares of what is left, before and after, and of what noise leaves, with the number of rows of each.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sums {
    /// What the nominal model leaves.
    pub before: (f64, f64),
    /// What the amended model leaves.
    pub after: (f64, f64),
    /// What noise alone leaves.
    pub floor: (f64, f64),
}

impl Sums {
    /// Both together.
    pub fn and(self, other: Self) -> Self {
        let sum = |a: (f64, f64), b: (f64, f64)| (a.0 + b.0, a.1 + b.1);
        Self {
            before: sum(self.before, other.before),
            after: sum(self.after, other.after),
            floor: sum(self.floor, other.floor),
        }
    }

    /// The gap in words and numbers.
    pub fn gap(self, of: Measure) -> Gap {
        let mean = |(square, count): (f64, f64)| (square / f64::max(count, 1.0)).sqrt();
        let (before, after, floor) = (mean(self.before), mean(self.after), mean(self.floor));
        let closed = (before > POLICY.gap_above * floor)
            .then(|| 1.0 - (after * after - floor * floor) / (before * before - floor * floor));
        let (signal, unit) = of.words();
        let (signal, unit) = (signal.into(), unit.into());
        Gap {
            before,
            after,
            floor,
            closed,
            held_out_runs: Vec::new(),
            cross_validated: Vec::new(),
            signal,
            unit,
        }
    }
}

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Torques that the model lacks.
    Torques,
    /// Centroids of circles.
    Centroids,
    /// Angles that a vision read.
    Angles,
}

impl Measure {
    /// In what an image's gap is measured: angles where no circle was logged.
    fn of_picture(blocks: &[Block]) -> Self {
        if measures(blocks, &CENTROIDS) { Self::Centroids } else { Self::Angles }
    }

    /// What the gap is of, and its unit.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Torques => ("plant: torque that the model lacks, both links", "N·m"),
            Self::Centroids => ("camera: centroids", "px"),
            Self::Angles => ("camera: estimated angles", "rad"),
        }
    }

    /// Sums over what two models leave, the second one after `shifts` more of some of its columns, each block with that of its fold.
    /// `noise` is what noise gives a row of each signal.
    pub fn sums(self, nominal: &Evaluation, last: &Evaluation, shifted: &Shifted<'_>, noise: &[f64]) -> Sums {
        let nominal = nominal.under(last);
        let Shifted { places, shifts, folds } = shifted;
        if self == Self::Torques {
            let after = torques(&last.blocks, places, shifts, folds);
            let mut quiet = last.blocks.clone();
            for cell in quiet.iter_mut().flat_map(|block| &mut block.cells) {
                let rows = cell.sigma.iter_mut().zip(&cell.signal);
                rows.for_each(|(sigma, signal)| *sigma *= noise[*signal] / last.sigmas[*signal]);
            }
            let floors = torques(&quiet, &[], &[], folds);
            let [before, after, floor, count] =
                shrunk(&torques(&nominal.blocks, &[], &[], folds), &after, &floors);
            return Sums { before: (before, count), after: (after, count), floor: (floor, count) };
        }
        let of = if self == Self::Centroids { CENTROIDS } else { ANGLES };
        let none = Shifted { places: &[], shifts: &[], folds };
        let (before, after) = (squares(&nominal.blocks, &none, &of), squares(&last.blocks, shifted, &of));
        let rows = last.blocks.iter().flat_map(|block| &block.cells).flat_map(|cell| &cell.signal);
        let rows = rows.filter(|signal| of.contains(signal));
        let floor = rows.fold((0.0, 0.0), |(sum, count), signal| (sum + noise[*signal].powi(2), count + 1.0));
        Sums { before, after, floor }
    }
}

/// By how much some columns' values differ from fold to fold.
#[derive(Debug, Clone, Copy)]
pub struct Shifted<'a> {
    /// The columns.
    pub places: &'a [usize],
    /// What is added in each fold.
    pub shifts: &'a [DVector<f64>],
    /// Fold of each block.
    pub folds: &'a [usize],
}

/// The gap of one study by cross-validation (values are fitted without each fold in turn; the effects were chosen with all), and what is
/// compared. `free` are its continuous active candidates. Where a plant follows poses that were read off images, both are looked
/// at: what a lens leaves shows in pixels, what a plant leaves in torques.
pub fn widest(
    study: &Study,
    free: &[usize],
    runs: &[String],
    torque: bool,
    signals: &[Signal],
) -> (Gap, Measure) {
    let picture = || Measure::of_picture(&study.last.blocks);
    let own = if torque { Measure::Torques } else { picture() };
    let cross_validated = |of: Measure| (cross_validated(study, free, runs, of), of);
    let own = cross_validated(own);
    if torque || !chained(signals) {
        return own;
    }
    let other = cross_validated(Measure::Torques);
    if above_floor(&other.0) > above_floor(&own.0) { other } else { own }
}

/// The gap of an image alone: what circles leave beside each other, whatever a plant does, where poses are read off them.
pub fn of_pictures(study: &Study, free: &[usize], runs: &[String]) -> Gap {
    cross_validated(study, free, runs, Measure::of_picture(&study.last.blocks))
}

/// The gap where nothing is added to the model: what clocks that were put right close is no name's merit, and no part of the gap.
pub fn without_effects(gap: Gap) -> Gap {
    let before = gap.after;
    let closed = (before > POLICY.gap_above * gap.floor).then_some(0.0);
    Gap { before, closed, ..gap }
}

/// Whether one of the effects that are told closes the gap of a part: one that the part found, or one of a unit whose signals it compares.
pub fn is_closed_by(told: &[&str], own: &[&str], signals: &[&str]) -> bool {
    let unit = |name: &str| name.split('.').next().unwrap_or_default().to_owned();
    let of_a_signal = |effect: &str| signals.iter().any(|signal| unit(signal) == unit(effect));
    told.iter().any(|effect| own.contains(effect) || of_a_signal(effect))
}

/// How far a gap stands above its floor.
pub fn above_floor(gap: &Gap) -> f64 {
    if gap.floor > 0.0 { gap.before / gap.floor } else { 0.0 }
}

/// Whether signals are both the image's and a plant's.
pub fn chained(signals: &[Signal]) -> bool {
    ["camera.", "plant."].iter().all(|unit| signals.iter().any(|signal| signal.name.starts_with(unit)))
}

/// The gap by cross-validation in one measure.
fn cross_validated(study: &Study, free: &[usize], runs: &[String], of: Measure) -> Gap {
    let (last, folds) = (&study.last, &study.folds);
    let places = last.places(free);
    let shifts =
        if free.is_empty() { vec![DVector::zeros(0); folds.count] } else { last.shifts(folds, free) };
    let shifted = Shifted { places: &places, shifts: &shifts, folds: &folds.of };
    let gap = of.sums(&study.nominal, last, &shifted, &study.noise).gap(of);
    Gap { cross_validated: folds.names(runs), ..gap }
}

/// Whether effects (`free` are the continuous ones) leave more torque on runs left out than none at all, and not by chance. Angles may
/// be met better by chance, where timestamps scatter, but then the motion's torques aren't.
pub fn widened(study: &Study, free: &[usize], gap: &Gap) -> bool {
    if gap.closed.is_none_or(|closed| closed >= -POLICY.gap_widened) {
        return false;
    }
    let (folds, last) = (&study.folds, &study.last);
    let shifts = if free.is_empty() { Vec::new() } else { last.shifts(folds, free) };
    let before = torques(&study.nominal.under(last).blocks, &[], &[], &folds.of);
    let after = torques(&last.blocks, &last.places(free), &shifts, &folds.of);
    growth(&before, &after) > POLICY.gap_clearly
}

/// Whether some of these signals are measured.
pub(crate) fn measures(blocks: &[Block], signals: &Range<usize>) -> bool {
    let cells = blocks.iter().flat_map(|block| &block.cells);
    cells.flat_map(|cell| &cell.signal).any(|signal| signals.contains(signal))
}

/// Sum of squares of an image's rows, and their number.
fn squares(blocks: &[Block], shifted: &Shifted<'_>, signals: &Range<usize>) -> (f64, f64) {
    let (mut sum, mut count) = (0.0, 0.0);
    for (index, block) in blocks.iter().enumerate() {
        let shift = shifted.folds.get(index).and_then(|fold| shifted.shifts.get(*fold));
        for cell in &block.cells {
            let residual = bare(cell, &moved(cell, shifted.places, shift), 0.0).residual;
            for row in (0..cell.residual.len()).filter(|row| signals.contains(&cell.signal[*row])) {
                sum += (residual[row] * cell.sigma[row]).powi(2);
                count += 1.0;
            }
        }
    }
    (sum, count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_a_gap_to_which_nothing_was_added_is_what_is_left_and_none_of_it_is_closed() {
        let sums = |after: f64| Sums { before: (9.0, 1.0), after: (after * after, 1.0), floor: (1.0, 1.0) };
        // clocks alone closed it from 3 to 2 times the noise, and to the noise
        let (open, quiet) = (
            without_effects(sums(2.0).gap(Measure::Angles)),
            without_effects(sums(1.0).gap(Measure::Angles)),
        );
        assert_eq!((open.before, open.after, open.closed), (2.0, 2.0, Some(0.0)));
        assert_eq!((quiet.before, quiet.after, quiet.closed), (1.0, 1.0, None));
    }

    #[test]
    fn law_what_comes_out_below_the_noise_is_more_than_closed() {
        let sums = Sums { before: (9.0, 1.0), after: (0.8, 1.0), floor: (1.0, 1.0) };
        assert!((sums.gap(Measure::Angles).closed.unwrap_or_default() - 1.025).abs() < 1e-12);
    }

    #[test]
    fn law_a_gap_is_closed_by_what_its_part_found_or_by_effects_of_its_units() {
        let pictures = ["camera.u3", "camera.v3"];
        assert!(!is_closed_by(&[], &["camera.T_delay"], &pictures));
        assert!(is_closed_by(&["camera.k1"], &[], &pictures));
        // pictures of a joint that rubs: no effect of the camera, and found in its part
        assert!(is_closed_by(&["plant.b_joint"], &["plant.b_joint"], &pictures));
        assert!(!is_closed_by(&["plant.b_joint"], &[], &pictures));
        assert!(!is_closed_by(&["plant.b_joint"], &["camera.T_delay"], &pictures));
    }
}
