//! Rounding as the kernels do it, in vector code without casts: against the functions of the standard library.

use crate::common::*;
use camera::photometry::{PARTS, edges, parts, quantise};

#[test]
fn every_value_is_rounded_as_floor_and_round_do() {
    let mut random = Random(6);
    let any = (0..10_000).map(|_| random.between(0.0, 4_000_000.0) as f32);
    let small = (0..400).map(|eighth| eighth as f32 / 8.0);
    for value in any.chain(small) {
        assert_eq!(edges::below(value), value.floor(), "{value}");
        // Halves go to the even neighbour, as sums of floating point numbers do.
        assert_eq!(edges::whole(value), value.round_ties_even() as i32, "{value}");
        assert_eq!(edges::whole(-value), -value.round_ties_even() as i32, "{value}");
    }
}

#[test]
fn every_grey_level_is_kept_in_the_nearest_of_its_parts() {
    for eighth in 0..8 * 300 {
        // Eighths of a part are exact; halves go up.
        let part = eighth as f32 / 8.0;
        assert_eq!(f32::from(parts(part / PARTS)), (part + 0.5).floor(), "{part}");
    }
    // Beyond what there is room for, and what is no number.
    for (grey, most) in
        [(511.0, 32704), (512.0, i16::MAX), (1e9, i16::MAX), (-0.1, 0), (-1e9, 0), (f32::NAN, 0)]
    {
        assert_eq!(parts(grey), most, "{grey}");
    }
    // And shown as the nearest whole level, within 0..255.
    for (part, level) in
        [(-32000, 0), (-1, 0), (31, 0), (32, 1), (95, 1), (96, 2), (16287, 254), (16288, 255), (32767, 255)]
    {
        assert_eq!(quantise::rounded(part), level, "{part}");
    }
}
