//! A model (values of the candidates) judged on one cut: residuals, noise, what is left, how it does on runs that
//! were left out.

use super::folds::Folds;
use crate::error::Error;
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::channels::Measures;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::{Block, Perturbation, Signal, Tracked};
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::statistics::levels::FINE;
use crate::statistics::linear::{Cell, Reduced, Sized, bare, solve, submatrix, subvector};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// A point, judged.
#[derive(Debug, Clone)]
pub struct Evaluation {
    /// Coordinates of all candidates.
    pub point: Vec<f64>,
    /// What the columns are.
    pub perturbations: Vec<Perturbation>,
    /// Residuals and columns.
    pub blocks: Vec<Block>,
    /// Blocks with nuisances projected out.
    pub reduced: Vec<Reduced>,
    /// Their sum.
    pub total: Reduced,
    /// Size of the discrepancy that is taken to be there, in the cut's own unit.
    pub discrepancy_sd: f64,
    /// Standard deviation of each signal in use.
    pub sigmas: Vec<f64>,
    /// Standard deviation of each signal as it shows in this data after the nuisances.
    pub seen: Vec<f64>,
}

impl Evaluation {
    /// Linearises at a point, from where the last linearisation had the nuisances, and judges it.
    ///
    /// # Errors
    /// A unit failed.
    pub fn at(cut: &mut Tracked, point: &[f64], perturbations: &[Perturbation]) -> Result<Self, Error> {
        let blocks = cut.linearise_anew(point, perturbations)?;
        Ok(Self::of(blocks, point, perturbations, cut.signals()))
    }

    /// Judges a point by a chord step.
    ///
    /// # Errors
    /// A unit failed.
    pub fn chord(cut: &mut Tracked, point: &[f64], perturbations: &[Perturbation]) -> Result<Self, Error> {
        let blocks = cut.chord(point, perturbations)?;
        Ok(Self::of(blocks, point, perturbations, cut.signals()))
    }

    /// Judges residuals that are there already.
    pub fn of(
        mut blocks: Vec<Block>,
        point: &[f64],
        perturbations: &[Perturbation],
        signals: &[Signal],
    ) -> Self {
        let mut sigmas: Vec<f64> = signals.iter().map(|signal| signal.sigma).collect();
        let mut seen = sigmas.clone();
        // two signals share nuisances, so that the estimate of one depends on the other's: settles in a few rounds
        for _ in 0..3 {
            seen = scatter(&blocks, &sigmas, signals);
            let wanted: Vec<f64> = signals
                .iter()
                .zip(&seen)
                .map(|(signal, seen)| match signal.known {
                    Some(known) => seen.max(known).max(signal.least),
                    None => seen.max(signal.least),
                })
                .collect();
            let moved = |(before, after): (&f64, &f64)| (after / before - 1.0).abs() > FINE;
            let done = !sigmas.iter().zip(&wanted).any(moved);
            rescale(&mut blocks, &sigmas, &wanted);
            sigmas = wanted;
            if done {
                break;
            }
        }
        let discrepancy_sd = likely_size(&blocks);
        let mut evaluation = Self {
            point: point.to_vec(),
            perturbations: perturbations.to_vec(),
            blocks,
            reduced: Vec::new(),
            total: Reduced::zero(perturbations.len()),
            discrepancy_sd,
            sigmas,
            seen,
        };
        evaluation.reduce();
        evaluation
    }

    /// These residuals under the noise and the size of discrepancy of another evaluation.
    pub fn under(&self, other: &Evaluation) -> Self {
        let mut same = self.clone();
        rescale(&mut same.blocks, &self.sigmas, &other.sigmas);
        same.sigmas.clone_from(&other.sigmas);
        same.discrepancy_sd = other.discrepancy_sd;
        same.reduce();
        same
    }

    /// These residuals under the given noise of each signal.
    pub fn with(&self, noise: &[f64]) -> Self {
        let mut same = self.clone();
        rescale(&mut same.blocks, &self.sigmas, noise);
        same.sigmas = noise.to_vec();
        same.reduce();
        same
    }

    /// The same residuals, with other columns for each cell.
    pub fn with_columns(
        &self,
        perturbations: Vec<Perturbation>,
        columns: impl Fn(&Cell) -> DMatrix<f64>,
    ) -> Self {
        let cells = |block: &Block| block.cells.iter().map(|cell| cell.with_columns(columns(cell))).collect();
        let blocks = self.blocks.iter().map(|block| Block { cells: cells(block), ..*block }).collect();
        let mut same = Self {
            point: self.point.clone(),
            perturbations,
            blocks,
            reduced: Vec::new(),
            total: Reduced::zero(0),
            discrepancy_sd: self.discrepancy_sd,
            sigmas: self.sigmas.clone(),
            seen: self.seen.clone(),
        };
        same.reduce();
        same
    }

    /// The same residuals without a discrepancy.
    pub fn hard(&self) -> Self {
        let mut same = Self { discrepancy_sd: 0.0, ..self.clone() };
        same.reduce();
        same
    }

