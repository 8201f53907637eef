//! Columns of doubles as short text that gives the same doubles back, to the bit.
//!
//! Each value is foretold by the polynomial through the values before it, and only the bits that differ are kept, as in
//! Burtscher and Ratanaworabhan, *FPC: A High-Speed Compressor for Double-Precision Floating-Point Data* (2009). A value
//! that is held costs half a byte, a smooth one about four. `assets/unpack.js` is the other side.

use base64::Engine as _;
use serde::Serialize;

/// The bits that stand for "this line has no point here", which is not the same as a point without a number.
pub(crate) const MISSING: u64 = 0x7ff8_0000_0000_00d1;
/// The bits of every value that is no finite number.
const NOTHING: u64 = 0x7ff8_0000_0000_0000;
/// A foretelling looks back on this many values at most.
const ORDERS: usize = 4;

/// A packed column.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub(crate) struct Packed {
    /// How many values there are.
    rows: usize,
    /// How many values the foretelling looks back on.
    order: usize,
    /// A half byte for each value, the first in the low half: how many of its low bytes differ. Then these bytes.
    data: String,
}

/// Packs bits of doubles, in the order that makes them shortest.
pub(crate) fn pack(bits: &[u64]) -> Packed {
    let clean: Vec<u64> = bits.iter().map(|bits| if finite(*bits) { *bits } else { hole(*bits) }).collect();
    let size = |order: &usize| lengths(&clean, *order).iter().sum::<usize>();
    let order = (1..=ORDERS).min_by_key(size).unwrap_or(1);
    let lengths = lengths(&clean, order);
    let mut bytes = vec![0_u8; clean.len().div_ceil(2)];
    for (row, length) in lengths.iter().enumerate() {
        bytes[row / 2] |= (*length as u8) << (4 * (row % 2));
    }
    for (row, length) in lengths.iter().enumerate() {
        let differs = clean[row] ^ foretold(&clean[..row], order);
        bytes.extend_from_slice(&differs.to_le_bytes()[..*length]);
    }
    Packed { rows: clean.len(), order, data: base64::engine::general_purpose::STANDARD.encode(bytes) }
}

fn finite(bits: u64) -> bool {
    f64::from_bits(bits).is_finite()
}

fn hole(bits: u64) -> u64 {
    if bits == MISSING { MISSING } else { NOTHING }
}

/// How many low bytes of each value differ from what is foretold.
fn lengths(bits: &[u64], order: usize) -> Vec<usize> {
    let differs = |row: usize| bits[row] ^ foretold(&bits[..row], order);
    (0..bits.len()).map(|row| 8 - differs(row).leading_zeros() as usize / 8).collect()
}

/// The bits of the next value by the polynomial through the last `order`, or those of the last value where that is no
/// number. The order of the sums is that of `assets/unpack.js`: another one rounds otherwise.
fn foretold(before: &[u64], order: usize) -> u64 {
    let back = |steps: usize| f64::from_bits(before[before.len() - steps]);
    let value = match order.min(before.len()) {
        0 => 0.0,
        1 => back(1),
        2 => 2.0 * back(1) - back(2),
        3 => 3.0 * back(1) - 3.0 * back(2) + back(3),
        _ => 4.0 * back(1) - 6.0 * back(2) + 4.0 * back(3) - back(4),
    };
    // After a hole most often comes another one.
    if value.is_finite() { value.to_bits() } else { before.last().copied().unwrap_or(0) }
}

#[cfg(test)]
mod tests {
    use super::{MISSING, NOTHING, Packed, foretold, pack};
    use base64::Engine as _;

    /// What `assets/unpack.js` does.
    fn unpack(packed: &Packed) -> Vec<u64> {
        let bytes = base64::engine::general_purpose::STANDARD.decode(&packed.data).expect("is base64");
        let mut at = packed.rows.div_ceil(2);
        let mut values = Vec::new();
        for row in 0..packed.rows {
            let length = usize::from(bytes[row / 2] >> (4 * (row % 2)) & 15);
            let mut word = [0; 8];
            word[..length].copy_from_slice(&bytes[at..at + length]);
            at += length;
            values.push(u64::from_le_bytes(word) ^ foretold(&values, packed.order));
        }
        assert_eq!(at, bytes.len(), "no byte is left");
        values
    }

    fn bits(values: impl IntoIterator<Item = f64>) -> Vec<u64> {
        values.into_iter().map(f64::to_bits).collect()
    }

    #[test]
    fn law_every_double_comes_back() {
        let odd = [0.0, -0.0, 1.0, f64::MAX, -f64::MAX, f64::MIN_POSITIVE, 5e-324, 0.1 + 0.2, f64::MAX];
        let smooth = (0..2000).map(|row| (f64::from(row) / 600.0).sin());
        let rough = (0..2000).map(|row| (f64::from(row) * 12.9898).sin() * 43758.5453 % 1.0);
        for column in [bits(odd), bits(smooth), bits(rough), Vec::new()] {
            assert_eq!(unpack(&pack(&column)), column);
        }
    }

    #[test]
    fn value_what_a_polynomial_foretells() {
        // The next one on the straight line, the parabola, the cubic through the last two, three, four.
        let next = |values: &[f64], order| f64::from_bits(foretold(&bits(values.iter().copied()), order));
        let powers = |power| (1..=7).map(|n| f64::from(n).powi(power)).collect::<Vec<_>>();
        assert_eq!(next(&[], 4), 0.0);
        assert_eq!(next(&powers(2), 1), 49.0, "held");
        assert_eq!(next(&powers(1), 2), 8.0);
        assert_eq!(next(&powers(2), 3), 64.0);
        assert_eq!(next(&powers(3), 4), 512.0);
        // As far back as there are values.
        assert_eq!(next(&[5.0], 4), 5.0);
        assert_eq!(next(&[5.0, 7.0], 4), 9.0);
        assert_eq!(next(&[1.0, 4.0, 9.0], 4), 16.0);
        // What is foretold costs half a byte: 1000 numbers and the first ones, in base64.
        let cubic = bits((0..1000).map(|n| f64::from(n).powi(3) - 5.0 * f64::from(n)));
        assert!(pack(&cubic).data.len() < 4 * (500 + 8 * 8) / 3, "{}", pack(&cubic).data.len());
    }

    #[test]
    fn law_a_hole_is_told_from_a_missing_point() {
        let column =
            [1.0_f64.to_bits(), f64::NAN.to_bits(), f64::INFINITY.to_bits(), MISSING, 2.0_f64.to_bits()];
        assert_eq!(unpack(&pack(&column)), [1.0_f64.to_bits(), NOTHING, NOTHING, MISSING, 2.0_f64.to_bits()]);
    }

    #[test]
    fn value_held_and_smooth_columns_are_short() {
        let held = bits((0..18_000).map(|row| f64::from(row / 20).sin()));
        // Half a byte a row and at most eight for each new value, in base64.
        assert!(pack(&held).data.len() < 4 * (9_000 + 900 * 8) / 3 + 8);
        let smooth = bits((0..18_000).map(|row| (f64::from(row) / 600.0).sin()));
        assert!(pack(&smooth).data.len() < 18_000 * 6, "{}", pack(&smooth).data.len());
        let time = bits((0..18_000).map(|row| f64::from(row) / 600.0));
        assert!(pack(&time).data.len() < 18_000 * 3, "{}", pack(&time).data.len());
        assert!(pack(&[MISSING; 18_000]).data.len() < 12_100, "{}", pack(&[MISSING; 18_000]).data.len());
    }
}
