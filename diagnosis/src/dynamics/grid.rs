//! The rows of a run: every time at which a compared channel has a value.

use super::machine::Machine;
use super::policy::DYNAMICS;
use crate::observe::{Hold, Reading, Run};
pub use crate::ports::Course;
use crate::statistics::levels::{HALF, MORE};
use crate::statistics::median::{median, usual_step};
use std::ops::Range;

/// A value of a compared channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Place among [`Machine::channels`].
    pub channel: usize,
    /// Time, s.
    pub time: f64,
    /// In the variable's own unit.
    pub value: f64,
}

/// Times at which an input jumps, s: at all where it seldom moves, by more than usual where it always does.
pub(super) fn jumps(course: &Course) -> Vec<f64> {
    jumps_beyond(course, 0.0)
}

/// The same where it moves by more than this share of all that it moves through, too: a brake that is mostly at rest and then pressed slowly moves by
/// more than usual in each row, and jolts nothing.
pub(super) fn jumps_beyond(course: &Course, share: f64) -> Vec<f64> {
    let moves: Vec<f64> = course.values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let usual = median(moves.iter().copied()).unwrap_or(0.0);
    let times = course.time.iter().skip(1).zip(&moves);
    let ends = |ends: (f64, f64), value: &f64| (ends.0.min(*value), ends.1.max(*value));
    let (least, most) = course.values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    let enough = (DYNAMICS.jump * usual).max(share * (most - least));
    times.filter(|(_, by)| **by > enough).map(|(time, _)| *time).collect()
}

/// One run, as the sweep walks it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Grid {
    /// Name of the run.
    pub name: String,
    /// Times of the rows, s.
    pub time: Vec<f64>,
    /// Values, ordered by time.
    pub samples: Vec<Sample>,
    /// Fed inputs, as [`Machine::inputs`].
    pub inputs: Vec<Course>,
    /// When the run begins, s: drifts count from there.
    pub origin: f64,
    /// Where a run that is simulated whole is started, as [`Machine::begins`]: values and how far they may be off.
    pub begin: Vec<(f64, f64)>,
    /// Where nobody knows what was fed.
    pub lost: Vec<Lost>,
}

/// A stretch in which nobody knows what a fed input was: rows of the log are missing, or its cells are empty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lost {
    /// Place among [`Machine::inputs`].
    pub input: usize,
    /// The row before it, s; -∞ before an input's own log begins.
    pub from: f64,
    /// The row after it, s.
    pub to: f64,
    /// Its rows' usual distance, s: so long what was logged before holds.
    pub usual: f64,
}

impl Lost {
    /// When it acts, with each input late by so much, s.
    fn later(&self, late: &[f64]) -> Self {
        let late = late.get(self.input).copied().unwrap_or(0.0);
        Self { from: self.from + late, to: self.to + late, ..*self }
    }

    /// Intervals of rows of which some lies in it. Timestamps jitter: half a row is none.
    fn intervals(&self, time: &[f64]) -> Range<usize> {
        let rows = self.between(time, MORE, HALF);
        rows.start.saturating_sub(1)..rows.end.min(time.len().saturating_sub(1))
    }

    /// Rows at which what was read was read with an input that nobody knows.
    fn rows(&self, time: &[f64], reading: Reading) -> Range<usize> {
        match reading {
            Reading::Before => self.between(time, MORE, -HALF),
            Reading::After => self.between(time, HALF, HALF),
        }
    }

    /// Rows in it, but for so many usual ones at its begin and at its end.
    fn between(&self, time: &[f64], late: f64, early: f64) -> Range<usize> {
        let begin = time.partition_point(|time| *time <= self.from + late * self.usual);
        let end = time.partition_point(|time| *time < self.to - early * self.usual);
        begin..end
    }
}

/// The usual distance of rows, s; infinite below two rows.
pub(super) fn usual(time: &[f64]) -> f64 {
    usual_step(time).unwrap_or(f64::INFINITY)
}

