//! Which rows are left out together, each part in turn.

use crate::rigs::acrobot::residual::Block;
use crate::statistics::levels::FEW;

/// Which blocks are left out together: runs, or thirds of a single run.
#[derive(Debug, Clone)]
pub struct Folds {
    /// Fold of each block.
    pub of: Vec<usize>,
    /// Number of folds.
    pub count: usize,
    /// Run that each fold is; empty where a single run is divided.
    pub runs: Vec<usize>,
}

impl Folds {
    /// Runs where there are two or more; else the run is divided.
    pub fn new(blocks: &[Block]) -> Self {
        let mut runs: Vec<usize> = blocks.iter().map(|block| block.run).collect();
        // a cut's signals may have blocks of their own, each over all runs
        runs.sort_unstable();
        runs.dedup();
        if runs.len() > 1 {
            let of = blocks
                .iter()
                .map(|block| runs.iter().position(|run| *run == block.run).unwrap_or(0))
                .collect();
            return Self { of, count: runs.len(), runs };
        }
        let of = (0..blocks.len()).map(|place| place * FEW / blocks.len().max(1)).collect();
        Self { of, count: FEW, runs: Vec::new() }
    }

    /// What was left out, each in turn, in words.
    pub fn names(&self, runs: &[String]) -> Vec<String> {
        if self.runs.is_empty() {
            return vec!["parts of the only run".to_owned()];
        }
        self.runs.iter().filter_map(|run| runs.get(*run).cloned()).collect()
    }
}
