//! Whether a unit remembers more than the states that can be set: a relay's position, a lag inside that no variable starts, a state that the
//! data set does not list. A row's interval begins anew from these states, so what a unit remembers beyond them counts as a fault of the model.
//!
//! The nominal model is simulated through each run, and once more from each row to the next; where the two go apart, a notice says so. States
//! that no variable shows are read for that through what the model's outputs did then.

use super::grid::Grid;
use super::interval::Along;
use super::linearise::Engine;
use super::policy::DYNAMICS;
use super::schedule::Schedule;
use super::stretch::{Glance, Left};
use super::worker::{Job, Worker};
use crate::error::{Error, Notice};
use crate::statistics::levels::{FEW, SAMPLE};
use nalgebra::DVector;

/// Stretches that are begun anew in what the model itself does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stretches {
    /// A few short ones: a model that bends far is followed through them.
    Few,
    /// Half of the run each: what resembles a state for a while does not for so long.
    Long,
}

impl Stretches {
    /// In a run of so many rows. The search for their states ends long before so many rounds when it finds them.
    fn glance(self, rows: usize) -> Glance {
        let rows = if self == Self::Few { SAMPLE } else { rows.div_ceil(2).max(SAMPLE) };
        Glance { stretches: FEW, rows, rounds: SAMPLE }
    }
}

impl Engine {
    /// How much the model misses, as a share of the motion, of what it does by itself in the longest run, where it begins anew in stretches of
    /// it from the states that fit best: little where these are all that it remembers. The most of all channels; nothing where it can't be
    /// followed.
    pub fn missed_begun_anew(mut self, stretches: Stretches) -> Option<f64> {
        self.replayed()?;
        let left = self.follow_stretches(&stretches.glance(self.grids[0].time.len()))?;
        // what is no number is missed
        let share = |channel: &Left| match (channel.error / channel.motion).sqrt() {
            _ if channel.error == 0.0 => 0.0,
            share if share.is_nan() => f64::INFINITY,
            share => share,
        };
        Some(left.iter().map(share).fold(0.0, f64::max))
    }

    /// Puts what the nominal model does in the longest run in the place of all logs.
    fn replayed(&mut self) -> Option<()> {
        let longest = (0..self.grids.len()).max_by_key(|run| self.grids[*run].time.len())?;
        let mut grid = self.grids.swap_remove(longest);
        self.starts = vec![self.starts.swap_remove(longest)];
        let schedule = Schedule::new(&self.machine, &grid, &self.machine.neutral());
        let start = self.nominal_states(&grid, 0);
        let courses =
            self.with_worker(|worker| self.outputs_through(worker, &grid, &schedule, &start)).ok()?;
        for sample in &mut grid.samples {
            let row = grid.time.partition_point(|time| *time < sample.time);
            sample.value = *courses.get(row * self.machine.channels.len() + sample.channel)?;
        }
        self.outliers = vec![vec![false; grid.samples.len()]];
        self.grids = vec![grid];
        Some(())
    }

    /// What the outputs of the nominal model do in a whole run from a start, a number for each row and channel.
    fn outputs_through(
        &self,
        worker: &mut Worker,
        grid: &Grid,
        schedule: &Schedule,
        start: &[f64],
    ) -> Result<Vec<f64>, Error> {
        let whole = schedule.job(grid.time[0], 0, grid.time.len() - 1, start);
        let mut out = Vec::new();
        worker.interval(&self.machine, &Job { each_row: true, reads: &[], ..whole }, &mut out)?;
        Ok(out.split_off(self.machine.order()))
    }

    /// A notice for each run in which rows begun anew go another way.
    pub fn remembered(&self) -> Vec<Notice> {
        let machine = &self.machine;
        if machine.whole {
            return Vec::new();
        }
        let shown = machine.horizon == 0 && machine.states.iter().all(|state| state.shows.is_some());
        let way = |grid: &Grid| if shown { self.other_way(grid) } else { self.other_way_as_read(grid) };
        let told = |grid: &Grid| {
            Some(Notice {
                file: grid.name.clone(),
                line: 0,
                message: message(&way(&self.while_followed(grid))?),
            })
        };
        self.grids.iter().filter_map(told).collect()
    }

    /// Which way rows go that are begun anew in states which are read through what the outputs did in the run, if it is another.
    fn other_way_as_read(&self, grid: &Grid) -> Option<String> {
        let (machine, rows, outputs) = (&self.machine, grid.time.len(), self.machine.channels.len());
        let schedule = Schedule::new(machine, grid, &machine.neutral());
        let along = Along { engine: self, grid, schedule: &schedule, set: &[] };
        let start = self.nominal_states(grid, 0);
        let beyond = machine.horizon + 1;
        let (mut apart, mut first) = (0, None);
        self.with_worker(|worker| {
            let through = self.outputs_through(worker, grid, &schedule, &start)?;
            let sizes: Vec<f64> = (0..outputs).map(|channel| deviation(&through, channel, outputs)).collect();
            let mut state = DVector::from_vec(start.clone());
            for row in 1..rows.saturating_sub(beyond) {
                let shown = &through[row * outputs..(row + beyond + 1) * outputs];
                let (next, following) = along.read_in(worker, row, &state, shown)?;
                state = next;
                let off = |entry: usize| (following[entry] - shown[outputs + entry], entry % outputs);
                let far = |(off, channel): &(f64, usize)| is_apart(off.abs(), sizes[*channel]);
                if let Some(off) = (0..following.len()).map(off).find(far) {
                    apart += 1;
                    first.get_or_insert((row, off));
                }
            }
            Ok(())
        })
        .ok()?;
        let (row, (off, channel)) = first?;
        let (count, name, time) = (rows - 1, &machine.channels[channel].name, grid.time[row]);
        Some(format!(
            "{apart} of {count} rows go another way, the first after {time:.6} s, where {name} becomes another by {off:.4}"
        ))
    }

    /// Which way rows go that are begun anew in the states that were shown in the run, if it is another.
    fn other_way(&self, grid: &Grid) -> Option<String> {
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
        Some(match apart.first() {
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
        })
    }
}

/// What a user should know of a model whose rows, begun anew, go another way.
fn message(way: &str) -> String {
    format!(
        "the model remembers more than the states that can be set: begun anew from them, {way}. What these rows seem to lack may be that"
    )
}

/// How far a channel moves about its mean, of numbers for each row and channel.
fn deviation(values: &[f64], channel: usize, channels: usize) -> f64 {
    let own = || values.iter().skip(channel).step_by(channels);
    let mean = own().sum::<f64>() / own().count() as f64;
    (own().map(|value| (value - mean).powi(2)).sum::<f64>() / own().count() as f64).sqrt()
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
