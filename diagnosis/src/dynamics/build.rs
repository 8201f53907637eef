//! From a problem to an engine: sizes of states, inputs and steps, and what the units can do.

use super::excluded::excluded;
use super::first_path::Trails;
use super::grid::{Grid, usual};
use super::linearise::{Chord, Engine};
use super::machine::{Machine, Parameter, Role};
use super::policy::DYNAMICS;
use super::schedule::Schedule;
use super::worker::{Job, Worker};
use crate::error::{Error, Notice};
use crate::infer::fit::{At, Path};
use crate::infer::likelihood::maximise;
use crate::infer::{Linearised, Noise, Sizes};
use crate::nuisance::{Scatter, scatter};
use crate::observe::{InputEffect, OutputEffect, Problem, Run, Scale};
use crate::statistics::levels::{FEW, anywhere_in};
use rayon::prelude::*;
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
    /// Path and noises at these parameters, before anything is fitted, and the runs about it without columns. Where runs were followed
    /// already the path begins there.
    ///
    /// # Errors
    /// A unit failed.
    pub fn begun(&mut self, theta: &[f64], known: &Trails) -> Result<(At, Vec<Linearised>), Error> {
        let paths = self.engine.paths(theta, &self.noise, known)?;
        self.engine.calibrate(theta, &paths, &self.noise)?;
        let runs = self.engine.chords(theta, &paths, &[])?;
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
    if n > crate::infer::sweep::MOST_STATES - 2 {
        return Err(Error::Model(format!(
            "{n} states; this way follows at most {}",
            crate::infer::sweep::MOST_STATES - 2
        )));
    }
    let (told, short): (Vec<_>, Vec<_>) = (runs.iter())
        .map(|(run, (from, to))| ((*run, (*from, *to)), Grid::new(&machine, run, *from, *to)))
        .partition(|(_, grid)| grid.time.len() >= FEW);
    let (rows, grids): (Vec<(&Run, Span)>, Vec<Grid>) = told.into_iter().unzip();
    let Some(first) = grids.first() else {
        return Err(Error::NothingUsable { path: problem.path.clone(), notices: problem.notices.clone() });
    };
    if problem.late && machine.any_step {
        machine.first_step = machine.short_step(&first.time);
    }
    let left_out = |(_, grid): ((&Run, Span), Grid)| Notice {
        file: grid.name,
        line: 0,
        message: format!("{} rows tell nothing of a motion: left out", grid.time.len()),
    };
    let mut notices: Vec<Notice> = short.into_iter().map(left_out).collect();
    let outliers = excluded(&machine, &grids);
    let values = |channel: usize| -> Vec<Vec<f64>> {
        let of = |(grid, out): (&Grid, &Vec<bool>)| {
            let all = grid.samples.iter().zip(out);
            all.filter(|(sample, out)| sample.channel == channel && !**out).map(|(s, _)| s.value).collect()
        };
        grids.iter().zip(&outliers).map(of).collect()
    };
    let scatters: Vec<Scatter> = (0..machine.channels.len())
        .map(|channel| scatter(&values(channel).iter().map(Vec::as_slice).collect::<Vec<_>>()))
        .collect();
    let input_scales: Vec<f64> = (0..machine.inputs.len())
        .map(|input| {
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
        })
        .collect();
    let measured_scale = |state: usize| {
        let channel = machine.states[state].channel?;
        let size = scatters[channel].size;
        Some(if size > 0.0 {
            size
        } else {
            machine.states[state].nominal.abs().max(1.0) * DYNAMICS.first_step
        })
    };
    let scales: Vec<f64> = (0..n)
        .map(|state| {
            measured_scale(state).unwrap_or(machine.states[state].nominal.abs().max(DYNAMICS.first_step))
        })
        .collect();
    let interval = usual(&first.time);
    let sensors: Vec<f64> = (machine.channels.iter().zip(&scatters))
        .map(|(output, scatter)| {
            output
                .noise
                .filter(|sd| *sd > 0.0)
                .unwrap_or(scatter.noise.max(DYNAMICS.exact_sensor * scatter.size.max(1e-300)))
        })
        .collect();
    let mut engine = Engine {
        steps: machine.parameters.iter().map(first_step).collect(),
        starts: Vec::new(),
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
    engine.check_clock(&mut notices)?;
    engine.check_reset(&mut notices)?;
    let sizes: Vec<f64> = scatters.iter().map(|scatter| scatter.size).collect();
    if problem.whole {
        engine.unmeasured_scales(&sizes)?;
        engine.follow_whole(&rows, &sizes);
    } else if engine.machine.states.is_empty() && engine.remembers(&sizes)? {
        engine.follow_whole(&rows, &sizes);
        let message = "no state of the model can be set (no start parameter, no output of initial \"exact\"): each run is \
                       simulated whole from the model's own start, and no window begins anew";
        notices.push(Notice { file: "dataset.toml".into(), line: 0, message: message.into() });
    }
    if engine.machine.whole {
        engine.whole_states()?;
    } else {
        engine.unmeasured_scales(&sizes)?;
    }
    engine.unlogged_scales(&sizes)?;
    if let Some(state) = if engine.machine.whole { None } else { engine.hidden()? } {
        let told = engine.look_ahead()?;
        notices.push(Notice {
            file: "dataset.toml".into(),
            line: 0,
            message: format!("no variable shows the state {state} again: states are read through the outputs of {told} rows"),
        });
    }
    engine.starts = engine.grids.iter().map(|grid| engine.prior(grid)).collect();
    let least = |(output, scatter): (&super::machine::Output, &Scatter)| match output.noise {
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
    let process: Vec<(f64, f64)> = engine
        .scales
        .iter()
        .map(|scale| {
            (DYNAMICS.least_process * scale / span.sqrt(), DYNAMICS.widest * scale / interval.sqrt())
        })
        .collect();
    let sizes = Sizes {
        channels: engine.machine.channels.iter().zip(&scatters).map(least).collect(),
        process,
        pinned: Vec::new(),
        jitter: DYNAMICS.most_jitter * interval,
    };
    let noise = Noise {
        channels: sensors,
        process: engine.scales.iter().map(|scale| 0.3 * scale / (10.0 * interval).sqrt()).collect(),
        jitter: 1e-3 * interval,
        disturbance: None,
    };
    Ok(Built { engine, noise, sizes, scatter: scatters, notices })
}

fn first_step(parameter: &Parameter) -> f64 {
    let (least, most) = parameter.range;
    let size = match parameter.role {
        Role::Input(_, InputEffect::Gain) | Role::Output(_, OutputEffect::Gain) => 1.0,
        _ if parameter.neutral != 0.0 => parameter.neutral.abs(),
        _ if (most - least).is_finite() => most - least,
        _ => 1.0,
    };
    let step = DYNAMICS.first_step * size;
    if parameter.neutral + step > most { -step } else { step }
}

impl Engine {
    /// The chord that is a derivative where the parameters are.
    pub fn local(&self, theta: &[f64], parameter: usize) -> Chord {
        let (least, most) = self.machine.parameters[parameter].range;
        let step = self.steps[parameter].abs();
        let here = theta[parameter];
        let by = if here + step <= most {
            step
        } else if here - step >= least {
            -step
        } else {
            step
        };
        Chord { parameter, to: here + by, per: by }
    }

    /// States as far as a row measures them, else nominal.
    pub(super) fn nominal_states(&self, grid: &Grid, row: usize) -> Vec<f64> {
        if self.machine.whole {
            return grid.begin.iter().map(|(value, _)| *value).collect();
        }
        let near = |channel: usize| {
            let own = grid.samples.iter().filter(|sample| sample.channel == channel);
            own.min_by(|a, b| {
                let away = |sample: &super::grid::Sample| (sample.time - grid.time[row]).abs();
                away(a).total_cmp(&away(b))
            })
        };
        let of = |state: &super::machine::State| {
            state.channel.and_then(near).map_or(state.nominal, |sample| sample.value)
        };
        self.machine.states.iter().map(of).collect()
    }

    fn prior(&self, grid: &Grid) -> (Vec<f64>, Vec<f64>) {
        if self.machine.whole {
            // the rest begins at none: an offset is an effect
            return (
                vec![0.0; self.machine.order()],
                self.scales.iter().map(|scale| DYNAMICS.least_process * scale).collect(),
            );
        }
        let mean = self.nominal_states(grid, 0);
        let size = |(state, scale): (&super::machine::State, &f64)| match state.channel {
            Some(_) => DYNAMICS.widest * scale,
            None => DYNAMICS.widest * scale.max(state.nominal.abs()),
        };
        (mean, self.machine.states.iter().zip(&self.scales).map(size).collect())
    }

    /// The same interval twice, with another between, and on a fresh instance.
    fn check_reset(&mut self, notices: &mut Vec<Notice>) -> Result<(), Error> {
        let grid = &self.grids[0];
        let schedule = Schedule::new(&self.machine, grid, &self.machine.neutral());
        let (here, there) = (self.nominal_states(grid, 0), self.nominal_states(grid, grid.time.len() / 2));
        let job = |row, states| Job { each_row: true, ..self.job(grid, &schedule, row, states) };
        let (mut fresh, mut again, mut other) = (Vec::new(), Vec::new(), Vec::new());
        let mut worker = Worker::new(&self.machine)?;
        worker.interval(&self.machine, &job(0, &here), &mut fresh)?;
        let turned = worker
            .interval(&self.machine, &job(grid.time.len() / 2, &there), &mut other)
            .and_then(|()| worker.interval(&self.machine, &job(0, &here), &mut again));
        let restores = self.machine.units.iter().all(|unit| unit.fmu.restores());
        if !restores || turned.is_err() || fresh != again {
            self.resets = false;
            let message = "fmi2Reset doesn't bring the unit back to where it began: a fresh instance for each interval instead";
            notices.push(Notice { file: "dataset.toml".into(), line: 0, message: message.into() });
        }
        Ok(())
    }

    /// Whether every state that is set is shown after initialisation; which isn't, if one is not.
    fn hidden(&self) -> Result<Option<String>, Error> {
        let grid = &self.grids[0];
        let schedule = Schedule::new(&self.machine, grid, &self.machine.neutral());
        let here: Vec<f64> = (self.nominal_states(grid, 0).iter().zip(&self.scales))
            .map(|(at, scale)| at + 0.01 * scale)
            .collect();
        let shown =
            self.with_worker(|worker| worker.shown(&self.machine, &self.job(grid, &schedule, 0, &here)))?;
        let pairs = self.machine.states.iter().zip(here.iter().zip(&shown));
        let mut other = pairs.filter(|(_, (set, shown))| {
            shown.is_nan() || (*set - *shown).abs() > 1e-6 * (set.abs() + shown.abs() + 1e-6)
        });
        Ok(other.next().map(|(state, _)| state.name.clone()))
    }

    /// Steps of the parameters that change what a row shows by a small share of the noise.
    ///
    /// # Errors
    /// A unit failed at its nominal values.
    pub fn calibrate(&mut self, theta: &[f64], paths: &[Path], noise: &Noise) -> Result<(), Error> {
        for _ in 0..2 {
            let unit: Vec<usize> = (0..self.machine.parameters.len())
                .filter(|place| matches!(self.machine.parameters[*place].role, Role::Unit(_)))
                .filter(|place| {
                    matches!(self.machine.parameters[*place].scale, Scale::Absolute | Scale::Relative)
                })
                .collect();
            let told = self.telling(theta, paths, noise, &unit)?;
            for (place, told) in unit.iter().zip(told) {
                if told > 0.0 {
                    let (least, most) = self.machine.parameters[*place].range;
                    let room = f64::max(most - theta[*place], theta[*place] - least);
                    let step = self.steps[*place].abs() * (DYNAMICS.telling_step / told).clamp(1e-4, 1e4);
                    // a share of the nominal value at most: beyond it models bend
                    let most = if theta[*place] != 0.0 { 0.01 * theta[*place].abs() } else { 0.01 * room };
                    self.steps[*place] = step.min(most).max(1e-9 * theta[*place].abs());
                }
            }
        }
        Ok(())
    }

    /// The largest change of a row, in units of noise or of the states' scales over their row-to-row motion, for one step of each.
    fn telling(
        &self,
        theta: &[f64],
        paths: &[Path],
        noise: &Noise,
        which: &[usize],
    ) -> Result<Vec<f64>, Error> {
        let (grid, path, n) = (&self.grids[0], &paths[0], self.machine.order());
        if self.machine.whole {
            let one = |place: &usize| {
                let mut moved = theta.to_vec();
                moved[*place] = self.local(theta, *place).to;
                self.telling_whole(theta, &moved, &noise.channels)
            };
            return which.par_iter().map(one).collect();
        }
        let schedule = Schedule::new(&self.machine, grid, theta);
        let rows: Vec<usize> = super::at_once::tried_rows(grid.time.len() - 1).collect();
        which
            .par_iter()
            .map(|place| {
                self.with_worker(|worker| {
                    let (mut base, mut out, mut largest) = (Vec::new(), Vec::new(), 0.0);
                    let mut moved = theta.to_vec();
                    moved[*place] = self.local(theta, *place).to;
                    let (set, there) = (self.set(theta), self.set(&moved));
                    for row in &rows {
                        let states = &path[row * n..(row + 1) * n];
                        let job = self.job(grid, &schedule, *row, states);
                        worker.interval(&self.machine, &Job { parameters: &set, ..job }, &mut base)?;
                        match worker.interval(&self.machine, &Job { parameters: &there, ..job }, &mut out) {
                            // a row in which the unit can't be run with the step tells nothing of it
                            Err(Error::Model(_)) => continue,
                            ended => ended?,
                        }
                        for (entry, (there, here)) in out.iter().zip(&base).enumerate() {
                            let size = match entry.checked_sub(n) {
                                None => self.scales[entry] * 1e-2,
                                Some(channel) => {
                                    noise.channels.get(channel).copied().unwrap_or(f64::INFINITY)
                                }
                            };
                            largest = f64::max(largest, (there - here).abs() / size);
                        }
                    }
                    Ok(largest)
                })
            })
            .collect()
    }
}
