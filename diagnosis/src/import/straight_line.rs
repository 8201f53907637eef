//! What a log shows against what the model shows on its inputs: a straight line.

use super::policy::IMPORT;

/// Measured against simulated: measured = slope · simulated + offset.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    /// In the log's unit per unit of the model.
    pub slope: f64,
    /// In the log's unit.
    pub offset: f64,
    /// Between -1 and 1.
    pub correlation: f64,
    /// Standard deviation of the measured values, in the log's unit.
    pub spread: f64,
    /// Means of simulated (in the model's unit) and measured values (in the log's).
    pub mean: (f64, f64),
    /// Whether the model began where the log does, or each state where the log says.
    pub begun: bool,
}

impl Line {
    /// Whether the model does what the log does, its sign aside.
    pub fn fits(&self) -> bool {
        self.correlation.abs() >= IMPORT.unit.0 && (self.slope.abs() - 1.0).abs() < IMPORT.unit.1
    }
}

/// The line through measured against simulated values, by least squares.
pub(super) fn line(points: &[(f64, f64)], times: &[f64], series: &[f64]) -> Option<Line> {
    let pairs: Vec<(f64, f64)> = (points.iter())
        .filter_map(|(time, measured)| {
            let next = times.partition_point(|at| at <= time).clamp(1, times.len() - 1);
            let share = (time - times[next - 1]) / (times[next] - times[next - 1]);
            let simulated = series[next - 1] + share.clamp(0.0, 1.0) * (series[next] - series[next - 1]);
            simulated.is_finite().then_some((simulated, *measured))
        })
        .collect();
    let count = pairs.len() as f64;
    let mean = pairs.iter().fold((0.0, 0.0), |sum, pair| (sum.0 + pair.0 / count, sum.1 + pair.1 / count));
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in &pairs {
        let (x, y) = (x - mean.0, y - mean.1);
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
    }
    if pairs.len() < 3 || xx <= 0.0 || yy <= 0.0 {
        return None;
    }
    let slope = xy / xx;
    Some(Line {
        slope,
        offset: mean.1 - slope * mean.0,
        correlation: xy / (xx * yy).sqrt(),
        spread: (yy / count).sqrt(),
        mean,
        begun: true,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_a_sign_and_an_offset_are_believed_from_a_slope_of_one_only() {
        let line = |slope, correlation| Line {
            slope,
            offset: 0.0,
            correlation,
            spread: 1.0,
            mean: (0.0, 0.0),
            begun: true,
        };
        assert!(line(-1.0, -0.95).fits() && line(1.25, 0.95).fits());
        assert!(!line(0.35, 0.98).fits() && !line(-0.29, -1.0).fits() && !line(1.0, 0.85).fits());
    }

    #[test]
    fn value_a_line_is_found_again() {
        let times: Vec<f64> = (0..100).map(|row| 0.1 * f64::from(row)).collect();
        let series: Vec<f64> = times.iter().map(|time| time.sin()).collect();
        let points: Vec<(f64, f64)> = times.iter().map(|time| (*time, 3.0 - 2.0 * time.sin())).collect();
        let found = line(&points, &times, &series).expect("it moves");
        let off = (found.slope + 2.0).abs() + (found.offset - 3.0).abs() + (found.correlation + 1.0).abs();
        // sums of a hundred products
        assert!(off < 1e-12, "{found:?}");
    }
}
