//! Sensitivities by differences: every row of every run, on all threads, with the same numbers whatever their count.
//!
//! Per row: the interval itself, once more for each state, for each input that an effect at its port changes, and for
//! each parameter of a unit. `assemble.rs` makes a linearised run of them.

use super::assemble::Assembly;
use super::grid::{Grid, usual};
use super::input_begin::{self, Begin};
use super::lag;
use super::machine::{Machine, Reference, Role};
use super::policy::DYNAMICS;
use super::refused_values::Refused;
use super::schedule::Schedule;
use super::worker::{Job, Worker};
use crate::error::Error;
use crate::infer::Linearised;
use crate::infer::fit::Path;
use crate::infer::sweep::MOST_STATES;
use crate::observe::Reading;
use crate::ports::Kind;
use crate::statistics::levels::TASK;
use rayon::prelude::*;
use std::sync::Mutex;

/// A sensitivity column: from where the parameters are to this value of one of them. A short chord is a derivative; a
/// long one is what a limit or a switch does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chord {
    /// The parameter.
    pub parameter: usize,
    /// The other end.
    pub to: f64,
    /// What the difference is divided by.
    pub per: f64,
}

/// The machine with its runs.
pub struct Engine {
    /// Variables.
    pub machine: Machine,
    /// Rows and values of each run.
    pub grids: Vec<Grid>,
    /// A size of each state that matters, in its own unit.
    pub scales: Vec<f64>,
    /// A size of each input, in its own unit.
    pub input_scales: Vec<f64>,
    /// Step of each parameter for a derivative, in its own unit.
    pub steps: Vec<f64>,
    /// Prior of the first state of each run: means and standard deviations (n each), in the states' units.
    pub starts: Vec<(Vec<f64>, Vec<f64>)>,
    /// Standard deviation of each channel's sensor, in the channel's unit, for weighing outputs against each other.
    pub sensors: Vec<f64>,
    /// Values that count as outliers: run and sample.
    pub outliers: Vec<Vec<bool>>,
    /// Instances of the units that no thread uses.
    pub(crate) pool: Mutex<Vec<Worker>>,
    /// Whether units can be reset.
    pub resets: bool,
    /// Parameters with which a unit couldn't be run: their value and what it said.
    pub(crate) refused: Mutex<Refused>,
}

/// Differences of one row: a vector for the base and one for each direction.
pub(super) struct RowParts {
    /// What [`Worker::interval`] gives.
    pub base: Vec<f64>,
    /// Its derivatives by the states.
    pub states: Vec<Vec<f64>>,
    /// By the inputs that move.
    pub inputs: Vec<Vec<f64>>,
    /// By the chords; empty for one at a port whose derivative follows from those above.
    pub simulated: Vec<Vec<f64>>,
    /// By the time at which the inputs act, per s; empty where none of them moves.
    pub late: Vec<f64>,
    /// Outputs where the interval begins, with the inputs that act in it: they jump at a row where they follow an input at once.
    pub begun: Vec<f64>,
}

impl Engine {
    /// The same units with another machine's parameters, and other runs: of a run in the same place with as many values its
    /// outliers and its start hold.
    pub fn with_runs(&self, machine: Machine, grids: Vec<Grid>) -> Self {
        let mut steps = self.steps.clone();
        steps.resize(machine.parameters.len(), 1.0);
        let outliers = |(run, grid): (usize, &Grid)| {
            let own = self.outliers.get(run).filter(|own| own.len() == grid.samples.len());
            own.cloned().unwrap_or_else(|| vec![false; grid.samples.len()])
        };
        let starts = (0..grids.len()).map(|run| self.starts.get(run).unwrap_or(&self.starts[0]).clone());
        Self {
            outliers: grids.iter().enumerate().map(outliers).collect(),
            starts: starts.collect(),
            grids,
            machine,
            steps,
            scales: self.scales.clone(),
            input_scales: self.input_scales.clone(),
            sensors: self.sensors.clone(),
            pool: Mutex::new(Vec::new()),
            resets: self.resets,
            refused: Mutex::default(),
        }
    }

