//! One CSV log: `time` and columns of numbers; an empty cell is `NaN` (not measured then).

use crate::error::{Error, Notice};
use crate::observe::csv_text;
use crate::rigs::acrobot::dataset::policy::LOGS;
use std::path::Path;

/// Says whether the camera found its circles.
const VALID: &str = "valid";
/// No run is silent for so long, s.
const DAY: f64 = 86_400.0;

/// An ordered log.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Table {
    /// Time of each row in s, strictly increasing.
    pub time: Vec<f64>,
    /// Line of each row in its file, counted from 1.
    pub line: Vec<usize>,
    /// How well the times are known together, s, standard deviation: those that were read off a line through scattering timestamps are off by
    /// as much as that line.
    pub tick_error: f64,
    /// Places before which rows were ignored.
    broken: Vec<usize>,
    columns: Vec<(String, Vec<f64>)>,
}

impl Table {
    /// A table from columns of equal length, for logs that are simulated instead of read.
    pub fn new(time: Vec<f64>, columns: Vec<(String, Vec<f64>)>) -> Self {
        let line = (0..time.len()).map(|row| row + 2).collect();
        Self { time, line, tick_error: 0.0, broken: Vec::new(), columns }
    }

    /// Times between which rows of the file were ignored, s.
    pub fn broken(&self) -> impl Iterator<Item = (f64, f64)> {
        let inside = |place: &&usize| (1..self.len()).contains(*place);
        self.broken.iter().filter(inside).map(|place| (self.time[place - 1], self.time[*place]))
    }

    /// A column, if it was measured at all.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|(column, _)| column == name).map(|(_, values)| values.as_slice())
    }

    /// A column to be mended.
    pub fn column_mut(&mut self, name: &str) -> Option<&mut Vec<f64>> {
        self.columns.iter_mut().find(|(column, _)| column == name).map(|(_, values)| values)
    }

    /// One more column, the same in all rows.
    pub fn push(&mut self, name: &str, value: f64) {
        self.columns.push((name.to_owned(), vec![value; self.time.len()]));
    }

    /// Marks the time between two rows as one of which nothing is known: from `from` to `to`, s.
    pub fn tear(&mut self, from: f64, to: f64) {
        let place = self.time.partition_point(|time| *time < to);
        if place > 0 && place < self.len() && self.time[place - 1] <= from && !self.broken.contains(&place) {
            self.broken.push(place);
        }
    }

    /// Whether two rows hold the same.
    pub fn same(&self, row: usize, other: usize) -> bool {
        let alike = |one: f64, two: f64| one == two || one.is_nan() && two.is_nan();
        self.columns.iter().all(|(_, values)| alike(values[row], values[other]))
    }

    /// Exchanges two columns that are both there.
    pub fn swap(&mut self, one: &str, other: &str) {
        let place = |name: &str| self.columns.iter().position(|(column, _)| column == name);
        if let (Some(one), Some(other)) = (place(one), place(other)) {
            let (a, b) = (self.columns[one].0.clone(), self.columns[other].0.clone());
            (self.columns[one].0, self.columns[other].0) = (b, a);
        }
    }

    /// Takes a column away.
    pub fn remove(&mut self, name: &str) {
        self.columns.retain(|(column, _)| column != name);
    }

    /// Some of the rows.
    pub fn rows(&self, rows: std::ops::Range<usize>) -> Self {
        let mut part = self.clone();
        part.keep(rows);
        part
    }

    fn keep(&mut self, rows: std::ops::Range<usize>) {
        self.time = self.time[rows.clone()].to_vec();
        self.line = self.line[rows.clone()].to_vec();
        let inside = self.broken.iter().filter(|place| rows.contains(place));
        self.broken = inside.filter_map(|place| place.checked_sub(rows.start)).collect();
        self.columns.iter_mut().for_each(|(_, values)| *values = values[rows.clone()].to_vec());
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// No rows.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Value of a held column (zero-order hold) at a time; `before` ahead of the first row.
    pub fn held(&self, name: &str, time: f64, before: f64) -> f64 {
        let Some(values) = self.column(name) else { return before };
        let next = self.time.partition_point(|t| *t <= time);
        values[..next].iter().rev().find(|value| value.is_finite()).copied().unwrap_or(before)
    }
}

