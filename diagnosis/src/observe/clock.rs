//! What loggers write as times: the units they count in, and how large times since 1970 are. One place for all who judge the times of a
//! log: `log.rs`, `import`, `check`, and our rig.

use super::measure::seconds;
use std::ops::Range;

/// Units that loggers count time in and their lengths in s, from the shortest on.
pub(crate) const UNITS: [(&str, f64); 6] =
    [("ns", 1e-9), ("us", 1e-6), ("ms", 1e-3), ("s", 1.0), ("min", 60.0), ("h", 3600.0)];

/// Times from here on, s, are those of a clock (1e8 s after 1970 is March 1973) and no time of a model.
pub(crate) const EPOCH: f64 = 1e8;

/// Seconds since 1970 of anything that is logged today. Begins above `EPOCH`: that asks only what is no time of a model.
pub(crate) const SINCE_1970: Range<f64> = 1e9..1e10;

/// The unit of time that stands in the head of a column, as people write it (`t [ms]`, `t_ms`, `t in ms`); s where none does.
pub(crate) fn unit_in(head: &str) -> &str {
    let part = head.rsplit(|letter: char| " _/[](){}".contains(letter)).find(|part| !part.is_empty());
    // a lone letter is a name: `t` is the time, and no ton
    part.filter(|part| *part != head && seconds(part).is_ok()).unwrap_or("s")
}

/// The units up to s, s first.
pub(crate) fn units_to_seconds() -> impl Iterator<Item = (&'static str, f64)> {
    UNITS.into_iter().rev().filter(|(_, length)| *length <= 1.0)
}

/// The longest unit of time that is shorter than one of so many seconds and with which rows are near each other: told by how many times as far
/// apart they are then.
pub(crate) fn shorter_unit(seconds: f64, is_near: impl Fn(f64) -> bool) -> Option<&'static str> {
    let mut fits = UNITS.iter().rev().filter(|(_, length)| *length < seconds && is_near(length / seconds));
    fits.next().map(|(unit, _)| *unit)
}

/// The units below s, ms first.
pub(crate) fn units_below_seconds() -> impl Iterator<Item = (&'static str, f64)> {
    units_to_seconds().filter(|(_, length)| *length < 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_units_of_time_are_those_of_a_channel() {
        for (unit, length) in UNITS {
            assert_eq!(seconds(unit), Ok(length), "{unit}");
        }
    }

    #[test]
    fn value_the_unit_of_time_in_a_head() {
        for (head, unit) in
            [("t [ms]", "ms"), ("t_us", "us"), ("time in min", "min"), ("t (s)", "s"), ("t", "s"), ("n", "s")]
        {
            assert_eq!(unit_in(head), unit, "{head}");
        }
    }

    #[test]
    fn value_the_unit_in_which_rows_are_near() {
        // rows of 10, 10 000 and 60 of a unit, in a machine that moves within a second
        let of = |seconds: f64, row: f64| shorter_unit(seconds, |factor| row * factor <= 1.0);
        assert_eq!((of(1.0, 10.0), of(1.0, 1e4), of(60.0, 60.0)), (Some("ms"), Some("us"), Some("s")));
        assert_eq!(of(1e-9, 1.0), None);
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
