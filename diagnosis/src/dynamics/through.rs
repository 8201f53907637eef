//! States that no variable shows, read through the outputs that follow.
//!
//! A unit goes on from x(k) over one interval, and then over a horizon of H more, with its outputs Y at each row. Started at
//! x̂(k+1) it gives O there. Where it is, x(k+1), is where O(x) = Y: to first order x(k+1) = x̂(k+1) + J⁺ (Y - O), J = ∂O/∂x.
//! By this ∂F/∂x = J⁺ ∂Y/∂x and ∂F/∂θ = J⁺ (∂Y/∂θ - ∂O/∂θ). No noise is in Y and O, so the horizon may be short.

use super::grid::Grid;
use super::linearise::{Engine, RowParts};
use super::machine::Reference;
use super::schedule::Schedule;
use super::worker::{Job, Worker};
use crate::error::Error;
use crate::infer::fit::Path;
use crate::statistics::levels::{FEW, FINE, ROUNDING, SAMPLE};
use nalgebra::{DMatrix, DVector};

/// Directions of the states that show less than this share of the clearest are left as they are: differences are good to 1e-6.
const CLEAR: f64 = ROUNDING;
/// A horizon is long enough when every direction shows more than this share of the clearest.
const ENOUGH: f64 = FINE;
/// Longest horizon, rows.
const FARTHEST: usize = SAMPLE;
/// Rounds of reading a state anew: each is quadratic.
const ROUNDS: usize = FEW;

/// Pseudo-inverse of ∂O/∂x, rows weighed by the sensors, columns by the states' scales; and the share that shows least.
fn reader(jacobian: &DMatrix<f64>, sensors: &[f64], scales: &[f64]) -> (DMatrix<f64>, f64) {
    let weighed = DMatrix::from_fn(jacobian.nrows(), jacobian.ncols(), |i, j| {
        jacobian[(i, j)] * scales[j] / sensors[i % sensors.len()]
    });
    let svd = weighed.svd(true, true);
    let most = svd.singular_values.amax();
    let least = svd.singular_values.min() / most.max(1e-300);
    let inverse = svd
        .pseudo_inverse(CLEAR * most)
        .unwrap_or_else(|_| DMatrix::zeros(jacobian.ncols(), jacobian.nrows()));
    let inverse = DMatrix::from_fn(inverse.nrows(), inverse.ncols(), |i, j| {
        inverse[(i, j)] * scales[i] / sensors[j % sensors.len()]
    });
    (inverse, least)
}

impl Engine {
    /// Chooses the horizon: as few rows as show every state. How many.
    ///
    /// # Errors
    /// A unit failed.
    pub(super) fn look_ahead(&mut self) -> Result<usize, Error> {
        let (n, outputs) = (self.machine.order(), self.machine.channels.len());
        let mut horizon = n.div_ceil(outputs.max(1)) + 1;
        loop {
            self.machine.horizon = horizon;
            let grid = &self.grids[0];
            let schedule = Schedule::new(&self.machine, grid, &self.machine.neutral());
            let row = grid.time.len() / 2;
            let here = self.nominal_states(grid, row);
            let least = self.with_worker(|worker| {
                let (_, jacobian) = self.outputs_from(worker, grid, &schedule, &[], row, &here)?;
                Ok(reader(&jacobian, &self.sensors, &self.scales).1)
            })?;
            if least > ENOUGH || 2 * horizon > FARTHEST || 2 * horizon > grid.time.len() / 2 {
                return Ok(horizon);
            }
            horizon *= 2;
        }
    }

    /// O at a state, and its derivative.
    fn outputs_from(
        &self,
        worker: &mut Worker,
        grid: &Grid,
        schedule: &Schedule,
        set: &[(Reference, f64)],
        row: usize,
        states: &[f64],
    ) -> Result<(Vec<f64>, DMatrix<f64>), Error> {
        let (n, reads) = (self.machine.order(), schedule.reads[row].len());
        let (mut base, mut out, mut at) = (Vec::new(), Vec::new(), states.to_vec());
        let job = Job { parameters: set, ..self.job(grid, schedule, row, states) };
        worker.interval(&self.machine, &job, &mut base)?;
        let here = self.shown(&base, reads);
        let mut jacobian = DMatrix::zeros(here.len(), n);
        for state in 0..n {
            let step = 1e-4 * self.scales[state];
            at[state] += step;
            worker.interval(&self.machine, &Job { states: &at, ..job }, &mut out)?;
            at[state] = states[state];
            for (entry, (there, here)) in self.shown(&out, reads).iter().zip(&here).enumerate() {
                jacobian[(entry, state)] = (there - here) / step;
            }
        }
        Ok((here, jacobian))
    }

