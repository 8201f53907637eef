//! The tolerance of renderers, and what that makes uncertain: an error of `Signal::tolerance` for all rows of a signal at one place
//! on the pixel lattice.

use super::evaluation::Evaluation;
use crate::rigs::acrobot::channels::Measures;
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::residual::image::IMAGES;
use crate::rigs::acrobot::residual::studio::AREAS;
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
        self.variances(active, &self.offsets(signals))
    }

    /// The same in another light, in which all areas are `larger` alike, px: what would make them so moves rims, too, and by how much at which
    /// place on the lattice nobody knows.
    pub fn systematic_unlit(&self, active: &[usize], signals: &[Signal], larger: f64) -> DVector<f64> {
        let elsewhere = |signal: &Signal| match signal.measures {
            Measures::Centroid => Signal { tolerance: IMAGES.unlit_place, ..signal.clone() },
            _ => signal.clone(),
        };
        let signals: Vec<Signal> = signals.iter().map(elsewhere).collect();
        let mut alike = DVector::zeros(self.perturbations.len());
        for cell in self.blocks.iter().flat_map(|block| &block.cells) {
            let columns = projected(cell, self.discrepancy_sd).columns;
            for row in (0..cell.signal.len()).filter(|row| AREAS.contains(&cell.signal[*row])) {
                alike.axpy(larger / cell.sigma[row], &columns.row(row).transpose(), 1.0);
            }
        }
        self.variances(active, &self.offsets(&signals))
            + self.variances(active, &DMatrix::from_columns(&[alike]))
    }

    /// Variance of each of the active values by errors, of which the columns of `offsets` are one each.
    fn variances(&self, active: &[usize], offsets: &DMatrix<f64>) -> DVector<f64> {
        let places = self.places(active);
        let Some(bread) = inverse(&submatrix(&self.total.gram, &places)) else {
            return DVector::zeros(places.len());
        };
        let shifts = bread * offsets.select_rows(&places);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::residual::studio::COLUMNS;
    use crate::rigs::acrobot::residual::{Block, Perturbation};
    use crate::statistics::linear::Cell;

    fn signals() -> Vec<Signal> {
        let signal = |(place, name): (usize, &&str)| Signal {
            name: (*name).to_owned(),
            unit: "px",
            measures: if AREAS.contains(&place) { Measures::Area } else { Measures::Centroid },
            known: None,
            sigma: 1.0,
            least: 0.0,
            tolerance: 0.006,
        };
        COLUMNS.iter().enumerate().map(signal).collect()
    }

    /// A frame each at four places on the lattice: the first column makes areas larger by 2 px, the second moves centroids by 1 px.
    fn frames() -> Evaluation {
        let cell = |place: usize| Cell {
            residual: vec![0.0; AREAS.end],
            sigma: vec![1.0; AREAS.end],
            signal: (0..AREAS.end).collect(),
            time: vec![place as f64; AREAS.end],
            hard: DMatrix::zeros(AREAS.end, 0),
            soft: DMatrix::zeros(AREAS.end, 0),
            discrepancy: 0,
            inertia_scale: 1.0,
            columns: DMatrix::from_fn(AREAS.end, 2, |s, own| match (AREAS.contains(&s), own) {
                (true, 0) => 2.0,
                (false, 1) => 1.0,
                _ => 0.0,
            }),
            floor: Vec::new(),
            state: Vec::new(),
            lattice: vec![place; AREAS.end],
            drawn: Vec::new(),
        };
        let block = Block { run: 0, from: 0.0, to: 4.0, cells: (0..4).map(cell).collect(), state: [0.0; 4] };
        let perturbations = [0, 1].map(|candidate| Perturbation { candidate, by: 0.01 });
        Evaluation::of(vec![block], &[0.0; 2], &perturbations, &signals())
    }

    #[test]
    fn value_another_light_may_be_all_that_makes_areas_larger() {
        let at = frames();
        let sd =
            |variances: DVector<f64>| variances.iter().map(|variance| variance.sqrt()).collect::<Vec<_>>();
        let [nominal, unlit] =
            [at.systematic(&[0, 1], &signals()), at.systematic_unlit(&[0, 1], &signals(), -1.2)].map(sd);
        // 1.2 px of 2 a unit, each at all places; 0.03 px, and 0.006 in the nominal light, each in one of 24 rows
        assert!((unlit[0] - 0.6).abs() < 1e-3, "{unlit:?}");
        let one = |own: f64| own / 24_f64.sqrt();
        assert!(
            (unlit[1] - one(0.03)).abs() < 1e-6 && (nominal[1] - one(0.006)).abs() < 1e-6,
            "{unlit:?} {nominal:?}"
        );
    }
}
