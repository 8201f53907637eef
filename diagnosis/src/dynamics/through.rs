//! States that no variable shows, read through the outputs that follow.
//!
//! A unit goes on from x(k) over one interval, and then over a horizon of H more, with its outputs Y at each row. Started at
//! x̂(k+1) it gives O there. Where it is, x(k+1), is where O(x) = Y: to first order x(k+1) = x̂(k+1) + J⁺ (Y - O), J = ∂O/∂x.
//! By this ∂F/∂x = J⁺ ∂Y/∂x and ∂F/∂θ = J⁺ (∂Y/∂θ - ∂O/∂θ). No noise is in Y and O, so the horizon may be short.

use super::about::{About, Along};
use super::linearise::{Engine, MOVE, RowParts};
use super::schedule::Schedule;
use super::worker::Worker;
use crate::error::Error;
use crate::infer::fit::Path;
use crate::statistics::levels::{FEW, FINE, MORE, ROUNDING, SAMPLE};
use nalgebra::{DMatrix, DVector};

/// Directions of the states that show less than this share of the clearest are left as they are: differences are good to 1e-6.
const CLEAR: f64 = ROUNDING;
/// A horizon is long enough when a small move of all states is read back to this share.
const ENOUGH: f64 = FINE;
/// Longest horizon, rows.
const FARTHEST: usize = SAMPLE;
/// Rounds of reading a state anew, at most.
const ROUNDS: usize = FEW;

/// Pseudo-inverse of ∂O/∂x, rows weighed by the sensors, columns by the states' scales.
fn reader(jacobian: &DMatrix<f64>, sensors: &[f64], scales: &[f64]) -> DMatrix<f64> {
    let weighed = DMatrix::from_fn(jacobian.nrows(), jacobian.ncols(), |i, j| {
        jacobian[(i, j)] * scales[j] / sensors[i % sensors.len()]
    });
    let svd = weighed.svd(true, true);
    let most = svd.singular_values.amax();
    let inverse = svd
        .pseudo_inverse(CLEAR * most)
        .unwrap_or_else(|_| DMatrix::zeros(jacobian.ncols(), jacobian.nrows()));
    DMatrix::from_fn(inverse.nrows(), inverse.ncols(), |i, j| {
        inverse[(i, j)] * scales[i] / sensors[j % sensors.len()]
    })
}

impl Engine {
    /// Chooses the horizon: as few rows as a state is read back from, or, where none does, as few as read nearly as well. How many.
    ///
    /// # Errors
    /// A unit failed.
    pub(super) fn look_ahead(&mut self) -> Result<usize, Error> {
        let (n, outputs) = (self.machine.order(), self.machine.channels.len());
        let mut tried: Vec<(usize, f64)> = Vec::new();
        let mut horizon = n.div_ceil(outputs.max(1)).saturating_sub(1).max(1);
        while tried.is_empty() || horizon <= FARTHEST.min(self.grids[0].time.len() / 2) {
            self.machine.horizon = horizon;
            let misread = self.misread()?;
            tried.push((horizon, misread));
            if misread < ENOUGH {
                break;
            }
            horizon *= 2;
        }
        let least = tried.iter().map(|(_, misread)| *misread).fold(f64::INFINITY, f64::min);
        let first = tried.iter().find(|(_, misread)| *misread <= (MORE * least).max(ENOUGH));
        self.machine.horizon = first.map_or(horizon, |(horizon, _)| *horizon);
        Ok(self.machine.horizon)
    }

    /// The largest share by which a small move of all states is misread, at rows in the first run.
    fn misread(&self) -> Result<f64, Error> {
        let grid = &self.grids[0];
        let schedule = Schedule::new(&self.machine, grid, &self.machine.neutral());
        let along = Along { engine: self, grid, schedule: &schedule, set: &[] };
        let moves =
            DVector::from_iterator(self.machine.order(), self.scales.iter().map(|scale| -MOVE * scale));
        let mut largest = 0.0;
        self.with_worker(|worker| {
            for part in 0..FEW {
                let row = (2 * part + 1) * grid.time.len() / (2 * FEW);
                let here = DVector::from_vec(self.nominal_states(grid, row));
                let about = along.about(worker, row, &here)?;
                let (mut out, reads) = (Vec::new(), schedule.reads[row].len());
                along.from(worker, row, (&here + &moves).as_slice(), &mut out)?;
                let shown = |out: &[f64]| DVector::from_vec(self.shown(out, reads));
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
    fn shown(&self, out: &[f64], reads: usize) -> Vec<f64> {
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
            inverse * (&wanted - DVector::from_vec(engine.shown(base, next_reads)))
        };
        let mut base = Vec::new();
        self.from(worker, row + 1, state.as_slice(), &mut base)?;
        let guess = state + by(&self.reader(row, about), &base);
        let following = self.about(worker, row + 1, &guess)?;
        let inverse = self.reader(row + 1, &following);
        let mut moved = by(&inverse, &following.base);
        let mut next = &guess + &moved;
        for _ in 0..ROUNDS {
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

/// Puts next states and their derivatives where a unit that shows them would have.
pub(super) fn next_states(engine: &Engine, path: &Path, schedule: &Schedule, parts: &mut [RowParts]) {
    let n = engine.machine.order();
    for row in 0..parts.len().saturating_sub(1) {
        let (here, there) = parts.split_at_mut(row + 1);
        let (here, there) = (&mut here[row], &there[0]);
        let (reads, next_reads) = (schedule.reads[row].len(), schedule.reads[row + 1].len());
        let columns: Vec<Vec<f64>> =
            there.states.iter().map(|column| engine.shown(column, next_reads)).collect();
        let jacobian = DMatrix::from_fn(columns[0].len(), n, |i, j| columns[j][i]);
        let inverse = reader(&jacobian, &engine.sensors, &engine.scales);
        let read = |following: &[f64], shown: Option<Vec<f64>>| {
            let rest = DVector::from_fn(following.len(), |i, _| {
                following[i] - shown.as_ref().map_or(0.0, |shown| shown[i])
            });
            &inverse * rest
        };
        let by = read(engine.following(&here.base, reads), Some(engine.shown(&there.base, next_reads)));
        (0..n).for_each(|i| here.base[i] = path[(row + 1) * n + i] + by[i]);
        for column in here.states.iter_mut().chain(&mut here.inputs) {
            let by = read(engine.following(column, reads), None);
            (0..n).for_each(|i| column[i] = by[i]);
        }
        for (column, next) in here.units.iter_mut().zip(&there.units).filter(|(column, _)| !column.is_empty())
        {
            let by = read(engine.following(column, reads), Some(engine.shown(next, next_reads)));
            (0..n).for_each(|i| column[i] = by[i]);
        }
    }
}
