//! Which simulated row goes into which bin of a window.

use super::window::Window;
use super::{PlantCut, applied_torque};
use crate::rigs::acrobot::residual::plant::policy::WINDOWS;
use crate::rigs::acrobot::residual::trajectory::{COLUMNS, MOTION, Row};
use crate::statistics::linear::Cell;
use nalgebra::DMatrix;

/// Which simulated row goes into which bin.
pub(super) struct Layout {
    /// Signal, rows (index among the wanted ones).
    pub(super) bins: Vec<(usize, Vec<usize>)>,
    /// Rows in each bin that show the same value as one, in the mean.
    repeats: Vec<f64>,
}

/// How many rows in a row show the value of each: what a coarse encoder is off by is the same in all of them.
fn repeats(values: &[f64]) -> Vec<usize> {
    values.chunk_by(|a, b| a == b).flat_map(|same| std::iter::repeat_n(same.len(), same.len())).collect()
}

impl Layout {
    /// The bins of a window, each of some rows in a row of one signal that were measured and aren't in doubt.
    pub(super) fn of(cut: &PlantCut, window: &Window) -> Self {
        let mut layout = Self { bins: Vec::new(), repeats: Vec::new() };
        let run = &cut.runs[window.run];
        let Some(log) = run.plant.as_ref() else { return layout };
        let size = window.rows.len().div_ceil(WINDOWS.bins);
        for (signal, name) in COLUMNS.iter().enumerate() {
            let Some(values) = log.column(name) else { continue };
            let shown: Vec<f64> = window.rows.iter().map(|row| values[*row]).collect();
            let repeats = repeats(&shown);
            let reach = if cut.applied(signal) { cut.reach[window.run] } else { 0.0 };
            // scattering timestamps may put it on either side of a change, and all rows on the same
            let sure = |place: usize| {
                applied_torque::in_doubt(run, log.time[window.rows[place]], reach)
                    <= cut.signals[signal].sigma
            };
            for chunk in (0..window.rows.len()).collect::<Vec<_>>().chunks(size) {
                // what arrives as a log begins is of commands before it
                let settled = |place: usize| signal < MOTION || place > 0 || !window.drive.begins_wanted();
                let tells = |place: &usize| {
                    values[window.rows[*place]].is_finite() && settled(*place) && sure(*place)
                };
                let rows: Vec<usize> = chunk.iter().copied().filter(tells).collect();
                if !rows.is_empty() {
                    let n = rows.len() as f64;
                    layout.repeats.push(rows.iter().map(|row| repeats[*row] as f64).sum::<f64>() / n);
                    layout.bins.push((signal, rows));
                }
            }
        }
        layout
    }

    /// Number of bins.
    pub(super) fn len(&self) -> usize {
        self.bins.len()
    }

    /// Puts the change of each bin's mean per unit into a column: `moved` are the rows with a value moved by `by`.
    pub(super) fn column(&self, base: &[Row], moved: &[Row], by: f64, into: &mut DMatrix<f64>, place: usize) {
        for (bin, (signal, rows)) in self.bins.iter().enumerate() {
            let sum: f64 = rows.iter().map(|row| moved[*row][*signal] - base[*row][*signal]).sum();
            into[(bin, place)] = sum / (rows.len() as f64 * by);
        }
    }

    /// Residuals of the bins beside simulated rows, without columns.
    pub(super) fn cell(&self, cut: &PlantCut, window: &Window, base: &[Row]) -> Cell {
        let empty = || DMatrix::zeros(self.len(), 0);
        let mut cell = Cell {
            residual: Vec::new(),
            sigma: Vec::new(),
            signal: Vec::new(),
            time: Vec::new(),
            hard: empty(),
            soft: empty(),
            discrepancy: 0,
            inertia_scale: cut.inertia_scale,
            columns: empty(),
            floor: Vec::new(),
            state: Vec::new(),
            lattice: Vec::new(),
            drawn: Vec::new(),
        };
        let Some(log) = cut.runs[window.run].plant.as_ref() else { return cell };
        for ((signal, rows), repeats) in self.bins.iter().zip(&self.repeats) {
            let values = log.column(COLUMNS[*signal]).unwrap_or(&[]);
            let n = rows.len() as f64;
            let residual: f64 = rows.iter().map(|row| values[window.rows[*row]] - base[*row][*signal]).sum();
            let time: f64 = rows.iter().map(|row| log.time[window.rows[*row]]).sum();
            cell.residual.push(residual / n);
            cell.sigma.push(cut.signals[*signal].sigma / n.sqrt() * repeats.sqrt());
            cell.signal.push(*signal);
            cell.time.push(time / n);
        }
        cell
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_rows_that_repeat_a_value_count_as_one() {
        assert_eq!(repeats(&[0.1, 0.2, 0.2, 0.2, 0.1, f64::NAN, f64::NAN]), [1, 3, 3, 3, 1, 1, 1]);
        // ten rows of one value are known no better than one of them
        let ten = repeats(&[0.3; 10]);
        let mean = ten.iter().sum::<usize>() as f64 / 10.0;
        assert_eq!((mean / 10.0_f64).sqrt(), 1.0);
    }
}
