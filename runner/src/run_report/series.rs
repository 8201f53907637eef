//! Reads back from `results.csv`, in one pass, what the page and the verdict need: signals thinned to what a screen can
//! show, so that the memory of a report does not grow with the length of the run, and numbers over the rows.

use super::verdict::{Tally, VerdictEntry};
use crate::error::Error;
use report::thin::Thinner;
use std::collections::BTreeMap;
use std::path::Path;

/// A line: a signal, and what is taken off it.
pub type Key = (String, Option<String>);

/// What was found.
pub struct Series {
    /// Thinned points of each signal or difference, up to a little after a failure.
    pub lines: BTreeMap<Key, Vec<(f64, f64)>>,
    /// For each wanted index: the values of the watched signals in the first row that has it.
    pub at_index: BTreeMap<u64, At>,
    /// How many rows there are.
    pub rows: u64,
    /// Time of the last row, s.
    pub last: f64,
    /// Time at which the run failed by the verdict's own rule, s.
    pub failed: Option<f64>,
    /// The verdict's figures, up to a failure.
    pub figures: Vec<Option<f64>>,
    /// What is to be told of them.
    pub told: Vec<String>,
    /// Columns with values that are no finite numbers: name, first such time, that value; in order of the columns.
    pub not_finite: Vec<(String, f64, String)>,
}

/// A row.
#[derive(Debug, Clone, PartialEq)]
pub struct At {
    /// Its time, s.
    pub time: f64,
    /// The watched signals.
    pub values: Vec<f64>,
}

/// What to read.
pub struct Wanted<'a> {
    /// Signals, or differences of two.
    pub lines: Vec<Key>,
    /// The index column, the wanted indices, and the signals to keep at those.
    pub watch: Option<(String, Vec<u64>, Vec<String>)>,
    /// What the verdict asks for.
    pub verdict: &'a VerdictEntry,
}

/// After a failure lines go on for this share of the time before it.
const AFTER: f64 = 0.25;

/// Reads the file once.
pub fn read(path: &Path, wanted: &Wanted<'_>) -> Result<Series, Error> {
    let mut reader = csv::Reader::from_path(path).map_err(refused(path))?;
    let head = reader.headers().map_err(refused(path))?.clone();
    let mut pass = Pass::new(&head, wanted, path)?;
    let mut record = csv::StringRecord::new();
    loop {
        match reader.read_record(&mut record) {
            Ok(true) => pass.row(&record),
            Ok(false) => break,
            // The last line of a run that was cut off in the middle of a row.
            Err(error) if matches!(error.kind(), csv::ErrorKind::UnequalLengths { .. }) => break,
            Err(error) => return Err(refused(path)(error)),
        }
    }
    Ok(pass.finish(wanted, &head))
}

fn refused(path: &Path) -> impl Fn(csv::Error) -> Error + '_ {
    |why| Error::File { path: path.to_owned(), why: why.to_string() }
}

/// The columns that are read, and what was read.
struct Pass<'a> {
    lines: Vec<(usize, Option<usize>, Thinner)>,
    watch: Option<(usize, &'a [u64], Vec<usize>)>,
    fails_when: Option<usize>,
    figures: Vec<(usize, Option<usize>, Option<usize>, Tally)>,
    at_index: BTreeMap<u64, At>,
    rows: u64,
    first: f64,
    last: f64,
    failed: Option<f64>,
    /// By column.
    not_finite: BTreeMap<usize, (f64, String)>,
}

impl<'a> Pass<'a> {
    fn new(head: &csv::StringRecord, wanted: &'a Wanted<'_>, path: &Path) -> Result<Self, Error> {
        let column = |name: &str| {
            let why = || format!("no column `{name}`, which [report] shows; is it recorded?");
            let found = head.iter().position(|entry| entry == name);
            found.ok_or_else(|| Error::File { path: path.to_owned(), why: why() })
        };
        let optional = |name: &Option<String>| name.as_deref().map(column).transpose();
        let mut lines = Vec::new();
        for (signal, minus) in &wanted.lines {
            lines.push((column(signal)?, optional(minus)?, Thinner::default()));
        }
        let mut figures = Vec::new();
        for figure in &wanted.verdict.figures {
            let tally = Tally::new(figure.reduce);
            figures.push((
                column(&figure.signal)?,
                optional(&figure.minus)?,
                optional(&figure.valid)?,
                tally,
            ));
        }
        let watch = match &wanted.watch {
            Some((index, indices, signals)) => {
                let columns = signals.iter().map(|name| column(name)).collect::<Result<Vec<_>, _>>()?;
                Some((column(index)?, indices.as_slice(), columns))
            }
            None => None,
        };
        let fails_when = optional(&wanted.verdict.fails_when)?;
        Ok(Self {
            lines,
            watch,
            fails_when,
            figures,
            at_index: BTreeMap::new(),
            rows: 0,
            first: f64::NAN,
            last: f64::NAN,
            failed: None,
            not_finite: BTreeMap::new(),
        })
    }

    fn row(&mut self, record: &csv::StringRecord) {
        let value = |column: usize| number(record.get(column).unwrap_or_default());
        let time = value(0);
        self.last = time;
        if self.rows == 0 {
            self.first = time;
        }
        self.rows += 1;
        for (column, cell) in record.iter().enumerate().filter(|(_, cell)| is_not_finite(cell)) {
            self.not_finite.entry(column).or_insert_with(|| (time, cell.to_owned()));
        }
        if self.failed.is_none() {
            for (signal, minus, valid, tally) in &mut self.figures {
                let taken_off = minus.map_or(0.0, value);
                tally.push(time, value(*signal) - taken_off, valid.is_none_or(|valid| value(valid) != 0.0));
            }
            self.failed = self.fails_when.filter(|column| value(*column) == 1.0).map(|_| time);
        }
        if self.failed.is_none_or(|failed| time <= failed + AFTER * (failed - self.first)) {
            for (signal, minus, thinner) in &mut self.lines {
                thinner.push(time, value(*signal) - minus.map_or(0.0, value));
            }
        }
        if let Some((index, indices, columns)) = &self.watch {
            let index = value(*index);
            if index >= 0.0 && indices.contains(&(index as u64)) {
                let values = || At { time, values: columns.iter().map(|column| value(*column)).collect() };
                self.at_index.entry(index as u64).or_insert_with(values);
            }
        }
    }

    fn finish(self, wanted: &Wanted<'_>, head: &csv::StringRecord) -> Series {
        let points = self.lines.into_iter().map(|(_, _, thinner)| thinner.finish());
        let name = |column: usize| head.get(column).unwrap_or_default().to_owned();
        let not_finite = self.not_finite.into_iter().map(|(column, (time, text))| (name(column), time, text));
        let told = wanted.verdict.figures.iter().zip(&self.figures);
        let told = told.filter_map(|(figure, (.., tally))| tally.between_rows(&figure.signal, &figure.label));
        Series {
            told: told.collect(),
            lines: wanted.lines.iter().cloned().zip(points).collect(),
            at_index: self.at_index,
            rows: self.rows,
            last: self.last,
            failed: self.failed,
            figures: self.figures.iter().map(|(.., tally)| tally.finish()).collect(),
            not_finite: not_finite.collect(),
        }
    }
}

fn is_not_finite(cell: &str) -> bool {
    matches!(cell, "NaN" | "inf" | "-inf")
}

/// A cell as a number; text is none.
fn number(cell: &str) -> f64 {
    cell.parse().unwrap_or(f64::NAN)
}
