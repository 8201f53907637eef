//! Sensitivities by differences: every row of every run, on all threads, with the same numbers whatever their count.
//!
//! Per row: the interval itself, once more for each state, for each input that an effect at its port changes, and for
//! each parameter of a unit. Effects at inputs follow by the chain rule from the mean of what is fed; effects at outputs
//! are exact.

use super::grid::Grid;
use super::lag;
use super::machine::{Machine, Reference, Role};
use super::policy::DYNAMICS;
use super::schedule::{Schedule, output_effects};
use super::through::Followed;
use super::worker::{Job, Worker};
use crate::error::Error;
use crate::infer::fit::Path;
use crate::infer::sweep::MOST_STATES;
use crate::infer::{Linearised, Measured};
use crate::observe::OutputEffect;
use crate::statistics::levels::TASK;
use rayon::prelude::*;
use std::collections::BTreeMap;
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
    /// Runs.
    pub grids: Vec<Grid>,
    /// A size of each state that matters.
    pub scales: Vec<f64>,
    /// A size of each input.
    pub input_scales: Vec<f64>,
    /// Step of each parameter for a derivative.
    pub steps: Vec<f64>,
    /// Prior mean and standard deviation of the first state of each run.
    pub starts: Vec<(Vec<f64>, Vec<f64>)>,
    /// Standard deviation of each channel, for weighing outputs against each other.
    pub sensors: Vec<f64>,
    /// Values that count as outliers: run and sample.
    pub outliers: Vec<Vec<bool>>,
    pub(crate) pool: Mutex<Vec<Worker>>,
    /// Whether units can be reset.
    pub resets: bool,
    /// Parameters with which a unit couldn't be run: their value and what it said.
    pub(crate) refused: Mutex<BTreeMap<usize, (f64, String)>>,
}

/// Differences of one row: a vector for the base and one for each direction.
pub(super) struct RowParts {
    /// What [`Worker::interval`] gives.
    pub base: Vec<f64>,
    /// Its derivatives by the states.
    pub states: Vec<Vec<f64>>,
    /// By the inputs that move.
    pub inputs: Vec<Vec<f64>>,
    /// By the chords; empty for one at a port.
    pub units: Vec<Vec<f64>>,
}

impl Engine {
    /// The same units with another machine's parameters, and other runs: of a run in the same place with as many values its
    /// outliers and its start hold.
    pub fn beside(&self, machine: Machine, grids: Vec<Grid>) -> Self {
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
        let wide = self.machine.order() + lag::active(&self.machine, theta).len();
        if wide > MOST_STATES - 1 {
            let most = MOST_STATES - 1;
            return Err(Error::Model(format!(
                "{wide} states with the sensors' lags; this way follows at most {most}"
            )));
        }
        let schedule = Schedule::new(&self.machine, grid, theta);
        let rows = grid.time.len();
        let tasks: Vec<usize> = (0..rows).step_by(TASK).collect();
        let moved: Vec<usize> = self.moved_inputs(chords);
        let parts: Vec<Result<Vec<RowParts>, Error>> = tasks
            .par_iter()
            .map(|begin| {
                self.with_worker(|worker| {
                    let rows = *begin..(begin + TASK).min(rows);
                    rows.map(|row| self.row(worker, grid, &schedule, row, theta, path, chords, &moved))
                        .collect()
                })
            })
            .collect();
        let mut all = Vec::with_capacity(rows);
        for part in parts {
            all.extend(part?);
        }
        if self.machine.horizon > 0 {
            let followed = Followed { engine: self, grid, schedule: &schedule, theta, path, chords };
            followed.next_states(&mut all);
        }
        Ok(self.assembled(run, theta, path, &schedule, &all, chords, &moved))
    }

    fn moved_inputs(&self, chords: &[Chord]) -> Vec<usize> {
        let touched = |input: &usize| {
            let at = |chord: &Chord| matches!(self.machine.parameters[chord.parameter].role, Role::Input(place, _) if place == *input);
            chords.iter().any(at)
        };
        (0..self.machine.inputs.len()).filter(touched).collect()
    }

