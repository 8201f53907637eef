//! Levels that thresholds are made of: how sure, how large a share, how many times, how many.
//!
//! Hardly any answer hangs on whether a share that counts as small is 8 % or 12 %: each threshold that could be moved to one of these
//! without a verdict or a name that changes stands here (`docs/log/numbers.md`). One that has to stand elsewhere has its number and its
//! reason in the `policy.rs` of its room.

/// Standard deviations from which something is doubted: chance gives as many once in 370.
pub const DOUBTED: f64 = 3.0;
/// Standard deviations from which the best of many that were tried is believed: chance gives as many once in 150 000. At three times
/// the minimum detectable effect no right effect had less than 6.9 on five seeds, and a vignetting that wasn't there had 3.1.
pub const CERTAIN: f64 = 4.5;
/// Within so many standard deviations lie 95 % of a normal distribution.
pub const WITHIN: f64 = 1.959_963_984_540_054;
/// And half of it.
pub const MIDDLE: f64 = 0.674_489_750_196_082;

/// A share that doesn't matter.
pub const SLIGHT: f64 = 0.02;
/// A share that is small beside the whole.
pub const SMALL: f64 = 0.1;
/// A share that counts, but leaves most.
pub const PART: f64 = 0.3;
/// As much as the rest.
pub const HALF: f64 = 0.5;

/// Times: more than chance or a crude estimate makes of the same.
pub const MORE: f64 = 1.5;
/// Times: not the same any more.
pub const SEVERAL: f64 = 3.0;
/// Times: of another kind.
pub const FAR: f64 = 10.0;

/// So many, where one could be chance or an exception.
pub const FEW: usize = 3;
/// Rows from which a log tells anything: more than four start values and what is asked of them.
pub const ROWS: usize = 12;
/// So many independent values tell their scatter to an eighth.
pub const SAMPLE: usize = 30;
/// Rows or frames that one thread takes at a time: enough to pay for handing them out.
pub const TASK: usize = 48;

/// Share below which a number is rounding: differences of units are good to it.
pub const ROUNDING: f64 = 1e-6;
/// Share that ends an iteration: far below what any number of rows tells.
pub const FINE: f64 = 1e-3;
/// Share of a scale over which a difference is taken: far above rounding, far below where models bend.
pub const STEP: f64 = 1e-2;

/// Standard deviation of what lies anywhere in a span, as a value does within the quantum that it was rounded to.
pub fn anywhere_in(span: f64) -> f64 {
    span / 12f64.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Probability that noise lies so many standard deviations off, on either side.
    fn outside(deviations: f64) -> f64 {
        libm::erfc(deviations * std::f64::consts::FRAC_1_SQRT_2)
    }

    #[test]
    fn value_levels_of_certainty_are_the_tails_that_they_say() {
        // scipy.stats.norm.sf, twice, to the digits that stand here
        assert!((outside(DOUBTED) * 370.398 - 1.0).abs() < 1e-5);
        assert!((outside(CERTAIN) * 147_160.0 - 1.0).abs() < 1e-4);
        assert!((outside(WITHIN) - 0.05).abs() < 1e-15);
        assert!((outside(MIDDLE) - 0.5).abs() < 1e-15);
    }

    #[test]
    fn law_a_difference_over_a_step_is_good_to_a_tenth_of_what_ends_an_iteration() {
        let slope = (libm::sin(1.0 + STEP) - libm::sin(1.0 - STEP)) / (2.0 * STEP);
        let (bending, rounding) = ((slope - libm::cos(1.0)).abs(), ROUNDING / STEP);
        assert!(bending < 0.1 * FINE && rounding <= 0.1 * FINE, "{bending} {rounding}");
        // three times as long a step, or rounding three times as coarse, would not do
        assert!(9.0 * bending > 0.08 * FINE && 3.0 * rounding > 0.1 * FINE);
    }

    #[test]
    fn value_a_sample_tells_its_scatter_to_an_eighth() {
        // the relative error of a standard deviation of n values is 1 / √(2n)
        let known = (2.0 * SAMPLE as f64).sqrt().recip();
        assert!((known - 0.125).abs() < 0.005, "{known}");
    }
}
