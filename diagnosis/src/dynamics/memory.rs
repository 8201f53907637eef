//! Whether a unit remembers more than the states that can be set: a relay's position, a lag inside that no variable starts, a state that the
//! data set does not list. A row's interval begins anew from these states, so what a unit remembers beyond them counts as a fault of the model.
//!
//! The nominal model is simulated through each run, and once more from each row to the next; where the two go apart, a notice says so.

use super::grid::Grid;
use super::linearise::Engine;
use super::policy::DYNAMICS;
use super::schedule::Schedule;
use super::stretch::Glance;
use super::worker::Job;
use crate::error::Notice;
use crate::statistics::levels::{FEW, SAMPLE};

/// Stretches that are begun anew in what the model itself does; the search for their states ends long before when it finds them.
const GLANCE: Glance = Glance { stretches: FEW, rows: SAMPLE, rounds: SAMPLE };

impl Engine {
    /// Whether these states are all that the model remembers, some of which no variable shows: what it does in the longest run, simulated
    /// through, it does again in stretches that begin anew in some such states.
    pub fn begins_by_its_states(mut self) -> bool {
        self.replayed().and_then(|()| self.follow_stretches(&GLANCE)).is_some_and(|left| {
            left.iter().all(|channel| channel.error <= DYNAMICS.apart * DYNAMICS.apart * channel.motion)
        })
    }

    /// Puts what the nominal model does in the longest run in the place of all logs.
    fn replayed(&mut self) -> Option<()> {
        let longest = (0..self.grids.len()).max_by_key(|run| self.grids[*run].time.len())?;
        let mut grid = self.grids.swap_remove(longest);
        self.starts = vec![self.starts.swap_remove(longest)];
        let machine = &self.machine;
        let schedule = Schedule::new(machine, &grid, &machine.neutral());
        let start = self.nominal_states(&grid, 0);
        let whole = schedule.job(grid.time[0], 0, grid.time.len() - 1, &start);
        let mut out = Vec::new();
        let job = Job { each_row: true, reads: &[], ..whole };
        self.with_worker(|worker| worker.interval(machine, &job, &mut out)).ok()?;
        let courses = &out[machine.order()..];
        for sample in &mut grid.samples {
            let row = grid.time.partition_point(|time| *time < sample.time);
            sample.value = *courses.get(row * machine.channels.len() + sample.channel)?;
        }
        self.outliers = vec![vec![false; grid.samples.len()]];
        self.grids = vec![grid];
        Some(())
    }

    /// A notice for each run in which rows begun anew go another way.
    pub fn remembered(&self) -> Vec<Notice> {
        let machine = &self.machine;
        if machine.whole || machine.horizon > 0 || machine.states.iter().any(|state| state.shows.is_none()) {
            return Vec::new();
        }
        self.grids.iter().filter_map(|grid| self.remembered_in(grid)).collect()
    }

    fn remembered_in(&self, grid: &Grid) -> Option<Notice> {
        let (machine, rows) = (&self.machine, grid.time.len());
        let schedule = Schedule::new(machine, grid, &machine.neutral());
        let start = self.nominal_states(grid, 0);
        let whole = schedule.job(grid.time[0], 0, rows - 1, &start);
        // a model that can't be simulated through (it falls, it refuses) says nothing of what it remembers
        let through = self.with_worker(|worker| worker.walk(machine, &whole)).ok()?;
        let mut apart: Vec<(usize, usize, f64)> = Vec::new();
        let mut drifts = vec![Drift::default(); machine.order()];
        self.with_worker(|worker| {
            let mut out = Vec::new();
            for row in 1..rows - 1 {
                let job = schedule.job(grid.time[row], row, 1, &through[row - 1]);
                worker.interval(machine, &job, &mut out)?;
                let off = |state: usize| out[state] - through[row][state];
                let size = |state: usize| self.scales[state].max(through[row][state].abs());
                drifts.iter_mut().enumerate().for_each(|(state, drift)| drift.add(off(state)));
                let worst = (0..machine.order())
                    .max_by(|a, b| (off(*a).abs() / size(*a)).total_cmp(&(off(*b).abs() / size(*b))));
                apart.extend(
                    worst
                        .filter(|state| is_apart(off(*state).abs(), size(*state)))
                        .map(|state| (row, state, off(state))),
                );
            }
            Ok(())
        })
        .ok()?;
        let way = match apart.first() {
            Some((row, state, off)) => format!(
                "{} of {} rows go another way, the first at {:.6} s, where {} becomes another by {off:.4}",
                apart.len(),
                rows - 1,
                grid.time[*row],
                machine.states[*state].name,
            ),
            // rows that are short against the motion go another way by little each, and by much together
            None => {
                let far = |state: &usize| drifts[*state].is_far(self.scales[*state]);
                let state = (0..machine.order()).find(far)?;
                let (name, span) = (&machine.states[state].name, drifts[state].span());
                format!("rows together miss {span:.4} of what {name} does")
            }
        };
        let message = format!(
            "the model remembers more than the states that can be set: begun anew from them, {way}. What these rows seem to lack may be that",
        );
        Some(Notice { file: grid.name.clone(), line: 0, message })
    }
}

/// Whether two ends lie apart by more than a solver that begins anew goes another way.
fn is_apart(off: f64, size: f64) -> bool {
    off > DYNAMICS.apart * size
}

/// How far errors take a sum, from its least to its most.
#[derive(Debug, Clone, Copy, Default)]
struct Drift {
    sum: f64,
    least: f64,
    most: f64,
}

impl Drift {
    fn add(&mut self, error: f64) {
        self.sum += error;
        self.least = self.least.min(self.sum);
        self.most = self.most.max(self.sum);
    }

    fn span(&self) -> f64 {
        self.most - self.least
    }

    /// Whether they take a state of this size another way.
    fn is_far(&self, size: f64) -> bool {
        self.span() > DYNAMICS.drifts * size
    }
}

#[cfg(test)]
mod tests {
    use super::{Drift, is_apart};

    #[test]
    fn value_what_no_solver_that_begins_anew_goes_apart_by() {
        // a row: a solver's step at its begin is off by a thousandth, a relay that fell back by all of it
        assert!(!is_apart(0.009, 1.0) && is_apart(0.011, 1.0));
        // rows together, by half of the state's size; errors that go to and fro are none that take it anywhere
        let drift = |errors: &mut dyn Iterator<Item = f64>| {
            let mut drift = Drift::default();
            errors.for_each(|error| drift.add(error));
            drift
        };
        assert!(!drift(&mut (0..90).map(|_| 0.005)).is_far(1.0));
        assert!(drift(&mut (0..110).map(|_| -0.005)).is_far(1.0));
        assert!(!drift(&mut (0..1000).map(|row| if row % 2 == 0 { 0.005 } else { -0.005 })).is_far(1.0));
    }
}
