//! Waves of ever higher frequency at the same places, turned from each frequency to the next, with what values hold of each. Compiled for AVX2,
//! too, and chosen at run time: the same sums in the same order, so the same bits.

use multiversion::multiversion;

/// Values at places, with the cosine and the sine of a wave there.
pub struct Waves {
    values: Vec<f64>,
    cos: Vec<f64>,
    sin: Vec<f64>,
    /// What turns each wave to the next.
    by: Turns,
}

struct Turns {
    cos: Vec<f64>,
    sin: Vec<f64>,
}

impl Waves {
    /// Of (place, value), at an angular frequency of `first`; the next ones lie `step` apart.
    pub fn new(samples: &[(f64, f64)], first: f64, step: f64) -> Self {
        let turned = |by: f64, of: fn(f64) -> f64| samples.iter().map(|(at, _)| of(by * at)).collect();
        Self {
            values: samples.iter().map(|(_, value)| *value).collect(),
            cos: turned(first, libm::cos),
            sin: turned(first, libm::sin),
            by: Turns { cos: turned(step, libm::cos), sin: turned(step, libm::sin) },
        }
    }

    /// Heights of cosine and sine at this frequency; then goes to the next one.
    pub fn height(&mut self) -> [f64; 2] {
        let share = 2.0 / self.values.len().max(1) as f64;
        sums_and_on(&self.values, &mut self.cos, &mut self.sin, &self.by.cos, &self.by.sin)
            .map(|sum| share * sum)
    }
}

#[multiversion(targets("x86_64+avx2"))]
fn sums_and_on(values: &[f64], cos: &mut [f64], sin: &mut [f64], by_cos: &[f64], by_sin: &[f64]) -> [f64; 2] {
    let rows = values.len();
    // slices of one length: no bound is asked for within the loops
    let (cos, sin, by_cos, by_sin) = (&mut cos[..rows], &mut sin[..rows], &by_cos[..rows], &by_sin[..rows]);
    // four sums side by side, so that compilers use vectors
    let (mut along_cos, mut along_sin) = ([0.0; 4], [0.0; 4]);
    let whole = rows - rows % 4;
    for first in (0..whole).step_by(4) {
        for lane in 0..4 {
            let row = first + lane;
            let (c, s) = (cos[row], sin[row]);
            along_cos[lane] += values[row] * c;
            along_sin[lane] += values[row] * s;
            cos[row] = c * by_cos[row] - s * by_sin[row];
            sin[row] = c * by_sin[row] + s * by_cos[row];
        }
    }
    for row in whole..rows {
        let (c, s) = (cos[row], sin[row]);
        along_cos[0] += values[row] * c;
        along_sin[0] += values[row] * s;
        cos[row] = c * by_cos[row] - s * by_sin[row];
        sin[row] = c * by_sin[row] + s * by_cos[row];
    }
    [along_cos, along_sin].map(|sums| sums.iter().sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_heights_are_those_of_sines_and_cosines_at_each_frequency() {
        // rows that fill the sums five times, with a rest
        let place = |row: usize| 0.37 * row as f64 - 2.0;
        let samples: Vec<(f64, f64)> = (0..23).map(|row| (place(row), 1.0 / (1.0 + row as f64))).collect();
        let mut waves = Waves::new(&samples, 2.0, 0.5);
        for count in 0..40 {
            let frequency = 2.0 + 0.5 * f64::from(count);
            let sum = |of: fn(f64) -> f64| {
                samples.iter().map(|(at, value)| value * of(frequency * at)).sum::<f64>() * 2.0 / 23.0
            };
            // forty turns of numbers below 1, each rounded
            let rounding = 1e-13;
            let [cos, sin] = waves.height();
            assert!((cos - sum(libm::cos)).abs() < rounding && (sin - sum(libm::sin)).abs() < rounding);
        }
        assert_eq!(Waves::new(&[], 1.0, 1.0).height(), [0.0; 2]);
    }
}