/// Where nobody knows what the inputs were that are logged row by row.
fn lost(time: &[f64], inputs: &[(bool, &Course)]) -> Vec<Lost> {
    let row = usual(time);
    let of = |(input, (logged, course)): (usize, &(bool, &Course))| {
        let own = usual(&course.time);
        if !logged || own >= DYNAMICS.missing * row {
            return Vec::new();
        }
        let begun = before_its_log(input, time, course);
        let lacks = |place: &usize| {
            let long = (course.time[place + 1] - course.time[*place]) / own;
            let other = course.hold == Hold::Zero && course.values[*place] != course.values[place + 1];
            long > DYNAMICS.missing && (other || long > 2.0 * DYNAMICS.missing)
        };
        let places: Vec<usize> = (0..course.time.len() - 1).filter(lacks).collect();
        if places.len() as f64 > DYNAMICS.seldom * course.time.len() as f64 {
            return Vec::from_iter(begun);
        }
        let one =
            |place: usize| Lost { input, from: course.time[place], to: course.time[place + 1], usual: own };
        begun.into_iter().chain(places.into_iter().map(one)).collect()
    };
    inputs.iter().enumerate().flat_map(of).collect()
}

/// The rows before an input's own log begins.
fn before_its_log(input: usize, time: &[f64], course: &Course) -> Option<Lost> {
    let (first, to, usual) = (*time.first()?, *course.time.first()?, usual(&course.time));
    (to - first > DYNAMICS.missing * usual).then_some(Lost { input, from: f64::NEG_INFINITY, to, usual })
}

/// Times of rows, of all values' in their order.
fn rows(mut time: Vec<f64>) -> Vec<f64> {
    let span = time.last().zip(time.first()).map_or(0.0, |(last, first)| last - first);
    let near = DYNAMICS.same_row * span / time.len().max(1) as f64;
    time.dedup_by(|later, earlier| *later - *earlier <= near);
    time
}

impl Grid {
    /// Of a run, between two times.
    pub fn new(machine: &Machine, run: &Run, from: f64, to: f64) -> Self {
        let mut samples: Vec<Sample> = Vec::new();
        for (channel, output) in machine.channels.iter().enumerate() {
            let series = &run.series[output.channel];
            let within = series.time.iter().zip(&series.values).filter(|(t, _)| (from..=to).contains(*t));
            samples.extend(within.map(|(time, value)| Sample { channel, time: *time, value: *value }));
        }
        samples.sort_by(|a, b| a.time.total_cmp(&b.time).then(a.channel.cmp(&b.channel)));
        let time = rows(samples.iter().map(|sample| sample.time).collect());
        let mut row = 0;
        for sample in &mut samples {
            while row + 1 < time.len() && time[row + 1] <= sample.time {
                row += 1;
            }
            sample.time = time[row];
        }
        let inputs: Vec<Course> = machine
            .inputs
            .iter()
            .map(|input| {
                let (begin, series) = match input.channel {
                    Some(channel) => (0.0, &run.series[channel]),
                    None => (run.span().0, &input.given),
                };
                let time: Vec<f64> = series.time.iter().map(|time| begin + time).collect();
                let values = series.values.clone();
                Course { time, values, hold: input.hold }
            })
            .collect();
        let logged = machine.inputs.iter().map(|input| input.channel.is_some());
        let lost = lost(&time, &logged.zip(&inputs).collect::<Vec<_>>());
        let begins = machine.channels.iter().filter_map(|output| run.series[output.channel].time.first());
        let origin = begins.copied().fold(f64::INFINITY, f64::min);
        Self { name: run.name.clone(), time, samples, inputs, origin, begin: Vec::new(), lost }
    }

    /// Whether nobody knows what was fed in each interval, with each input `late` by so much, s: the state behind it is as unknown as the
    /// first. Of those in which what acted came from before the log the last will do.
    pub fn torn(&self, late: &[f64]) -> Vec<bool> {
        let count = self.time.len().saturating_sub(1);
        let lost = self.lost.iter().map(|lost| lost.later(late).intervals(&self.time));
        let last = |rows: Range<usize>| rows.end.saturating_sub(1).max(rows.start)..rows.end.min(count);
        marked(count, lost.chain(self.fed_before(late).map(last)))
    }

    /// Whether each row was read with an input that nobody knows, with each input `late` by so much, s: the first, too, if before its own
    /// inputs acted.
    pub fn rows_with_unknown_input(&self, reading: Reading, late: &[f64]) -> Vec<bool> {
        let first = 0..usize::from(reading == Reading::Before).min(self.time.len());
        let rows = self.lost.iter().map(|lost| lost.later(late).rows(&self.time, reading));
        marked(self.time.len(), rows.chain(self.fed_before(late)).chain(std::iter::once(first)))
    }

