//! Which terms, and how large: forward selection, each term judged on runs that were left out.

use super::dictionary::Entry;
use crate::rigs::acrobot::correction::policy::CORRECTION;
use crate::rigs::acrobot::residual::torque::{Torque, rms, torques};
use crate::rigs::acrobot::residual::{Block, Perturbation, Signal};
use crate::rigs::acrobot::selection::{Evaluation, Folds, discrepancies};
use crate::statistics::linear::{moved, solve, submatrix, subvector};
use nalgebra::{DMatrix, DVector};

/// Chosen terms with their size.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// Entry, coefficient and its standard deviation.
    pub terms: Vec<(usize, f64, f64)>,
    /// Residual before, after (on runs left out), and what noise alone gives, N·m.
    pub gap: (f64, f64, f64),
    /// What is left of torques of a usual size, as gaps of effects are measured, N·m.
    pub usual: f64,
    /// What was left out.
    pub folds: Folds,
    /// For each block what is left on both links on runs left out: run, from, to, N·m.
    pub left: Vec<(usize, f64, f64, [f64; 2])>,
}

/// The residual that the terms are chosen against.
struct Residual<'a> {
    evaluation: Evaluation,
    folds: Folds,
    entries: &'a [Entry],
    /// Its first size, N·m.
    first: f64,
}

/// Fits terms to blocks whose columns are those of the entries.
pub fn fit(blocks: Vec<Block>, signals: &[Signal], entries: &[Entry]) -> Fitted {
    let perturbations: Vec<Perturbation> =
        (0..entries.len()).map(|candidate| Perturbation { candidate, by: 1.0 }).collect();
    let folds = Folds::new(&blocks);
    let evaluation = Evaluation::of(blocks, &vec![0.0; entries.len()], &perturbations, signals);
    let mut residual = Residual { evaluation, folds, entries, first: 0.0 };
    residual.sharpen(&[], signals);
    let (before, floor) = residual.size(&[]);
    residual.first = before;
    let mut active: Vec<usize> = Vec::new();
    let mut now = before;
    loop {
        let supported = residual.ranked(&active).into_iter().find_map(|more| {
            let with = residual.size(&more).0;
            (residual.worth(now, with, floor) && residual.certain(&more)).then_some((more, with))
        });
        let Some((more, _)) = supported else { break };
        active = more;
        residual.sharpen(&active, signals);
        now = residual.size(&active).0;
    }
    residual.drop_needless(&mut active, &mut now, floor);
    let values = residual.values(&active);
    let errors = residual.errors(&active);
    let terms =
        active.iter().enumerate().map(|(place, entry)| (*entry, values[place], errors[place])).collect();
    let torques = residual.left(&active);
    Fitted {
        terms,
        gap: (before, now, floor),
        usual: rms(&torques).0,
        folds: residual.folds.clone(),
        left: residual.over_time(&torques),
    }
}

