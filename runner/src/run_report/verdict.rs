//! The verdict on a run: the scenario's `[report.verdict]` says what is wished and what is counted; without it a verdict
//! is that the run came to its end.
//!
//! ```toml
//! [report.verdict]
//! fails_when = "plant.contact"     # Boolean; once it is true, the run has failed
//! failed = "lost balance"          # words for that
//! held = "balanced"                # and for a run that did not fail
//! figures = [                      # numbers, up to the failure
//!     { label = "rms tracking error", signal = "controller.z_desired", minus = "plant.z", reduce = "rms" },
//!     { label = "unseen frames", signal = "camera.frame_index", valid = "camera.valid", reduce = "lost" },
//! ]
//! ```
//!
//! `reduce` is `last`, `min`, `max`, `mean`, `rms`, `peak` (the largest absolute value), each over the rows, or `lost`: of
//! a counter, the numbers that were passed over, and those that came while `valid` was false.

use serde::Deserialize;

/// `[report.verdict]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct VerdictEntry {
    /// `unit.variable` of a Boolean.
    pub fails_when: Option<String>,
    /// Words for a run that failed.
    pub failed: String,
    /// Words for one that did not.
    pub held: String,
    /// Numbers.
    pub figures: Vec<FigureEntry>,
}

impl Default for VerdictEntry {
    fn default() -> Self {
        Self { fails_when: None, failed: "failed".into(), held: "ran".into(), figures: Vec::new() }
    }
}

/// A number of the verdict.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FigureEntry {
    /// What it is called.
    pub label: String,
    /// `unit.variable`
    pub signal: String,
    /// Taken off the signal.
    pub minus: Option<String>,
    /// Only for `lost`: false in rows whose count is lost, too.
    pub valid: Option<String>,
    /// What becomes of the rows.
    pub reduce: Reduce,
}

/// What becomes of the rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Reduce {
    /// The last value.
    Last,
    /// The least.
    Min,
    /// The greatest.
    Max,
    /// The mean.
    Mean,
    /// The root of the mean square.
    Rms,
    /// The greatest absolute value.
    Peak,
    /// Counts that were passed over or not valid.
    Lost,
}

impl VerdictEntry {
    /// Variables that are true or false, with the key that names them.
    pub fn booleans(&self) -> impl Iterator<Item = (&'static str, &String)> {
        let valid = self.figures.iter().filter_map(|figure| Some(("valid", figure.valid.as_ref()?)));
        self.fails_when.iter().map(|name| ("fails_when", name)).chain(valid)
    }

    /// Every variable that it needs.
    pub fn signals(&self) -> impl Iterator<Item = &String> {
        let figures = self.figures.iter();
        let named =
            figures.flat_map(|figure| [Some(&figure.signal), figure.minus.as_ref(), figure.valid.as_ref()]);
        named.flatten().chain(&self.fails_when)
    }
}

/// Takes the values of a figure, row by row.
#[derive(Debug, Clone)]
pub enum Tally {
    /// What scalars of a sweep are, too.
    Reduced(report::tally::Tally),
    /// Counts that are lost.
    Lost(Lost),
}

/// Of a counter, the numbers that were passed over, and those that came while they were not valid.
#[derive(Debug, Clone, Default)]
pub struct Lost {
    /// The count before.
    before: Option<f64>,
    lost: f64,
    /// By how much it counted on, in how many rows.
    counted: f64,
    rows: u64,
}

impl Tally {
    /// Nothing yet.
    pub fn new(reduce: Reduce) -> Self {
        let shared = match reduce {
            Reduce::Last => report::tally::Reduce::Last,
            Reduce::Min => report::tally::Reduce::Min,
            Reduce::Max => report::tally::Reduce::Max,
            Reduce::Mean => report::tally::Reduce::Mean,
            Reduce::Rms => report::tally::Reduce::Rms,
            Reduce::Peak => report::tally::Reduce::Peak,
            Reduce::Lost => return Self::Lost(Lost::default()),
        };
        Self::Reduced(report::tally::Tally::new(shared))
    }

