//! Whether more than noise remains in what a driven plant leaves, whatever it is: the deviance that a free torque in each part
//! of each window takes away.

use super::evaluation::Evaluation;
use super::folds::Folds;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::torque::torques;
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::statistics::linear::Sized;

/// Decrease of the deviance that a torque of its own in each part of each window brings.
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
    evaluation.discrepancy_sd > SELECTION.stamps * explained && discrepancy(evaluation) >= enough
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::selection::examples::{block, evaluation};

    /// One row of unit noise that a torque of ten explains: the deviance decreases by r² 100/101 - ln 101.
    fn lacks(decrease: f64, explained: f64, pictured: bool) -> bool {
        let residual = ((decrease + libm::log(101.0)) * 1.01).sqrt();
        let mut last = evaluation(&[], &[], &[]);
        (last.blocks, last.discrepancy_sd) = (vec![block(residual, 1.0)], 10.0);
        assert!((discrepancy(&last) - decrease).abs() < 1e-9, "{}", discrepancy(&last));
        lacking(&last, &Folds { of: vec![0], count: 1, runs: Vec::new() }, explained, pictured)
    }

    #[test]
    fn value_a_torque_lacks_that_more_than_chance_and_stamps_say() {
        // 4.5² of deviance; ten times as many where poses are read off images
        assert_eq!([19.0, 22.0].map(|decrease| lacks(decrease, 0.0, false)), [false, true]);
        assert_eq!([190.0, 220.0].map(|decrease| lacks(decrease, 0.0, true)), [false, true]);
        // three times what the scatter of the stamps gives
        assert_eq!([3.6, 3.1].map(|explained| lacks(1e3, explained, false)), [false, true]);
    }
}
