//! Covariance of the parameters that holds where the noises' form is wrong: from how far stretches of the log disagree.
//!
//! With the score g_j of each stretch at the fitted parameters and the Gram matrix Γ, Γ⁻¹ (Σ g_j g_jᵀ) Γ⁻¹ is Γ⁻¹ where the
//! innovations are white and as large as their variances say, and more where single stretches pull hard.
//! White, Econometrica 50 (1982) 1.

use super::linearised::Linearised;
use super::noise::Noise;
use super::policy::INFER;
use super::sweep::sweep_scores;
use crate::statistics::linear::inverse;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// The covariance of parameters by their columns; nothing where the data say nothing of one.
pub fn sandwich(runs: &[Linearised], noise: &Noise, columns: &[usize]) -> Option<DMatrix<f64>> {
    let p = columns.len();
    let each = INFER.stretches.div_ceil(runs.len().max(1)).max(2);
    let swept: Vec<_> = runs.par_iter().map(|run| sweep_scores(run, noise, columns)).collect();
    let mut gram = DMatrix::zeros(p, p);
    let mut meat = DMatrix::zeros(p, p);
    let mut whole = DVector::zeros(p);
    let mut count = 0.0;
    for (reduced, scores) in &swept {
        gram += &reduced.gram;
        let rows = scores.len() / p.max(1);
        let at = |row: usize| DVector::from_column_slice(&scores[row * p..(row + 1) * p]);
        let mut last = DVector::zeros(p);
        for stretch in 1..=each.min(rows) {
            let to = at(stretch * rows / each.min(rows) - 1);
            let own = &to - &last;
            meat += &own * own.transpose();
            whole += own;
            last = to;
            count += 1.0;
        }
    }
    // the fit is where the scores sum to 0, but for what a range or the end of the fit leaves
    if count > 1.0 {
        meat = (meat - &whole * whole.transpose() / count) * (count / (count - 1.0));
    }
    let inverse = inverse(&gram)?;
    Some(&inverse * meat * &inverse)
}
