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

#[cfg(test)]
mod tests {
    use super::brief;

    #[test]
    fn value_numbers_have_three_digits() {
        let told = [5.0, 1234.5, 9.999, 1.23456, 0.009_999_999_9, 1e-3, -0.25].map(brief);
        assert_eq!(told, ["5", "1234", "10.0", "1.23", "0.010", "1.00e-3", "-0.250"]);
    }
}
