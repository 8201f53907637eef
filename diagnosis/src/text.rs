//! Numbers as people write them.

/// Three digits, without an exponent where a person would write none.
pub fn brief(value: f64) -> String {
    let whole = value == value.round() && value.abs() < 1e6;
    // by the digits that are shown: 0.009 999 9 is 0.010
    let shown = format!("{value:.2e}").parse().unwrap_or(value);
    match f64::abs(shown) {
        _ if whole => format!("{value:.0}"),
        100.0..1e6 => format!("{value:.0}"),
        10.0..100.0 => format!("{value:.1}"),
        1.0..10.0 => format!("{value:.2}"),
        0.01..1.0 => format!("{value:.3}"),
        _ => format!("{value:.2e}"),
    }
}

/// Numbers that stand in one row, with equally many decimals: the smallest has three digits. Where that would be too many, all have an
/// exponent.
pub fn alike<const N: usize>(values: [f64; N]) -> [String; N] {
    let sizes = values.iter().map(|value| value.abs()).filter(|size| *size > 0.0 && size.is_finite());
    // 1 where nothing is but zeros
    let least = sizes.reduce(f64::min).unwrap_or(1.0);
    let decimals = (2.0 - least.log10().floor()).max(0.0);
    match decimals <= 6.0 {
        true => values.map(|value| format!("{value:.0$}", decimals as usize)),
        false => values.map(|value| format!("{value:.2e}")),
    }
}

/// A number beside an estimate and its interval: with digits after the point that show the interval's width, four at least. Where eleven of
/// them show nothing of it, with an exponent.
pub fn with_digits_of(value: f64, estimate: f64, [low, high]: [f64; 2]) -> String {
    let width = high - low;
    let shows = |size: f64| (4..12_usize).find(|digits| size * 10f64.powi(*digits as i32) >= 10.0);
    let size = if width > 0.0 { width } else { estimate.abs() };
    match shows(size) {
        Some(digits) if width > 0.0 => format!("{value:.digits$}"),
        None if size > 0.0 => format!("{value:.2e}"),
        _ => format!("{value:.4}"),
    }
}

#[cfg(test)]
mod tests {
    use super::{alike, brief, with_digits_of};

    #[test]
    fn value_a_number_has_digits_that_show_its_interval() {
        let of = |value: f64, half: f64| with_digits_of(value, value, [value - half, value + half]);
        assert_eq!([of(0.02, 8e-5), of(1.5, 2.0)], ["0.02000", "1.5000"]);
        assert_eq!(of(3e-11, 1e-12), "3.00e-11");
        // a count has no interval
        assert_eq!([of(4.0, 0.0), of(3e-11, 0.0), of(0.0, 0.0)], ["4.0000", "3.00e-11", "0.0000"]);
        assert_eq!(of(2.0, f64::INFINITY), "2.0000", "nothing is known of it");
    }

    #[test]
    fn value_numbers_of_a_row_have_one_notation() {
        assert_eq!(alike([0.015_566, 0.005_342, 0.005_492]), ["0.01557", "0.00534", "0.00549"]);
        assert_eq!(alike([2.269, 2.142, 0.056_4]), ["2.2690", "2.1420", "0.0564"]);
        assert_eq!(alike([1234.0, 250.0]), ["1234", "250"]);
        assert_eq!(alike([2e-7, 0.0]), ["2.00e-7", "0.00e0"]);
        assert_eq!(alike([0.0, 0.0]), ["0.00", "0.00"]);
    }

    #[test]
    fn value_numbers_have_three_digits() {
        let told = [5.0, 1234.5, 9.999, 1.23456, 0.009_999_999_9, 1e-3, -0.25].map(brief);
        assert_eq!(told, ["5", "1234", "10.0", "1.23", "0.010", "1.00e-3", "-0.250"]);
    }
}
