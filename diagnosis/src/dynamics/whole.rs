//! Units that nothing can start within a run: no start parameter, no output of initial "exact". A run is simulated whole, from the
//! unit's own start.
//!
//! What a channel shows beyond the model is then a state of its own, one a channel: a random walk with process noise, which is at
//! its floor where the model explains the data. Search and verdict are those of linked states; an unlisted input is one that
//! adds to this residual.

use super::grid::Grid;
use super::linearise::{Chord, Engine};
use super::machine::{Machine, Reference, State};
use super::schedule::{Schedule, output_effects};
use super::worker::Job;
use crate::error::Error;
use crate::infer::fit::Path;
use crate::infer::{Linearised, Measured};
use crate::statistics::levels::SAMPLE;
use rayon::prelude::*;

/// Rows over which a unit is watched after a fresh start.
const WATCHED: usize = SAMPLE;

/// One state for each channel: what it shows beyond the model.
pub(super) fn states(machine: &Machine) -> Vec<State> {
    let own = |(channel, output): (usize, &super::machine::Output)| State {
        name: output.name.clone(),
        start: Reference { unit: 0, reference: 0, kind: output.variable.kind },
        shows: None,
        nominal: 0.0,
        channel: Some(channel),
    };
    machine.channels.iter().enumerate().map(own).collect()
}

impl Engine {
    /// Whether the outputs after some rows depend on what was before them: a fresh start there gives others.
    pub(super) fn remembers(&self, sizes: &[f64]) -> Result<bool, Error> {
        let grid = &self.grids[0];
        let schedule = Schedule::new(&self.machine, grid, &self.machine.neutral());
        let (n, channels, rows) = (self.machine.order(), self.machine.channels.len(), grid.time.len());
        let watched = WATCHED.min((rows - 1) / 2);
        self.with_worker(|worker| {
            let (mut through, mut fresh) = (Vec::new(), Vec::new());
            let states = self.nominal_states(grid, 0);
            let job = |row: usize, count: usize| Job {
                probe: true,
                reads: &[],
                ..schedule.job(grid.time[row], row, count, &states)
            };
            worker.interval(&self.machine, &job(0, 2 * watched), &mut through)?;
            worker.interval(&self.machine, &job(watched, watched), &mut fresh)?;
            Ok((1..=watched).any(|row| {
                (0..channels).any(|channel| {
                    let there = through[n + (watched + row) * channels + channel];
                    let here = fresh[n + row * channels + channel];
                    (there - here).abs() > (0.5 * self.sensors[channel]).max(1e-3 * sizes[channel])
                })
            }))
        })
    }

    /// Outputs of a run at its rows, as the log would show them: rows of channels.
    fn simulated(&self, grid: &Grid, theta: &[f64]) -> Result<Vec<f64>, Error> {
        let (machine, channels) = (&self.machine, self.machine.channels.len());
        let schedule = Schedule::new(machine, grid, theta);
        let set = self.set(theta);
        let states = vec![0.0; machine.order()];
        let whole = schedule.job(grid.time[0], 0, grid.time.len() - 1, &states);
        let mut out = Vec::new();
        self.with_worker(|worker| {
            worker.interval(machine, &Job { parameters: &set, probe: true, reads: &[], ..whole }, &mut out)
        })?;
        let rows = out.split_off(machine.order());
        let mut shown = vec![0.0; rows.len()];
        for (channel, effect) in output_effects(machine, theta).iter().enumerate() {
            let values: Vec<f64> = rows.iter().skip(channel).step_by(channels).copied().collect();
            let sensed = super::sensed(&grid.time, &values, effect.delay, effect.lag);
            for (row, value) in sensed.into_iter().enumerate() {
                shown[row * channels + channel] = effect.shown(value, grid.time[row] - grid.origin);
            }
        }
        Ok(shown)
    }

    /// A run about its path of rests.
    pub(super) fn whole(
        &self,
        run: usize,
        theta: &[f64],
        path: &Path,
        chords: &[Chord],
    ) -> Result<Linearised, Error> {
        let (grid, n, p) = (&self.grids[run], self.machine.order(), chords.len());
        let base = self.simulated(grid, theta)?;
        let column = |chord: &Chord| -> Result<Vec<f64>, Error> {
            let mut there = theta.to_vec();
            there[chord.parameter] = chord.to;
            let there = self.simulated(grid, &there)?;
            Ok(there.iter().zip(&base).map(|(there, here)| (there - here) / chord.per).collect())
        };
        let columns = chords.par_iter().map(column).collect::<Result<Vec<_>, _>>()?;
        let rows = grid.time.len();
        let mut out = Linearised {
            states: n,
            parameters: p,
            time: grid.time.clone(),
            first: vec![0],
            start: self.start(run, path),
            drive: vec![0.0; (rows - 1) * n * p],
            ..Linearised::default()
        };
        for row in 0..rows - 1 {
            out.transition.extend((0..n * n).map(|place| if place % (n + 1) == 0 { 1.0 } else { 0.0 }));
            out.defect.extend((0..n).map(|i| path[row * n + i] - path[(row + 1) * n + i]));
        }
        let mut samples = grid.samples.iter().zip(&self.outliers[run]).peekable();
        for row in 0..rows {
            let around = (row.saturating_sub(1), (row + 1).min(rows - 1));
            let span = (grid.time[around.1] - grid.time[around.0]).max(1e-300);
            while let Some((sample, outlier)) = samples.next_if(|(sample, _)| sample.time <= grid.time[row]) {
                let entry = row * n + sample.channel;
                out.measured.push(Measured {
                    channel: sample.channel,
                    time: sample.time,
                    residual: sample.value - base[entry] - path[entry],
                    slope: (base[around.1 * n + sample.channel] - base[around.0 * n + sample.channel]) / span,
                    weight: if *outlier { 0.0 } else { 1.0 },
                });
                out.observe.extend((0..n).map(|i| if i == sample.channel { 1.0 } else { 0.0 }));
                out.direct.extend(columns.iter().map(|column| column[entry]));
            }
            out.first.push(out.measured.len());
        }
        Ok(out)
    }

    /// A parameter's largest change of a whole run, in units of noise.
    pub(super) fn telling_whole(&self, theta: &[f64], there: &[f64], noise: &[f64]) -> Result<f64, Error> {
        let grid = &self.grids[0];
        let (here, there) = (self.simulated(grid, theta)?, self.simulated(grid, there)?);
        let changes = here.iter().zip(&there).enumerate();
        Ok(changes.map(|(entry, (a, b))| (b - a).abs() / noise[entry % noise.len()]).fold(0.0, f64::max))
    }
}
