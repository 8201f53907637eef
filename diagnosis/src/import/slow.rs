//! A model that takes too long for a log: how long it may, and the question whether the times are in another unit.

use super::Time;
use super::policy::IMPORT;
use super::sheet::Sheet;
use crate::observe::shorter_unit;
use crate::options::GIVEN_UP;
use orchestrator::fmu::Description;
use std::time::Duration;

/// What to do about times that are in another unit.
pub(super) const WRITE_IT: &str =
    "Write the unit into the head of the column of time, as in \"time [ms]\", and import again";

/// How far apart the rows of a log are, as its times are read.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pace {
    /// Head of the column of time.
    head: String,
    /// Usual distance of rows, s.
    row: f64,
    /// From the first row to the last, s.
    span: f64,
    /// The unit's own step, s, if its description tells one.
    own: Option<f64>,
    /// The unit of time in which the rows are no longer far apart, where they are.
    shorter: Option<&'static str>,
}

impl Pace {
    /// Of a log, where the time stands so.
    pub(super) fn of(sheet: &Sheet, time: &Time, description: &Description) -> Self {
        let place = sheet.place(&time.name);
        let row = place.map_or(0.0, |place| sheet.usual_gap(place) * time.seconds);
        let ends = |place| Some(sheet.rows.last()?[place] - sheet.rows.first()?[place]);
        let span = place.and_then(ends).unwrap_or(0.0) * time.seconds;
        let own = description.default_experiment.step_size.filter(|step| *step > 0.0);
        let shorter = own.and_then(|own| shorter(time.seconds, row, own));
        Self { head: time.name.clone(), row, span, own, shorter }
    }

    /// Real time that a look at the unit may take on this log.
    pub(super) fn patience(&self) -> Duration {
        let seconds = if self.shorter.is_some() { IMPORT.short_patience } else { IMPORT.patience };
        Duration::from_secs_f64(seconds)
    }

    /// Real time that a search in a few rows may take: its steps are counted, and only one in a unit that is slow is ended by the clock.
    pub(super) fn patience_of_search() -> Duration {
        Duration::from_secs_f64(GIVEN_UP)
    }

    /// What to ask of times in which rows are so far apart; nothing where they are not.
    pub(super) fn question(&self) -> Option<String> {
        let (unit, own) = self.shorter.zip(self.own)?;
        Some(format!(
            "as they are read, the rows of column {:?} are {:.3e} s apart and span {:.3e} s, and the unit's own step is {own:.3e} s: are these times in \
             {unit}?",
            self.head, self.row, self.span
        ))
    }

    /// What to say where the unit had not come to an end within that time.
    pub(super) fn too_slow(&self) -> String {
        let seconds = self.patience().as_secs_f64();
        let advice = match self.question() {
            Some(question) => format!("{question} {WRITE_IT}"),
            None => "if it is so slow, give it fewer rows".to_owned(),
        };
        format!("the model takes more than {seconds} s on the longest log: {advice}")
    }
}

/// The unit of time in which rows are near each other; nothing where they are as they are read.
fn shorter(seconds: f64, row: f64, own: f64) -> Option<&'static str> {
    let is_near = |factor: f64| row * factor <= IMPORT.rows_apart * own;
    if is_near(1.0) { None } else { shorter_unit(seconds, is_near) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pace(row: f64, own: Option<f64>) -> Pace {
        let shorter = own.and_then(|own| super::shorter(1.0, row, own));
        Pace { head: "t [s]".into(), row, span: 600.0 * row, own, shorter }
    }

    #[test]
    fn value_times_that_may_be_ms_are_asked_about_and_given_less_time() {
        let told = pace(10.0, Some(0.01)).question().expect("a thousand steps a row");
        for part in ["\"t [s]\"", "1.000e1 s apart", "6.000e3 s", "1.000e-2 s", "in ms?"] {
            assert!(told.contains(part), "{told}");
        }
        // twenty steps a row are usual, and a unit that tells no step of its own is just slow
        for (row, own) in [(0.2, Some(0.01)), (10.0, None)] {
            assert_eq!(pace(row, own).question(), None);
            assert!(pace(row, own).too_slow().contains("fewer rows"));
            assert!(pace(row, own).patience() > pace(10.0, Some(0.01)).patience());
        }
    }
}
