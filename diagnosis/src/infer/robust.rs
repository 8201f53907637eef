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

#[cfg(test)]
mod tests {
    use super::super::linearised::Measured;
    use super::*;
    use crate::statistics::random::Random;

    /// Standard deviation of an offset by these residuals with noise of one, in units of what white noise leaves.
    fn times(residuals: &[f64]) -> f64 {
        let rows = residuals.len();
        let run = Linearised {
            states: 1,
            parameters: 1,
            time: (0..rows).map(|row| row as f64).collect(),
            transition: vec![0.0; rows - 1],
            drive: vec![0.0; rows - 1],
            defect: vec![0.0; rows - 1],
            first: (0..=rows).collect(),
            measured: (0..rows)
                .map(|row| Measured {
                    channel: 0,
                    time: row as f64,
                    residual: residuals[row],
                    slope: 0.0,
                    weight: 1.0,
                })
                .collect(),
            observe: vec![0.0; rows],
            direct: vec![1.0; rows],
            start: (vec![0.0], vec![1.0]),
            ..Linearised::default()
        };
        let noise = Noise { channels: vec![1.0], process: vec![0.0], jitter: 0.0, disturbance: None };
        let covariance = sandwich(&[run], &noise, &[0]).expect("it tells of an offset");
        (covariance[(0, 0)] * rows as f64).sqrt()
    }

    #[test]
    fn value_stretches_are_enough_to_know_a_deviation_and_long_enough_to_forget() {
        let mut random = Random::new(3);
        // white: thirty squares tell a deviation to an eighth, ten only to a fifth
        let off = (0..20).map(|_| times(&(0..600).map(|_| random.normal()).collect::<Vec<_>>()) - 1.0);
        let off = (off.map(|off| off * off).sum::<f64>() / 20.0).sqrt();
        // itself known to a sixth from twenty sets
        assert!((0.08..0.18).contains(&off), "{off}");
        // residuals that are the same for twenty rows tell as much as thirty values of six hundred
        let mut value = 0.0;
        let mut held = || {
            let course = (0..600).map(|row| {
                value = if row % 20 == 0 { random.normal() } else { value };
                value
            });
            times(&course.collect::<Vec<_>>())
        };
        let mean = (0..20).map(|_| held()).sum::<f64>() / 20.0;
        // of a mean of twenty, each to an eighth
        assert!((mean / 20f64.sqrt() - 1.0).abs() < 0.125, "{mean}");
    }
}
