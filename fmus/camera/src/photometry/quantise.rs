//! The last step, fused: base plus noise, rounded to whole grey levels in 0..255, and compared with the threshold.
//!
//! The portable and the SIMD paths give the same bits; which one runs is chosen at run time.

use super::noise::{self, Keys};
use super::plane::{BLOCK, Mask, Plane};
use super::{Area, simd, tails};

/// Noise of one frame; `None`: no noise.
pub type FrameNoise = Option<(Keys, i16)>;

/// What a span of whole blocks needs.
#[derive(Debug, Clone, Copy)]
pub struct Span<'a> {
    /// The base in parts of a grey level; a whole number of blocks.
    pub base: &'a [i16],
    /// Index of the span's first pixel in the padded frame, divided by two.
    pub first_word: u32,
    /// Noise.
    pub noise: FrameNoise,
    /// Pixels at or above this are set in the mask; at least 1.
    pub level: u8,
}

/// Makes the pixels and mask bits of an area of the frame, widened to whole blocks. Rows go up by `row_step`.
pub fn quantise(
    base: &Plane<i16>,
    area: Area,
    row_step: usize,
    noise: FrameNoise,
    level: u8,
    picture: &mut Plane<u8>,
    mask: &mut Mask,
) {
    let (from, to) = (area.x0 / BLOCK, area.x1.div_ceil(BLOCK));
    let path = simd::best();
    if row_step == 1 && (to - from) * BLOCK == base.stride {
        // Whole rows lie one after the other: one span.
        let pixels = area.y0 * base.stride..area.y1 * base.stride;
        let words = area.y0 * mask.stride..area.y1 * mask.stride;
        let first_word = (pixels.start / 2) as u32;
        let span = Span { base: &base.values[pixels.clone()], first_word, noise, level };
        let (picture, mask) = (&mut picture.values[pixels], &mut mask.words[words]);
        path(span, picture, mask);
        return tails::draw(span, picture, mask);
    }
    for y in (area.y0..area.y1).step_by(row_step) {
        let start = y * base.stride + from * BLOCK;
        let pixels = start..y * base.stride + to * BLOCK;
        let words = y * mask.stride + from..y * mask.stride + to;
        let span = Span { base: &base.values[pixels.clone()], first_word: (start / 2) as u32, noise, level };
        let (picture, mask) = (&mut picture.values[pixels], &mut mask.words[words]);
        path(span, picture, mask);
        tails::draw(span, picture, mask);
    }
}

/// The path for every machine, and the definition of the others: all but the tails of the noise.
pub fn portable(span: Span<'_>, picture: &mut [u8], mask: &mut [u32]) {
    let blocks = span.base.chunks_exact(BLOCK).zip(picture.chunks_exact_mut(BLOCK)).zip(mask);
    for (block, ((base, picture), mask)) in blocks.enumerate() {
        match span.noise {
            Some((keys, gain)) => {
                let first = span.first_word.wrapping_add((block * BLOCK / 2) as u32);
                for (pair, (base, out)) in base.chunks_exact(2).zip(picture.chunks_exact_mut(2)).enumerate() {
                    let word = noise::random_word(first.wrapping_add(pair as u32), keys);
                    out[0] =
                        rounded(base[0].saturating_add(noise::scaled(noise::deviate(word as u16), gain)));
                    out[1] = rounded(
                        base[1].saturating_add(noise::scaled(noise::deviate((word >> 16) as u16), gain)),
                    );
                }
            }
            None => picture.iter_mut().zip(base).for_each(|(out, base)| *out = rounded(*base)),
        }
        *mask = picture
            .iter()
            .enumerate()
            .fold(0, |bits, (i, pixel)| bits | u32::from(*pixel >= span.level) << i);
    }
}

/// Nearest whole grey level.
#[inline]
pub fn rounded(parts: i16) -> u8 {
    (parts.saturating_add(32) >> 6).clamp(0, 255) as u8
}

/// Whether noise can lift a base of at most `brightest` parts to the level.
pub fn reaches(brightest: i16, noise: FrameNoise, level: u8) -> bool {
    let most = noise.map_or(0, |(_, gain)| tails::largest(gain));
    rounded(brightest.saturating_add(most)) >= level
}
