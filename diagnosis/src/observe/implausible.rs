//! Values that nothing can have been measured at: a word of a logger's for what is missing, or cells that ran into each other.

use crate::statistics::levels::ROUNDING;
use crate::statistics::median::median;

/// When a value is no measurement, with the reasons.
struct Implausible {
    /// No sensor counts so far, in whatever unit: a double tells such numbers no more from the next whole one.
    least: f64,
    /// And beside such a value the usual ones of its column are nothing, even squared: `ROUNDING` of its rounding.
    beyond: f64,
}

/// Those in force.
const IMPLAUSIBLE: Implausible =
    Implausible { least: 1.0 / f64::EPSILON, beyond: 1.0 / (ROUNDING * ROUNDING) };

/// The first value of a column that can be no measurement: its place, and what is wrong with it. What is no number is passed over.
pub(crate) fn implausible(values: &[f64]) -> Option<(usize, String)> {
    let sizes = || values.iter().map(|value| value.abs()).filter(|size| size.is_finite());
    // most columns have none, and cost no sorting
    let at = values.iter().position(|value| value.is_finite() && value.abs() > IMPLAUSIBLE.least)?;
    let usual = median(sizes())?;
    let is_beyond =
        |value: &f64| value.is_finite() && value.abs() > IMPLAUSIBLE.least.max(IMPLAUSIBLE.beyond * usual);
    let at = at + values[at..].iter().position(is_beyond)?;
    let told = format!(
        "{:e} is no measurement, where half of the column's values are at most {usual:.2e} in size: write the value that was meant, or leave \
         the cell empty where nothing was measured",
        values[at]
    );
    Some((at, told))
}

#[cfg(test)]
mod tests {
    use super::implausible;

    #[test]
    fn value_a_number_that_no_sensor_gives_is_found() {
        let place = |values: &[f64]| implausible(values).map(|(place, _)| place);
        assert_eq!(place(&[19.0, -2.1, f64::NAN, 1e308, 14.3]), Some(3));
        assert_eq!(place(&[0.0, 0.0, 0.0, -1e30, 1e30]), Some(3));
        // a spike is an outlier, a pulse beside the rounding of zeros is one, and times since 1970 in ns are alike
        assert_eq!(place(&[19.0, 1e9, 14.3]), None);
        assert_eq!(place(&[1e-17, 1.0, -1e-17, 1e-17]), None);
        assert_eq!(place(&[1.7e18, 1.8e18, 1.7e18]), None);
    }
}
