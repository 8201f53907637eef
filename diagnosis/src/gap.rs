//! How far apart, in physical units, before and after, on runs left out; and where.

use crate::diagnosis::{Gap, Trace, Where};
use crate::residual::picture::{ANGLES, CENTROIDS, COLUMNS};
use crate::residual::torque::{growth, shrunk, torques};
use crate::residual::{Block, Signal};
use crate::selection::{Evaluation, Study};
use crate::statistics::linear::{bare, moved};
use nalgebra::DVector;
use std::ops::Range;

/// A gap must stand this far above the floor to be worth closing.
const ABOVE: f64 = 1.05;
/// Share of the disagreement below which a signal isn't listed.
const LISTED: f64 = 0.02;

/// The gap of one study, and whether it is one of torques. `free` are its continuous active candidates. Where a plant follows
/// poses that were read off pictures, both are looked at: what a lens leaves shows in pixels, what a plant leaves in torques.
pub fn widest(
    study: &Study,
    free: &[usize],
    runs: &[String],
    torque: bool,
    signals: &[Signal],
) -> (Gap, bool) {
    let own = (gap(study, free, runs, torque), torque);
    if torque || !led(signals) {
        return own;
    }
    let other = (gap(study, free, runs, true), true);
    if above(&other.0) > above(&own.0) { other } else { own }
}

/// How far a gap stands above its floor.
pub fn above(gap: &Gap) -> f64 {
    if gap.floor > 0.0 { gap.before / gap.floor } else { 0.0 }
}

/// Whether signals are both the picture's and a plant's.
pub fn led(signals: &[Signal]) -> bool {
    ["camera.", "plant."].iter().all(|unit| signals.iter().any(|signal| signal.name.starts_with(unit)))
}

fn gap(study: &Study, free: &[usize], runs: &[String], torque: bool) -> Gap {
    let (nominal, last, folds) = (study.nominal.under(&study.last), &study.last, &study.folds);
    let places = last.places(free);
    let shifts =
        if free.is_empty() { vec![DVector::zeros(0); folds.count] } else { last.shifts(folds, free) };
    let (before, after, floor, signal, unit) = if torque {
        let nominal = torques(&nominal.blocks, &[], &[], &folds.of);
        let (before, after, floor) = shrunk(&nominal, &torques(&last.blocks, &places, &shifts, &folds.of));
        (before, after, floor, "plant: torque that the model lacks, both links", "N·m")
    } else {
        let circles = measures(&last.blocks, &CENTROIDS);
        let of = if circles { CENTROIDS } else { ANGLES };
        let rms = |blocks: &[Block], places: &[usize], shifts: &[DVector<f64>]| {
            picture_rms(blocks, places, shifts, &folds.of, &of)
        };
        let (floor, before) = (rms(&last.blocks, &[], &[]), rms(&nominal.blocks, &[], &[]));
        let after = rms(&last.blocks, &places, &shifts);
        let (signal, unit) =
            if circles { ("camera: centroids", "px") } else { ("camera: estimated angles", "rad") };
        (before, after, floor, signal, unit)
    };
    let closed = (before > ABOVE * floor)
        .then(|| 1.0 - (after * after - floor * floor) / (before * before - floor * floor))
        .map(|closed| closed.min(1.0));
    Gap {
        before,
        after,
        floor,
        closed,
        held_out_runs: folds.names(runs),
        signal: signal.into(),
        unit: unit.into(),
    }
}

/// A share of the torques' gap, and standard errors, by which effects must widen it on runs left out to be withdrawn.
const WIDENED: f64 = 0.1;
const CLEARLY: f64 = 2.0;

/// Whether effects (`free` are the continuous ones) leave more torque on runs left out than none at all, and not by chance. Angles may
/// be met better by chance, where stamps scatter, but then the motion's torques aren't.
pub fn widened(study: &Study, free: &[usize], gap: &Gap) -> bool {
    if gap.closed.is_none_or(|closed| closed >= -WIDENED) {
        return false;
    }
    let (folds, last) = (&study.folds, &study.last);
    let shifts = if free.is_empty() { Vec::new() } else { last.shifts(folds, free) };
    let before = torques(&study.nominal.under(last).blocks, &[], &[], &folds.of);
    let after = torques(&last.blocks, &last.places(free), &shifts, &folds.of);
    growth(&before, &after) > CLEARLY
}

/// Whether some of these signals are measured.
fn measures(blocks: &[Block], signals: &Range<usize>) -> bool {
    let cells = blocks.iter().flat_map(|block| &block.cells);
    cells.flat_map(|cell| &cell.signal).any(|signal| signals.contains(signal))
}

fn picture_rms(
    blocks: &[Block],
    places: &[usize],
    shifts: &[DVector<f64>],
    folds: &[usize],
    signals: &Range<usize>,
) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (block, fold) in blocks.iter().zip(folds) {
        for cell in &block.cells {
            let rest = bare(cell, &moved(cell, places, shifts.get(*fold)), 0.0).rest;
            for row in (0..cell.residual.len()).filter(|row| signals.contains(&cell.signal[*row])) {
                sum += (rest[row] * cell.sigma[row]).powi(2);
                count += 1.0;
            }
        }
    }
    (sum / f64::max(count, 1.0)).sqrt()
}

