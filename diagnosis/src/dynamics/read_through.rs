//! States that no variable shows, read through the outputs that follow.
//!
//! A unit goes on from x(k) over one interval, and then over a horizon of H more, with its outputs Y at each row. Started at
//! x̂(k+1) it gives O there. Where it is, x(k+1), is where O(x) = Y: to first order x(k+1) = x̂(k+1) + J⁺ (Y - O), J = ∂O/∂x.
//! By this ∂F/∂x = J⁺ ∂Y/∂x and ∂F/∂θ = J⁺ (∂Y/∂θ - ∂O/∂θ), with O from x(k+1). No noise is in Y and O, so the horizon may be short.

use super::interval::{About, Along};
use super::linearise::{Chord, Engine, RowParts, RunAt, difference};
use super::machine::Role;
use super::policy::DYNAMICS;
use super::schedule::Schedule;
use super::worker::{Job, Worker};
use crate::error::Error;
use crate::statistics::levels::{FEW, FINE, MORE, ROUNDING, SEVERAL, TASK};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Pseudo-inverse of ∂O/∂x, rows weighed by the sensors, columns by the states' scales. Directions that show less than rounding are left
/// as they are.
fn reader(jacobian: &DMatrix<f64>, sensors: &[f64], scales: &[f64]) -> DMatrix<f64> {
    let weighed = DMatrix::from_fn(jacobian.nrows(), jacobian.ncols(), |i, j| {
        jacobian[(i, j)] * scales[j] / sensors[i % sensors.len()]
    });
    let svd = weighed.svd(true, true);
    let most = svd.singular_values.amax();
    let inverse = svd
        .pseudo_inverse(ROUNDING * most)
        .unwrap_or_else(|_| DMatrix::zeros(jacobian.ncols(), jacobian.nrows()));
    DMatrix::from_fn(inverse.nrows(), inverse.ncols(), |i, j| {
        inverse[(i, j)] * scales[i] / sensors[j % sensors.len()]
    })
}

/// The horizon from a first one on, in logs of twice so many rows, by the share that each misreads.
fn horizon_by_misreading(
    first: usize,
    half: usize,
    misread: &mut dyn FnMut(usize) -> Result<f64, Error>,
) -> Result<usize, Error> {
    let mut tried: Vec<(usize, f64)> = Vec::new();
    let mut horizon = first;
    while tried.is_empty() || horizon <= DYNAMICS.farthest.min(half) {
        let misread = misread(horizon)?;
        tried.push((horizon, misread));
        if misread < DYNAMICS.read_back {
            break;
        }
        horizon *= 2;
    }
    let least = tried.iter().map(|(_, misread)| *misread).fold(f64::INFINITY, f64::min);
    let first = tried.iter().find(|(_, misread)| *misread <= (MORE * least).max(DYNAMICS.read_back));
    Ok(first.map_or(horizon, |(horizon, _)| *horizon))
}

impl Engine {
    /// Chooses the horizon: as few rows as a state is read back from, or, where none does, as few as read nearly as well. How many.
    ///
    /// # Errors
    /// A unit failed.
    pub(super) fn choose_horizon(&mut self) -> Result<usize, Error> {
        let (n, outputs) = (self.machine.order(), self.machine.channels.len());
        let first = n.div_ceil(outputs.max(1)).saturating_sub(1).max(1);
        let half = self.grids[0].time.len() / 2;
        let misread = &mut |horizon| {
            self.machine.horizon = horizon;
            self.misread()
        };
        self.machine.horizon = horizon_by_misreading(first, half, misread)?;
        Ok(self.machine.horizon)
    }

