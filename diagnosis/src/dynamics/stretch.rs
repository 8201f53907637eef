//! How well the units at nominal parameters follow stretches of the logs: each from the start state that fits best, without process
//! noise. Nothing else is fitted.

use super::grid::Grid;
use super::linearise::Engine;
use super::machine::Machine;
use super::policy::DYNAMICS;
use super::schedule::Schedule;
use super::worker::{Job, Worker};
use crate::error::Error;
use crate::nuisance::scatter;
use crate::statistics::levels::{FEW, FINE};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Which stretches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Glance {
    /// Over all runs.
    pub stretches: usize,
    /// Rows of each.
    pub rows: usize,
    /// Gauss-Newton steps of the start state.
    pub rounds: usize,
}

/// What is left of one compared channel.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Left {
    /// Sum of squares of measured less simulated.
    pub error: f64,
    /// Sum of squares about the mean of each stretch.
    pub motion: f64,
    /// Number of values.
    pub count: f64,
    /// Variance of the sensor.
    pub variance: f64,
}

/// How the model moves a channel by itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Standard deviation.
    pub size: f64,
    /// Largest value, whatever its sign.
    pub largest: f64,
}

/// One stretch of a run.
struct Stretch<'a> {
    schedule: &'a Schedule,
    grid: &'a Grid,
    row: usize,
    /// Values: place in what is simulated, channel, measured.
    values: Vec<(usize, usize, f64)>,
    intervals: usize,
    /// The machine grows away from where it is begun.
    grows: bool,
}

impl Stretch<'_> {
    /// Its first quarter; of so many outputs.
    fn begin(&self, outputs: usize) -> Self {
        let intervals = self.intervals.div_ceil(4);
        let within = |(place, ..): &&(usize, usize, f64)| place / outputs <= intervals;
        let values = self.values.iter().filter(within).copied().collect();
        Self { values, intervals, ..*self }
    }
}

