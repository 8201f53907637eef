//! The engine as what a fit linearises.

use super::linearise::{Chord, Engine};
use crate::error::Error;
use crate::infer::Linearised;
use crate::infer::fit::{Linearise, Path};
use crate::observe::Scale;

impl Linearise for Engine {
    fn linearise(&self, theta: &[f64], paths: &[Path], columns: &[usize]) -> Result<Vec<Linearised>, Error> {
        let chords: Vec<Chord> = columns.iter().map(|parameter| self.local(theta, *parameter)).collect();
        self.chords(theta, paths, &chords)
    }

    fn range(&self, parameter: usize) -> (f64, f64) {
        self.machine.parameters[parameter].range
    }

    fn is_relative(&self, parameter: usize) -> bool {
        self.machine.parameters[parameter].scale == Scale::Relative
    }

    fn scales(&self) -> &[f64] {
        &self.scales
    }
}

impl Engine {
    /// Every run with these columns.
    ///
    /// # Errors
    /// A unit failed.
    pub fn chords(&self, theta: &[f64], paths: &[Path], chords: &[Chord]) -> Result<Vec<Linearised>, Error> {
        (0..self.grids.len()).map(|run| self.run(run, theta, &paths[run], chords)).collect()
    }
}
