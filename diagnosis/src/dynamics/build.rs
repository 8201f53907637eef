//! From a problem to an engine: sizes of states and inputs, noises to begin with. What the units can do is `probe.rs`.

use super::first_path::Trails;
use super::grid::{Grid, Lost, Sample, usual};
use super::linearise::Engine;
use super::machine::{Machine, Output, State};
use super::outliers::excluded;
use super::parameter_steps::first_step;
use super::policy::DYNAMICS;
use crate::error::{Error, Notice};
use crate::infer::fit::{At, Linearise};
use crate::infer::likelihood::maximise;
use crate::infer::sweep::MOST_STATES;
use crate::infer::{Linearised, Noise, Sizes, first_process_noise};
use crate::nuisance::{Scatter, scatter};
use crate::observe::{Problem, Run};
use crate::statistics::levels::{FEW, anywhere_in};
use std::sync::Mutex;

/// Rows of a run from which a span of time follows.
pub type Span = (f64, f64);

/// What the build found.
pub struct Built {
    /// The engine.
    pub engine: Engine,
    /// Noises to begin with.
    pub noise: Noise,
    /// Which of them are free.
    pub sizes: Sizes,
    /// Scatter of each compared channel.
    pub scatter: Vec<Scatter>,
    /// What a user should know.
    pub notices: Vec<Notice>,
}

impl Built {
    /// Path and noises at these parameters, before anything is fitted, and the runs about it with a column for each of those that will be
    /// `free`. Where runs were followed already the path begins there.
    ///
    /// # Errors
    /// A unit failed.
    pub fn begin_fit(
        &mut self,
        theta: &[f64],
        known: &Trails,
        free: &[usize],
    ) -> Result<(At, Vec<Linearised>), Error> {
        let paths = self.engine.paths(theta, &self.noise, known)?;
        self.engine.calibrate(theta, &paths, &self.noise)?;
        let runs = self.engine.linearise(theta, &paths, free)?;
        let from = |share: &f64| {
            let process = self.noise.process.iter().map(|size| share * size).collect();
            maximise(&runs, &[], &Noise { process, ..self.noise.clone() }, &self.sizes)
        };
        let best = DYNAMICS.first_process.iter().map(from).min_by(|a, b| a.1.total_cmp(&b.1));
        let noise = best.map_or(self.noise.clone(), |(noise, _)| noise);
        Ok((At { theta: theta.to_vec(), paths, noise }, runs))
    }
}

/// Builds for these runs, each between two times.
///
/// # Errors
/// No state can be linked, or a unit failed.
pub fn build(problem: &Problem, runs: &[(&Run, Span)]) -> Result<Built, Error> {
    let mut machine = Machine::new(problem)?;
    let n = machine.order();
    if n > MOST_STATES - 2 {
        return Err(Error::Model(format!("{n} states; this way follows at most {}", MOST_STATES - 2)));
    }
    let Usable { runs, grids, mut notices } = usable(problem, &machine, runs)?;
    if problem.late && machine.any_step {
        machine.first_step = machine.short_step(&grids[0].time);
    }
    let interval = usual(&grids[0].time);
    let outliers = excluded(&machine, &grids);
    let scatter = channel_scatters(&machine, &grids, &outliers);
    let sensors = first_sensors(&machine, &scatter);
    let scales = state_scales(&machine, &scatter);
    let input_scales = input_scales(&machine, &grids);
    let first_step = |parameter| first_step(parameter, &input_scales, interval);
    let engine = Engine {
        steps: machine.parameters.iter().map(first_step).collect(),
        starts: grids.iter().map(|grid| prior(&machine, grid, &scales)).collect(),
        outliers,
        pool: Mutex::new(Vec::new()),
        resets: true,
        refused: Mutex::default(),
        sensors: sensors.clone(),
        scales,
        input_scales,
        grids,
        machine,
    };
    let sizes: Vec<f64> = scatter.iter().map(|scatter| scatter.size).collect();
    let (engine, found) = engine.probed(problem, &runs, &sizes)?;
    notices.extend(found);
    notices.extend(still(problem, &engine.machine, &scatter));
    let sizes = noise_sizes(&engine, &scatter, interval);
    let noise = Noise {
        channels: sensors,
        process: engine.scales.iter().map(|scale| first_process_noise(*scale, interval)).collect(),
        jitter: 1e-3 * interval,
        disturbance: None,
    };
    Ok(Built { engine, noise, sizes, scatter, notices })
}

