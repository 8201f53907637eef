//! One interval about a state: what it gives, and its derivatives by the states.

use super::grid::Grid;
use super::linearise::Engine;
use super::machine::Reference;
use super::policy::DYNAMICS;
use super::schedule::Schedule;
use super::worker::{Job, Worker};
use crate::error::Error;
use nalgebra::{DMatrix, DVector};

/// A run whose intervals are asked for, with the parameters of units that are off their nominal values.
#[derive(Clone, Copy)]
pub(super) struct Along<'a> {
    /// The machine with all runs.
    pub engine: &'a Engine,
    /// Rows and values of the run.
    pub grid: &'a Grid,
    /// What is fed and read within its intervals.
    pub schedule: &'a Schedule,
    /// Parameters of units with their values.
    pub set: &'a [(Reference, f64)],
}

/// What [`Worker::interval`] gives from a row on, about a state.
pub(super) struct About {
    /// The state.
    pub at: DVector<f64>,
    /// What follows from it.
    pub base: Vec<f64>,
    /// Its derivatives, a column for each state.
    pub columns: DMatrix<f64>,
}

impl About {
    /// An entry at a state near by, to first order.
    pub fn entry_near(&self, entry: usize, state: &DVector<f64>) -> f64 {
        self.base[entry] + (self.columns.row(entry) * (state - &self.at))[0]
    }
}

impl Along<'_> {
    /// What follows from a state at a row.
    pub fn from(
        &self,
        worker: &mut Worker,
        row: usize,
        states: &[f64],
        out: &mut Vec<f64>,
    ) -> Result<(), Error> {
        let job = Job { parameters: self.set, ..self.engine.job(self.grid, self.schedule, row, states) };
        worker.interval(&self.engine.machine, &job, out)
    }

    /// The same with its derivatives.
    pub fn about(&self, worker: &mut Worker, row: usize, states: &DVector<f64>) -> Result<About, Error> {
        let (mut base, mut out) = (Vec::new(), Vec::new());
        let mut at: Vec<f64> = states.iter().copied().collect();
        self.from(worker, row, &at, &mut base)?;
        let mut columns = DMatrix::zeros(base.len(), at.len());
        for i in 0..at.len() {
            let step = DYNAMICS.state_step * self.engine.scales[i];
            at[i] += step;
            self.from(worker, row, &at, &mut out)?;
            at[i] = states[i];
            for (entry, (there, here)) in out.iter().zip(&base).enumerate() {
                columns[(entry, i)] = (there - here) / step;
            }
        }
        Ok(About { at: states.clone(), base, columns })
    }
}
