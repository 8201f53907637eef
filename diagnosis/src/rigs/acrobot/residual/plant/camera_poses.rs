//! A motion that is known through a camera.

use nalgebra::DMatrix;

/// Poses that were read off images.
#[derive(Debug, Clone, Default)]
pub struct Poses {
    /// Per run and row: q1, q2; `NaN` where the image says nothing.
    pub angles: Vec<Vec<[f64; 2]>>,
    /// Per run and row: how each perturbation would move them, per unit.
    pub moves: Vec<Vec<DMatrix<f64>>>,
}

impl Poses {
    /// None yet.
    pub fn new(runs: usize) -> Self {
        Self { angles: vec![Vec::new(); runs], moves: vec![Vec::new(); runs] }
    }

    /// The next row of a run.
    pub fn push(&mut self, run: usize, angles: [f64; 2], moves: &DMatrix<f64>) {
        self.angles[run].push(angles);
        self.moves[run].push(moves.clone());
    }
}

/// What lies between the motion and a log that a camera made.
#[derive(Clone)]
pub(super) struct Through {
    pub(super) index: Option<usize>,
    pub(super) delay: f64,
    pub(super) poses: Poses,
}