    /// One interval after a row, or as many as show the state at its end.
    pub(super) fn job<'a>(
        &self,
        grid: &Grid,
        schedule: &'a Schedule,
        row: usize,
        states: &'a [f64],
    ) -> Job<'a> {
        let horizon = self.machine.horizon;
        Job { each_row: horizon > 0, ..schedule.job(grid.time[row], row, 1 + horizon, states) }
    }

    /// Parameters of units that are off their nominal values.
    pub fn set(&self, theta: &[f64]) -> Vec<(Reference, f64)> {
        let of = |(parameter, value): (&super::machine::Parameter, &f64)| match parameter.role {
            Role::Unit(reference) if *value != parameter.neutral => Some((reference, *value)),
            _ => None,
        };
        self.machine.parameters.iter().zip(theta).filter_map(of).collect()
    }

    /// One run about its path.
    ///
    /// # Errors
    /// A unit failed.
    pub fn run(&self, run: usize, theta: &[f64], path: &Path, chords: &[Chord]) -> Result<Linearised, Error> {
        if self.machine.whole {
            return self.whole(run, theta, path, chords);
        }
        let grid = &self.grids[run];
        let schedule = Schedule::new(&self.machine, grid, theta);
        let begins = input_begin::begins(&self.machine, grid, &schedule, theta, &self.sensors);
        let wide = self.machine.order() + lag::active(&self.machine, theta).len() + begins.len();
        if wide > MOST_STATES - 1 {
            let most = MOST_STATES - 1;
            return Err(Error::Model(format!(
                "{wide} states with the ports' lags; this way follows at most {most}"
            )));
        }
        let (beside, begins) = (&self.beside(grid, theta, chords), &begins[..]);
        let by = DYNAMICS.most_jitter * usual(&grid.time);
        let late = by.is_finite().then(|| (Schedule::later(&self.machine, grid, theta, by), by));
        let (schedule, late) = (&schedule, late.as_ref());
        let about = RunAt { engine: self, run, grid, schedule, beside, late, theta, path, chords, begins };
        let moved = self.moved_inputs(&about);
        let parts = about.differences(&moved)?;
        Ok(Assembly::new(about, &parts, moved).linearised())
    }

    /// The schedules along derivatives of what changes when an input acts within a row: what that does at the row's end its mean doesn't tell.
    /// Where states are read through the rows that follow, these tell it.
    fn beside(&self, grid: &Grid, theta: &[f64], chords: &[Chord]) -> Vec<Option<Schedule>> {
        let within = |chord: &Chord| {
            let Role::Input(_, effect) = self.machine.parameters[chord.parameter].role else { return false };
            Kind::of_input(effect).over_time && chord.per != 1.0 && self.machine.horizon == 0
        };
        let schedule = |chord: &Chord| {
            let mut there = theta.to_vec();
            there[chord.parameter] = chord.to;
            within(chord).then(|| Schedule::new(&self.machine, grid, &there))
        };
        chords.iter().map(schedule).collect()
    }

    /// Inputs at which a chord changes an effect, or where a lag begins.
    fn moved_inputs(&self, about: &RunAt<'_>) -> Vec<usize> {
        let touched = |input: &usize| {
            let at = |chord: &Chord| matches!(self.machine.parameters[chord.parameter].role, Role::Input(place, _) if place == *input);
            about.chords.iter().any(at) || about.begins.iter().any(|begin| begin.input == *input)
        };
        (0..self.machine.inputs.len()).filter(touched).collect()
    }

    /// Prior of the first state against the path.
    pub(super) fn start(&self, run: usize, path: &Path) -> (Vec<f64>, Vec<f64>) {
        let (mean, sd) = &self.starts[run];
        (mean.iter().zip(path).map(|(mean, path)| mean - path).collect(), sd.clone())
    }
}