    /// For each input the rows, from where its log begins, at which what acts was fed before that.
    fn fed_before(&self, late: &[f64]) -> impl Iterator<Item = Range<usize>> {
        let before = |when: f64| self.time.partition_point(|time| *time < when);
        let begins = self.inputs.iter().map(|course| course.time.first().copied().unwrap_or(f64::INFINITY));
        begins.zip(late).map(move |(first, late)| before(first)..before(first + late))
    }

    /// Length, s.
    pub fn span(&self) -> f64 {
        self.time.last().zip(self.time.first()).map_or(0.0, |(last, first)| last - first)
    }
}

/// Which of so many lie in one of the ranges.
fn marked(count: usize, ranges: impl Iterator<Item = Range<usize>>) -> Vec<bool> {
    let mut marked = vec![false; count];
    for range in ranges {
        for place in range {
            marked[place] = true;
        }
    }
    marked
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows one apart but for so many between two rows, with another value from there on or the same.
    fn gap(rows: f64, other: bool, hold: Hold) -> Course {
        let time: Vec<f64> =
            (0..100).map(|row| f64::from(row) + if row < 50 { 0.0 } else { rows - 1.0 }).collect();
        let values = time.iter().map(|time| if *time < 50.0 || !other { 1.0 } else { 2.0 }).collect();
        Course { time, values, hold }
    }

    fn found(course: &Course) -> Vec<(f64, f64)> {
        let lost = lost(&course.time, &[(true, course)]);
        lost.iter().map(|one| (one.from, one.to)).collect()
    }

    #[test]
    fn policy_an_input_is_unknown_where_rows_of_it_are_missing() {
        assert_eq!(found(&gap(2.0, true, Hold::Zero)), [(49.0, 51.0)]);
        // a row that came late is none that is missing: at half the threshold it would be
        assert_eq!(found(&gap(1.0, true, Hold::Zero)), []);
        assert_eq!(found(&gap(1.5, true, Hold::Zero)), []);
        // one row with the same value on either side was as these say; of a long stretch nobody knows
        assert_eq!(found(&gap(3.0, false, Hold::Zero)), []);
        assert_eq!(found(&gap(5.0, false, Hold::Zero)), [(49.0, 54.0)]);
        // between rows of a line the line is as good a guess
        assert_eq!(found(&gap(3.0, true, Hold::Linear)), []);
        assert_eq!(found(&gap(5.0, true, Hold::Linear)), [(49.0, 54.0)]);
    }

    #[test]
    fn policy_an_input_that_often_skips_a_row_is_logged_so_by_intent() {
        let every = |rows: usize| {
            let time: Vec<f64> = (0..1000).filter(|row| row % rows != 0).map(|row| row as f64).collect();
            let values = time.clone();
            found(&Course { time, values, hold: Hold::Zero }).len()
        };
        assert!(every(15) > 60, "7 % of the rows are lost");
        assert_eq!(every(7), 0, "14 % are missing");
    }

    #[test]
    fn law_an_empty_cell_hides_the_input_from_its_row_to_the_next() {
        let time: Vec<f64> = (0..100).map(f64::from).collect();
        let (mut course, rows) = (gap(1.0, true, Hold::Zero), time.clone());
        course.time.remove(50);
        course.values.remove(50);
        let lost = lost(&rows, &[(true, &course)]);
        let grid = Grid {
            name: "a".into(),
            time,
            samples: Vec::new(),
            inputs: vec![course],
            origin: 0.0,
            begin: Vec::new(),
            lost,
        };
        let torn: Vec<usize> = (0..99).filter(|row| grid.torn(&[0.0])[*row]).collect();
        assert_eq!(torn, [50], "until row 50 the value of row 49 held");
        let blind = |reading| {
            (1..100).filter(|row| grid.rows_with_unknown_input(reading, &[0.0])[*row]).collect::<Vec<usize>>()
        };
        assert_eq!(blind(Reading::After), [50], "it was read with what its cell would say");
        assert_eq!(blind(Reading::Before), [51], "it was read with what was there before it");
        assert!(
            grid.rows_with_unknown_input(Reading::Before, &[0.0])[0]
                && !grid.rows_with_unknown_input(Reading::After, &[0.0])[0]
        );
    }

    #[test]
    fn law_nobody_knows_an_input_before_its_own_log_begins() {
        let time: Vec<f64> = (0..100).map(f64::from).collect();
        let begins = |at: usize| {
            let mut course = gap(1.0, true, Hold::Zero);
            course.time.drain(..at);
            course.values.drain(..at);
            let lost = lost(&time, &[(true, &course)]);
            let grid = Grid { time: time.clone(), inputs: vec![course], lost, ..Grid::default() };
            let count = |rows: &[bool]| rows.iter().take_while(|row| **row).count();
            [0.0, 7.0].map(|late| {
                let blind = grid.rows_with_unknown_input(Reading::After, &[late]);
                (count(&blind), count(&grid.torn(&[late])))
            })
        };
        assert_eq!(begins(20), [(20, 20), (27, 27)]);
        // a clock of its own, and no row that is missing
        assert_eq!(begins(1)[0], (0, 0));
    }

    #[test]
    fn law_a_late_input_carries_in_what_was_there_before_the_log() {
        let time: Vec<f64> = (0..100).map(f64::from).collect();
        let course = gap(1.0, true, Hold::Zero);
        let lost = vec![Lost { input: 0, from: 50.0, to: 60.0, usual: 1.0 }];
        let grid = Grid { name: "a".into(), time, inputs: vec![course], lost, ..Grid::default() };
        let torn = |late| (0..99).filter(|row| grid.torn(&[late])[*row]).collect::<Vec<usize>>();
        let blind = |late| {
            let rows = grid.rows_with_unknown_input(Reading::After, &[late]);
            (0..100).filter(|row| rows[*row]).collect::<Vec<usize>>()
        };
        assert_eq!(
            (torn(0.0).first(), blind(0.0).first()),
            (Some(&51), Some(&51)),
            "no delay, nothing before"
        );
        assert_eq!(
            (torn(2.5)[0], torn(2.5)[1]),
            (2, 54),
            "row 3 is the first; what is lost comes later, too"
        );
        assert_eq!(blind(2.5)[..4], [0, 1, 2, 54]);
        assert_eq!((torn(0.9)[0], blind(0.9)[0]), (0, 0), "a part of an interval, too");
        assert_eq!((torn(1e3).first(), blind(1e3).len()), (None, 100), "later than the log is long");
        // what was fed before an input's own log acts behind where that begins
        let mut grid = grid;
        grid.inputs[0].time.drain(..20);
        grid.inputs[0].values.drain(..20);
        let rows = grid.rows_with_unknown_input(Reading::After, &[2.5]);
        assert_eq!((0..50).filter(|row| rows[*row]).collect::<Vec<usize>>(), [20, 21, 22]);
    }

    #[test]
    fn value_timestamps_that_are_one_row() {
        // a thousand rows 10 ms apart, the second sensor's timestamps later by so much of that
        let with = |late: f64| {
            let timestamps = (0..1000).flat_map(|row| [f64::from(row), f64::from(row) + late]);
            rows(timestamps.map(|timestamp| 0.01 * timestamp).collect()).len()
        };
        // all values are twice as near to each other as the rows: of that a thousandth, as digits of a timestamp are cut off
        assert_eq!((with(0.45e-3), with(0.55e-3)), (1000, 2000));
    }

    #[test]
    fn value_an_input_that_always_moves_jumps_where_it_moves_by_far_more() {
        // usual changes of one, and one of so many times that
        let jumps = |times: f64| {
            let at = |row: i32| f64::from(row) + if row >= 50 { times - 1.0 } else { 0.0 };
            let values = (0..100).map(at).collect();
            jumps(&Course { time: (0..100).map(f64::from).collect(), values, hold: Hold::Zero })
        };
        assert_eq!(jumps(2.7).len(), 0);
        assert_eq!(jumps(3.3), [50.0]);
        // at rest, then pressed over twenty rows and let go at once
        let pressed = |row: i32| if (50..=70).contains(&row) { f64::from(row - 50) } else { 0.0 };
        let values = (0..100).map(pressed).collect();
        let brake = Course { time: (0..100).map(f64::from).collect(), values, hold: Hold::Zero };
        assert_eq!((super::jumps(&brake).len(), jumps_beyond(&brake, 0.1)), (21, vec![71.0]));
    }
}