/// Runs with enough rows to tell of a motion, and what a user should know of the others.
struct Usable<'a> {
    runs: Vec<(&'a Run, Span)>,
    grids: Vec<Grid>,
    notices: Vec<Notice>,
}

fn usable<'a>(problem: &Problem, machine: &Machine, runs: &[(&'a Run, Span)]) -> Result<Usable<'a>, Error> {
    let (long, short): (Vec<_>, Vec<_>) = (runs.iter())
        .map(|(run, (from, to))| ((*run, (*from, *to)), Grid::new(machine, run, *from, *to)))
        .partition(|(_, grid)| grid.time.len() >= FEW);
    let (runs, grids): (Vec<(&Run, Span)>, Vec<Grid>) = long.into_iter().unzip();
    let left_out = |((run, _), grid): ((&Run, Span), Grid)| {
        let (from, to) = run.span();
        let all = Grid::new(machine, run, from, to).time.len();
        let beside = if all > grid.time.len() { " that are not kept back to judge by" } else { "" };
        let message = format!("{} rows{beside} tell nothing of a motion: left out", grid.time.len());
        Notice { file: grid.name, line: 0, message }
    };
    let left_out = short.into_iter().map(left_out);
    if grids.is_empty() {
        let notices = problem.notices.iter().cloned().chain(left_out).collect();
        return Err(Error::NothingUsable { path: problem.path.clone(), notices });
    }
    let notices = left_out.chain(grids.iter().flat_map(|grid| begun_late(machine, grid))).collect();
    Ok(Usable { runs, grids, notices })
}

/// Inputs whose own log begins later than a run.
fn begun_late(machine: &Machine, grid: &Grid) -> Vec<Notice> {
    let notice = |lost: &Lost| {
        let rows = grid.time.partition_point(|time| *time < lost.to);
        let message = format!(
            "{} is logged from {} s on, {rows} rows after the run begins: nobody knows what was fed until then, so that these are left out",
            machine.inputs[lost.input].name, lost.to
        );
        Notice { file: grid.name.clone(), line: 0, message }
    };
    grid.lost.iter().filter(|lost| lost.from == f64::NEG_INFINITY).map(notice).collect()
}

