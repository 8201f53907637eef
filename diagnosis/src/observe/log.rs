//! One log: a CSV file with a column of time and columns of numbers.
//!
//! An empty cell, or `nan`, was not measured then. Rows of one time that hold different columns, as merged logs have them, are one row. Other rows
//! whose time is not later than the one before are left out, with a notice; what is no number is an error with its line.

use super::implausible::implausible;
use super::{EPOCH, Series, csv_text};
use crate::error::{Error, Notice};
use crate::statistics::levels::SMALL;
use orchestrator::nearest;
use std::path::{Path, PathBuf};

/// Rows out of order from which on the file is refused, as a share and as a number: its times are not what they are said to be.
const DISORDER: (f64, usize) = (SMALL, 2);

/// A log with its columns as text.
#[derive(Debug)]
pub(super) struct Log {
    path: PathBuf,
    /// The first line.
    pub(super) columns: Vec<String>,
    rows: Vec<(usize, csv::StringRecord)>,
}

/// The times of a log's rows that are used, s.
#[derive(Debug)]
pub(super) struct Times {
    /// Row and its time.
    rows: Vec<(usize, f64)>,
}

impl Log {
    /// Reads a file.
    pub(super) fn read(path: &Path) -> Result<Self, Error> {
        let wrong = |line: usize, problem: String| Error::Manifest { path: path.to_owned(), line, problem };
        let text = csv_text::read(path, " (`acroscope import` converts such a file)")?;
        let mut reader =
            csv::ReaderBuilder::new().flexible(true).trim(csv::Trim::All).from_reader(text.as_bytes());
        let columns: Vec<String> = match reader.headers() {
            Ok(headers) => headers.iter().map(str::to_owned).collect(),
            Err(error) => return Err(wrong(1, format!("not CSV: {error}"))),
        };
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| {
                wrong(error.position().map_or(1, |at| at.line() as usize), format!("not CSV: {error}"))
            })?;
            let line = record.position().map_or(0, |position| position.line() as usize);
            if record.len() != columns.len() {
                let problem = format!("{} cells where the first line has {}", record.len(), columns.len());
                return Err(wrong(line, problem + comma(&record)));
            }
            rows.push((line, record));
        }
        if rows.is_empty() {
            return Err(wrong(1, "no rows after the first line".into()));
        }
        Ok(Self { path: path.to_owned(), columns, rows })
    }

    /// Place of a column.
    pub(super) fn place(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }

    /// What to say of a column that isn't there.
    pub(super) fn lacks(&self, name: &str) -> String {
        let known = nearest(name, self.columns.iter().map(String::as_str));
        format!("{} has no column {name:?}: {known}", self.path.display())
    }

    fn wrong(&self, line: usize, problem: String) -> Error {
        Error::Manifest { path: self.path.clone(), line, problem }
    }

    fn number(&self, row: usize, place: usize) -> Result<Option<f64>, Error> {
        let (line, record) = &self.rows[row];
        match record.get(place).unwrap_or("") {
            "" => Ok(None),
            "true" | "True" | "TRUE" => Ok(Some(1.0)),
            "false" | "False" | "FALSE" => Ok(Some(0.0)),
            text => match text.parse::<f64>() {
                Ok(number) if number.is_finite() => Ok(Some(number)),
                Ok(number) if number.is_nan() => Ok(None),
                _ => {
                    let hint = if text.contains(',') { " (write 0.5, not 0,5)" } else { if_date(text) };
                    let problem =
                        format!("column {:?}: {text:?} is not a finite number{hint}", self.columns[place]);
                    Err(self.wrong(*line, problem))
                }
            },
        }
    }

    /// The times in s, from a column in a unit of `seconds`.
    pub(super) fn times(
        &self,
        place: usize,
        seconds: f64,
        label: &str,
        notices: &mut Vec<Notice>,
    ) -> Result<Times, Error> {
        let mut rows: Vec<(usize, f64)> = Vec::with_capacity(self.rows.len());
        let mut late: Option<(usize, usize)> = None;
        let first = (0..self.rows.len()).next().map(|row| self.number(row, place)).transpose()?.flatten();
        // differences before units: microseconds since 1970 are exact, in seconds a quarter of one is lost
        let origin = first.filter(|first| (first * seconds).abs() >= EPOCH).unwrap_or(0.0);
        if origin != 0.0 {
            let message = format!("times are a clock's: {origin} in the first row is taken as 0 s");
            notices.push(Notice { file: label.to_owned(), line: self.rows[0].0, message });
        }
        for row in 0..self.rows.len() {
            let Some(time) = self.number(row, place)? else {
                let problem = format!("column {:?}: a row without a time", self.columns[place]);
                return Err(self.wrong(self.rows[row].0, problem));
            };
            let time = (time - origin) * seconds;
            if rows.last().is_some_and(|(_, before)| time <= *before) && !self.joins(row, time, place, &rows)
            {
                late = Some(late.map_or((self.rows[row].0, 1), |(line, count)| (line, count + 1)));
                continue;
            }
            rows.push((row, time));
        }
        if let Some((line, count)) = late {
            if count >= DISORDER.1 && count as f64 > DISORDER.0 * self.rows.len() as f64 {
                return Err(self.wrong(line, self.disorder(place, count)?));
            }
            let message =
                format!("not later than the row before; left out ({count} such rows, this is the first)");
            notices.push(Notice { file: label.to_owned(), line, message });
        }
        Ok(Times { rows })
    }

    /// Whether a row is of the time of those before it, and holds something that none of them holds, and nothing else: of one time there are at most as
    /// many rows as columns.
    fn joins(&self, row: usize, time: f64, clock: usize, before: &[(usize, f64)]) -> bool {
        let is_told = |row: usize, place: usize| {
            let cell = self.rows[row].1.get(place).unwrap_or("");
            !cell.is_empty() && !cell.parse::<f64>().is_ok_and(f64::is_nan)
        };
        let mut told =
            (0..self.columns.len()).filter(|place| *place != clock && is_told(row, *place)).peekable();
        let same = before.iter().rev().take_while(|(_, at)| *at == time);
        before.last().is_some_and(|(_, at)| *at == time)
            && told.peek().is_some()
            && told.all(|place| same.clone().all(|(other, _)| !is_told(*other, place)))
    }

    /// What is wrong with a column of time of which so many rows are not later than one before: a clock that began again goes on from there.
    fn disorder(&self, place: usize, count: usize) -> Result<String, Error> {
        let column = &self.columns[place];
        let times: Vec<f64> = (0..self.rows.len())
            .filter_map(|row| self.number(row, place).transpose())
            .collect::<Result<_, _>>()?;
        let mut back = times.windows(2).filter(|pair| pair[1] <= pair[0]);
        if let Some([from, to]) = back.next()
            && back.count() as f64 + 1.0 <= DISORDER.0 * count as f64
        {
            return Ok(format!(
                "column {column:?}: the clock begins again here, from {from} to {to}: split the log before this line, into one file a run"
            ));
        }
        let all = self.rows.len();
        Ok(format!(
            "column {column:?} is no time: {count} of {all} rows are not later than the row before, this is the first"
        ))
    }

    /// The numbers of a column, with their times.
    pub(super) fn series(&self, place: usize, times: &Times) -> Result<Series, Error> {
        let (mut series, mut lines) = (Series::default(), Vec::new());
        for (row, time) in &times.rows {
            if let Some(value) = self.number(*row, place)? {
                series.time.push(*time);
                series.values.push(value);
                lines.push(self.rows[*row].0);
            }
        }
        match implausible(&series.values) {
            Some((at, told)) => {
                Err(self.wrong(lines[at], format!("column {:?}: {told}", self.columns[place])))
            }
            None => Ok(series),
        }
    }
}

