//! How far what is drawn reaches.

use crate::Error;

/// Largest magnitude that is drawn; what lies beyond is a hole. A range of values must have a finite width, with its margin: the
/// drawing library looks for ticks without end in one that hasn't.
const DRAWN: f64 = 1e300;
/// Margin on either side of the data, as a share of its range.
const MARGIN: f64 = 0.06;

/// Whether a value has a place in a graph.
pub fn is_drawn(value: f64) -> bool {
    value.abs() <= DRAWN
}

/// Smallest and largest of the values that are drawn.
pub fn of(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let ends = values.filter(|value| is_drawn(*value)).map(|value| (value, value));
    ends.reduce(|(low, high), (value, _)| (low.min(value), high.max(value)))
}

/// The range of an axis over values of this extent: with a margin, and a band around values that are all the same, so that a line doesn't lie
/// on the frame.
pub fn with_margin((low, high): (f64, f64)) -> (f64, f64) {
    let span = high - low;
    let pad = if span > 0.0 { MARGIN * span } else { 0.5 * high.abs().max(1e-3) };
    (low - pad, high + pad)
}

/// The range that an axis was given, if it can be drawn over.
pub(crate) fn checked((low, high): (f64, f64), title: &str) -> Result<(f64, f64), Error> {
    if is_drawn(low) && is_drawn(high) {
        return Ok((low, high));
    }
    let why = format!("its axis runs from {low:e} to {high:e}, and values up to {DRAWN:e} can be drawn");
    Err(Error::Draw { title: title.to_owned(), why })
}

#[cfg(test)]
mod tests {
    use super::{is_drawn, of, with_margin};

    #[test]
    fn bad_values_beyond_every_range_are_none() {
        assert_eq!(of([f64::NAN, 1.0, f64::INFINITY, -2.0, 1e301].into_iter()), Some((-2.0, 1.0)));
        assert_eq!(of([f64::NAN, f64::MIN].into_iter()), None);
        assert!(is_drawn(-1e300) && !is_drawn(f64::MAX) && !is_drawn(f64::NAN));
    }

    #[test]
    fn value_the_widest_range_has_a_finite_width() {
        let (low, high) = with_margin((-1e300, 1e300));
        assert!((high - low).is_finite());
        assert_eq!(with_margin((0.0, 1.0)), (-0.06, 1.06));
        assert_eq!(with_margin((4.0, 4.0)), (2.0, 6.0));
    }
}
