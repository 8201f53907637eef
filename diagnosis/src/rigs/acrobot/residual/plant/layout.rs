//! Which simulated row goes into which bin of a window.

use super::*;
use crate::rigs::acrobot::residual::plant::policy::WINDOWS;

/// Which simulated row goes into which bin.
pub(super) struct Layout {
    /// Signal, rows (index among the wanted ones).
    pub(super) bins: Vec<(usize, Vec<usize>)>,
}

impl Layout {
    pub(super) fn of(cut: &PlantCut, window: &Window) -> Self {
        let mut bins = Vec::new();
        let Some(log) = cut.runs[window.run].plant.as_ref() else { return Self { bins } };
        let size = window.rows.len().div_ceil(WINDOWS.bins);
        for (signal, name) in COLUMNS.iter().enumerate() {
            let Some(values) = log.column(name) else { continue };
            for chunk in (0..window.rows.len()).collect::<Vec<_>>().chunks(size) {
                // what arrives as a log begins is of commands before it
                let settled = |place: usize| signal < MOTION || place > 0 || !window.drive.begins_wanted();
                let tells = |place: &usize| values[window.rows[*place]].is_finite() && settled(*place);
                let rows: Vec<usize> = chunk.iter().copied().filter(tells).collect();
                if !rows.is_empty() {
                    bins.push((signal, rows));
                }
            }
        }
        Self { bins }
    }

    pub(super) fn len(&self) -> usize {
        self.bins.len()
    }

    pub(super) fn column(&self, base: &[Row], moved: &[Row], by: f64, into: &mut DMatrix<f64>, place: usize) {
        for (bin, (signal, rows)) in self.bins.iter().enumerate() {
            let sum: f64 = rows.iter().map(|row| moved[*row][*signal] - base[*row][*signal]).sum();
            into[(bin, place)] = sum / (rows.len() as f64 * by);
        }
    }

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
        };
        let Some(log) = cut.runs[window.run].plant.as_ref() else { return cell };
        for (signal, rows) in &self.bins {
            let values = log.column(COLUMNS[*signal]).unwrap_or(&[]);
            let n = rows.len() as f64;
            let residual: f64 = rows.iter().map(|row| values[window.rows[*row]] - base[*row][*signal]).sum();
            let time: f64 = rows.iter().map(|row| log.time[window.rows[*row]]).sum();
            cell.residual.push(residual / n);
            cell.sigma.push(cut.signals[*signal].sigma / n.sqrt());
            cell.signal.push(*signal);
            cell.time.push(time / n);
        }
        cell
    }
}
