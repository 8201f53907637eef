//! Signals fed to inputs from outside: constants and tables over time.

use crate::scenario::Shape;

/// A table over time, read at times that mostly rise.
#[derive(Debug, Clone)]
pub(crate) struct Signal {
    shape: Shape,
    points: Vec<(f64, f64)>,
    /// The segment that was read last.
    segment: usize,
}

impl Signal {
    /// `points` is not empty and its times don't fall.
    pub(crate) fn new(shape: Shape, points: Vec<(f64, f64)>) -> Self {
        Self { shape, points, segment: 0 }
    }

    /// Its table, in order of time.
    pub(crate) fn points(&self) -> &[(f64, f64)] {
        &self.points
    }

    /// It jumps from value to value.
    pub(crate) fn holds(&self) -> bool {
        self.shape == Shape::Hold
    }

    /// The value at a time. Of several points at the same time the last one counts, so that a table may jump.
    pub(crate) fn at(&mut self, time: f64) -> f64 {
        let points = &self.points;
        if time < points[self.segment].0 {
            self.segment = 0;
        }
        while self.segment + 1 < points.len() && points[self.segment + 1].0 <= time {
            self.segment += 1;
        }
        let (from, value) = points[self.segment];
        let Some(&(to, next)) = points.get(self.segment + 1) else { return value };
        if time <= from {
            return value;
        }
        let share = (time - from) / (to - from);
        match self.shape {
            Shape::Hold => value,
            Shape::Linear => value + (next - value) * share,
            Shape::Smooth => value + (next - value) * smooth_step(share),
        }
    }
}

/// The polynomial of degree nine that goes from 0 to 1 with four vanishing derivatives at both ends:
/// s(u) = u⁵ (126 - 420 u + 540 u² - 315 u³ + 70 u⁴), evaluated in this order so that others get the same bits.
pub fn smooth_step(u: f64) -> f64 {
    let power = u * u * u * u * u;
    power * (126.0 + u * (-420.0 + u * (540.0 + u * (-315.0 + u * 70.0))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_tables_between_their_points() {
        let points = vec![(1.0, 2.0), (2.0, 4.0), (2.0, 10.0), (4.0, 0.0)];
        for (shape, expected) in [
            (Shape::Hold, [2.0, 2.0, 2.0, 10.0, 10.0, 0.0, 0.0]),
            (Shape::Linear, [2.0, 2.0, 3.0, 10.0, 5.0, 0.0, 0.0]),
            (Shape::Smooth, [2.0, 2.0, 3.0, 10.0, 5.0, 0.0, 0.0]),
        ] {
            let mut signal = Signal::new(shape, points.clone());
            let times = [0.0, 1.0, 1.5, 2.0, 3.0, 4.0, 9.0];
            assert_eq!(times.map(|time| signal.at(time)), expected, "{shape:?}");
            assert_eq!(signal.at(0.5), 2.0, "back in time, {shape:?}");
        }
    }

    #[test]
    fn law_smooth_step_is_flat_at_its_ends_and_symmetric() {
        assert_eq!([smooth_step(0.0), smooth_step(0.5), smooth_step(1.0)], [0.0, 0.5, 1.0]);
        // Near 0 the leading term is 126 u⁵: the first four derivatives vanish.
        assert!((smooth_step(1e-3) / 126e-15 - 1.0).abs() < 4e-3);
        // s(u) + s(1-u) = 1; both have rounding errors of some ulp of the largest term, 540.
        for step in 0..=1000 {
            let u = f64::from(step) / 1000.0;
            assert!((smooth_step(u) + smooth_step(1.0 - u) - 1.0).abs() < 540.0 * 4.0 * f64::EPSILON);
        }
    }
}
