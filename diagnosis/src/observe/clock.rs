//! What loggers write as times: the units they count in, and how large times since 1970 are. One place for all who judge the times of a
//! log: `log.rs`, `import`, `check`, and our rig.

use std::ops::Range;

/// Units that loggers count time in and their lengths in s, from the shortest on.
pub(crate) const UNITS: [(&str, f64); 6] =
    [("ns", 1e-9), ("us", 1e-6), ("ms", 1e-3), ("s", 1.0), ("min", 60.0), ("h", 3600.0)];

/// Times from here on, s, are those of a clock (1e8 s after 1970 is March 1973) and no time of a model.
pub(crate) const EPOCH: f64 = 1e8;

/// Seconds since 1970 of anything that is logged today. Begins above `EPOCH`: that asks only what is no time of a model.
pub(crate) const SINCE_1970: Range<f64> = 1e9..1e10;

/// The units up to s, s first.
pub(crate) fn units_to_seconds() -> impl Iterator<Item = (&'static str, f64)> {
    UNITS.into_iter().rev().filter(|(_, length)| *length <= 1.0)
}

/// The units below s, ms first.
pub(crate) fn units_below_seconds() -> impl Iterator<Item = (&'static str, f64)> {
    units_to_seconds().filter(|(_, length)| *length < 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::measure::seconds;

    #[test]
    fn law_units_of_time_are_those_of_a_channel() {
        for (unit, length) in UNITS {
            assert_eq!(seconds(unit), Ok(length), "{unit}");
        }
    }

    #[test]
    fn value_units_are_tried_from_the_longest_on() {
        let names = |units: &mut dyn Iterator<Item = (&'static str, f64)>| -> Vec<&str> {
            units.map(|(unit, _)| unit).collect()
        };
        assert_eq!(names(&mut units_to_seconds()), ["s", "ms", "us", "ns"]);
        assert_eq!(names(&mut units_below_seconds()), ["ms", "us", "ns"]);
    }
}