    /// Projects nuisances and discrepancy out of each block, and sums up.
    fn reduce(&mut self) {
        let discrepancy_sd = self.discrepancy_sd;
        let p = self.perturbations.len();
        self.reduced = self
            .blocks
            .par_iter()
            .map(|block| {
                let mut sum = Reduced::zero(p);
                block.cells.iter().for_each(|cell| sum.add_cell(cell, discrepancy_sd));
                sum
            })
            .collect();
        self.total = Reduced::zero(p);
        for reduced in &self.reduced {
            self.total.add(reduced);
        }
    }

    /// What sizes of the discrepancy are counted in.
    pub fn inertia_scale(&self) -> f64 {
        inertia_scale(&self.blocks)
    }

    /// -2 log likelihood, up to a constant, with noise and discrepancy at their most likely.
    pub fn deviance(&self) -> f64 {
        self.total.square + self.total.log_det
    }

    /// Places of the columns that belong to some candidates (the first column of each).
    pub fn places(&self, candidates: &[usize]) -> Vec<usize> {
        candidates
            .iter()
            .filter_map(|c| self.perturbations.iter().position(|perturbation| perturbation.candidate == *c))
            .collect()
    }

    /// Whether a small step of an active value changes anything.
    pub fn shows(&self, candidate: usize) -> bool {
        self.places(&[candidate]).iter().all(|place| self.total.gram[(*place, *place)] > 0.0)
    }

    /// The decrease of the deviance that a straight step of some active values predicts.
    pub fn predicted_decrease(&self, free: &[usize]) -> Option<f64> {
        let places = self.places(free);
        let score = subvector(&self.total.score, &places);
        let shift = solve(&submatrix(&self.total.gram, &places), &score)?;
        (places.len() == free.len()).then(|| shift.dot(&score))
    }

    /// Held-out squares: each fold judged with the active values that the other folds want (one Newton step).
    pub fn held_out(&self, folds: &Folds, active: &[usize]) -> f64 {
        self.shifts(folds, active)
            .iter()
            .enumerate()
            .map(|(fold, shift)| {
                let part = self.fold(folds, fold);
                let places = self.places(active);
                let gram = submatrix(&part.gram, &places);
                let score = subvector(&part.score, &places);
                part.square - 2.0 * shift.dot(&score) + shift.dot(&(gram * shift))
            })
            .sum()
    }

    /// How far a Newton step would still move the coordinates of the active candidates.
    pub fn newton_step(&self, active: &[usize]) -> Option<DVector<f64>> {
        let places = self.places(active);
        solve(&submatrix(&self.total.gram, &places), &subvector(&self.total.score, &places))
    }

    /// How far the active values move when a fold is left out.
    pub fn shifts(&self, folds: &Folds, active: &[usize]) -> Vec<DVector<f64>> {
        let places = self.places(active);
        (0..folds.count)
            .map(|fold| {
                let mut rest = self.total.clone();
                rest.subtract(&self.fold(folds, fold));
                let gram = submatrix(&rest.gram, &places);
                solve(&gram, &subvector(&rest.score, &places)).unwrap_or_else(|| DVector::zeros(places.len()))
            })
            .collect()
    }

    /// Sum over the blocks of one fold.
    fn fold(&self, folds: &Folds, fold: usize) -> Reduced {
        let mut sum = Reduced::zero(self.perturbations.len());
        for (reduced, of) in self.reduced.iter().zip(&folds.of) {
            if *of == fold {
                sum.add(reduced);
            }
        }
        sum
    }

    /// Covariance of the active values: the sandwich over blocks, never smaller than the model's own.
    pub fn covariance(&self, active: &[usize]) -> Option<DMatrix<f64>> {
        let places = self.places(active);
        let gram = submatrix(&self.total.gram, &places);
        let bread = crate::statistics::linear::inverse(&gram)?;
        // no scatter is left of as many blocks as values
        if self.reduced.len() <= places.len() {
            return Some(bread);
        }
        let shift = &bread * subvector(&self.total.score, &places);
        let mut meat = DMatrix::zeros(places.len(), places.len());
        for reduced in &self.reduced {
            let score = subvector(&reduced.score, &places) - submatrix(&reduced.gram, &places) * &shift;
            meat += &score * score.transpose();
        }
        let blocks = self.reduced.len() as f64;
        meat *= blocks / (blocks - places.len() as f64).max(1.0);
        let sandwich = &bread * meat * &bread;
        let mut covariance = sandwich.clone();
        for i in 0..places.len() {
            // few blocks make the sandwich too small by chance; the other off-diagonals keep their correlation
            let factor = (bread[(i, i)] / sandwich[(i, i)]).max(1.0).sqrt();
            for j in 0..places.len() {
                covariance[(i, j)] *= factor;
                covariance[(j, i)] *= factor;
            }
        }
        Some(covariance)
    }
}

