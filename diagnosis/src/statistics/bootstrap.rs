//! How large the best of many candidates looks when none is there.
//!
//! Blocks (windows of a run) are the independent units, so neither overlap nor correlation inside a window counts
//! twice. Under the null each block's score has mean zero; multiplying it by a random sign keeps its size and its
//! correlation between candidates. The distribution of the *largest* statistic over all candidates corrects for
//! looking at many. Liu, Annals of Statistics 16 (1988) 1696; Westfall and Young, *Resampling-Based Multiple
//! Testing*, Wiley 1993.

use super::random::Random;
use crate::statistics::levels::CERTAIN;
use nalgebra::{DMatrix, DVector};

const DRAWS: usize = 4000;
const SEED: u64 = 0x0ac0_b075;

/// No threshold below this, in standard deviations. Draws know noise only; two right renderers or integrators differ
/// by a few thousandths of a pixel or a hundredth of a milliradian, which long data show.
const LEAST: f64 = CERTAIN;

/// A statistic per column: score over its standard deviation.
#[derive(Debug, Clone)]
pub struct Scores {
    /// Each block's score, a row per block.
    pub blocks: DMatrix<f64>,
    /// Sum over blocks.
    pub total: DVector<f64>,
    /// Standard deviation of the sum.
    pub deviation: DVector<f64>,
    /// Which signs count: +1 upwards only, -1 downwards only, 0 both.
    pub sided: Vec<i8>,
}

impl Scores {
    /// Standardised score; 0 where nothing can be said or the sign is not allowed.
    pub fn statistic(&self, column: usize) -> f64 {
        signed(self.total[column] / self.deviation[column], self.sided[column])
    }
}

fn signed(value: f64, sided: i8) -> f64 {
    if !value.is_finite() {
        return 0.0;
    }
    match sided {
        1 => value.max(0.0),
        -1 => (-value).max(0.0),
        _ => value.abs(),
    }
}

/// Null distribution of the largest statistic.
#[derive(Debug, Clone)]
pub struct Null {
    largest: Vec<f64>,
}

impl Null {
    /// Draws it.
    pub fn of(scores: &Scores) -> Self {
        let (blocks, columns) = scores.blocks.shape();
        let mut random = Random::new(SEED);
        let usable: Vec<usize> =
            (0..columns).filter(|c| scores.deviation[*c] > 0.0 && scores.deviation[*c].is_finite()).collect();
        // block by block, so that compilers use vectors
        let own: Vec<f64> = (0..blocks)
            .flat_map(|block| usable.iter().map(move |column| scores.blocks[(block, *column)]))
            .collect();
        let mut largest = Vec::with_capacity(DRAWS);
        let mut sums = vec![0.0; usable.len()];
        for _ in 0..DRAWS {
            sums.iter_mut().for_each(|sum| *sum = 0.0);
            for own in own.chunks_exact(usable.len().max(1)) {
                let sign = random.sign();
                sums.iter_mut().zip(own).for_each(|(sum, score)| *sum += sign * score);
            }
            let best = sums
                .iter()
                .zip(&usable)
                .map(|(sum, column)| signed(sum / scores.deviation[*column], scores.sided[*column]))
                .fold(0.0, f64::max);
            largest.push(best);
        }
        largest.sort_by(f64::total_cmp);
        Self { largest }
    }

    /// Share of draws at least as large, never quite 0.
    pub fn p_value(&self, statistic: f64) -> f64 {
        let above = self.largest.len() - self.largest.partition_point(|value| *value < statistic);
        (above as f64 + 1.0) / (self.largest.len() as f64 + 1.0)
    }

    /// The size that noise alone exceeds with probability `alpha`.
    pub fn threshold(&self, alpha: f64) -> f64 {
        let place = ((1.0 - alpha) * self.largest.len() as f64) as usize;
        let drawn = self.largest.get(place.min(self.largest.len().saturating_sub(1))).copied();
        drawn.unwrap_or(f64::INFINITY).max(LEAST)
    }
}