impl Residual<'_> {
    /// What is left on runs left out.
    fn left(&self, active: &[usize]) -> Vec<Torque> {
        let shifts = self.evaluation.shifts(&self.folds, active);
        let places = self.evaluation.places(active);
        let mut all = torques(&self.evaluation.blocks, &places, &shifts, &self.folds.of);
        all.retain(|torque| torque.torque.iter().chain(&torque.floor).all(|x| x.is_finite()));
        all
    }

    /// Mean of each block, with its run and time.
    fn over_time(&self, torques: &[Torque]) -> Vec<(usize, f64, f64, [f64; 2])> {
        let blocks = self.evaluation.blocks.iter().enumerate();
        blocks
            .map(|(index, block)| {
                let own: Vec<&Torque> = torques.iter().filter(|t| t.block == index).collect();
                let mean =
                    |link: usize| own.iter().map(|t| t.torque[link]).sum::<f64>() / own.len().max(1) as f64;
                (block.run, block.from, block.to, [mean(0), mean(1)])
            })
            .collect()
    }

    /// Its size, and that of noise alone, N·m.
    fn size(&self, active: &[usize]) -> (f64, f64) {
        let all = self.left(active);
        let mean = |of: &dyn Fn(&Torque) -> [f64; 2]| {
            let sum: f64 = all.iter().flat_map(of).map(|x| x * x).sum();
            (sum / (2 * all.len()).max(1) as f64).sqrt()
        };
        (mean(&|torque| torque.torque), mean(&|torque| torque.floor))
    }

    /// The terms with one more, those first that help runs left out most; only such that do.
    fn ranked(&self, active: &[usize]) -> Vec<Vec<usize>> {
        let taken = |entry: usize| {
            active.iter().any(|other| self.entries[*other].coefficient == self.entries[entry].coefficient)
        };
        let now = self.evaluation.held_out(&self.folds, active);
        let mut all: Vec<(f64, Vec<usize>)> = (0..self.entries.len())
            .filter(|entry| !taken(*entry) && self.excited(*entry))
            .map(|entry| active.iter().copied().chain([entry]).collect::<Vec<usize>>())
            .map(|more| (self.evaluation.held_out(&self.folds, &more), more))
            .filter(|(square, _)| *square < now)
            .collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.into_iter().map(|(_, more)| more).collect()
    }

    /// A fair part of what is left goes, and more than is inexact.
    fn worth(&self, now: f64, with: f64, floor: f64) -> bool {
        let gain = now * now - with * with;
        let least = (CORRECTION.exact * self.first).powi(2);
        gain >= f64::max(CORRECTION.worth * (now * now - floor * floor), least) && with < now
    }

    fn excited(&self, entry: usize) -> bool {
        let size = self.evaluation.total.gram[(entry, entry)];
        size.is_finite() && size > 0.0
    }

    /// Values of the coefficients.
    fn values(&self, active: &[usize]) -> DVector<f64> {
        let total = &self.evaluation.total;
        let places = self.evaluation.places(active);
        solve(&submatrix(&total.gram, &places), &subvector(&total.score, &places))
            .unwrap_or_else(|| DVector::zeros(places.len()))
    }

    /// Standard errors of the coefficients.
    fn errors(&self, active: &[usize]) -> Vec<f64> {
        let covariance = self.evaluation.covariance(active);
        (0..active.len())
            .map(|place| covariance.as_ref().map_or(f64::INFINITY, |c| c[(place, place)].max(0.0).sqrt()))
            .collect()
    }

    /// Every one of them is certain beside the others.
    fn certain(&self, active: &[usize]) -> bool {
        let (values, errors) = (self.values(active), self.errors(active));
        values.iter().zip(&errors).all(|(value, error)| value.abs() > CORRECTION.certain * error)
    }

    /// Noise and size of what is lacking as they show once the terms are there: large residuals weigh rows too alike.
    fn sharpen(&mut self, active: &[usize], signals: &[Signal]) {
        let (places, values) = (self.evaluation.places(active), self.values(active));
        let mut blocks = self.evaluation.blocks.clone();
        for cell in blocks.iter_mut().flat_map(|block| &mut block.cells) {
            cell.residual = moved(cell, &places, Some(&values));
            cell.columns = DMatrix::zeros(cell.residual.len(), 0);
        }
        let mut sharper = Evaluation::of(blocks, &[], &[], signals);
        // what is lacking within a window would count as noise where the noise is not stated
        for (sigma, signal) in sharper.sigmas.iter_mut().zip(signals) {
            *sigma = signal.known.unwrap_or(*sigma);
        }
        let size = |discrepancy_sd: f64| Evaluation { discrepancy_sd, ..sharper.clone() };
        let likely = |discrepancy_sd: f64| sharper.under(&size(discrepancy_sd)).deviance();
        let inertia_scale = sharper.inertia_scale();
        let sizes = std::iter::once(0.0).chain(discrepancies(inertia_scale));
        let best = sizes.map(|size| (likely(size), size)).min_by(|a, b| a.0.total_cmp(&b.0));
        self.evaluation = self.evaluation.under(&size(best.map_or(0.0, |(_, size)| size)));
    }

    /// Takes out terms that later ones made superfluous.
    fn drop_needless(&self, active: &mut Vec<usize>, now: &mut f64, floor: f64) {
        while active.len() > 1 {
            let least = (0..active.len())
                .map(|place| {
                    let mut fewer = active.clone();
                    fewer.remove(place);
                    (self.size(&fewer).0, place)
                })
                .min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((without, place)) = least else { return };
            if self.worth(without, *now, floor) {
                return;
            }
            active.remove(place);
            *now = without;
        }
    }
}
