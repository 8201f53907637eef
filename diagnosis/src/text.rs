//! Numbers as people write them.

/// Three digits, without an exponent where a person would write none.
pub fn brief(value: f64) -> String {
    let whole = value == value.round() && value.abs() < 1e6;
    match value.abs() {
        _ if whole => format!("{value:.0}"),
        100.0..1e6 => format!("{value:.0}"),
        10.0..100.0 => format!("{value:.1}"),
        1.0..10.0 => format!("{value:.2}"),
        0.01..1.0 => format!("{value:.3}"),
        _ => format!("{value:.2e}"),
    }
}