/// Which signals disagree under the nominal model, when, and where.
pub fn places(study: &Study, signals: &[Signal]) -> Vec<(f64, Where)> {
    let nominal = study.nominal.under(&study.last);
    let mut excess = vec![0.0; signals.len()];
    let mut spans = vec![(f64::INFINITY, f64::NEG_INFINITY); signals.len()];
    let mut worst: Vec<Vec<(f64, [f64; 4])>> = vec![Vec::new(); signals.len()];
    for block in &nominal.blocks {
        let mut own = vec![0.0; signals.len()];
        let mut rows = vec![0.0; signals.len()];
        for cell in &block.cells {
            let rest = bare(cell, &cell.residual, 0.0).rest;
            for row in 0..cell.residual.len() {
                own[cell.signal[row]] += rest[row] * rest[row];
                rows[cell.signal[row]] += 1.0;
            }
        }
        for s in 0..signals.len() {
            if rows[s] == 0.0 {
                continue;
            }
            let over = own[s] - rows[s];
            excess[s] += over;
            worst[s].push((over, block.state));
            // three standard deviations of a sum of squares
            if over > 3.0 * (2.0 * rows[s]).sqrt() {
                spans[s] = (spans[s].0.min(block.from), spans[s].1.max(block.to));
            }
        }
    }
    (0..signals.len())
        .filter(|s| excess[*s] > 0.0 && spans[*s].0.is_finite())
        .map(|s| {
            let place = Where {
                signal: signals[s].name.clone(),
                share: excess[s],
                from: spans[s].0,
                to: spans[s].1,
                region: region(&mut worst[s]),
            };
            (excess[s], place)
        })
        .collect()
}

/// Turns excesses into shares and drops crumbs.
pub fn shares(found: Vec<(f64, Where)>) -> Vec<Where> {
    let total: f64 = found.iter().map(|(excess, _)| excess).sum();
    let mut all: Vec<Where> =
        found.into_iter().map(|(excess, place)| Where { share: excess / total, ..place }).collect();
    all.retain(|place| place.share >= LISTED);
    all.sort_by(|a, b| b.share.total_cmp(&a.share));
    all
}

/// The states of the tenth of the blocks that disagree most.
fn region(worst: &mut [(f64, [f64; 4])]) -> String {
    worst.sort_by(|a, b| b.0.total_cmp(&a.0));
    let many = worst.len().div_ceil(10);
    let of = |index: usize, slice: &[(f64, [f64; 4])]| {
        let values = slice.iter().map(|(_, state)| state[index]);
        (values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max))
    };
    let ((a, b), (c, d)) = (of(1, &worst[..many]), of(1, worst));
    let ((e, f), (g, h)) = (of(3, &worst[..many]), of(3, worst));
    format!(
        "most where q2 is {a:.2} to {b:.2} rad (of {c:.2} to {d:.2}) and dq2 {e:.2} to {f:.2} rad/s (of {g:.2} to {h:.2})"
    )
}

/// Which signal of a picture is shown, if it was measured: the tip goes furthest.
const SHOWN: [usize; 8] = [4, 5, 2, 3, 10, 9, 0, 1];

/// Rests over time for the report: torque at the joint, or the tip in the picture.
pub fn trace(study: &Study, torque: bool) -> Trace {
    let measured = |signal: &usize| measures(&study.last.blocks, &(*signal..*signal + 1));
    let shown = SHOWN.into_iter().find(measured).unwrap_or(SHOWN[0]);
    let of = |evaluation: &Evaluation| -> Vec<(f64, f64)> {
        let mut base = 0.0;
        let mut run = usize::MAX;
        let (mut begin, mut end) = (0.0, 0.0);
        let lacking =
            if torque { torques(&evaluation.blocks, &[], &[], &study.folds.of) } else { Vec::new() };
        let mut points = Vec::new();
        for (index, block) in evaluation.blocks.iter().enumerate() {
            if block.run != run {
                base += end - begin;
                (run, begin) = (block.run, block.from);
            }
            end = block.to + 1.0;
            if torque {
                let own: Vec<f64> =
                    lacking.iter().filter(|t| t.block == index).map(|t| t.torque[1]).collect();
                let middle = base - begin + 0.5 * (block.from + block.to);
                points.push((middle, own.iter().sum::<f64>() / own.len().max(1) as f64));
            } else {
                for cell in &block.cells {
                    if let Some(row) = cell.signal.iter().position(|s| *s == shown) {
                        points.push((base - begin + cell.time[row], cell.residual[row]));
                    }
                }
            }
        }
        points
    };
    Trace {
        title: match torque {
            true => "Torque that the model lacks at the joint".into(),
            false => format!("In the picture, {}: measured - rendered", COLUMNS[shown]),
        },
        unit: match torque {
            true => "N·m",
            false if ANGLES.contains(&shown) => "rad",
            false => "px",
        }
        .into(),
        before: of(&study.nominal),
        after: of(&study.last),
    }
}
