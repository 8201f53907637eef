//! The tails of the noise: few pixels, drawn one by one over what the fast paths of [`super::quantise`] have made.
//!
//! The sums of [`super::noise`] end at 3.9 deviations. Let Q be the probability that a Gaussian lies beyond t either way
//! and B that of the sums. A share of the pixels, S(t₀), gets noise anew, of magnitudes beyond t with probability
//! S(t)/S(t₀), S = Q − B (taken through the middle of B's steps, and never rising). Then beyond t there are about
//! S + B = Q: within 15 % for every t up to 3.9 deviations, where B's steps are coarse, and to rounding from there on up
//! to 6.5, where the random bits end. That adds 0.2 % to the variance.
//!
//! Which pixels: the frame is cut into cells of [`CELL`] pixels, in reading order. A cell has one such pixel, or none.
//! Place, sign and magnitude follow from (seed, frame, cell) alone, so that they are the same whatever part of a frame
//! is made.

use super::noise::{self, Keys, random_word};
use super::plane::BLOCK;
use super::quantise::{Span, rounded};
use std::sync::LazyLock;

/// Pixels of a cell.
pub const CELL: u32 = 1024;
/// Where sums begin to be too few, in deviations.
const BEGIN: f64 = 3.2;
/// Octaves of the probability within the tails: what 23 random bits tell apart.
const OCTAVES: usize = 23;
/// Parts of an octave.
const PER_OCTAVE: usize = 32;

/// What is drawn from.
struct Law {
    /// Words below this have a pixel in their cell.
    below: u32,
    /// Magnitudes in units of the sums: rows for octaves of the probability, each in [`PER_OCTAVE`] parts.
    magnitudes: [u16; OCTAVES * PER_OCTAVE],
}

static LAW: LazyLock<Law> = LazyLock::new(|| {
    let missing = Missing::new();
    let share = missing.knots[0].1;
    let magnitudes = core::array::from_fn(|place| {
        let (octave, part) = (place / PER_OCTAVE, PER_OCTAVE - 1 - place % PER_OCTAVE);
        let middle = 1.0 + (part as f64 + 0.5) / PER_OCTAVE as f64;
        let t = missing.quantile(share * middle * libm::exp2(-1.0 - octave as f64));
        libm::round(t * noise::deviation()) as u16
    });
    Law { below: (share * f64::from(CELL) * 4_294_967_296.0) as u32, magnitudes }
});

/// S: what the sums lack.
struct Missing {
    /// (t, S(t)) at the sums beyond [`BEGIN`].
    knots: Vec<(f64, f64)>,
}

impl Missing {
    fn new() -> Self {
        let deviation = noise::deviation();
        let magnitudes = (0..=u16::MAX).map(|bits| f64::from(noise::deviate(bits).abs()) / deviation);
        let mut far: Vec<f64> = magnitudes.filter(|t| *t >= BEGIN).collect();
        far.sort_by(|a, b| b.total_cmp(a));
        let mut knots: Vec<(f64, f64)> = Vec::new();
        // Sums come in pairs, one of each sign: a pair's first has as many before it as B's upper step.
        for (before, t) in far.iter().enumerate().step_by(2) {
            let sums = (before as f64 + 1.0) / 65536.0;
            let least = knots.last().map_or(0.0, |(_, missing)| *missing);
            knots.push((*t, (both_tails(*t) - sums).max(least)));
        }
        knots.push((BEGIN, (both_tails(BEGIN) - far.len() as f64 / 65536.0).max(knots[knots.len() - 1].1)));
        knots.reverse();
        Self { knots }
    }

    /// Where S has come down to this.
    fn quantile(&self, missing: f64) -> f64 {
        let after = self.knots.partition_point(|(_, known)| *known > missing);
        match self.knots.get(after) {
            _ if after == 0 => BEGIN,
            Some((t1, s1)) => {
                let (t0, s0) = self.knots[after - 1];
                t0 + (t1 - t0) * (s0 - missing) / (s0 - s1)
            }
            None => gaussian_quantile(missing, self.knots[after - 1].0),
        }
    }
}

/// Probability that a Gaussian of deviation 1 lies beyond t either way.
fn both_tails(t: f64) -> f64 {
    libm::erfc(t * core::f64::consts::FRAC_1_SQRT_2)
}

/// Where that has come down to `both`, after `from`, by halving.
fn gaussian_quantile(both: f64, from: f64) -> f64 {
    let (mut low, mut high) = (from, 8.0);
    while high - low > 1e-5 {
        let middle = 0.5 * (low + high);
        *(if both_tails(middle) > both { &mut low } else { &mut high }) = middle;
    }
    low
}

/// The pixel of a cell that lies in a tail: its place in the cell, its sign and the random bits of its magnitude.
fn drawn(cell: u32, keys: Keys, below: u32) -> Option<(u32, bool, u32)> {
    // The keys in other places, so that these words have nothing to do with those of the sums.
    let word = random_word(cell, Keys(keys.1, keys.0));
    if word >= below {
        return None;
    }
    let bits = random_word(word, keys);
    Some((bits % CELL, bits & CELL == 0, bits >> (u32::BITS - OCTAVES as u32)))
}

/// The magnitude of a pixel's noise in units of the sums, from as many random bits as there are octaves.
fn magnitude(law: &Law, bits: u32) -> u16 {
    let bits = bits << (u32::BITS - OCTAVES as u32);
    let octave = (bits.leading_zeros() as usize).min(OCTAVES - 1);
    let part = (bits << (octave + 1) >> (u32::BITS - PER_OCTAVE.ilog2())) as usize;
    law.magnitudes[octave * PER_OCTAVE + PER_OCTAVE - 1 - part]
}

/// deviate · gain / 2¹⁵, rounded: beyond what a picture can show it stays at the largest number.
fn scaled(magnitude: u16, gain: i16) -> i16 {
    let noise = (((i32::from(magnitude) * i32::from(gain)) >> 14) + 1) >> 1;
    noise.min(i32::from(i16::MAX)) as i16
}

/// The largest noise there is, in parts of a grey level.
pub fn largest(gain: i16) -> i16 {
    scaled(LAW.magnitudes[OCTAVES * PER_OCTAVE - 1], gain)
}

/// Makes the pixels of a span that lie in a tail anew, and their bits of the mask.
pub fn draw(span: Span<'_>, picture: &mut [u8], mask: &mut [u32]) {
    let Some((keys, gain)) = span.noise else { return };
    let law = &*LAW;
    let first = span.first_word * 2;
    for cell in first / CELL..=(first + span.base.len() as u32 - 1) / CELL {
        let Some((at, is_up, bits)) = drawn(cell, keys, law.below) else { continue };
        let Some(place) = (cell * CELL + at).checked_sub(first).map(|place| place as usize) else { continue };
        let Some(base) = span.base.get(place) else { continue };
        let noise = scaled(magnitude(law, bits), gain);
        let pixel = rounded(base.saturating_add(if is_up { noise } else { -noise }));
        picture[place] = pixel;
        let bit = 1 << (place % BLOCK);
        let word = &mut mask[place / BLOCK];
        *word = if pixel >= span.level { *word | bit } else { *word & !bit };
    }
}
