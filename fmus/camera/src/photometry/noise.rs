//! Gaussian noise by counter: a pure function of (seed, frame, pixel), so that frames do not depend on threads,
//! regions or order.
//!
//! Two neighbouring pixels share one 32-bit word: a mixing function of the word's place in the frame and of two keys
//! of the frame. The keys enter at different rounds, so that no frame is another one shifted. Each pixel takes 16
//! bits, four nibbles, each of which looks up a table of 16 entries; the weighted sum of the four is the deviate.
//! Tables and weights were searched for so that the distribution of the sum is Gaussian to [`CDF_ERROR`]; its mean
//! is zero by symmetry and its deviation [`deviation`] exactly known.
//!
//! Sums end at 3.9 deviations and thin out before. What a Gaussian has there beyond them, one pixel in 2900, is laid over
//! the finished picture by [`super::tails`].

/// Table of the nibbles 0 and 2 of a pixel's bits.
pub const TABLE_A: [i8; 16] = symmetric([2, 11, 14, 28, 32, 49, 63, 123]);
/// Table of the nibbles 1 and 3.
pub const TABLE_B: [i8; 16] = symmetric([2, 18, 22, 42, 46, 62, 88, 104]);
/// Weights of the four nibbles.
pub const WEIGHTS: [i8; 4] = [89, 74, 39, 65];
/// Largest error of the deviate's distribution function (see the test `value_noise_law`).
pub const CDF_ERROR: f64 = 3.8e-4;

const fn symmetric(half: [i8; 8]) -> [i8; 16] {
    let mut table = [0; 16];
    let mut i = 0;
    while i < 8 {
        table[7 - i] = -half[i];
        table[8 + i] = half[i];
        i += 1;
    }
    table
}

/// The two keys of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Keys(pub u32, pub u32);

impl Keys {
    /// Keys of frame `k`.
    pub fn new(seed: i32, k: i64) -> Self {
        let key = mixed(seed, k, 0);
        Self(key as u32, (key >> 32) as u32)
    }
}

/// A well-mixed word from seed, frame and the name of a stream (the finaliser of SplitMix64, twice).
pub fn mixed(seed: i32, k: i64, stream: u64) -> u64 {
    let finish = |mut z: u64| {
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let seeded =
        finish((seed as u32 as u64 | stream << 32).wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(1));
    finish(seeded.wrapping_add((k as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)))
}

/// Multipliers of the two rounds (odd, found by Ellis' search for low bias).
pub const ROUNDS: (u32, u32) = (0x7feb_352d, 0x846c_a68b);

/// The random word of a pair of pixels; `word` is the even pixel's index divided by two.
#[inline]
pub fn random_word(word: u32, keys: Keys) -> u32 {
    let mut h = word.wrapping_add(keys.0);
    h = (h ^ (h >> 16)).wrapping_mul(ROUNDS.0);
    h ^= keys.1;
    h = (h ^ (h >> 15)).wrapping_mul(ROUNDS.1);
    h ^ (h >> 16)
}

/// The deviate of 16 random bits, in units of 1/[`deviation`].
#[inline]
pub fn deviate(bits: u16) -> i16 {
    let nibble = |n: u16| usize::from((bits >> (4 * n)) & 15);
    let term = |weight: i8, entry: i8| i16::from(weight) * i16::from(entry);
    (term(WEIGHTS[0], TABLE_A[nibble(0)]) + term(WEIGHTS[2], TABLE_A[nibble(2)]))
        + (term(WEIGHTS[1], TABLE_B[nibble(1)]) + term(WEIGHTS[3], TABLE_B[nibble(3)]))
}

/// Standard deviation of the deviates.
pub fn deviation() -> f64 {
    let variance = |table: &[i8; 16]| table.iter().map(|x| f64::from(*x) * f64::from(*x)).sum::<f64>() / 16.0;
    let square = |n: usize| f64::from(WEIGHTS[n]) * f64::from(WEIGHTS[n]);
    let (a, b) = (variance(&TABLE_A), variance(&TABLE_B));
    ((square(0) + square(2)) * a + (square(1) + square(3)) * b).sqrt()
}

/// The factor that makes noise of `sigma` grey levels from deviates, for [`scaled`].
pub fn gain(sigma: f64) -> i16 {
    let gain = sigma * f64::from(super::PARTS) * 32768.0 / deviation();
    libm::round(gain.clamp(0.0, 32767.0)) as i16
}

/// deviate · gain / 2¹⁵, rounded: noise in parts of a grey level.
#[inline]
pub fn scaled(deviate: i16, gain: i16) -> i16 {
    ((((i32::from(deviate) * i32::from(gain)) >> 14) + 1) >> 1) as i16
}
