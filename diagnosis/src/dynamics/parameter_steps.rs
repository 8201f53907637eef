//! Steps of the parameters over which a difference is a derivative: large enough to be seen, small enough not to bend.

use super::at_once::tried_rows;
use super::linearise::{Chord, Engine};
use super::machine::{Parameter, Role};
use super::policy::DYNAMICS;
use super::schedule::Schedule;
use super::worker::{Job, Worker};
use crate::error::Error;
use crate::infer::Noise;
use crate::infer::fit::Path;
use crate::observe::{InputEffect, OutputEffect, Scale};
use crate::ports::{Kind, Measure};
use rayon::prelude::*;

/// A parameter's step before anything is known of what it does, in its own unit. `inputs` are the sizes of the inputs, each in its unit, and
/// `interval` is the usual distance of rows, s: a flow of 1e-4 m³/s has steps of its own size.
pub(super) fn first_step(parameter: &Parameter, inputs: &[f64], interval: f64) -> f64 {
    let (least, most) = parameter.range;
    let measure = |effect| Kind::of_input(effect).measure;
    let size = match parameter.role {
        Role::Input(_, InputEffect::Gain) | Role::Output(_, OutputEffect::Gain) => 1.0,
        Role::Input(place, effect) if measure(effect) == Measure::Variable => inputs[place],
        Role::Input(place, effect) if measure(effect) == Measure::VariablePerSecond => {
            inputs[place] / interval
        }
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

    /// All parameters, one of them moved by its step.
    pub(super) fn stepped(&self, theta: &[f64], parameter: usize) -> Vec<f64> {
        let mut moved = theta.to_vec();
        moved[parameter] = self.local(theta, parameter).to;
        moved
    }

    /// Parameters of units that move as numbers.
    pub(super) fn calibrated(&self) -> Vec<usize> {
        let is_number = |parameter: &Parameter| {
            matches!(parameter.role, Role::Unit(_))
                && matches!(parameter.scale, Scale::Absolute | Scale::Relative)
        };
        let parameters = &self.machine.parameters;
        (0..parameters.len()).filter(|place| is_number(&parameters[*place])).collect()
    }

    /// Steps of the parameters that change what a row shows by a small share of the noise.
    ///
    /// # Errors
    /// A unit failed at its nominal values.
    pub fn calibrate(&mut self, theta: &[f64], paths: &[Path], noise: &Noise) -> Result<(), Error> {
        let calibrated = self.calibrated();
        for _ in 0..2 {
            let changes = self.largest_changes(theta, paths, noise, &calibrated)?;
            for (place, change) in calibrated.iter().zip(changes).filter(|(_, change)| *change > 0.0) {
                self.steps[*place] = self.telling_step(theta, *place, change);
            }
        }
        Ok(())
    }

    /// A parameter's step that changes a row by the wanted share of the noise, where its step so far changes it by `change` of that.
    fn telling_step(&self, theta: &[f64], parameter: usize, change: f64) -> f64 {
        let (here, (least, most)) = (theta[parameter], self.machine.parameters[parameter].range);
        let room = f64::max(most - here, here - least);
        let step = self.steps[parameter].abs() * (DYNAMICS.telling_step / change).clamp(1e-4, 1e4);
        // a share of the nominal value at most: beyond it models bend
        let most = if here != 0.0 { 0.01 * here.abs() } else { 0.01 * room };
        step.min(most).max(1e-9 * here.abs())
    }

    /// The largest change of a row, in units of noise or of the states' scales over their row-to-row motion, for one step of each.
    fn largest_changes(
        &self,
        theta: &[f64],
        paths: &[Path],
        noise: &Noise,
        parameters: &[usize],
    ) -> Result<Vec<f64>, Error> {
        if self.machine.whole {
            let one =
                |place: &usize| self.telling_whole(theta, &self.stepped(theta, *place), &noise.channels);
            return parameters.par_iter().map(one).collect();
        }
        let schedule = Schedule::new(&self.machine, &self.grids[0], theta);
        let one = |place: &usize| {
            let there = self.stepped(theta, *place);
            self.with_worker(|worker| {
                self.largest_change(worker, &schedule, &paths[0], (theta, &there), &noise.channels)
            })
        };
        parameters.par_iter().map(one).collect()
    }

    /// The same for one parameter: between parameters without and with its step, over some rows of the first run.
    fn largest_change(
        &self,
        worker: &mut Worker,
        schedule: &Schedule,
        path: &[f64],
        (here, there): (&[f64], &[f64]),
        sensors: &[f64],
    ) -> Result<f64, Error> {
        let (grid, n) = (&self.grids[0], self.machine.order());
        let (set, moved) = (self.set(here), self.set(there));
        let size = |entry: usize| match entry.checked_sub(n) {
            None => self.scales[entry] * 1e-2,
            Some(channel) => sensors.get(channel).copied().unwrap_or(f64::INFINITY),
        };
        let (mut base, mut out, mut largest) = (Vec::new(), Vec::new(), 0.0);
        for row in tried_rows(grid.time.len() - 1) {
            let job = self.job(grid, schedule, row, &path[row * n..(row + 1) * n]);
            worker.interval(&self.machine, &Job { parameters: &set, ..job }, &mut base)?;
            match worker.interval(&self.machine, &Job { parameters: &moved, ..job }, &mut out) {
                // a row in which the unit can't be run with the step tells nothing of it
                Err(Error::Model(_)) => continue,
                ended => ended?,
            }
            let changes = out.iter().zip(&base).enumerate();
            largest = changes
                .map(|(entry, (there, here))| (there - here).abs() / size(entry))
                .fold(largest, f64::max);
        }
        Ok(largest)
    }
}