impl Engine {
    /// Of each compared channel; `None` where a unit fails or gives nothing finite.
    pub fn follow_stretches(&self, glance: &Glance) -> Option<Vec<Left>> {
        let machine = &self.machine;
        let neutral = machine.neutral();
        let schedules: Vec<Schedule> =
            self.grids.iter().map(|grid| Schedule::new(machine, grid, &neutral)).collect();
        let stretches = self.stretches(glance, &schedules);
        let one = |stretch: &Stretch<'_>| {
            self.with_worker(|worker| self.follow_stretch(worker, stretch, glance.rounds)).ok()
        };
        let parts: Option<Vec<Vec<Left>>> = stretches.par_iter().map(one).collect();
        let mut sums: Vec<Left> =
            self.sensors.iter().map(|sd| Left { variance: sd * sd, ..Left::default() }).collect();
        for part in parts? {
            for (sum, part) in sums.iter_mut().zip(part) {
                sum.error += part.error;
                sum.motion += part.motion;
                sum.count += part.count;
            }
        }
        Some(sums)
    }

    /// How the model moves a channel of the data set in that part of a run, of so many rows each, in which it moves it most; each begins where the
    /// log says that the model stands. Nothing where the run or the channel isn't compared, or the model can't be followed in any part.
    pub fn motion(&self, run: &str, channel: usize, rows: usize) -> Option<Motion> {
        let machine = &self.machine;
        let grid = self.grids.iter().find(|grid| grid.name == run)?;
        let place = machine.channels.iter().position(|output| output.channel == channel)?;
        let schedule = Schedule::new(machine, grid, &machine.neutral());
        let last = grid.time.len() - 1;
        let rows = if machine.whole { last } else { rows.min(last) };
        let part = |row: usize| {
            let states = self.nominal_states(grid, row);
            let whole = schedule.job(grid.time[row], row, rows.min(last - row), &states);
            let (job, mut out) = (Job { each_row: true, reads: &[], ..whole }, Vec::new());
            self.with_worker(|worker| worker.interval(machine, &job, &mut out)).ok()?;
            let shown = out[machine.order()..].iter().skip(place).step_by(machine.channels.len());
            let shown: Vec<f64> = shown.copied().collect();
            let largest = shown.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            let motion = Motion { size: scatter(&[&shown]).size, largest };
            (motion.size.is_finite() && largest.is_finite()).then_some(motion)
        };
        (0..last).step_by(rows.max(1)).filter_map(part).max_by(|a, b| a.size.total_cmp(&b.size))
    }

    /// What the model shows of a channel where the state that it shows begins at a value, in the middle of a run; nothing where it shows no state.
    pub fn shown_begun_at(&self, run: &str, channel: usize, value: f64) -> Option<f64> {
        let machine = &self.machine;
        let grid = self.grids.iter().find(|grid| grid.name == run)?;
        let place = machine.channels.iter().position(|output| output.channel == channel)?;
        let state = machine.states.iter().position(|state| state.channel == Some(place))?;
        let schedule = Schedule::new(machine, grid, &machine.neutral());
        let row = grid.time.len() / 2;
        let mut states = self.nominal_states(grid, row);
        states[state] = value;
        let (job, mut out) = (schedule.job(grid.time[row], row, 1, &states), Vec::new());
        self.with_worker(|worker| worker.interval(machine, &Job { reads: &[], ..job }, &mut out)).ok()?;
        out.get(machine.order() + place).copied()
    }

    /// Evenly over the runs; from the begin of a run where nothing can be started later.
    fn stretches<'a>(&'a self, glance: &Glance, schedules: &'a [Schedule]) -> Vec<Stretch<'a>> {
        let runs = self.grids.len();
        let whole = self.machine.whole;
        let each = if whole { 1 } else { glance.stretches.div_ceil(runs) };
        let taken = glance.stretches.min(runs).max(1);
        let (rows, grows) = self.rows_followed(glance.rows);
        let mut list = Vec::new();
        for run in (0..taken).map(|part| part * runs / taken) {
            let grid = &self.grids[run];
            let last = grid.time.len() - 1;
            let intervals = rows.min(last).max(1);
            let room = last - intervals;
            let count = each.min(last / intervals).max(1);
            for part in 0..count {
                let row = if whole { 0 } else { (2 * part + 1) * room / (2 * count) };
                list.push(Stretch {
                    schedule: &schedules[run],
                    grid,
                    row,
                    values: self.values(run, row, intervals),
                    intervals,
                    grows,
                });
            }
        }
        list
    }

    /// Of so many rows of a stretch those through which a machine that grows away from its log can be followed, and whether it does.
    pub(crate) fn rows_followed(&self, rows: usize) -> (usize, bool) {
        let grid = &self.grids[0];
        let (row, last) = (grid.time.len() / 2, grid.time.len() - 1);
        let asked = rows.min(last - row).max(1);
        let followed = self.rows_before_growth(grid, row, asked);
        // through as many values as start states any model is followed
        let least = FEW * self.machine.order() / self.machine.channels.len().max(1);
        if followed < asked { (rows.min(followed.max(least)), true) } else { (rows, false) }
    }

    /// What was measured in a stretch.
    fn values(&self, run: usize, row: usize, intervals: usize) -> Vec<(usize, usize, f64)> {
        let (grid, width) = (&self.grids[run], self.machine.channels.len());
        let (mut values, mut at) = (Vec::new(), row);
        let from = grid.samples.partition_point(|sample| sample.time < grid.time[row]);
        for (sample, outlier) in grid.samples.iter().zip(&self.outliers[run]).skip(from) {
            while at < row + intervals && grid.time[at] < sample.time {
                at += 1;
            }
            if grid.time[at] < sample.time {
                break;
            }
            if !outlier {
                values.push(((at - row) * width + sample.channel, sample.channel, sample.value));
            }
        }
        values
    }

    fn follow_stretch(
        &self,
        worker: &mut Worker,
        stretch: &Stretch<'_>,
        rounds: usize,
    ) -> Result<Vec<Left>, Error> {
        let mut states = self.nominal_states(stretch.grid, stretch.row);
        if stretch.grows {
            // a rate that nobody measures begins at any value: what it grows to would lead a fit of all rows astray
            let begin = stretch.begin(self.machine.channels.len().max(1));
            states = self.settled(worker, &begin, states, rounds)?.0;
        }
        let (_, rest) = self.settled(worker, stretch, states, rounds)?;
        Ok(self.summed(stretch, &rest))
    }

    /// The start state that fits best, from one on, and what it leaves.
    fn settled(
        &self,
        worker: &mut Worker,
        stretch: &Stretch<'_>,
        states: Vec<f64>,
        rounds: usize,
    ) -> Result<(Vec<f64>, Vec<f64>), Error> {
        let free = !self.machine.whole && !states.is_empty();
        let rest = self.apart(worker, stretch, &states)?;
        let mut here = (states, rest);
        let mut damping = 0.0;
        for _ in 0..if free { rounds } else { 0 } {
            let to = self.nearer(worker, stretch, &here, damping)?;
            let square = |rest: &[f64]| rest.iter().map(|e| e * e).sum::<f64>();
            match self.apart(worker, stretch, &to) {
                Ok(rest) if square(&rest) <= square(&here.1) => {
                    let settled = square(&here.1) - square(&rest) < FINE * square(&rest);
                    here = (to, rest);
                    damping /= DYNAMICS.damping.1;
                    if settled {
                        break;
                    }
                }
                _ => damping = f64::max(DYNAMICS.damping.0, damping) * DYNAMICS.damping.1,
            }
        }
        Ok(here)
    }

    /// The start state after a Gauss-Newton step.
    fn nearer(
        &self,
        worker: &mut Worker,
        stretch: &Stretch<'_>,
        here: &(Vec<f64>, Vec<f64>),
        damping: f64,
    ) -> Result<Vec<f64>, Error> {
        let (states, rest) = here;
        let n = states.len();
        let mut beside = states.clone();
        let mut columns = DMatrix::zeros(rest.len(), n);
        for state in 0..n {
            let step = DYNAMICS.state_step * self.scales[state];
            beside[state] += step;
            let there = self.apart(worker, stretch, &beside)?;
            beside[state] = states[state];
            // in units of the states' scales
            for (row, (there, here)) in there.iter().zip(rest).enumerate() {
                columns[(row, state)] = (here - there) / DYNAMICS.state_step;
            }
        }
        let mut gram = columns.tr_mul(&columns);
        for state in 0..n {
            gram[(state, state)] *= 1.0 + damping;
            // what nothing shows stays where it is
            gram[(state, state)] += 1e-6 * rest.len() as f64;
        }
        let score = columns.tr_mul(&DVector::from_column_slice(rest));
        let Some(by) = crate::statistics::linear::solve(&gram, &score) else { return Ok(states.clone()) };
        Ok((0..n).map(|state| states[state] + by[state] * self.scales[state]).collect())
    }

    /// Measured less simulated, in units of the sensors' deviations.
    fn apart(&self, worker: &mut Worker, stretch: &Stretch<'_>, states: &[f64]) -> Result<Vec<f64>, Error> {
        let machine: &Machine = &self.machine;
        let Stretch { schedule, grid, row, intervals, .. } = *stretch;
        let whole = schedule.job(grid.time[row], row, intervals, states);
        let mut out = Vec::new();
        worker.interval(machine, &Job { each_row: true, reads: &[], ..whole }, &mut out)?;
        let simulated = &out[machine.order()..];
        let rest = |(place, channel, value): &(usize, usize, f64)| {
            (value - simulated[*place]) / self.sensors[*channel]
        };
        Ok(stretch.values.iter().map(rest).collect())
    }

    fn summed(&self, stretch: &Stretch<'_>, rest: &[f64]) -> Vec<Left> {
        let mut sums = vec![Left::default(); self.machine.channels.len()];
        let mut means = vec![0.0; sums.len()];
        for ((_, channel, value), rest) in stretch.values.iter().zip(rest) {
            let sd = self.sensors[*channel];
            sums[*channel].error += rest * rest * sd * sd;
            sums[*channel].count += 1.0;
            means[*channel] += value;
        }
        means.iter_mut().zip(&sums).for_each(|(mean, sum)| *mean /= sum.count.max(1.0));
        for (_, channel, value) in &stretch.values {
            sums[*channel].motion += (value - means[*channel]).powi(2);
        }
        sums
    }
}
