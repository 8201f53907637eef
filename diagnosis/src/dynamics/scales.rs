//! Sizes of what no log tells: states that nobody measures, inputs that nobody feeds.

use super::linearise::Engine;
use super::policy::DYNAMICS;
use super::schedule::Schedule;
use super::worker::Job;
use crate::error::Error;
use crate::statistics::levels::{FEW, FINE, STEP};
use crate::statistics::linear::RANK_TOLERANCE;

/// Share of an output below which a state moves it not at all: a state that is forgotten within a row leaves rounding, by which it would have to
/// move a million million times as far as it stands.
const FORGOTTEN: f64 = RANK_TOLERANCE;
/// The same for an input, of which nobody knows how large it is: a thousandth of a watt hardly warms a room within a log, and that is no rounding.
const NOTHING: f64 = FINE * RANK_TOLERANCE;

/// Steps by which a state is moved that nobody measures, one after the other until an output moves: nobody knows how large it is where its start is
/// zero, and a millionth of a speed is rounding beside a place that has run far away. At most as far as its start, or one.
fn steps(nominal: f64) -> [f64; FEW] {
    let (first, most) = (1e-4 * nominal.abs().max(STEP), nominal.abs().max(1.0));
    [1.0, FINE.recip(), FINE.recip().powi(2)].map(|times| (times * first).min(most))
}

/// How far something must move to move an output as far as that moves, where a step of it changes the outputs of rows so; `None`: it changes
/// none of them by more than this share.
fn scale((base, moved): (&[f64], &[f64]), step: f64, sizes: &[f64], least: f64) -> Option<f64> {
    let changes = base.iter().zip(moved).zip(sizes.iter().cycle());
    let is_real = |base: f64, moved: f64| (moved - base).abs() > least * base.abs().max(moved.abs());
    let largest = changes
        .filter(|((base, moved), _)| is_real(**base, **moved))
        .map(|((base, moved), size)| ((moved - base) / step).abs() / size.max(1e-300))
        .fold(0.0, f64::max);
    (largest > 0.0 && largest.is_finite()).then(|| 1.0 / largest)
}

impl Engine {
    /// The scales of all states, with one for each that nobody measures: what moves an output by as much as it moves, over a stretch of rows
    /// (of an unstable machine those before its own growth is what moves it).
    pub(super) fn unmeasured_scales(&self, sizes: &[f64]) -> Result<Vec<f64>, Error> {
        let grid = &self.grids[0];
        let schedule = Schedule::new(&self.machine, grid, &self.machine.neutral());
        let (n, row) = (self.machine.order(), grid.time.len() / 2);
        let here = self.nominal_states(grid, row);
        let rows = self.rows_before_growth(grid, row, DYNAMICS.watched);
        let mut scales = self.scales.clone();
        self.with_worker(|worker| {
            let (mut base, mut out) = (Vec::new(), Vec::new());
            let job = Job { each_row: true, ..schedule.job(grid.time[row], row, DYNAMICS.watched, &here) };
            worker.interval(&self.machine, &job, &mut base)?;
            let first = n + self.machine.channels.len() + schedule.reads[row].len();
            let told = first..base.len().min(first + rows * sizes.len());
            for (state, of) in self.machine.states.iter().enumerate().filter(|(_, of)| of.channel.is_none()) {
                let mut moved = |step: f64| {
                    let mut at = here.clone();
                    at[state] += step;
                    worker.interval(&self.machine, &Job { states: &at, ..job }, &mut out).ok()?;
                    scale((&base[told.clone()], &out[told.clone()]), step, sizes, FORGOTTEN)
                };
                scales[state] = steps(of.nominal).into_iter().find_map(&mut moved).unwrap_or(scales[state]);
            }
            Ok(())
        })?;
        Ok(scales)
    }

    /// The scales of all inputs, with one for each that nobody logs: what moves an output by as much as it moves, over a stretch of rows.
    pub(super) fn unlogged_scales(&self, sizes: &[f64]) -> Result<Vec<f64>, Error> {
        let grid = &self.grids[0];
        let schedule = Schedule::new(&self.machine, grid, &self.machine.neutral());
        let (n, row, width) = (self.machine.order(), grid.time.len() / 2, self.machine.inputs.len());
        let here = self.nominal_states(grid, row);
        let rows = self.rows_before_growth(grid, row, DYNAMICS.watched);
        let mut scales = self.input_scales.clone();
        self.with_worker(|worker| {
            let (mut base, mut out) = (Vec::new(), Vec::new());
            let job = Job { each_row: true, ..schedule.job(grid.time[row], row, DYNAMICS.watched, &here) };
            worker.interval(&self.machine, &job, &mut base)?;
            let first = n + self.machine.channels.len() + schedule.reads[row].len();
            let told = first..base.len().min(first + rows * sizes.len());
            for input in (0..width).filter(|input| self.machine.inputs[*input].open) {
                let step = 1e-3 * scales[input];
                let shifted = |values: &[f64]| -> Vec<f64> {
                    let own = |(place, value): (usize, &f64)| {
                        value + if place % width == input { step } else { 0.0 }
                    };
                    values.iter().enumerate().map(own).collect()
                };
                let (at_row, fed) = (shifted(job.at_row), shifted(job.fed));
                worker.interval(&self.machine, &Job { at_row: &at_row, fed: &fed, ..job }, &mut out)?;
                let moved = scale((&base[told.clone()], &out[told.clone()]), step, sizes, NOTHING);
                scales[input] = moved.unwrap_or(scales[input]);
            }
            Ok(())
        })?;
        Ok(scales)
    }
}

#[cfg(test)]
mod tests {
    use super::{FORGOTTEN, NOTHING, scale, steps};

    #[test]
    fn value_a_state_is_moved_until_an_output_moves_and_no_farther_than_its_start_or_one() {
        assert_eq!(steps(0.0).map(|step| step as f32), [1e-6, 1e-3, 1.0]);
        assert_eq!(steps(-300.0).map(|step| step as f32), [0.03, 30.0, 300.0]);
        // a carriage at 45 rad that 1e-6 rad/s take 2e-9 rad farther within a row
        let of = |step: f64| scale((&[45.0], &[45.0 + 0.002 * step]), step, &[20.0], FORGOTTEN);
        assert!(of(1e-6).is_none());
        assert!((of(1e-3).expect("it moves") / 1e4 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn value_rounding_is_no_move_of_an_output() {
        // a step of 0.03 K of a cell that is forgotten within a row: 6e-14 K of 350 K are the unit's rounding
        let of = |by: f64, step: f64, least: f64| {
            scale((&[350.0, 290.0], &[350.0 + by, 290.0]), step, &[2.0], least)
        };
        assert_eq!((of(6e-14, 0.03, FORGOTTEN), of(6e-14, 1e-3, NOTHING)), (None, None));
        let seen = of(1e-3, 0.03, FORGOTTEN).expect("it moves by a thousandth");
        // the output moves by 2 K, two thousand times as far
        assert!((seen / 60.0 - 1.0).abs() < 1e-6, "{seen}");
        // what an input does is seen far below what a state must do, but for rounding
        assert!(of(1e-8, 1e-3, NOTHING).is_some() && of(1e-8, 0.03, FORGOTTEN).is_none());
    }
}