    #[allow(clippy::too_many_arguments, reason = "one row of a run with all that it depends on")]
    fn row(
        &self,
        worker: &mut Worker,
        grid: &Grid,
        schedule: &Schedule,
        row: usize,
        theta: &[f64],
        path: &Path,
        chords: &[Chord],
        moved: &[usize],
    ) -> Result<RowParts, Error> {
        let (machine, n, width) = (&self.machine, self.machine.order(), schedule.width);
        let set = self.set(theta);
        let states = path[row * n..(row + 1) * n].to_vec();
        let mut beside = states.clone();
        let job = Job { parameters: &set, ..self.job(grid, schedule, row, &states) };
        let mut base = Vec::new();
        worker.interval(machine, &job, &mut base)?;
        let mut parts = RowParts { base, states: Vec::new(), inputs: Vec::new(), units: Vec::new() };
        let mut out = Vec::new();
        for state in 0..n {
            let step = DYNAMICS.state_step * self.scales[state];
            beside[state] += step;
            worker.interval(machine, &Job { states: &beside, ..job }, &mut out)?;
            beside[state] = states[state];
            parts.states.push(difference(&out, &parts.base, step));
        }
        for input in moved {
            let step = DYNAMICS.state_step * 10.0 * self.input_scales[*input];
            // over this interval only: what follows shows the state at its end
            let own = job.first.get(1).map_or(0, |end| end - job.first[0]) * width;
            let shifted = |values: &[f64], until: usize| -> Vec<f64> {
                let one = |(place, value): (usize, &f64)| {
                    if place < until && place % width == *input { value + step } else { *value }
                };
                values.iter().enumerate().map(one).collect()
            };
            let (at_row, fed) = (shifted(job.at_row, width), shifted(job.fed, own));
            worker.interval(machine, &Job { at_row: &at_row, fed: &fed, ..job }, &mut out)?;
            parts.inputs.push(difference(&out, &parts.base, step));
        }
        for chord in chords {
            if !matches!(machine.parameters[chord.parameter].role, Role::Unit(_)) {
                parts.units.push(Vec::new());
                continue;
            }
            let mut theta = theta.to_vec();
            theta[chord.parameter] = chord.to;
            let set = self.set(&theta);
            let there = worker.interval(machine, &Job { parameters: &set, ..job }, &mut out);
            let changed = there.map(|()| difference(&out, &parts.base, chord.per));
            parts.units.push(self.or_refused(chord, changed, || vec![0.0; parts.base.len()])?);
        }
        Ok(parts)
    }

    #[allow(clippy::too_many_arguments, reason = "all rows of a run with all that they depend on")]
    fn assembled(
        &self,
        run: usize,
        theta: &[f64],
        path: &Path,
        schedule: &Schedule,
        parts: &[RowParts],
        chords: &[Chord],
        moved: &[usize],
    ) -> Linearised {
        let (machine, grid, n) = (&self.machine, &self.grids[run], self.machine.order());
        let (rows, p, width) = (grid.time.len(), chords.len(), schedule.width);
        // what an effect at an input changes: mean over each interval, and at each row
        let shifts: Vec<Option<Fed>> =
            chords.iter().map(|chord| self.fed_difference(grid, schedule, theta, chord)).collect();
        let column = |row: usize, place: usize, entry: usize| -> f64 {
            let chord = &chords[place];
            match machine.parameters[chord.parameter].role {
                Role::Unit(_) => parts[row].units[place][entry],
                Role::Output(..) => 0.0,
                Role::Input(input, _) => {
                    let (Some(shift), Some(slot)) =
                        (&shifts[place], moved.iter().position(|known| *known == input))
                    else {
                        return 0.0;
                    };
                    let at_row = (n..n + machine.channels.len()).contains(&entry) || row + 1 == rows;
                    let by = if at_row { &shift.at_row } else { &shift.mean };
                    parts[row].inputs[slot][entry] * by[row * width + input]
                }
            }
        };
        let mut out = Linearised {
            states: n,
            parameters: p,
            time: grid.time.clone(),
            first: vec![0],
            torn: grid.torn(),
            start: self.start(run, path),
            ..Linearised::default()
        };
        for row in 0..rows.saturating_sub(1) {
            for i in 0..n {
                out.transition.extend(parts[row].states.iter().map(|column| column[i]));
                out.defect.push(parts[row].base[i] - path[(row + 1) * n + i]);
            }
            for place in 0..p {
                out.drive.extend((0..n).map(|i| column(row, place, i)));
            }
        }
        let effects = output_effects(machine, theta);
        let sensed: Vec<Option<Vec<f64>>> =
            chords.iter().map(|chord| self.sensed(grid, parts, theta, chord)).collect();
        let mut placed = schedule.placed.iter().peekable();
        let blind = grid.blind(machine.reading);
        for row in 0..rows {
            while let Some(at) = placed.next_if(|at| at.row == row) {
                let sample = grid.samples[at.sample];
                let effect = effects[sample.channel];
                let entry = n + at.read.map_or(sample.channel, |read| machine.channels.len() + read);
                let value = parts[row].base[entry];
                let slope = slope(parts, grid, row, n + sample.channel);
                let since = sample.time - grid.origin;
                let outlier = self.outliers[run].get(at.sample).copied().unwrap_or(false);
                let left_out = at.early || blind[row];
                if left_out && !outlier {
                    // as one that is met to within its noise
                    out.left_out += 1.0 + 2.0 * libm::log(self.sensors[sample.channel]);
                }
                out.measured.push(Measured {
                    channel: sample.channel,
                    time: sample.time,
                    residual: sample.value - effect.shown(value, since),
                    slope: effect.gain * slope,
                    weight: if left_out || outlier { 0.0 } else { 1.0 },
                });
                out.observe.extend(parts[row].states.iter().map(|column| effect.gain * column[entry]));
                for (place, chord) in chords.iter().enumerate() {
                    let through = effect.gain * column(row, place, entry);
                    let own = match machine.parameters[chord.parameter].role {
                        Role::Output(channel, kind) if channel == sample.channel => {
                            let late = sensed[place].as_ref().map_or(-slope, |by| by[row]);
                            effect.sensitivity(kind, value, since, late)
                        }
                        _ => 0.0,
                    };
                    out.direct.push(through + own);
                }
            }
            out.first.push(out.measured.len());
        }
        let lags = lag::active(machine, theta);
        if lags.is_empty() {
            return out;
        }
        let around =
            lag::Around { engine: self, run, schedule, parts, effects: &effects, chords, column: &column };
        around.augmented(out, &lags)
    }

