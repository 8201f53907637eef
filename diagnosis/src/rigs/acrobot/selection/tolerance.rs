//! The tolerance of renderers, and what that makes uncertain: an error of `Signal::tolerance` for all rows of a signal at one place
//! on the pixel lattice.

use super::evaluation::Evaluation;
use crate::rigs::acrobot::residual::Signal;
use crate::statistics::linear::{inverse, projected, solve, submatrix};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

impl Evaluation {
    /// How each column answers to each such error (perturbations by errors).
    pub fn offsets(&self, signals: &[Signal]) -> DMatrix<f64> {
        let mut errors: BTreeMap<(usize, usize), DVector<f64>> = BTreeMap::new();
        for cell in self.blocks.iter().flat_map(|block| &block.cells).filter(|cell| !cell.lattice.is_empty())
        {
            let columns = projected(cell, self.discrepancy_sd).columns;
            for (row, (signal, place)) in cell.signal.iter().zip(&cell.lattice).enumerate() {
                let sum = errors
                    .entry((*signal, *place))
                    .or_insert_with(|| DVector::zeros(self.perturbations.len()));
                sum.axpy(signals[*signal].tolerance / cell.sigma[row], &columns.row(row).transpose(), 1.0);
            }
        }
        let all: Vec<DVector<f64>> = errors.into_values().collect();
        if all.is_empty() { DMatrix::zeros(self.perturbations.len(), 0) } else { DMatrix::from_columns(&all) }
    }

    /// Variance that systematic differences between simulations add to each of the active values.
    pub fn systematic(&self, active: &[usize], signals: &[Signal]) -> DVector<f64> {
        let places = self.places(active);
        let Some(bread) = inverse(&submatrix(&self.total.gram, &places)) else {
            return DVector::zeros(places.len());
        };
        let shifts = bread * self.offsets(signals).select_rows(&places);
        DVector::from_fn(places.len(), |i, _| shifts.row(i).norm_squared())
    }

    /// Standard deviation that systematic differences add to the value of each column, fitted beside the active ones.
    pub fn systematic_beside(&self, active: &[usize], signals: &[Signal]) -> Vec<f64> {
        let (places, offsets, gram) = (self.places(active), self.offsets(signals), &self.total.gram);
        let among = submatrix(gram, &places);
        let own = |column: usize| {
            let rest: Vec<usize> = places.iter().copied().filter(|place| *place != column).collect();
            let across = DVector::from_fn(rest.len(), |i, _| gram[(rest[i], column)]);
            let inner = if rest.len() == places.len() { among.clone() } else { submatrix(gram, &rest) };
            let weights = if rest.is_empty() { Some(DVector::zeros(0)) } else { solve(&inner, &across) };
            let weights = weights.unwrap_or_else(|| DVector::zeros(rest.len()));
            let length = gram[(column, column)] - weights.dot(&across);
            let off = offsets.row(column) - weights.transpose() * offsets.select_rows(&rest);
            if length > 0.0 { off.norm() / length } else { 0.0 }
        };
        (0..self.perturbations.len()).map(own).collect()
    }
}
