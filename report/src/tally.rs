//! Numbers of a run: what becomes of a signal over its rows, as a figure of a verdict and as a scalar of a sweep.

/// What is made of the values in the rows of a run. A value that is no number is no row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reduce {
    /// The last one.
    Last,
    /// The smallest.
    Min,
    /// The largest.
    Max,
    /// Their mean: every row counts alike.
    Mean,
    /// The root of the mean of their squares.
    Rms,
    /// The largest absolute value.
    Peak,
    /// The time in s of the first row at which something is so.
    FirstTrue(Test),
}

/// What is so of a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Test {
    /// It is true (a number other than 0).
    True,
    /// It is above a limit.
    Above(f64),
    /// It is below a limit.
    Below(f64),
}

impl Test {
    fn holds(self, value: f64) -> bool {
        match self {
            Self::True => value != 0.0,
            Self::Above(limit) => value > limit,
            Self::Below(limit) => value < limit,
        }
    }
}

impl Reduce {
    /// The names of all.
    pub const NAMES: [&'static str; 7] = ["last", "min", "max", "mean", "rms", "peak", "first_true"];

    /// The one of a name.
    pub fn named(name: &str, test: Test) -> Option<Self> {
        Some(match name {
            "last" => Self::Last,
            "min" => Self::Min,
            "max" => Self::Max,
            "mean" => Self::Mean,
            "rms" => Self::Rms,
            "peak" => Self::Peak,
            "first_true" => Self::FirstTrue(test),
            _ => return None,
        })
    }
}

/// Takes the values, row by row.
#[derive(Debug, Clone, Copy)]
pub struct Tally {
    reduce: Reduce,
    rows: f64,
    /// The value, or the sum so far.
    value: f64,
}

impl Tally {
    /// Nothing yet.
    pub fn new(reduce: Reduce) -> Self {
        Self { reduce, rows: 0.0, value: 0.0 }
    }

    /// Before the first row of another run.
    pub fn clear(&mut self) {
        (self.rows, self.value) = (0.0, 0.0);
    }

    /// The next row.
    #[inline]
    pub fn push(&mut self, time: f64, value: f64) {
        if value.is_nan() {
            return;
        }
        let first = self.rows == 0.0;
        match self.reduce {
            Reduce::Last => self.value = value,
            Reduce::Min => self.value = if first { value } else { self.value.min(value) },
            Reduce::Max => self.value = if first { value } else { self.value.max(value) },
            Reduce::Mean => self.value += value,
            Reduce::Rms => self.value += value * value,
            Reduce::Peak => self.value = self.value.max(value.abs()),
            // Rows count from the one on at which it is so.
            Reduce::FirstTrue(test) if first && !test.holds(value) => return,
            Reduce::FirstTrue(_) if first => self.value = time,
            Reduce::FirstTrue(_) => {}
        }
        self.rows += 1.0;
    }

    /// The number; `None` if there was no row, or it never was so.
    pub fn finish(&self) -> Option<f64> {
        let value = match self.reduce {
            Reduce::Mean => self.value / self.rows,
            Reduce::Rms => (self.value / self.rows).sqrt(),
            _ => self.value,
        };
        (self.rows > 0.0).then_some(value)
    }
}

#[cfg(test)]
mod tests {
    use super::{Reduce, Tally, Test};

    fn of(reduce: Reduce, rows: &[f64]) -> Option<f64> {
        let mut tally = Tally::new(reduce);
        rows.iter().enumerate().for_each(|(row, value)| tally.push(0.5 * row as f64, *value));
        tally.finish()
    }

    #[test]
    fn value_reductions() {
        let rows = [-3.0, -4.0, f64::NAN, -1.0];
        // (9 + 16 + 1)/3 = 8.6667, -8/3; what is no number is no row.
        let expected = [
            (Reduce::Last, -1.0),
            (Reduce::Min, -4.0),
            (Reduce::Max, -1.0),
            (Reduce::Mean, -8.0 / 3.0),
            (Reduce::Rms, (26.0_f64 / 3.0).sqrt()),
            (Reduce::Peak, 4.0),
        ];
        for (reduce, value) in expected {
            assert_eq!(of(reduce, &rows), Some(value), "{reduce:?}");
            assert_eq!(of(reduce, &[]), None);
        }
    }

    #[test]
    fn every_name_means_its_reduction() {
        let test = Test::Above(1.5);
        let rows = [-3.0, 2.0, 1.0];
        let expected = [1.0, -3.0, 2.0, 0.0, (14.0_f64 / 3.0).sqrt(), 3.0, 0.5];
        for (name, expected) in Reduce::NAMES.into_iter().zip(expected) {
            let reduce = Reduce::named(name, test).expect("a name");
            assert_eq!(of(reduce, &rows), Some(expected), "{name}");
        }
        assert_eq!(Reduce::named("median", test), None);
    }

    #[test]
    fn law_a_cleared_tally_is_a_new_one() {
        for name in Reduce::NAMES {
            let reduce = Reduce::named(name, Test::True).expect("a name");
            let mut tally = Tally::new(reduce);
            (0..5).for_each(|row| tally.push(f64::from(row), 9.0));
            tally.clear();
            assert_eq!(tally.finish(), None, "{name}");
            [0.0, 2.0, 1.0]
                .into_iter()
                .zip([0.0, 0.5, 1.0])
                .for_each(|(value, time)| tally.push(time, value));
            assert_eq!(tally.finish(), of(reduce, &[0.0, 2.0, 1.0]), "{name}");
        }
    }

    #[test]
    fn value_first_times() {
        let first = |test, rows: &[f64]| of(Reduce::FirstTrue(test), rows);
        assert_eq!(first(Test::True, &[0.0, 0.0, 1.0, 0.0, 1.0]), Some(1.0));
        assert_eq!(first(Test::True, &[1.0]), Some(0.0));
        assert_eq!(first(Test::True, &[0.0, 0.0]), None);
        assert_eq!(first(Test::Above(2.0), &[0.0, 2.0, 2.5, 9.0]), Some(1.0));
        assert_eq!(first(Test::Below(-1.0), &[0.0, f64::NAN, -1.0, -2.0]), Some(1.5));
    }
}