    /// The next row. What is no number counts as none.
    pub fn push(&mut self, time: f64, value: f64, valid: bool) {
        match self {
            Self::Reduced(tally) => tally.push(time, value),
            Self::Lost(lost) if !value.is_nan() => lost.push(value, valid),
            Self::Lost(_) => {}
        }
    }

    /// The number; `None` if there was no row.
    pub fn finish(&self) -> Option<f64> {
        match self {
            Self::Reduced(tally) => tally.finish(),
            Self::Lost(Lost { before, lost, .. }) => before.map(|_| *lost),
        }
    }

    /// Why some that count as lost were there all the same: what counts faster than there are rows has some between two of them.
    pub fn between_rows(&self, signal: &str, label: &str) -> Option<String> {
        let Self::Lost(Lost { counted, rows, .. }) = self else { return None };
        let between = counted - *rows as f64;
        // one may come by where the first and the last row lie
        (between > 1.0).then(|| {
            format!(
                "{signal} counts {counted} on in {rows} rows: at least {between} of the {label} came between two rows, and were passed over, \
                 not dropped; a shorter interval would see them"
            )
        })
    }
}

impl Lost {
    fn push(&mut self, value: f64, valid: bool) {
        // A counter below zero hasn't begun.
        if value >= 0.0 {
            let before = self.before.filter(|before| *before >= 0.0).unwrap_or(value - 1.0);
            if self.before.is_some_and(|before| before >= 0.0) {
                self.rows += 1;
                self.counted += (value - before).max(0.0);
            }
            if value > before {
                self.lost += value - before - 1.0 + f64::from(u8::from(!valid));
            }
        }
        self.before = Some(value);
    }
}

#[cfg(test)]
mod tests {
    use super::{Reduce, Tally};

    fn of(reduce: Reduce, rows: &[(f64, bool)]) -> Option<f64> {
        let mut tally = Tally::new(reduce);
        rows.iter().for_each(|(value, valid)| tally.push(0.0, *value, *valid));
        tally.finish()
    }

    #[test]
    fn value_each_name_reduces_as_it_says() {
        let rows = [3.0, -4.0, f64::NAN, 1.0].map(|value| (value, true));
        // (9 + 16 + 1)/3 = 8.6667; NaN is no row.
        let expected = [
            (Reduce::Last, 1.0),
            (Reduce::Min, -4.0),
            (Reduce::Max, 3.0),
            (Reduce::Mean, 0.0),
            (Reduce::Rms, (26.0_f64 / 3.0).sqrt()),
            (Reduce::Peak, 4.0),
        ];
        for (reduce, value) in expected {
            assert_eq!(of(reduce, &rows), Some(value), "{reduce:?}");
            assert_eq!(of(reduce, &[]), None);
        }
    }

    #[test]
    fn value_lost_counts_gaps_and_invalid_ones_once() {
        let rows =
            [(-1.0, false), (-1.0, false), (0.0, true), (0.0, true), (1.0, false), (1.0, false), (4.0, true)];
        // 1 came invalid, 2 and 3 were passed over; before the first there is nothing to lose.
        assert_eq!(of(Reduce::Lost, &rows), Some(3.0));
        assert_eq!(of(Reduce::Lost, &[(7.0, true), (8.0, true)]), Some(0.0), "a run may begin at any count");
        assert_eq!(of(Reduce::Lost, &[(f64::NAN, true)]), None);
    }

    #[test]
    fn value_what_comes_between_two_rows_is_told_as_not_dropped() {
        let told = |counts: &[f64]| {
            let mut tally = Tally::new(Reduce::Lost);
            counts.iter().for_each(|count| tally.push(0.0, *count, true));
            tally.between_rows("camera.frame_index", "unseen frames")
        };
        // 5 frames in 3 rows: of the 2 that were passed over none need have been dropped
        let said = told(&[-1.0, 0.0, 2.0, 3.0, 5.0]).expect("it is faster");
        let expected =
            "camera.frame_index counts 5 on in 3 rows: at least 2 of the unseen frames came between two rows";
        assert!(said.starts_with(expected), "{said}");
        // one is missing of a camera that is slower than the rows
        assert_eq!(told(&[0.0, 0.0, 1.0, 1.0, 3.0]), None);
    }
}