/// A run at its parameters, about its path, with the chords of its columns.
#[derive(Clone, Copy)]
pub(super) struct RunAt<'a> {
    /// The machine with all runs.
    pub engine: &'a Engine,
    /// Place of the run among the engine's.
    pub run: usize,
    /// Its rows and values.
    pub grid: &'a Grid,
    /// What is fed and read within its intervals with these parameters.
    pub schedule: &'a Schedule,
    /// The same along each chord that moves an input within its intervals.
    pub beside: &'a [Option<Schedule>],
    /// What is fed when all inputs act later by so much, s; nothing where there is one row.
    pub late: Option<&'a (Schedule, f64)>,
    /// All parameters, each in its own unit.
    pub theta: &'a [f64],
    /// States, n a row, each in its own unit.
    pub path: &'a Path,
    /// Columns of the linearised run, in their order.
    pub chords: &'a [Chord],
    /// Columns behind them: where the inputs' lags begin.
    pub begins: &'a [Begin],
}

impl RunAt<'_> {
    /// Differences of all rows, on all threads; `moved` are the inputs at which a column changes something.
    fn differences(&self, moved: &[usize]) -> Result<Vec<RowParts>, Error> {
        let rows = self.grid.time.len();
        let tasks: Vec<usize> = (0..rows).step_by(TASK).collect();
        let parts: Vec<Result<Vec<RowParts>, Error>> = tasks
            .par_iter()
            .map(|begin| {
                self.engine.with_worker(|worker| {
                    let rows = *begin..(begin + TASK).min(rows);
                    rows.map(|row| self.row(worker, row, moved)).collect()
                })
            })
            .collect();
        let mut all = Vec::with_capacity(rows);
        for part in parts {
            all.extend(part?);
        }
        if self.engine.machine.horizon > 0 {
            self.next_states(&mut all);
        }
        Ok(all)
    }

    /// Differences of one row.
    fn row(&self, worker: &mut Worker, row: usize, moved: &[usize]) -> Result<RowParts, Error> {
        let (machine, n) = (&self.engine.machine, self.engine.machine.order());
        let set = self.engine.set(self.theta);
        let states = self.path[row * n..(row + 1) * n].to_vec();
        let job = Job { parameters: &set, ..self.engine.job(self.grid, self.schedule, row, &states) };
        let mut base = Vec::new();
        worker.interval(machine, &job, &mut base)?;
        Ok(RowParts {
            states: self.by_states(worker, &job, &base)?,
            inputs: self.by_inputs(worker, &job, &base, moved)?,
            simulated: self.by_simulation(worker, row, &job, &base)?,
            late: self.by_time(worker, row, &job, &base)?,
            begun: self.begun(worker, &job, &base)?,
            base,
        })
    }

    /// Outputs where an interval begins. Read before the row's inputs acted, an output that follows one at once shows what was before.
    fn begun(&self, worker: &mut Worker, job: &Job<'_>, base: &[f64]) -> Result<Vec<f64>, Error> {
        let machine = &self.engine.machine;
        let (n, width) = (machine.order(), self.schedule.width);
        let outputs = |out: &[f64]| out[n..n + machine.channels.len()].to_vec();
        // the last row has no interval
        let jumps = job.fed.len() >= width && job.fed[..width] != job.at_row[..width];
        if machine.reading == Reading::After || !jumps || machine.channels.iter().all(|own| !own.jumps) {
            return Ok(outputs(base));
        }
        let (mut at_row, mut out) = (job.at_row.to_vec(), Vec::new());
        at_row[..width].copy_from_slice(&job.fed[..width]);
        // no interval: nothing is stepped
        let first = &job.first[..1];
        worker.interval(machine, &Job { at_row: &at_row, first, ..*job }, &mut out)?;
        Ok(outputs(&out))
    }

    /// ∂/∂(state) of what an interval gives, a column for each state.
    fn by_states(&self, worker: &mut Worker, job: &Job<'_>, base: &[f64]) -> Result<Vec<Vec<f64>>, Error> {
        let machine = &self.engine.machine;
        let (mut beside, mut out) = (job.states.to_vec(), Vec::new());
        let mut columns = Vec::new();
        for state in 0..machine.order() {
            let step = DYNAMICS.state_step * self.engine.scales[state];
            beside[state] += step;
            worker.interval(machine, &Job { states: &beside, ..*job }, &mut out)?;
            beside[state] = job.states[state];
            columns.push(difference(&out, base, step));
        }
        Ok(columns)
    }

    /// ∂/∂(input) of what an interval gives, a column for each input in `moved`.
    fn by_inputs(
        &self,
        worker: &mut Worker,
        job: &Job<'_>,
        base: &[f64],
        moved: &[usize],
    ) -> Result<Vec<Vec<f64>>, Error> {
        let width = self.schedule.width;
        // over this interval only: what follows shows the state at its end
        let own = job.first.get(1).map_or(0, |end| end - job.first[0]) * width;
        let (mut columns, mut out) = (Vec::new(), Vec::new());
        for input in moved {
            let step = DYNAMICS.state_step * 10.0 * self.engine.input_scales[*input];
            let shifted = |values: &[f64], until: usize| -> Vec<f64> {
                let one = |(place, value): (usize, &f64)| {
                    if place < until && place % width == *input { value + step } else { *value }
                };
                values.iter().enumerate().map(one).collect()
            };
            let (at_row, fed) = (shifted(job.at_row, width), shifted(job.fed, own));
            let job = Job { at_row: &at_row, fed: &fed, ..*job };
            worker.interval(&self.engine.machine, &job, &mut out)?;
            columns.push(difference(&out, base, step));
        }
        Ok(columns)
    }

    /// ∂/∂(time at which the inputs act) of what an interval gives, per s; empty where none of them moves within it.
    fn by_time(
        &self,
        worker: &mut Worker,
        row: usize,
        job: &Job<'_>,
        base: &[f64],
    ) -> Result<Vec<f64>, Error> {
        let mut out = Vec::new();
        let Some((schedule, by)) = self.late.filter(|_| !job.fed.is_empty()) else { return Ok(out) };
        let there = self.engine.job(self.grid, schedule, row, job.states);
        if there.fed != job.fed || there.pieces != job.pieces {
            // what is logged in one row was read together
            let later = Job { parameters: job.parameters, at_row: job.at_row, ..there };
            worker.interval(&self.engine.machine, &later, &mut out)?;
        }
        Ok(difference(&out, base, *by))
    }

    /// What an interval gives along each chord of a unit's parameter, and along those that move an input within it; an empty column for any
    /// other chord at a port.
    fn by_simulation(
        &self,
        worker: &mut Worker,
        row: usize,
        job: &Job<'_>,
        base: &[f64],
    ) -> Result<Vec<Vec<f64>>, Error> {
        let (machine, mut out) = (&self.engine.machine, Vec::new());
        let mut column = |(chord, beside): (&Chord, &Option<Schedule>)| {
            if let Some(schedule) = beside {
                let there = self.engine.job(self.grid, schedule, row, job.states);
                worker.interval(machine, &Job { parameters: job.parameters, ..there }, &mut out)?;
                return Ok(difference(&out, base, chord.per));
            }
            if !matches!(machine.parameters[chord.parameter].role, Role::Unit(_)) {
                return Ok(Vec::new());
            }
            let mut theta = self.theta.to_vec();
            theta[chord.parameter] = chord.to;
            let set = self.engine.set(&theta);
            let there = worker.interval(machine, &Job { parameters: &set, ..*job }, &mut out);
            let changed = there.map(|()| difference(&out, base, chord.per));
            self.engine.or_refused(chord, changed, || vec![0.0; base.len()])
        };
        self.chords.iter().zip(self.beside).map(&mut column).collect()
    }
}

/// (there - here) / step, entry by entry.
pub(super) fn difference(there: &[f64], here: &[f64], step: f64) -> Vec<f64> {
    there.iter().zip(here).map(|(there, here)| (there - here) / step).collect()
}
