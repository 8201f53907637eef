//! Rows that a torque's log lost: the row before looks as if its torque had been held, and nobody knows what came after it.
//!
//! Only a log that a clock wrote has places for rows. One that is written where the torque changes lacks rows where it was held, and a
//! frame that was lost gave no command: nothing is missing there.

use super::row_times::{by_a_clock, typical_gap, unevenness};
use super::{Run, Table};
use crate::error::Notice;
use crate::rigs::acrobot::dataset::policy::LOGS;
use crate::rigs::acrobot::policy::POLICY;

/// Marks the times of a run, whose torque stands in `file`, at which a row of it was lost as times of which nothing is known.
pub fn mark_lost_rows(run: &mut Run, file: &str, notices: &mut Vec<Notice>) {
    let Some(log) = run.controller.as_ref() else { return };
    let lost = lost_rows(log, run.camera.as_ref());
    let Some((first, _)) = lost.first().copied() else { return };
    let rows: usize = lost.iter().map(|(_, rows)| rows).sum();
    let message = format!(
        "{rows} of {} rows {} missing, the first after this one: what the motor was told then is not known, and these times are left \
         out (if the torque was held, write gaps = \"known\" under [log])",
        log.len() + rows,
        if rows == 1 { "is" } else { "are" }
    );
    notices.push(Notice { file: format!("{}/{file}", run.name), line: log.line[first], message });
    let gaps: Vec<(f64, f64)> = lost.iter().map(|(row, _)| (log.time[*row], log.time[row + 1])).collect();
    run.controller.iter_mut().for_each(|log| gaps.iter().for_each(|(from, to)| log.tear(*from, *to)));
}

/// After which rows some are missing, and how many.
fn lost_rows(log: &Table, camera: Option<&Table>) -> Vec<(usize, usize)> {
    let even = |usual: &f64| unevenness(&log.time) < LOGS.even * usual;
    let Some(usual) = by_a_clock(log).filter(even) else { return Vec::new() };
    let gap = |row: usize| Some(log.time.get(row + 1)? - log.time[row]);
    // a row that is stamped late is followed by one that seems early
    let on_time =
        |row: Option<usize>| row.and_then(gap).is_none_or(|gap: f64| gap > (1.0 - LOGS.whole) * usual);
    let ignored = |row: usize| log.broken().any(|(from, _)| from == log.time[row]);
    let repeats = (1..log.len()).any(|row| log.same(row - 1, row));
    let once = |row: usize| (0..log.len()).filter(|other| log.same(row, *other)).count() == 1;
    let is_lost = |row: usize| {
        let places = gap(row)? / usual;
        let rows = (places.round() as usize).checked_sub(1).filter(|rows| *rows > 0)?;
        let told = || ignored(row) || log.same(row, row + 1) || !(repeats || once(row));
        let whole = (places - places.round()).abs() < LOGS.whole;
        let missing = whole && on_time(row.checked_sub(1)) && on_time(Some(row + 1)) && !told();
        (missing && !camera.is_some_and(|camera| pauses(camera, log.time[row], log.time[row + 1])))
            .then_some((row, rows))
    };
    (0..log.len()).filter_map(is_lost).collect()
}

/// Whether images, too, are missing in most of this time.
fn pauses(camera: &Table, from: f64, to: f64) -> bool {
    let Some(usual) = typical_gap(camera) else { return false };
    let pause = |pair: &[f64]| {
        let common = pair[1].min(to) - pair[0].max(from);
        pair[1] - pair[0] > POLICY.steps * usual && common > LOGS.most * (to - from)
    };
    camera.time.windows(2).any(pause)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows each `gap` s with another torque each, but for the places that `without` names.
    fn log(gap: f64, without: &[usize], tau: &dyn Fn(usize) -> f64, off: &dyn Fn(usize) -> f64) -> Table {
        let rows: Vec<usize> = (0..200).filter(|row| !without.contains(row)).collect();
        let time = rows.iter().map(|row| *row as f64 * gap + off(*row)).collect();
        Table::new(time, vec![("tau".into(), rows.iter().map(|row| tau(*row)).collect())])
    }

    fn anew(row: usize) -> f64 {
        libm::sin(row as f64)
    }

    fn even(_: usize) -> f64 {
        0.0
    }

    #[test]
    fn every_row_that_a_clock_would_have_written_is_missed() {
        assert_eq!(lost_rows(&log(0.03, &[], &anew, &even), None), []);
        assert_eq!(lost_rows(&log(0.03, &[50, 90, 91], &anew, &even), None), [(49, 1), (88, 2)]);
    }

    #[test]
    fn every_log_without_places_for_rows_is_whole() {
        let gone = [50, 90, 91];
        // held for four rows: the same before and after the first gap
        assert_eq!(lost_rows(&log(0.03, &gone, &|row| (row / 4) as f64, &even), None), [(88, 2)]);
        // no row is like the one before, and before each gap stands what stands elsewhere: written where it changes
        let changing = |row: usize| if [49, 89, 120].contains(&row) { 2.0 } else { anew(row) };
        assert_eq!(lost_rows(&log(0.03, &gone, &changing, &even), None), []);
        // one row in 30 is stamped as late as the next one, which comes at its own time
        let late = |row: usize| if row.is_multiple_of(30) { 0.028 } else { 0.0 };
        assert_eq!(lost_rows(&log(0.03, &[], &anew, &late), None), []);
        // three rows in ten come early: no clock
        let odd = |row: usize| if row % 10 < 3 { -0.02 } else { 0.0 };
        assert_eq!(lost_rows(&log(0.03, &gone, &anew, &odd), None), []);
    }

    #[test]
    fn every_command_that_no_frame_gave_was_held() {
        let torque = log(0.03, &[50, 90], &anew, &even);
        let frames = |without: &[usize]| log(0.03, without, &anew, &|_| 0.004);
        assert_eq!(lost_rows(&torque, Some(&frames(&[50]))), [(88, 1)]);
        assert_eq!(lost_rows(&torque, Some(&frames(&[]))).len(), 2);
    }

    #[test]
    fn value_a_row_is_missing_at_a_place_of_its_own_to_three_tenths_of_a_period() {
        // all rows after the gap are late by so much of a period
        let found = |late: f64| {
            lost_rows(&log(0.03, &[50], &anew, &|row| if row > 50 { 0.03 * late } else { 0.0 }), None).len()
        };
        assert_eq!([-0.31, -0.29, 0.29, 0.31].map(found), [0, 1, 1, 0]);
    }

    #[test]
    fn value_a_clock_is_even_to_a_tenth_of_its_period() {
        // one row in three is late by so much: two gaps in three are off by it
        let found = |late: f64| {
            let off = |row: usize| if row % 3 == 1 { 0.03 * late } else { 0.0 };
            lost_rows(&log(0.03, &[50, 51], &anew, &off), None).len()
        };
        // the median's share of a normal distribution, of a difference of two: 0.1 · 0.6745 · √2
        assert_eq!([0.095, 0.096].map(found), [1, 0]);
    }

    #[test]
    fn value_a_frame_is_lost_where_images_pause_for_most_of_the_time() {
        // a pause of two periods of the camera that covers so much of the torque's
        let found = |late: f64| {
            let torque = log(0.03, &[50], &anew, &even);
            lost_rows(&torque, Some(&log(0.03, &[50], &anew, &|_| 0.06 * late))).len()
        };
        assert_eq!([0.49, 0.51].map(found), [0, 1]);
    }
}