    /// Outputs at a row and the H rows after it, of what [`Worker::interval`] gives.
    fn shown(&self, out: &[f64], reads: usize) -> Vec<f64> {
        let (n, outputs, horizon) = (self.machine.order(), self.machine.channels.len(), self.machine.horizon);
        let mut shown = out[n..n + outputs].to_vec();
        shown.extend_from_slice(&out[n + outputs + reads..n + outputs + reads + horizon * outputs]);
        shown
    }

    /// Outputs at the H + 1 rows after the first.
    fn following<'a>(&self, out: &'a [f64], reads: usize) -> &'a [f64] {
        let (n, outputs, horizon) = (self.machine.order(), self.machine.channels.len(), self.machine.horizon);
        let from = n + outputs + reads;
        &out[from..from + (horizon + 1) * outputs]
    }

    /// The state at the next row, which shows what followed from this one; and its reader.
    #[allow(clippy::too_many_arguments, reason = "one row of a run with all that it depends on")]
    pub(super) fn shown_next(
        &self,
        worker: &mut Worker,
        grid: &Grid,
        schedule: &Schedule,
        set: &[(Reference, f64)],
        row: usize,
        guess: &[f64],
        out: &[f64],
    ) -> Result<(Vec<f64>, DMatrix<f64>), Error> {
        let wanted = self.following(out, schedule.reads[row].len()).to_vec();
        let mut state = guess.to_vec();
        let mut round = 0;
        loop {
            let (here, jacobian) = self.outputs_from(worker, grid, schedule, set, row + 1, &state)?;
            let (inverse, _) = reader(&jacobian, &self.sensors, &self.scales);
            let rest = DVector::from_iterator(
                here.len(),
                wanted.iter().zip(&here).map(|(wanted, here)| wanted - here),
            );
            let by = &inverse * rest;
            state.iter_mut().zip(by.iter()).for_each(|(state, by)| *state += by);
            round += 1;
            let small = by.iter().zip(&self.scales).all(|(by, scale)| by.abs() < 1e-3 * scale);
            if small || round >= ROUNDS {
                return Ok((state, inverse));
            }
        }
    }
}

/// Puts next states and their derivatives where a unit that shows them would have.
pub(super) fn next_states(engine: &Engine, path: &Path, schedule: &Schedule, parts: &mut [RowParts]) {
    let n = engine.machine.order();
    for row in 0..parts.len().saturating_sub(1) {
        let (here, there) = parts.split_at_mut(row + 1);
        let (here, there) = (&mut here[row], &there[0]);
        let (reads, next_reads) = (schedule.reads[row].len(), schedule.reads[row + 1].len());
        let columns: Vec<Vec<f64>> =
            there.states.iter().map(|column| engine.shown(column, next_reads)).collect();
        let jacobian = DMatrix::from_fn(columns[0].len(), n, |i, j| columns[j][i]);
        let (inverse, _) = reader(&jacobian, &engine.sensors, &engine.scales);
        let read = |following: &[f64], shown: Option<Vec<f64>>| {
            let rest = DVector::from_fn(following.len(), |i, _| {
                following[i] - shown.as_ref().map_or(0.0, |shown| shown[i])
            });
            &inverse * rest
        };
        let by = read(engine.following(&here.base, reads), Some(engine.shown(&there.base, next_reads)));
        (0..n).for_each(|i| here.base[i] = path[(row + 1) * n + i] + by[i]);
        for column in here.states.iter_mut().chain(&mut here.inputs) {
            let by = read(engine.following(column, reads), None);
            (0..n).for_each(|i| column[i] = by[i]);
        }
        for (column, next) in here.units.iter_mut().zip(&there.units).filter(|(column, _)| !column.is_empty())
        {
            let by = read(engine.following(column, reads), Some(engine.shown(next, next_reads)));
            (0..n).for_each(|i| column[i] = by[i]);
        }
    }
}
