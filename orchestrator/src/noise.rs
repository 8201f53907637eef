//! Random numbers from a counter: seed, connection and sample give the number, whatever was drawn before. Sines and
//! logarithms come from `libm`, so that every machine draws the same.

use std::f64::consts::TAU;

/// The numbers of one connection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Draw {
    key: u64,
}

impl Draw {
    /// By a seed and the name of what draws: other connections may come and go.
    pub(crate) fn new(seed: u64, name: &str) -> Self {
        // FNV-1a, 64 bits.
        let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        });
        Self { key: mixed(mixed(seed) ^ hash) }
    }

    /// From 0 to below 1, of the sample with this number; the same at each call.
    pub(crate) fn uniform(self, sample: u64) -> f64 {
        self.number(sample, 0)
    }

    /// Of mean 0 and standard deviation 1 (Box and Muller 1958); independent of [`Draw::uniform`].
    pub(crate) fn normal(self, sample: u64) -> f64 {
        // From above 0 to 1, so that the logarithm is finite.
        let radius = (-2.0 * libm::log(1.0 - self.number(sample, 1))).sqrt();
        radius * libm::cos(TAU * self.number(sample, 2))
    }

    fn number(self, sample: u64, which: u64) -> f64 {
        let bits = mixed(self.key ^ mixed(sample.wrapping_mul(4).wrapping_add(which)));
        (bits >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014) on the next value of its sequence.
fn mixed(value: u64) -> u64 {
    let mut z = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_the_mixing_is_splitmix64s() {
        // The first three outputs for the seed 1234567, of the authors' C program.
        let step = 0x9e37_79b9_7f4a_7c15_u64;
        let found = [0, 1, 2].map(|n: u64| mixed(1_234_567_u64.wrapping_add(step.wrapping_mul(n))));
        assert_eq!(found, [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]);
    }

    #[test]
    fn value_numbers_of_a_connection_are_those_of_every_version() {
        // The same formulas in Python's integers; else a checkpoint would go on with other numbers.
        let draw = Draw::new(3, "b.u1");
        let found = [0, 1, 12_345].map(|sample| draw.uniform(sample));
        assert_eq!(found, [0.4543257576152958, 0.42238163008649376, 0.6966912778151214]);
        let radius = (-2.0 * libm::log(1.0 - 0.7284609009239627)).sqrt();
        assert_eq!(draw.normal(1), radius * libm::cos(TAU * 0.45376310434219735));
    }

    #[test]
    fn law_moments_are_those_of_the_distributions() {
        const COUNT: u64 = 40_000;
        let mean = |f: &dyn Fn(u64) -> f64| (0..COUNT).map(f).sum::<f64>() / COUNT as f64;
        for name in ["b.u1", "b.u2", ""] {
            let draw = Draw::new(3, name);
            // Five standard errors: of a mean sd / 200, of the second moments below sqrt(2) / 200, of the fourth sqrt(96) / 200.
            assert!((mean(&|n| draw.uniform(n)) - 0.5).abs() < 5.0 * 0.289 / 200.0);
            assert!(mean(&|n| draw.normal(n)).abs() < 5.0 / 200.0);
            assert!((mean(&|n| draw.normal(n).powi(2)) - 1.0).abs() < 5.0 * 1.42 / 200.0);
            assert!((mean(&|n| draw.normal(n).powi(4)) - 3.0).abs() < 5.0 * 9.8 / 200.0);
            assert!(
                mean(&|n| draw.normal(n) * draw.normal(n + 1)).abs() < 5.0 / 200.0,
                "one after the other"
            );
            assert!(
                mean(&|n| draw.normal(n) * (draw.uniform(n) - 0.5)).abs() < 5.0 * 0.289 / 200.0,
                "beside"
            );
        }
        let between = mean(&|n| Draw::new(3, "b.u1").normal(n) * Draw::new(3, "b.u2").normal(n));
        assert!(between.abs() < 5.0 / 200.0, "two connections");
        let seeds = mean(&|n| Draw::new(3, "b.u1").normal(n) * Draw::new(4, "b.u1").normal(n));
        assert!(seeds.abs() < 5.0 / 200.0, "two seeds");
    }
}