    /// The largest share by which a small move of all states is misread, at rows in the first run.
    fn misread(&self) -> Result<f64, Error> {
        let grid = &self.grids[0];
        let schedule = Schedule::new(&self.machine, grid, &self.machine.neutral());
        let along = Along { engine: self, grid, schedule: &schedule, set: &[] };
        let moves = DVector::from_iterator(
            self.machine.order(),
            self.scales.iter().map(|scale| -DYNAMICS.state_step * scale),
        );
        let mut largest = 0.0;
        self.with_worker(|worker| {
            for part in 0..FEW {
                let row = (2 * part + 1) * grid.time.len() / (2 * FEW);
                // a machine at rest stands where its equations bend: a valve that is shut, a joint that sticks. Beside that both moves are
                // on one side
                let here = DVector::from_vec(self.nominal_states(grid, row)) - SEVERAL * &moves;
                let about = along.about(worker, row, &here)?;
                let (mut out, reads) = (Vec::new(), schedule.reads[row].len());
                along.from(worker, row, (&here + &moves).as_slice(), &mut out)?;
                let shown = |out: &[f64]| DVector::from_vec(self.outputs_shown(out, reads));
                let told = along.reader(row, &about) * (shown(&out) - shown(&about.base));
                let wrong = told.iter().zip(&moves).map(|(told, moved)| (told / moved - 1.0).abs());
                // what is no number is misread
                let wrong = wrong.map(|wrong| if wrong.is_nan() { f64::INFINITY } else { wrong });
                largest = wrong.fold(largest, f64::max);
            }
            Ok(largest)
        })
    }

    /// Where outputs at a row and the H rows after it stand in what [`Worker::interval`] gives, and how many there are.
    fn shown_at(&self, reads: usize) -> (impl Fn(usize) -> usize, usize) {
        let (n, outputs, horizon) = (self.machine.order(), self.machine.channels.len(), self.machine.horizon);
        (move |entry| n + entry + if entry < outputs { 0 } else { reads }, outputs * (1 + horizon))
    }

    /// Outputs at a row and the H rows after it.
    fn outputs_shown(&self, out: &[f64], reads: usize) -> Vec<f64> {
        let (at, count) = self.shown_at(reads);
        (0..count).map(|entry| out[at(entry)]).collect()
    }

    /// Outputs at the H + 1 rows after the first.
    fn following<'a>(&self, out: &'a [f64], reads: usize) -> &'a [f64] {
        let (n, outputs, horizon) = (self.machine.order(), self.machine.channels.len(), self.machine.horizon);
        let from = n + outputs + reads;
        &out[from..from + (horizon + 1) * outputs]
    }
}

impl Along<'_> {
    /// The reader of the states at a row.
    fn reader(&self, row: usize, about: &About) -> DMatrix<f64> {
        let (first, rows) = self.engine.shown_at(self.schedule.reads[row].len());
        let jacobian =
            DMatrix::from_fn(rows, about.at.len(), |entry, state| about.columns[(first(entry), state)]);
        reader(&jacobian, &self.engine.sensors, &self.engine.scales)
    }

    /// The state at a row from which outputs do what was `shown` at this row and those of the horizon, searched from a state near by, and what
    /// they do from it at the rows after this one.
    pub(super) fn read_in(
        &self,
        worker: &mut Worker,
        row: usize,
        near: &DVector<f64>,
        shown: &[f64],
    ) -> Result<(DVector<f64>, Vec<f64>), Error> {
        let (engine, reads) = (self.engine, self.schedule.reads[row].len());
        let mut state = near.clone();
        let mut base = Vec::new();
        for _ in 0..FEW {
            let about = self.about(worker, row, &state)?;
            let simulated = DVector::from_vec(engine.outputs_shown(&about.base, reads));
            let wanted = DVector::from_column_slice(&shown[..simulated.len()]);
            let by = self.reader(row, &about) * (wanted - simulated);
            state += &by;
            self.from(worker, row, state.as_slice(), &mut base)?;
            if by.iter().zip(&engine.scales).all(|(by, scale)| by.abs() < FINE * scale) {
                break;
            }
        }
        Ok((state, engine.following(&base, reads).to_vec()))
    }

    /// The state at the next row, which shows what followed from this one (`out`); its derivative by this one; what follows from it.
    ///
    /// This row's reader gives a first guess, about which the next row is linearised; from there its own reader goes on.
    pub(super) fn read_next(
        &self,
        worker: &mut Worker,
        row: usize,
        state: &DVector<f64>,
        about: &About,
        out: &[f64],
    ) -> Result<(DVector<f64>, DMatrix<f64>, About), Error> {
        let engine = self.engine;
        let (reads, next_reads) = (self.schedule.reads[row].len(), self.schedule.reads[row + 1].len());
        let wanted = DVector::from_column_slice(engine.following(out, reads));
        let by = |inverse: &DMatrix<f64>, base: &[f64]| {
            inverse * (&wanted - DVector::from_vec(engine.outputs_shown(base, next_reads)))
        };
        let mut base = Vec::new();
        self.from(worker, row + 1, state.as_slice(), &mut base)?;
        let guess = state + by(&self.reader(row, about), &base);
        let following = self.about(worker, row + 1, &guess)?;
        let inverse = self.reader(row + 1, &following);
        let mut moved = by(&inverse, &following.base);
        let mut next = &guess + &moved;
        for _ in 0..FEW {
            if moved.iter().zip(&engine.scales).all(|(by, scale)| by.abs() < FINE * scale) {
                break;
            }
            self.from(worker, row + 1, next.as_slice(), &mut base)?;
            moved = by(&inverse, &base);
            next += &moved;
        }
        let first = engine.machine.order() + engine.machine.channels.len() + reads;
        let transition = &inverse * about.columns.rows(first, inverse.ncols());
        Ok((next, transition, following))
    }
}