    /// What a chord of a delay or lag at an output changes of its channel, row by row: along the path where it has none yet.
    fn sensed(&self, grid: &Grid, parts: &[RowParts], theta: &[f64], chord: &Chord) -> Option<Vec<f64>> {
        let Role::Output(channel, kind) = self.machine.parameters[chord.parameter].role else { return None };
        if theta[chord.parameter] != 0.0 || chord.per != 1.0 {
            return None;
        }
        let entry = self.machine.order() + channel;
        let values: Vec<f64> = parts.iter().map(|part| part.base[entry]).collect();
        let there = match kind {
            OutputEffect::Lag => lag::lagged(&grid.time, &values, chord.to),
            OutputEffect::Delay => lag::delayed(&grid.time, &values, chord.to),
            _ => return None,
        };
        Some(difference(&there, &values, chord.per))
    }

    /// Prior of the first state against the path.
    pub(super) fn start(&self, run: usize, path: &Path) -> (Vec<f64>, Vec<f64>) {
        let (mean, sd) = &self.starts[run];
        (mean.iter().zip(path).map(|(mean, path)| mean - path).collect(), sd.clone())
    }

    fn fed_difference(&self, grid: &Grid, schedule: &Schedule, theta: &[f64], chord: &Chord) -> Option<Fed> {
        let Role::Input(..) = self.machine.parameters[chord.parameter].role else { return None };
        let mut theta = theta.to_vec();
        theta[chord.parameter] = chord.to;
        let there = Schedule::new(&self.machine, grid, &theta);
        Some(Fed {
            mean: difference(&there.mean, &schedule.mean, chord.per),
            at_row: difference(&there.at_row, &schedule.at_row, chord.per),
        })
    }
}

/// What an effect changes at an input.
struct Fed {
    mean: Vec<f64>,
    at_row: Vec<f64>,
}

pub(super) fn difference(there: &[f64], here: &[f64], step: f64) -> Vec<f64> {
    there.iter().zip(here).map(|(there, here)| (there - here) / step).collect()
}

/// Rate of change of an output along the path.
fn slope(parts: &[RowParts], grid: &Grid, row: usize, entry: usize) -> f64 {
    let (from, to) = (row.saturating_sub(1), (row + 1).min(parts.len() - 1));
    let span = grid.time[to] - grid.time[from];
    if span > 0.0 { (parts[to].base[entry] - parts[from].base[entry]) / span } else { 0.0 }
}
