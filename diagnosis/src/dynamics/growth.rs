//! How long an unstable machine can be followed by itself: a pendulum that a loop balances parts from its own log, and what is seen then is
//! the machine's growth and no longer what it was begun with.

use super::grid::Grid;
use super::linearise::Engine;
use super::policy::DYNAMICS;
use super::schedule::Schedule;
use super::worker::Job;
use crate::statistics::levels::{FAR, ROWS, SAMPLE};

impl Engine {
    /// Of so many rows from one on those before a move of a state that a channel shows has grown far beyond itself there: one at least, and all of
    /// a machine that forgets or drifts, or can't be run there. What a state does to others says nothing: their units may be misread.
    pub(super) fn rows_before_growth(&self, grid: &Grid, row: usize, rows: usize) -> usize {
        let machine = &self.machine;
        // what is simulated whole begins nowhere else
        if machine.whole {
            return rows;
        }
        let schedule = Schedule::new(machine, grid, &machine.neutral());
        let here = self.nominal_states(grid, row);
        let whole = schedule.job(grid.time[row], row, rows, &here);
        let job = Job { each_row: true, reads: &[], ..whole };
        let shown = machine.states.iter().enumerate().filter_map(|(state, of)| Some((state, of.channel?)));
        let grown = self.with_worker(|worker| {
            let (mut base, mut out, mut all) = (Vec::new(), Vec::new(), rows);
            worker.interval(machine, &job, &mut base)?;
            for (state, channel) in shown {
                let by = DYNAMICS.state_step * self.scales[state];
                let mut at = here.clone();
                at[state] += by;
                worker.interval(machine, &Job { states: &at, ..job }, &mut out)?;
                let own = |out: &[f64]| -> Vec<f64> {
                    let rows = &out[machine.order()..];
                    rows.iter().skip(channel).step_by(machine.channels.len()).copied().collect()
                };
                all = all.min(rows_until_grown(&own(&base), &own(&out), by));
            }
            Ok(all)
        });
        grown.unwrap_or(rows).max(1)
    }

    /// The rows of a run that the model is followed through from its begin: all where it doesn't grow away from them within many.
    pub(super) fn while_followed(&self, grid: &Grid) -> Grid {
        let asked = (SAMPLE * ROWS).min(grid.time.len() - 1);
        let rows = self.rows_before_growth(grid, 0, asked);
        let mut part = grid.clone();
        if rows < asked {
            part.time.truncate(rows + 1);
            let last = part.time[rows];
            part.samples.retain(|sample| sample.time <= last);
        }
        part
    }
}

/// Rows until a state that was moved is off by far more than that.
fn rows_until_grown(base: &[f64], moved: &[f64], by: f64) -> usize {
    let mut off = base.iter().zip(moved).map(|(base, moved)| (moved - base).abs());
    off.position(|off| off > FAR * by).unwrap_or(base.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::{built, swung};

    #[test]
    fn value_how_long_a_move_tells_of_a_state() {
        let moved =
            |rate: f64| -> Vec<f64> { (0..30).map(|row| 1e-4 * libm::exp(rate * f64::from(row))).collect() };
        // a machine that forgets, one that drifts off slowly, and one that grows tenfold in twelve rows
        let rows = [-0.2, 0.05, 0.2].map(|rate| rows_until_grown(&[0.0; 30], &moved(rate), 1e-4));
        assert_eq!(rows, [30, 30, 12]);
    }

    #[test]
    fn law_what_hangs_is_followed_for_long_and_what_stands_is_not() {
        let problem = swung("growth", 400);
        let built = built(&problem);
        let engine = &built.engine;
        assert_eq!(engine.rows_before_growth(&engine.grids[0], 0, 200), 200);
        // the same arm upside down
        let mut grid = engine.grids[0].clone();
        grid.samples.iter_mut().for_each(|sample| sample.value = 0.0);
        let rows = engine.rows_before_growth(&grid, 0, 200);
        assert!((5..100).contains(&rows), "{rows}");
    }
}
