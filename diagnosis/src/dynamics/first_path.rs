//! A path to begin with: an extended Kalman filter over each run, with process noise as large as the motion itself. Where another
//! search went along a run already, its path is taken. Where the filter goes to states with which the unit can't be run, the path is
//! what channels measured of the states.

use super::grid::Grid;
use super::interval::{About, Along};
use super::linearise::Engine;
use super::schedule::{Schedule, output_effects};
use super::worker::Worker;
use crate::error::Error;
use crate::infer::Noise;
use crate::infer::fit::Path;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Where runs were followed already: paths with the times of their rows, by the run's name.
#[derive(Debug, Clone, Default)]
pub struct Trails(BTreeMap<String, Vec<(f64, Vec<f64>)>>);

impl Trails {
    /// Adds paths of an engine's runs.
    pub fn add(&mut self, engine: &Engine, paths: &[Path]) {
        let order = engine.machine.order();
        engine.grids.iter().zip(paths).for_each(|(grid, path)| self.add_path(grid, path, order));
    }

    fn add_path(&mut self, grid: &Grid, path: &[f64], order: usize) {
        let states = path.chunks(order.max(1)).map(<[f64]>::to_vec);
        let trail = self.0.entry(grid.name.clone()).or_default();
        trail.extend(grid.time.iter().copied().zip(states));
        trail.sort_by(|a, b| a.0.total_cmp(&b.0));
        trail.dedup_by(|a, b| a.0 == b.0);
    }

    /// The path along a run, if it was followed at each of its rows.
    fn path_along(&self, grid: &Grid) -> Option<Path> {
        let trail = self.0.get(&grid.name)?;
        let at = |time: &f64| trail.binary_search_by(|(known, _)| known.total_cmp(time)).ok();
        let rows = grid.time.iter().map(|time| at(time).map(|place| trail[place].1.as_slice()));
        Some(rows.collect::<Option<Vec<_>>>()?.concat())
    }
}

impl Engine {
    /// A path along every run: a known one, or filtered states.
    ///
    /// # Errors
    /// A unit failed from the first row on.
    pub fn paths(&self, theta: &[f64], noise: &Noise, known: &Trails) -> Result<Vec<Path>, Error> {
        let path = |run| match known.path_along(&self.grids[run]) {
            Some(path) => Ok(path),
            None => self.filtered(run, theta, noise).or_else(|error| self.measured(run).ok_or(error)),
        };
        (0..self.grids.len()).into_par_iter().map(path).collect()
    }

    /// Filtered states of every run.
    ///
    /// # Errors
    /// A unit failed from the first row on.
    pub fn first_paths(&self, theta: &[f64], noise: &Noise) -> Result<Vec<Path>, Error> {
        self.paths(theta, noise, &Trails::default())
    }

    /// At each row what was last measured of the states; those that no channel measures stay where they begin. `None`: no channel measures any.
    fn measured(&self, run: usize) -> Option<Path> {
        let (machine, grid) = (&self.machine, &self.grids[run]);
        let of = |channel: usize| machine.states.iter().position(|state| state.channel == Some(channel));
        if machine.states.iter().all(|state| state.channel.is_none()) {
            return None;
        }
        let mut state = self.starts[run].0.clone();
        let believed = grid.samples.iter().zip(&self.outliers[run]).filter(|(_, outlier)| !**outlier);
        let mut seen = believed.map(|(sample, _)| sample).peekable();
        let mut path = Vec::with_capacity(grid.time.len() * state.len());
        for time in &grid.time {
            while let Some(sample) = seen.next_if(|sample| sample.time <= *time) {
                if let Some(place) = of(sample.channel) {
                    state[place] = sample.value;
                }
            }
            path.extend(&state);
        }
        Some(path)
    }

