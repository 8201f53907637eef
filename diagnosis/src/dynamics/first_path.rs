//! A path to begin with: an extended Kalman filter over each run, with process noise as large as the motion itself.

use super::linearise::Engine;
use super::linearise::MOVE;
use super::schedule::{Schedule, output_effects};
use super::worker::{Job, Worker};
use crate::error::Error;
use crate::infer::Noise;
use crate::infer::fit::Path;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

impl Engine {
    /// Filtered states of every run.
    ///
    /// # Errors
    /// A unit failed from the first row on.
    pub fn first_paths(&self, theta: &[f64], noise: &Noise) -> Result<Vec<Path>, Error> {
        (0..self.grids.len()).into_par_iter().map(|run| self.first_path(run, theta, noise)).collect()
    }

    fn first_path(&self, run: usize, theta: &[f64], noise: &Noise) -> Result<Path, Error> {
        let (machine, grid, n) = (&self.machine, &self.grids[run], self.machine.order());
        if machine.whole {
            return Ok(vec![0.0; grid.time.len() * n]);
        }
        let schedule = Schedule::new(machine, grid, theta);
        let effects = output_effects(machine, theta);
        let set = self.set(theta);
        let (mean, sd) = &self.starts[run];
        let (torn, blind) = (grid.torn(), grid.blind(machine.reading));
        let mut state = DVector::from_column_slice(mean);
        let mut covariance = DMatrix::from_fn(n, n, |i, j| if i == j { sd[i] * sd[i] } else { 0.0 });
        let mut path = Vec::with_capacity(grid.time.len() * n);
        let mut placed = schedule.placed.iter().peekable();
        self.with_worker(|worker| {
            let (mut base, mut out) = (Vec::new(), Vec::new());
            for (row, blind) in blind.into_iter().enumerate() {
                let mut at: Vec<f64> = state.iter().copied().collect();
                let job = |states: &[f64], out: &mut Vec<f64>, worker: &mut Worker| {
                    let job = Job { parameters: &set, ..self.job(grid, &schedule, row, states) };
                    worker.interval(machine, &job, out)
                };
                job(&at, &mut base, worker)?;
                let mut columns = DMatrix::zeros(base.len(), n);
                for i in 0..n {
                    let step = MOVE * self.scales[i];
                    at[i] += step;
                    job(&at, &mut out, worker)?;
                    at[i] = state[i];
                    for (entry, (there, here)) in out.iter().zip(&base).enumerate() {
                        columns[(entry, i)] = (there - here) / step;
                    }
                }
                let before = state.clone();
                while let Some(at) = placed.next_if(|at| at.row == row) {
                    if at.early || blind || self.outliers[run].get(at.sample).copied().unwrap_or(false) {
                        continue;
                    }
                    let sample = grid.samples[at.sample];
                    let effect = effects[sample.channel];
                    let entry = n + at.read.map_or(sample.channel, |read| machine.channels.len() + read);
                    let observe = columns.row(entry).transpose() * effect.gain;
                    let shown = effect.shown(base[entry], sample.time - grid.origin);
                    let gain = &covariance * &observe;
                    let spread = observe.dot(&gain) + noise.variance(sample.channel, 0.0);
                    let innovation = sample.value - shown - observe.dot(&(&state - &before));
                    state += &gain * (innovation / spread);
                    covariance -= &gain * gain.transpose() / spread;
                }
                path.extend(state.iter().copied());
                if row + 1 < grid.time.len() {
                    let to: Vec<f64> = state.iter().copied().collect();
                    let dt = grid.time[row + 1] - grid.time[row];
                    let transition = if machine.horizon == 0 {
                        let transition = columns.rows(0, n).into_owned();
                        // a correction that the unit can't follow is followed to first order
                        state = match job(&to, &mut out, worker) {
                            Ok(()) => DVector::from_column_slice(&out[..n]),
                            Err(_) => {
                                DVector::from_column_slice(&base[..n]) + &transition * (&state - &before)
                            }
                        };
                        transition
                    } else {
                        job(&to, &mut out, worker)?;
                        let reads = schedule.reads[row].len();
                        let (next, reader) =
                            self.shown_next(worker, grid, &schedule, &set, row, &to, &out)?;
                        state = DVector::from_vec(next);
                        &reader * columns.rows(n + machine.channels.len() + reads, reader.ncols())
                    };
                    covariance = &transition * &covariance * transition.transpose();
                    for i in 0..n {
                        let anew = if torn.get(row) == Some(&true) { sd[i] * sd[i] } else { 0.0 };
                        covariance[(i, i)] += noise.process[i] * noise.process[i] * dt + anew;
                    }
                    covariance = 0.5 * (&covariance + covariance.transpose());
                }
            }
            Ok(path)
        })
    }
}