/// The scatter of each compared channel over all runs, outliers apart. One that has a single value has no size of its own: it is that value, or 1,
/// as for inputs.
fn channel_scatters(machine: &Machine, grids: &[Grid], outliers: &[Vec<bool>]) -> Vec<Scatter> {
    let values = |channel: usize| -> Vec<Vec<f64>> {
        let of = |(grid, out): (&Grid, &Vec<bool>)| {
            let all = grid.samples.iter().zip(out);
            all.filter(|(sample, out)| sample.channel == channel && !**out).map(|(s, _)| s.value).collect()
        };
        grids.iter().zip(outliers).map(of).collect()
    };
    let sized = |channel: usize| {
        let values = values(channel);
        let found = scatter(&values.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let largest = values.iter().flatten().fold(0.0, |most: f64, value| most.max(value.abs()));
        match (found.size > 0.0, largest > 0.0) {
            (true, _) => found,
            (false, some) => Scatter { size: if some { largest } else { 1.0 }, ..found },
        }
    };
    (0..machine.channels.len()).map(sized).collect()
}

/// Channels that have one value in all rows, where others have noise.
fn still(problem: &Problem, machine: &Machine, scatter: &[Scatter]) -> Vec<Notice> {
    let is_still = |output: &Output| {
        let mut values = problem.runs.iter().map(|run| run.series[output.channel].one_value());
        values.next().flatten().is_some_and(|first| values.all(|value| value == Some(first)))
    };
    let noisy = scatter.iter().any(|scatter| scatter.noise > 0.0);
    let notice = |output: &Output| {
        let channel = &problem.channels[output.channel];
        Notice {
            file: "dataset.toml".into(),
            line: channel.line,
            message: format!(
                "column {:?} ({}) has one value in all rows: if its sensor stood still, leave the channel out, since what it seems to show \
                 would be named",
                channel.column, channel.name
            ),
        }
    };
    machine.channels.iter().filter(|output| noisy && is_still(output)).map(notice).collect()
}

/// Standard deviation of each channel to begin with, in its own unit: the stated one, or the scatter of neighbouring values.
fn first_sensors(machine: &Machine, scatter: &[Scatter]) -> Vec<f64> {
    let first = |(output, scatter): (&Output, &Scatter)| {
        let stated = output.noise.filter(|sd| *sd > 0.0);
        stated.unwrap_or(scatter.noise.max(DYNAMICS.exact_sensor * scatter.size.max(1e-300)))
    };
    machine.channels.iter().zip(scatter).map(first).collect()
}

/// A size of each state that matters, in its own unit: how far its channel moves, or a share of its nominal value.
fn state_scales(machine: &Machine, scatter: &[Scatter]) -> Vec<f64> {
    let measured = |state: &State| {
        let size = scatter[state.channel?].size;
        Some(if size > 0.0 { size } else { state.nominal.abs().max(1.0) * DYNAMICS.first_step })
    };
    let scale = |state| measured(state).unwrap_or(state.nominal.abs().max(DYNAMICS.first_step));
    machine.states.iter().map(scale).collect()
}

/// A size of each input, in its own unit: how far it moves, else its largest value, else 1.
fn input_scales(machine: &Machine, grids: &[Grid]) -> Vec<f64> {
    let scale = |input: usize| {
        let all: Vec<&[f64]> = grids.iter().map(|grid| grid.inputs[input].values.as_slice()).collect();
        let largest = all.iter().flat_map(|run| run.iter()).fold(0.0, |most: f64, v| most.max(v.abs()));
        let size = scatter(&all).size;
        if size > 0.0 {
            size
        } else if largest > 0.0 {
            largest
        } else {
            1.0
        }
    };
    (0..machine.inputs.len()).map(scale).collect()
}

/// Between what the noises are searched; `interval` is the usual distance of rows, s.
fn noise_sizes(engine: &Engine, scatter: &[Scatter], interval: f64) -> Sizes {
    let least = |(output, scatter): (&Output, &Scatter)| match output.noise {
        Some(sd) if sd > 0.0 => None,
        // rounding is uniform: its standard deviation is a quantum over √12
        _ => Some(
            anywhere_in(scatter.quantum)
                .max(DYNAMICS.exact_sensor * scatter.size)
                .max(1e-300)
                .max(0.02 * scatter.noise),
        ),
    };
    let span = engine.grids.iter().map(Grid::span).fold(0.0, f64::max).max(interval);
    let process = |scale: &f64| {
        (DYNAMICS.least_process * scale / span.sqrt(), DYNAMICS.widest * scale / interval.sqrt())
    };
    Sizes {
        channels: engine.machine.channels.iter().zip(scatter).map(least).collect(),
        process: engine.scales.iter().map(process).collect(),
        pinned: Vec::new(),
        jitter: DYNAMICS.most_jitter * interval,
    }
}

/// States as far as a row measures them, else nominal.
pub(super) fn nominal_states(machine: &Machine, grid: &Grid, row: usize) -> Vec<f64> {
    if machine.whole {
        return grid.begin.iter().map(|(value, _)| *value).collect();
    }
    let near = |channel: usize| {
        let own = grid.samples.iter().filter(|sample| sample.channel == channel);
        own.min_by(|a, b| {
            let away = |sample: &Sample| (sample.time - grid.time[row]).abs();
            away(a).total_cmp(&away(b))
        })
    };
    let of = |state: &State| state.channel.and_then(near).map_or(state.nominal, |sample| sample.value);
    machine.states.iter().map(of).collect()
}

/// Prior mean and standard deviation of a run's first state.
pub(super) fn prior(machine: &Machine, grid: &Grid, scales: &[f64]) -> (Vec<f64>, Vec<f64>) {
    if machine.whole {
        // the rest begins at none: an offset is an effect
        return (
            vec![0.0; machine.order()],
            scales.iter().map(|scale| DYNAMICS.least_process * scale).collect(),
        );
    }
    let mean = nominal_states(machine, grid, 0);
    let size = |(state, scale): (&State, &f64)| match state.channel {
        Some(_) => DYNAMICS.widest * scale,
        None => DYNAMICS.widest * scale.max(state.nominal.abs()),
    };
    (mean, machine.states.iter().zip(scales).map(size).collect())
}
