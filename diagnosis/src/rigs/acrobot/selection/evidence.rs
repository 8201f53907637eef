//! Whether more than noise remains in what a driven plant leaves, whatever it is: the deviance that a free torque in each part
//! of each window takes away.

use super::evaluation::{Evaluation, Folds};
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::torque::torques;
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::statistics::levels::SEVERAL;
use crate::statistics::linear::Sized;

/// A lacking torque up to this many times what the timestamps' scatter gives is theirs: lateness has a long tail.
pub const STAMPS: f64 = SEVERAL;

/// Fall of the deviance that a torque of its own in each part of each window brings.
pub fn discrepancy(evaluation: &Evaluation) -> f64 {
    let size = evaluation.discrepancy_sd;
    if size <= 0.0 {
        return 0.0;
    }
    let cells = evaluation.blocks.iter().flat_map(|block| &block.cells);
    cells.map(Sized::of).map(|cell| cell.deviance(0.0) - cell.deviance(size)).sum()
}

/// Whether a torque lacks. `explained` is what the scatter of the timestamps gives, N·m; `pictured` where poses are read off images.
pub fn lacking(evaluation: &Evaluation, folds: &Folds, explained: f64, pictured: bool) -> bool {
    let enough = if pictured {
        let parts = torques(&evaluation.blocks, &[], &[], &folds.of).len() as f64;
        SELECTION.pictured_evidence.max(SELECTION.pictured_each * parts)
    } else {
        POLICY.evidence
    };
    evaluation.discrepancy_sd > STAMPS * explained && discrepancy(evaluation) >= enough
}