    fn filtered(&self, run: usize, theta: &[f64], noise: &Noise) -> Result<Path, Error> {
        let (machine, grid, n) = (&self.machine, &self.grids[run], self.machine.order());
        if machine.whole {
            return Ok(vec![0.0; grid.time.len() * n]);
        }
        let schedule = Schedule::new(machine, grid, theta);
        let effects = output_effects(machine, theta);
        let along = Along { engine: self, grid, schedule: &schedule, set: &self.set(theta) };
        let (mean, sd) = &self.starts[run];
        let torn = grid.torn(&schedule.late);
        let blind = grid.rows_with_unknown_input(machine.reading, &schedule.late);
        let mut filter = Filter {
            state: DVector::from_column_slice(mean),
            covariance: DMatrix::from_fn(n, n, |i, j| if i == j { sd[i] * sd[i] } else { 0.0 }),
        };
        let mut path = Vec::with_capacity(grid.time.len() * n);
        let mut placed = schedule.placed.iter().peekable();
        self.with_worker(|worker| {
            let mut about = along.about(worker, 0, &filter.state)?;
            for (row, blind) in blind.into_iter().enumerate() {
                while let Some(at) = placed.next_if(|at| at.row == row) {
                    if at.early || blind || self.outliers[run].get(at.sample).copied().unwrap_or(false) {
                        continue;
                    }
                    let sample = grid.samples[at.sample];
                    let effect = effects[sample.channel];
                    let entry = n + at.read.map_or(sample.channel, |read| machine.channels.len() + read);
                    let observe = about.columns.row(entry).transpose() * effect.gain;
                    let near = about.entry_near(entry, &filter.state);
                    let shown = effect.shown(near, sample.time - grid.origin);
                    filter.correct(&observe, sample.value - shown, noise.variance(sample.channel, 0.0));
                }
                path.extend(filter.state.iter().copied());
                if row + 1 < grid.time.len() {
                    let dt = grid.time[row + 1] - grid.time[row];
                    let transition;
                    (filter.state, transition, about) = along.next(worker, row, &filter.state, &about)?;
                    let anew = (torn.get(row) == Some(&true)).then_some(sd.as_slice());
                    filter.spread(&transition, dt, noise, anew);
                }
            }
            Ok(path)
        })
    }
}

/// An extended Kalman filter at a row.
struct Filter {
    state: DVector<f64>,
    covariance: DMatrix<f64>,
}

impl Filter {
    /// Takes in a value that is so much more than the state shows; `variance` is the sensor's.
    fn correct(&mut self, observe: &DVector<f64>, innovation: f64, variance: f64) {
        let gain = &self.covariance * observe;
        let spread = observe.dot(&gain) + variance;
        self.state += &gain * (innovation / spread);
        self.covariance -= &gain * gain.transpose() / spread;
    }

    /// The covariance after an interval of `dt` s, with process noise, and as at the first row (standard deviations `anew`) where nobody
    /// knows what was fed.
    fn spread(&mut self, transition: &DMatrix<f64>, dt: f64, noise: &Noise, anew: Option<&[f64]>) {
        self.covariance = transition * &self.covariance * transition.transpose();
        for i in 0..self.state.len() {
            let anew = anew.map_or(0.0, |sd| sd[i] * sd[i]);
            self.covariance[(i, i)] += noise.process[i] * noise.process[i] * dt + anew;
        }
        self.covariance = 0.5 * (&self.covariance + self.covariance.transpose());
    }
}

impl Along<'_> {
    /// The state at the next row, its derivative by this one, and what follows from it.
    fn next(
        &self,
        worker: &mut Worker,
        row: usize,
        state: &DVector<f64>,
        about: &About,
    ) -> Result<(DVector<f64>, DMatrix<f64>, About), Error> {
        let n = state.len();
        let mut out = Vec::new();
        let there = self.from(worker, row, state.as_slice(), &mut out);
        if self.engine.machine.horizon > 0 {
            there?;
            return self.read_next(worker, row, state, about, &out);
        }
        // a correction that the unit can't follow is followed to first order
        let next = match there {
            Ok(()) => DVector::from_column_slice(&out[..n]),
            Err(_) => DVector::from_fn(n, |i, _| about.entry_near(i, state)),
        };
        let following = self.about(worker, row + 1, &next)?;
        Ok((next, about.columns.rows(0, n).into_owned(), following))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(name: &str, time: &[f64]) -> Grid {
        Grid {
            name: name.into(),
            time: time.to_vec(),
            samples: Vec::new(),
            inputs: Vec::new(),
            origin: 0.0,
            begin: Vec::new(),
            lost: Vec::new(),
        }
    }

    #[test]
    fn law_a_trail_is_taken_where_it_knows_every_row_of_the_run() {
        let mut trails = Trails::default();
        trails.add_path(&grid("a", &[0.2, 0.3]), &[5.0, 6.0, 7.0, 8.0], 2);
        trails.add_path(&grid("a", &[0.0, 0.1, 0.2]), &[1.0, 2.0, 3.0, 4.0, 9.0, 9.0], 2);
        // parts of one run join; a row of both is known from the first of them
        let whole = trails.path_along(&grid("a", &[0.0, 0.1, 0.2, 0.3]));
        assert_eq!(whole, Some(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]));
        assert_eq!(trails.path_along(&grid("a", &[0.1, 0.3])), Some(vec![3.0, 4.0, 7.0, 8.0]));
        assert_eq!(trails.path_along(&grid("a", &[0.1, 0.15])), None);
        assert_eq!(trails.path_along(&grid("b", &[0.1])), None);
    }
}
