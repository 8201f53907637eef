//! What the residual of the plant's cut is in newton metres: the torques that, pushed at link 1 and at the joint over
//! each part of a window, would make the plant follow the log. The plant unit itself does the weighting, so this is
//! a weak form: nothing is differentiated.

use super::Block;
use crate::rigs::acrobot::policy::POLICY;
use crate::statistics::levels::MIDDLE;
use crate::statistics::linear::{Cell, inverse, moved, nuisances};
use crate::statistics::median::median;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// The torques that a model lacks, as signals: on link 1, and at the joint.
pub const LACKING: [&str; 2] = ["plant torque on link 1", "plant torque at the joint"];

/// The torques of one part of a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Torque {
    /// Index of the block.
    pub block: usize,
    /// Part of the block.
    pub part: usize,
    /// On link 1 and at the joint, N·m.
    pub torque: [f64; 2],
    /// What noise alone gives, N·m.
    pub floor: [f64; 2],
}

/// Torques of all blocks after `shift` more of the active columns.
pub fn torques(blocks: &[Block], places: &[usize], shifts: &[DVector<f64>], folds: &[usize]) -> Vec<Torque> {
    let of = |(index, block): (usize, &Block)| -> Vec<Torque> {
        let shift = shifts.get(folds[index]);
        block.cells.iter().flat_map(|cell| parts(index, cell, &moved(cell, places, shift))).collect()
    };
    let each: Vec<Vec<Torque>> = blocks.par_iter().enumerate().map(of).collect();
    each.into_iter().flatten().collect()
}

/// The torques of a cell's parts, N·m: of windows the nuisances that the rows ask for, of the weak form the rows themselves.
fn parts(block: usize, cell: &Cell, residual: &[f64]) -> Vec<Torque> {
    let (at, solved, floor) = if cell.floor.is_empty() {
        let solved = nuisances(cell, residual, cell.free());
        (cell.hard.ncols() + cell.discrepancy, solved.as_slice().to_vec(), deviations(cell))
    } else {
        (0, residual.to_vec(), cell.floor.clone())
    };
    (0..(solved.len() - at) / 2)
        .map(|part| {
            let place = at + 2 * part;
            Torque {
                block,
                part,
                torque: [solved[place], solved[place + 1]],
                floor: [floor[place], floor[place + 1]],
            }
        })
        .collect()
}

/// Standard deviations of the nuisances that the rows' noise gives; the discrepancy is free.
pub fn deviations(cell: &Cell) -> Vec<f64> {
    let (hard, all) = (cell.hard.ncols(), cell.hard.ncols() + cell.soft.ncols());
    let white = DMatrix::from_fn(cell.residual.len(), all, |row, column| {
        let value = if column < hard { cell.hard[(row, column)] } else { cell.soft[(row, column - hard)] };
        value / cell.sigma[row]
    });
    let mut normal = white.tr_mul(&white);
    for place in hard..hard + cell.discrepancy {
        normal[(place, place)] += 1.0;
    }
    let inverse = inverse(&normal).filter(|inverse| inverse.iter().all(|value| value.is_finite()));
    let deviation = |place: usize| {
        inverse.as_ref().map_or(f64::INFINITY, |inverse| inverse[(place, place)].max(0.0).sqrt())
    };
    (0..all).map(deviation).collect()
}

/// The largest torque that counts.
fn limit(torques: &[Torque]) -> f64 {
    let usable = torques.iter().filter(|t| t.floor.iter().all(|f| f.is_finite()));
    POLICY.wild * median(usable.flat_map(|t| t.torque).map(f64::abs)).unwrap_or(0.0) / MIDDLE
}

impl Torque {
    fn within(&self, limit: f64) -> bool {
        self.floor.iter().all(|f| f.is_finite()) && self.torque.iter().all(|x| x.abs() <= limit)
    }

    fn square(&self) -> f64 {
        self.torque.iter().map(|x| x * x).sum()
    }
}

/// Root mean square of torques and of what noise gives, both links together.
pub fn rms(torques: &[Torque]) -> (f64, f64) {
    let limit = limit(torques);
    let tame: Vec<&Torque> = torques.iter().filter(|torque| torque.within(limit)).collect();
    let n = (2 * tame.len()).max(1) as f64;
    let floors = tame.iter().map(|t| t.floor.iter().map(|x| x * x).sum::<f64>()).sum::<f64>();
    ((tame.iter().map(|t| t.square()).sum::<f64>() / n).sqrt(), (floors / n).sqrt())
}

/// Sums of squares before and after, of what noise gives, and their number, where the plant follows the log after: what made it run
/// away before was lacking. `floors` are the torques again, with the noise that is no model's.
pub fn shrunk(before: &[Torque], after: &[Torque], floors: &[Torque]) -> [f64; 4] {
    let limit = limit(after);
    let mut sums = [0.0; 4];
    for ((old, new), floor) in before.iter().zip(after).zip(floors) {
        if !old.within(f64::INFINITY) || !new.within(limit) {
            continue;
        }
        let floor: f64 = floor.floor.iter().map(|x| x * x).sum();
        let own = [old.square(), new.square(), if floor.is_finite() { floor } else { 0.0 }, 2.0];
        sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
    }
    sums
}

/// By how many standard errors torques are larger `after` than `before`, compared block by block.
pub fn growth(before: &[Torque], after: &[Torque]) -> f64 {
    let limits = (limit(before), limit(after));
    let (mut sum, mut squares) = (0.0, 0.0);
    for (old, new) in before.iter().zip(after) {
        if old.within(limits.0) && new.within(limits.1) {
            let more = new.square() - old.square();
            sum += more;
            squares += more * more;
        }
    }
    sum / squares.sqrt().max(f64::MIN_POSITIVE)
}