/// What to do about a date or a time of day, if a cell holds one.
fn if_date(cell: &str) -> &'static str {
    if is_date(cell) {
        "; dates and times of day are read by `acroscope import`; here the time stands in seconds, such as those since the first row"
    } else {
        ""
    }
}

/// Whether a cell has the shape of a date or a time of day: `2026-11-24T10:00:00Z`, `24.11.2026 10:00 PM`, `10:00:00.5`, `10:00`.
pub(crate) fn is_date(cell: &str) -> bool {
    let is_part = |byte: u8| byte.is_ascii_digit() || b"-/:. +,TZAPM".contains(&byte.to_ascii_uppercase());
    let groups =
        cell.split(|letter: char| !letter.is_ascii_digit()).filter(|group| !group.is_empty()).count();
    cell.starts_with(|first: char| first.is_ascii_digit())
        && cell.bytes().all(is_part)
        && (groups > 2 || groups == 2 && cell.contains(':'))
}

/// The usual cause of too many cells.
fn comma(record: &csv::StringRecord) -> &'static str {
    let whole = |cell: &str| cell.trim_start_matches('-').bytes().all(|byte| byte.is_ascii_digit());
    if record.iter().all(|cell| !cell.is_empty() && whole(cell)) {
        "; are these decimal commas? Write points"
    } else {
        ""
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_of_one_time_is_joined_that_holds_other_columns() {
        let path = std::env::temp_dir().join(format!("merged-{}.csv", std::process::id()));
        let read = |text: &str| {
            std::fs::write(&path, text).expect("a temporary file can be written");
            let (log, mut notices) = (Log::read(&path).expect("a log"), Vec::new());
            let times = log.times(0, 1.0, "merged.csv", &mut notices).expect("times");
            let of = |place| log.series(place, &times).expect("numbers");
            (of(1).values, of(2).time, notices.len())
        };
        // of three rows at 1 s two hold different columns; the third says `a` again
        let merged = "time,a,b\n0,1,\n1,2,\n1,,5\n1,3,nan\n2,4,6\n";
        assert_eq!(read(merged), (vec![1.0, 2.0, 4.0], vec![1.0, 2.0], 1));
        // one that holds nothing is left out, as an earlier one is
        assert_eq!(read("time,a,b\n0,1,\n1,2,\n1,,NAN\n2,3,6\n").2, 1);
        assert_eq!(read("time,a,b\n0,1,\n1,2,\n0.5,,5\n2,3,6\n").2, 1);
        let _ = std::fs::remove_file(path);
    }

    #[test]
    fn value_dates_and_times_of_day_are_known() {
        for cell in [
            "2026-11-24T10:00:00Z",
            "2026-05-03 10:00:00.010",
            "24.11.2026 10:00",
            "10:00:00.5",
            "2026/11/24",
        ] {
            assert!(if_date(cell).contains("in seconds"), "{cell}");
        }
        for cell in ["-1.5-", "0,5", "1.2", "off", "v1.2.3", "1e-3"] {
            assert_eq!(if_date(cell), "", "{cell}");
        }
    }
}
