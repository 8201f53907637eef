//! Outliers of the channels: found without the model, taken back where the model explains them.

use super::grid::{Grid, jumps_beyond};
use super::linearise::Engine;
use super::machine::Machine;
use super::policy::DYNAMICS;
use super::schedule::Schedule;
use crate::error::Notice;
use crate::infer::{Linearised, Noise, smooth};
use crate::nuisance::{outliers, scatter};
use crate::statistics::levels::SMALL;

fn of_channel(grid: &Grid, channel: usize) -> Vec<usize> {
    (0..grid.samples.len()).filter(|place| grid.samples[*place].channel == channel).collect()
}

/// Values that stand alone: run and sample.
pub(super) fn excluded(machine: &Machine, grids: &[Grid]) -> Vec<Vec<bool>> {
    let mut all: Vec<Vec<bool>> = grids.iter().map(|grid| vec![false; grid.samples.len()]).collect();
    for channel in 0..machine.channels.len() {
        let values = |grid: &Grid| -> Vec<f64> {
            of_channel(grid, channel).iter().map(|place| grid.samples[*place].value).collect()
        };
        let logs: Vec<Vec<f64>> = grids.iter().map(values).collect();
        let logs: Vec<&[f64]> = logs.iter().map(Vec::as_slice).collect();
        let scale = outliers::scale(&logs, scatter(&logs).quantum);
        for (run, (grid, log)) in grids.iter().zip(&logs).enumerate() {
            let jumps: Vec<Vec<f64>> = grid.inputs.iter().map(|course| jumps_beyond(course, SMALL)).collect();
            let places = of_channel(grid, channel);
            let time: Vec<f64> = places.iter().map(|place| grid.samples[*place].time).collect();
            let driven = |from: f64, to: f64| jumps.iter().flatten().any(|time| (from..=to).contains(time));
            for out in outliers::outliers(&time, log, scale, driven) {
                all[run][places[out]] = true;
            }
        }
    }
    all
}

/// Whether a model that leaves so much of a value explains why it lies so far from its neighbours.
fn is_explained(left: f64, away: f64) -> bool {
    left.abs() < DYNAMICS.explained * away
}

impl Engine {
    /// Takes back the outliers that the model explains: a peak may be sharp and no accident. Whether there were any.
    pub fn readmit(&mut self, theta: &[f64], runs: &[Linearised], noise: &Noise) -> bool {
        let mut back: Vec<(usize, usize)> = Vec::new();
        for (run, linearised) in runs.iter().enumerate() {
            if !self.outliers[run].contains(&true) {
                continue;
            }
            let (grid, n) = (&self.grids[run], linearised.states);
            let schedule = Schedule::new(&self.machine, grid, theta);
            let state = smooth(linearised, noise).state;
            for row in 0..linearised.rows() {
                for value in linearised.values(row) {
                    let sample = schedule.placed[value].sample;
                    if !self.outliers[run][sample] {
                        continue;
                    }
                    let by: f64 =
                        (0..n).map(|i| linearised.observe[value * n + i] * state[row * n + i]).sum();
                    let left = linearised.measured[value].residual - by;
                    if is_explained(left, self.away(run, sample)) {
                        back.push((run, sample));
                    }
                }
            }
        }
        back.iter().for_each(|(run, sample)| self.outliers[*run][*sample] = false);
        !back.is_empty()
    }

    /// Distance of a value from the mean of its nearest neighbours that are no outliers.
    fn away(&self, run: usize, sample: usize) -> f64 {
        let (samples, out) = (&self.grids[run].samples, &self.outliers[run]);
        let fits = |place: &usize| samples[*place].channel == samples[sample].channel && !out[*place];
        let near = [(0..sample).rev().find(fits), (sample + 1..samples.len()).find(fits)];
        let values: Vec<f64> = near.iter().flatten().map(|place| samples[*place].value).collect();
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        (samples[sample].value - mean).abs()
    }

    /// What a reader should know of the outliers.
    pub fn outlier_notices(&self) -> Vec<Notice> {
        let mut notices = Vec::new();
        for (channel, output) in self.machine.channels.iter().enumerate() {
            let all: Vec<(usize, usize)> = (0..self.grids.len())
                .flat_map(|run| {
                    of_channel(&self.grids[run], channel).into_iter().map(move |place| (run, place))
                })
                .filter(|(run, place)| self.outliers[*run][*place])
                .collect();
            let Some((run, place)) = all.first() else { continue };
            let first = self.grids[*run].samples[*place];
            let message = format!(
                "{} value(s) of {} stand alone among their neighbours, and the model doesn't explain them; the first at \
                 {:.6} s ({:.6} {}): excluded as outliers",
                all.len(),
                output.name,
                first.time,
                first.value,
                output.unit
            );
            notices.push(Notice { file: self.grids[*run].name.clone(), line: 0, message });
        }
        notices
    }
}

#[cfg(test)]
mod tests {
    use super::is_explained;

    #[test]
    fn value_a_model_explains_a_peak_that_it_makes_most_of() {
        assert!(is_explained(-0.9, 2.0) && !is_explained(1.1, 2.0) && !is_explained(-1.1, 2.0));
    }
}