/// Reads one file of a run; `None` when it isn't there or can't be used at all.
///
/// # Errors
/// The file exists but can't be read.
pub fn load(
    root: &Path,
    run: &str,
    file: &str,
    known: &[&str],
    notices: &mut Vec<Notice>,
) -> Result<Option<Table>, Error> {
    let path = root.join(run).join(file);
    let label = format!("{run}/{file}");
    if !path.try_exists().map_err(|source| Error::Io { path: path.clone(), source })? {
        return Ok(None);
    }
    let text = csv_text::read(&path, "")?;
    let mut notes = Notes { file: label, into: notices, counts: Vec::new() };
    let table = parse(&text, known, &mut notes);
    notes.finish();
    Ok(table)
}

/// Reads the text of a log: a table of the `known` columns, with a notice for each row and column that is left out.
fn parse(text: &str, known: &[&str], notes: &mut Notes<'_>) -> Option<Table> {
    let mut reader = csv::ReaderBuilder::new()
        .flexible(true)
        .trim(csv::Trim::All)
        .has_headers(true)
        .from_reader(text.as_bytes());
    let headers = reader.headers().ok()?.clone();
    if headers.get(0) != Some("time") {
        let found = headers.get(0).unwrap_or("").to_owned();
        notes.add(1, format!("the first column must be `time` in s, found `{found}`; file excluded"));
        return None;
    }
    let mut table = Table::default();
    for name in headers.iter().skip(1) {
        if !known.contains(&name) {
            notes.add(1, format!("column `{name}` is not a variable of this unit; ignored"));
        }
        table.columns.push((name.to_owned(), Vec::new()));
    }
    let mut last_record = csv::StringRecord::new();
    for record in reader.records() {
        let Ok(record) = record else {
            notes.many("not a line of CSV; row ignored", 0);
            table.broken.push(table.len());
            continue;
        };
        let line = record.position().map_or(0, |position| position.line() as usize);
        if record.len() != headers.len() {
            notes.many("wrong number of cells; row ignored", line);
            table.broken.push(table.len());
            continue;
        }
        let Some(time) = time_of_row(&mut table, &record, &last_record, line, notes) else { continue };
        table.time.push(time);
        table.line.push(line);
        for (place, (name, values)) in table.columns.iter_mut().enumerate() {
            let value = value_of_cell(record.get(place + 1).unwrap_or(""));
            if name == VALID && value.is_none_or(|value| !(value.is_nan() || value == 0.0 || value == 1.0)) {
                notes.many("column `valid` is neither 0 nor 1 (or False nor True); taken as 0", line);
                values.push(0.0);
                continue;
            }
            values.push(value.unwrap_or_else(|| {
                let message = format!("column `{name}` is not a finite number; taken as not measured");
                notes.many(&message, line);
                f64::NAN
            }));
        }
        last_record = record;
    }
    table.columns.retain(|(name, _)| known.contains(&name.as_str()));
    longest(&mut table, notes);
    Some(table)
}

/// The time of a row that can be used, s. Takes the row before out again if only that one leaps.
fn time_of_row(
    table: &mut Table,
    record: &csv::StringRecord,
    last_record: &csv::StringRecord,
    line: usize,
    notes: &mut Notes<'_>,
) -> Option<f64> {
    let time = record.get(0).and_then(|cell| cell.parse::<f64>().ok()).unwrap_or(f64::NAN);
    if !time.is_finite() {
        notes.many("time is not a number; row ignored", line);
        table.broken.push(table.len());
        return None;
    }
    if let [.., before, last] = table.time[..]
        && last - before > DAY
        && (before..last).contains(&time)
    {
        notes.many(&leap(before, last), table.line[table.len() - 1]);
        table.keep(0..table.len() - 1);
        table.broken.push(table.len());
    }
    let Some(last) = table.time.last() else { return Some(time) };
    if time < *last {
        let message = format!("time runs back (from {last} to {time} s at the first such line); row ignored");
        notes.many(&message, line);
        table.broken.push(table.len());
        return None;
    }
    if time == *last {
        notes.many("same time as the row before; row ignored", line);
        // a row that was written twice is none that is missing
        if record != last_record {
            table.broken.push(table.len());
        }
        return None;
    }
    Some(time)
}