/// Standard deviation of each signal after start states and free discrepancy. A few blocks that the model can't follow at all
/// say nothing of noise.
fn scatter(blocks: &[Block], sigmas: &[f64], signals: &[Signal]) -> Vec<f64> {
    let count = sigmas.len();
    let pixels = |measures| matches!(measures, Measures::Centroid | Measures::Area);
    let each: Vec<Vec<(f64, f64)>> = blocks
        .par_iter()
        .map(|block| {
            let mut sums = vec![(0.0, 0.0); count];
            for cell in &block.cells {
                let left = bare(cell, &cell.residual, cell.free());
                for (row, signal) in cell.signal.iter().enumerate() {
                    sums[*signal].0 += left.residual[row] * left.residual[row];
                    sums[*signal].1 += left.expected[row];
                }
            }
            sums
        })
        .collect();
    (0..count)
        .map(|s| {
            let mut ratios: Vec<f64> =
                each.iter().filter(|sums| sums[s].1 > 1.0).map(|sums| sums[s].0 / sums[s].1).collect();
            ratios.sort_by(f64::total_cmp);
            let most = match ratios.get(ratios.len() / 2) {
                Some(median) if !pixels(signals[s].measures) => POLICY.wild * median,
                // areas in whole pixels may not scatter at all in most blocks
                _ => f64::INFINITY,
            };
            let sum: f64 = each.iter().map(|sums| sums[s].0.min(most * sums[s].1)).sum();
            let freedom: f64 = each.iter().map(|sums| sums[s].1).sum();
            if freedom > 3.0 { sigmas[s] * (sum / freedom).sqrt().max(1e-6) } else { sigmas[s] }
        })
        .collect()
}

/// Puts other standard deviations of the signals in the place of those that rows were weighted by.
fn rescale(blocks: &mut [Block], from: &[f64], to: &[f64]) {
    for cell in blocks.iter_mut().flat_map(|block| &mut block.cells) {
        for (sigma, signal) in cell.sigma.iter_mut().zip(&cell.signal) {
            *sigma *= to[*signal] / from[*signal];
        }
    }
}

/// What sizes of the discrepancy are counted in.
fn inertia_scale(blocks: &[Block]) -> f64 {
    let mut cells = blocks.iter().flat_map(|block| &block.cells);
    cells.find(|cell| cell.soft.ncols() > cell.discrepancy).map_or(1.0, |cell| cell.inertia_scale)
}

/// Sizes of the discrepancy among which the most likely is taken, each twice the one before, for cells of this inertia scale.
pub fn discrepancies(inertia_scale: f64) -> impl Iterator<Item = f64> {
    (0..SELECTION.sizes).map(move |power| SELECTION.smallest * inertia_scale * f64::from(1_u32 << power))
}

/// The most likely size of the discrepancy (restricted maximum likelihood over a grid).
fn likely_size(blocks: &[Block]) -> f64 {
    let cells: Vec<&Cell> = blocks.iter().flat_map(|block| &block.cells).collect();
    if cells.iter().all(|cell| cell.soft.ncols() <= cell.discrepancy) {
        return 0.0;
    }
    let sizes: Vec<f64> = discrepancies(inertia_scale(blocks)).collect();
    let sized: Vec<Sized> = cells.par_iter().map(|cell| Sized::of(cell)).collect();
    let deviance = |size: f64| -> f64 { sized.iter().map(|cell| cell.deviance(size)).sum() };
    let mut best = (deviance(0.0), 0.0);
    // every other one first, then the neighbours of the best
    for size in sizes.into_iter().step_by(2) {
        let here = deviance(size);
        if here < best.0 {
            best = (here, size);
        }
    }
    if best.1 > 0.0 {
        for size in [0.5 * best.1, 2.0 * best.1] {
            let here = deviance(size);
            if here < best.0 {
                best = (here, size);
            }
        }
    }
    best.1
}

/// Columns for a linearisation with everything: each candidate's steps, and a derivative for the active ones first.
pub fn all_perturbations(
    candidates: &[Candidate],
    point: &[f64],
    sees: &dyn Fn(&Candidate) -> bool,
    active: &[usize],
) -> Vec<Perturbation> {
    let mut perturbations = Vec::new();
    for (index, candidate) in candidates.iter().enumerate().filter(|(_, candidate)| sees(candidate)) {
        if active.contains(&index) {
            if !candidate.is_discrete() {
                perturbations
                    .push(Perturbation { candidate: index, by: candidate.derivative_step(point[index]) });
            }
            // all of it taken away again: what it does as a whole
            if candidate.nonlinear && !candidate.is_discrete() && point[index] != candidate.off {
                perturbations.push(Perturbation { candidate: index, by: candidate.off - point[index] });
            }
            continue;
        }
        for step in &candidate.steps {
            let at = point[index] + step;
            let by = if at > candidate.range.1 || at < candidate.range.0 { -step } else { *step };
            perturbations.push(Perturbation { candidate: index, by });
        }
    }
    perturbations
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::selection::examples::block;

    #[test]
    fn value_sizes_of_a_discrepancy_reach_from_a_tenth_of_a_millinewtonmetre_to_six_newtonmetres() {
        // 2e-4 times powers of two up to 2^14, and one to either side
        let sizes = [0.0, 1e-5, 0.1, 100.0].map(|residual| likely_size(&[block(residual, 1e-7)]));
        assert_eq!(sizes, [0.0, 1e-4, 0.1024, 6.5536]);
    }
}
