//! Parameters of the log that are nobody's fault: noise, quantisation, timestamps. Estimated with everything else, never
//! candidates.

use crate::statistics::levels::{MIDDLE, anywhere_in};

mod held_over;
pub mod outliers;
mod policy;

pub use held_over::held_over;

use policy::NUISANCE;

/// What the values of one channel say of its noise, without any model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scatter {
    /// Standard deviation of what differs from row to row and follows no polynomial: at most the noise and the model's own
    /// motion within a few rows.
    pub noise: f64,
    /// The same of the rows between jumps: by the median of the differences, which rows at the steps of an input don't move, and
    /// at least what rounding leaves.
    pub quiet: f64,
    /// Distance of neighbouring values of the log, if it looks rounded; else 0.
    pub quantum: f64,
    /// Standard deviation of the values.
    pub size: f64,
}

/// Looks at all runs of one channel.
pub fn scatter(runs: &[&[f64]]) -> Scatter {
    let all: Vec<f64> = runs.iter().flat_map(|run| run.iter().copied()).collect();
    let mean = all.iter().sum::<f64>() / all.len().max(1) as f64;
    let squares = all.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
    // of what never changes the mean is rounded, and that is no size
    let still = all.windows(2).all(|pair| pair[0] == pair[1]);
    let size = if still { 0.0 } else { (squares / all.len().max(1) as f64).sqrt() };
    let (mut noise, mut quiet) = (f64::INFINITY, f64::INFINITY);
    let mut weight = 1.0;
    let mut differences: Vec<Vec<f64>> = runs.iter().map(|run| run.to_vec()).collect();
    for order in 1..=NUISANCE.orders {
        for run in &mut differences {
            *run = run.windows(2).map(|pair| pair[1] - pair[0]).collect();
        }
        // Σ binomial(d, k)² = binomial(2d, d): the variance of a d-th difference of white noise
        weight *= (4 * order - 2) as f64 / order as f64;
        let (sum, count) = (differences.iter().flatten()).fold((0.0, 0), |(s, n), v| (s + v * v, n + 1));
        if count > 2 {
            noise = noise.min((sum / count as f64 / weight).sqrt());
            let mut sizes: Vec<f64> = differences.iter().flatten().map(|v| v.abs()).collect();
            let middle = sizes.len() / 2;
            quiet =
                quiet.min(*sizes.select_nth_unstable_by(middle, f64::total_cmp).1 / MIDDLE / weight.sqrt());
        }
    }
    let noise = if noise.is_finite() { noise } else { size };
    let quantum = quantum(&all);
    // rounding is uniform: its standard deviation is a quantum over √12
    Scatter { noise, quiet: quiet.max(anywhere_in(quantum)).min(noise), quantum, size }
}

/// The distance of neighbouring values, where there are few enough of them that they look rounded.
fn quantum(values: &[f64]) -> f64 {
    let real = gaps(values);
    if real.is_empty() || (real.len() + 1) as f64 > NUISANCE.rounded * values.len() as f64 {
        return 0.0;
    }
    real.into_iter().fold(f64::INFINITY, f64::min)
}

/// The least distance of two values: what they are rounded to, if they are. Of a wide range all of a few rows are others though they are.
pub fn least_gap(values: &[f64]) -> f64 {
    gaps(values).into_iter().reduce(f64::min).unwrap_or(0.0)
}

/// The distances of neighbouring values that are no rounding of numbers.
fn gaps(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let span = sorted.last().zip(sorted.first()).map_or(0.0, |(last, first)| last - first);
    let gaps = sorted.windows(2).map(|pair| pair[1] - pair[0]);
    gaps.filter(|gap| *gap > 1e-9 * span).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::random::Random;

    #[test]
    fn law_what_never_changes_has_no_size() {
        let still = [1.4585064; 14]; // their mean is rounded
        assert!(still.iter().sum::<f64>() / 14.0 != still[0]);
        assert_eq!(scatter(&[&still[..6], &still[6..]]).size, 0.0);
    }

    #[test]
    fn law_noise_is_found_beside_a_motion_and_rounding_is_seen() {
        let mut random = Random::new(3);
        let motion = |k: usize| libm::sin(0.05 * k as f64);
        let noisy: Vec<f64> = (0..2000).map(|k| motion(k) + 0.01 * random.normal()).collect();
        let found = scatter(&[&noisy]);
        // 2000 values of a fifth difference know their size to about 5 %
        assert!((found.noise / 0.01 - 1.0).abs() < 0.1, "{found:?}");
        assert_eq!(found.quantum, 0.0);
        let rounded: Vec<f64> = noisy.iter().map(|v| (v / 0.02).round() * 0.02).collect();
        assert!((scatter(&[&rounded]).quantum - 0.02).abs() < 1e-9);
        let quiet = scatter(&[&rounded]).quiet;
        assert!(quiet >= anywhere_in(0.02), "rounding alone leaves more than {quiet}");
    }

    #[test]
    fn law_steps_of_an_input_are_no_noise() {
        let mut random = Random::new(4);
        // an output that jumps with an input, once in 25 rows, by a hundred times the noise
        let steps = |k: usize| f64::from((k / 25 * 7 % 5) as u32);
        let log: Vec<f64> = (0..2000).map(|k| steps(k) + 0.01 * random.normal()).collect();
        let found = scatter(&[&log]);
        assert!(found.noise > 0.1, "{found:?}: the mean square has the jumps in it");
        // of a fifth difference 6 rows in 25 see a jump: the median of the others lies half as high again at most
        assert!(found.quiet > 0.009 && found.quiet < 0.015, "{found:?}");
    }
}