/// The number in a cell, NaN where nothing was measured; `None` where it holds something else.
fn value_of_cell(cell: &str) -> Option<f64> {
    match cell {
        "" => Some(f64::NAN),
        text if text.eq_ignore_ascii_case("true") => Some(1.0),
        text if text.eq_ignore_ascii_case("false") => Some(0.0),
        text => text.parse().ok().filter(|value: &f64| value.is_finite()),
    }
}

/// A clock that leaps, in words; times are in s.
fn leap(before: f64, time: f64) -> String {
    format!("time leaps ahead (from {before} to {time} s at the first such line); row ignored")
}

/// A clock that was set while the log was written: the longest part of it counts. Times that leap at every row are in other units.
fn longest(table: &mut Table, notes: &mut Notes<'_>) {
    let leaps: Vec<usize> =
        (1..table.len()).filter(|row| table.time[*row] - table.time[row - 1] > DAY).collect();
    if leaps.is_empty() || leaps.len() > LOGS.few {
        return;
    }
    let edges: Vec<usize> = [0].into_iter().chain(leaps).chain([table.len()]).collect();
    let parts = edges.windows(2).map(|pair| pair[0]..pair[1]);
    let Some(kept) = parts.max_by_key(|part| part.len()) else { return };
    let message = leap(table.time[edges[1] - 1], table.time[edges[1]]);
    for row in (0..table.len()).filter(|row| !kept.contains(row)) {
        notes.many(&message, table.line[row]);
    }
    table.keep(kept);
}

/// Collects notices of one file; the same complaint on many lines becomes one with a count.
struct Notes<'a> {
    file: String,
    into: &'a mut Vec<Notice>,
    counts: Vec<(String, usize, usize)>,
}

impl Notes<'_> {
    /// Says something of one line.
    fn add(&mut self, line: usize, message: String) {
        self.into.push(Notice { file: self.file.clone(), line, message });
    }

    /// Counts a complaint that may be made of many lines.
    fn many(&mut self, message: &str, line: usize) {
        // the values belong to the first occurrence only, so compare up to them
        let kind = message.split('(').next().unwrap_or(message);
        match self.counts.iter_mut().find(|(known, _, _)| known.split('(').next() == Some(kind)) {
            Some(entry) => entry.2 += 1,
            None => self.counts.push((message.to_owned(), line, 1)),
        }
    }

    /// Hands on all complaints, each with its count.
    fn finish(self) {
        for (message, line, count) in self.counts {
            let message =
                if count > 1 { format!("{message} ({count} such rows, this is the first)") } else { message };
            self.into.push(Notice { file: self.file.clone(), line, message });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_for_a_frame_without_circles_is_read_and_any_other_is_told() {
        let text =
            "time,u1,valid\n0.0,1,True\n0.1,999,False\n0.2,1,1\n0.3,999,0\n0.4,999,yes\n0.5,999,2\n0.6,1,\n";
        let mut notices = Vec::new();
        let mut notes = Notes { file: "camera.csv".into(), into: &mut notices, counts: Vec::new() };
        let table = parse(text, &["u1", "valid"], &mut notes).expect("a log");
        notes.finish();
        let valid = table.column("valid").expect("there");
        assert_eq!(valid[..6], [1.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
        assert!(valid[6].is_nan(), "an empty cell says nothing");
        assert_eq!((notices.len(), notices[0].line), (1, 6));
        assert!(notices[0].message.contains("neither 0 nor 1"), "{}", notices[0].message);
    }
}