/// How the state at the end of a row's interval is read.
struct Reading {
    inverse: DMatrix<f64>,
    /// From the path to that state.
    by: DVector<f64>,
    /// What each chord changes of what that state shows, where it is not the path's and the unit takes it.
    shown: Option<Vec<Vec<f64>>>,
}

impl RunAt<'_> {
    /// Puts next states and their derivatives where a unit that shows them would have.
    pub(super) fn next_states(&self, parts: &mut [RowParts]) {
        let intervals = parts.len().saturating_sub(1);
        let tasks: Vec<usize> = (0..intervals).step_by(TASK).collect();
        let readings: Vec<Vec<Reading>> = tasks
            .par_iter()
            .map(|begin| {
                let mut refused = false;
                let rows = *begin..(begin + TASK).min(intervals);
                rows.map(|row| self.reading(row, &parts[row], &parts[row + 1], &mut refused)).collect()
            })
            .collect();
        for (row, reading) in readings.iter().flatten().enumerate() {
            let (here, there) = parts.split_at_mut(row + 1);
            self.put(row, reading, &mut here[row], &there[0]);
        }
    }

    /// A unit that refuses a state which the path doesn't visit is not asked again in this task.
    fn reading(&self, row: usize, here: &RowParts, there: &RowParts, refused: &mut bool) -> Reading {
        let (engine, n) = (self.engine, self.engine.machine.order());
        let (reads, next_reads) = (self.schedule.reads[row].len(), self.schedule.reads[row + 1].len());
        let columns: Vec<Vec<f64>> =
            there.states.iter().map(|column| engine.outputs_shown(column, next_reads)).collect();
        let jacobian = DMatrix::from_fn(columns[0].len(), n, |i, j| columns[j][i]);
        let inverse = reader(&jacobian, &engine.sensors, &engine.scales);
        let base = engine.outputs_shown(&there.base, next_reads);
        let following = engine.following(&here.base, reads);
        let by = &inverse * DVector::from_fn(base.len(), |i, _| following[i] - base[i]);
        let near = by.iter().zip(&engine.scales).all(|(by, scale)| by.abs() < ROUNDING * scale);
        let mut shown = None;
        if !near && !*refused && there.simulated.iter().any(|column| !column.is_empty()) {
            let state: Vec<f64> = (0..n).map(|i| self.path[(row + 1) * n + i] + by[i]).collect();
            let changed = engine.with_worker(|worker| self.changed(worker, row + 1, &state)).ok();
            shown = changed.filter(|columns| columns.iter().flatten().all(|value| value.is_finite()));
            *refused = shown.is_none();
        }
        Reading { inverse, by, shown }
    }

    /// What each chord of a unit's parameter changes of what a state at a row shows. Where outputs hardly tell states apart, even a
    /// state a little off has it wrong by a large share of what a chord does to the state.
    fn changed(&self, worker: &mut Worker, row: usize, state: &[f64]) -> Result<Vec<Vec<f64>>, Error> {
        let engine = self.engine;
        let reads = self.schedule.reads[row].len();
        let mut from = |theta: &[f64]| {
            let (set, mut out) = (engine.set(theta), Vec::new());
            let job = Job { parameters: &set, ..engine.job(self.grid, self.schedule, row, state) };
            worker.interval(&engine.machine, &job, &mut out)?;
            Ok::<_, Error>(engine.outputs_shown(&out, reads))
        };
        let base = from(self.theta)?;
        let of = |chord: &Chord| {
            if !matches!(engine.machine.parameters[chord.parameter].role, Role::Unit(_)) {
                return Ok(Vec::new());
            }
            let mut theta = self.theta.to_vec();
            theta[chord.parameter] = chord.to;
            Ok(difference(&from(&theta)?, &base, chord.per))
        };
        self.chords.iter().map(of).collect()
    }

    fn put(&self, row: usize, reading: &Reading, here: &mut RowParts, there: &RowParts) {
        let (engine, n) = (self.engine, self.engine.machine.order());
        let (reads, next_reads) = (self.schedule.reads[row].len(), self.schedule.reads[row + 1].len());
        let read = |following: &[f64], shown: Option<&[f64]>| {
            let rest = |i: usize| following[i] - shown.map_or(0.0, |shown| shown[i]);
            &reading.inverse * DVector::from_fn(following.len(), |i, _| rest(i))
        };
        (0..n).for_each(|i| here.base[i] = self.path[(row + 1) * n + i] + reading.by[i]);
        for column in here.states.iter_mut().chain(&mut here.inputs) {
            let by = read(engine.following(column, reads), None);
            (0..n).for_each(|i| column[i] = by[i]);
        }
        for (place, column) in here.simulated.iter_mut().enumerate().filter(|(_, column)| !column.is_empty())
        {
            let shown = match &reading.shown {
                Some(shown) => shown[place].clone(),
                None => engine.outputs_shown(&there.simulated[place], next_reads),
            };
            let by = read(engine.following(column, reads), Some(&shown));
            (0..n).for_each(|i| column[i] = by[i]);
        }
        if !here.late.is_empty() {
            let shown = (!there.late.is_empty()).then(|| engine.outputs_shown(&there.late, next_reads));
            let by = read(engine.following(&here.late, reads), shown.as_deref());
            (0..n).for_each(|i| here.late[i] = by[i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::horizon_by_misreading;

    #[test]
    fn value_a_horizon_is_as_short_as_reads_a_state_back_and_not_a_second_long() {
        let with = |half: usize, misread: &dyn Fn(usize) -> f64| {
            horizon_by_misreading(1, half, &mut |horizon| Ok(misread(horizon))).expect("no unit, no fault")
        };
        // to a thousandth, the share that ends an iteration: the first that does
        assert_eq!(with(100, &|horizon| if horizon >= 4 { 0.9e-3 } else { 1.0 }), 4);
        assert_eq!(with(100, &|horizon| if horizon >= 4 { 1.8e-3 / horizon as f64 } else { 1.0 }), 4);
        assert_eq!(with(100, &|horizon| if horizon >= 4 { 9e-3 / horizon as f64 } else { 1.0 }), 16);
        // where none does, the shortest that reads nearly as well as the best; thirty rows, or half of a log, are the most that is asked
        assert_eq!(with(100, &|horizon| if horizon < 16 { 1.0 } else { 8.0 / horizon as f64 }), 16);
        assert_eq!(with(6, &|horizon| 1.0 / horizon as f64), 4);
        assert_eq!(with(100, &|horizon| if horizon == 8 { 0.1 } else { 0.14 }), 1);
    }
}
