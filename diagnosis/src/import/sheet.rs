//! A log as loggers and spreadsheets write it: decimal commas; units in the header or in a line of their own; columns of words.

use super::Time;
use super::heads::{Header, header};
use super::policy::IMPORT;
use super::text::{Separator, Text};
use crate::error::Error;
use crate::observe::measure;
use crate::observe::{EPOCH, SINCE_1970, if_date, units_to_seconds};
use crate::statistics::median::usual_step;
use orchestrator::fmu::Description;
use std::path::{Path, PathBuf};

/// What a column of time is called.
const TIME: &str = "time";
const TIME_NAMES: [&str; 8] = ["time", "t", "timestamp", "stamp", "zeit", "elapsed", "clock", "times"];

/// One log.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sheet {
    pub(super) path: PathBuf,
    pub(super) columns: Vec<Header>,
    /// A cell that holds no number is `NaN`.
    pub(super) rows: Vec<Vec<f64>>,
    /// The line of the names, and that of each row.
    pub(super) lines: (usize, Vec<usize>),
    /// How it was written, where not as plain CSV.
    pub(super) dialect: Option<String>,
    /// Columns that hold words, told.
    pub(super) left_out: Vec<String>,
}

/// How many cells of a column are numbers and words, and the first word with its line.
#[derive(Debug, Clone, Default)]
struct Cells {
    numbers: usize,
    words: usize,
    first: Option<(usize, String)>,
}

impl Cells {
    /// Counts a cell of a line, and gives its number; `NaN` where it holds none.
    fn count(&mut self, cell: &str, comma: bool, line: usize) -> f64 {
        match (cell, number(cell, comma)) {
            ("", _) => f64::NAN,
            (_, Some(value)) => {
                self.numbers += 1;
                value
            }
            (cell, None) => {
                self.words += 1;
                self.first.get_or_insert_with(|| (line, cell.to_owned()));
                f64::NAN
            }
        }
    }
}

/// Whether a line below the names holds units of measurement: something, and no number.
fn is_line_of_units(record: &csv::StringRecord) -> bool {
    record.iter().any(|cell| !cell.is_empty()) && record.iter().all(|cell| number(cell, true).is_none())
}

/// What is wrong with a line of more cells than there are names, where a further one holds a number.
fn nameless(record: &csv::StringRecord, names: usize, comma: bool) -> Option<String> {
    let cell = record.iter().skip(names).find(|cell| number(cell, comma).is_some())?;
    Some(format!("{} cells below {names} names: {cell} stands below none", record.len()))
}

impl Sheet {
    /// Reads a file.
    pub(super) fn read(path: &Path) -> Result<Self, Error> {
        let bytes = std::fs::read(path).map_err(|source| Error::Io { path: path.to_owned(), source })?;
        let wrong = |line: usize, problem: String| Error::Manifest { path: path.to_owned(), line, problem };
        let Text { separator, table, above } = Text::decode(&bytes, path)?;
        let comma = separator != Separator::Comma;
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(separator.byte())
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(table.as_bytes());
        let headers =
            reader.headers().map_err(|error| wrong(above + 1, format!("not CSV: {error}")))?.clone();
        let mut columns: Vec<Header> = headers.iter().map(header).collect();
        let (mut rows, mut lines): (Vec<Vec<f64>>, Vec<usize>) = (Vec::new(), Vec::new());
        let mut decimal = false;
        let mut kinds: Vec<Cells> = vec![Cells::default(); columns.len()];
        for record in reader.records() {
            let line = |error: &csv::Error| error.position().map_or(1, |at| at.line() as usize);
            let record = record.map_err(|error| wrong(above + line(&error), format!("not CSV: {error}")))?;
            let line = above + record.position().map_or(0, |position| position.line() as usize);
            if rows.is_empty() && is_line_of_units(&record) {
                columns.iter_mut().zip(record.iter()).for_each(|(column, cell)| column.measured_in(cell));
                continue;
            }
            decimal |= comma && record.iter().any(|cell| cell.contains(',') && number(cell, true).is_some());
            if let Some(problem) = nameless(&record, columns.len(), comma) {
                return Err(wrong(line, problem));
            }
            let mut row: Vec<f64> = (record.iter().take(columns.len()).zip(&mut kinds))
                .map(|(cell, kind)| kind.count(cell, comma, line))
                .collect();
            row.resize(columns.len(), f64::NAN);
            rows.push(row);
            lines.push(line);
        }
        let lines = (above + 1, lines);
        let (dialect, left_out) = (None, Vec::new());
        let mut sheet = Self { path: path.to_owned(), columns, rows, lines, dialect, left_out };
        sheet.without_words(&kinds)?;
        if sheet.rows.len() < 3 {
            return Err(wrong(above + 1, format!("{} rows: too few to compare", sheet.rows.len())));
        }
        let commas = if decimal { ", numbers had decimal commas" } else { "" };
        sheet.dialect = separator.in_words().map(|name| format!("columns were separated by {name}{commas}"));
        Ok(sheet)
    }

    /// Leaves out columns that hold words. One of numbers with a word in it is an error, as is one of time: another would pass for it.
    fn without_words(&mut self, kinds: &[Cells]) -> Result<(), Error> {
        for (place, cells) in kinds.iter().enumerate().rev() {
            let Some((line, cell)) = &cells.first else { continue };
            let Header { text, name, .. } = &self.columns[place];
            if TIME_NAMES.contains(&name.to_lowercase().as_str()) || cells.words <= cells.numbers {
                let problem = format!("column {text:?}: {cell:?} is no number{}", if_date(cell));
                return Err(Error::Manifest { path: self.path.clone(), line: *line, problem });
            }
            self.left_out.push(format!(
                "column {text:?} holds words (line {line}: {cell:?}) and is left out{}",
                if_date(cell)
            ));
            self.columns.remove(place);
            for row in &mut self.rows {
                row.remove(place);
            }
        }
        Ok(())
    }

    /// With a column of time, for rows that were written at a rate.
    pub(super) fn timed(&mut self, rate: f64, start: f64) -> Result<(), Error> {
        let is_time = |column: &&Header| column.text.eq_ignore_ascii_case(TIME);
        if let Some(column) = self.columns.iter().find(is_time) {
            let problem = format!("there is a column {:?}: without --rate its times are taken", column.text);
            return Err(Error::Manifest { path: self.path.clone(), line: 1, problem });
        }
        self.columns.insert(0, Header { text: TIME.into(), name: TIME.into(), unit: Some("s".into()) });
        for (count, row) in self.rows.iter_mut().enumerate() {
            row.insert(0, start + count as f64 / rate);
        }
        Ok(())
    }

    /// The heads as written.
    pub(super) fn names(&self) -> Vec<&str> {
        self.columns.iter().map(|column| column.text.as_str()).collect()
    }

    /// The line here of a line of the plain CSV that this is written as.
    pub(super) fn line_of(&self, plain: usize) -> usize {
        let row = plain.checked_sub(2).and_then(|row| self.lines.1.get(row));
        row.copied().unwrap_or(self.lines.0)
    }

    /// Place of a column by its head.
    pub(super) fn place(&self, text: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.text == text)
    }

    /// All cells of a column.
    pub(super) fn column(&self, place: usize) -> Vec<f64> {
        self.rows.iter().map(|row| row[place]).collect()
    }

    /// Columns that are named after a variable to the letter have that name: `M_A` is no M in ampere, `v[2]` no v in units of 2.
    pub(super) fn with_names(&mut self, known: &dyn Fn(&str) -> bool) {
        for column in self.columns.iter_mut().filter(|column| known(&column.text)) {
            // a unit from the line below stays
            if column.unit == header(&column.text).unit {
                column.unit = None;
            }
            column.name.clone_from(&column.text);
        }
    }

    /// The column of time, with its unit and why it is thought to be that.
    pub(super) fn time_column(&self, description: &Description) -> Result<(Time, String), Error> {
        let rises = |place: &usize| {
            let rising = self.rows.windows(2).filter(|pair| pair[1][*place] > pair[0][*place]).count();
            rising as f64 > 0.9 * (self.rows.len() - 1) as f64
        };
        let places = || (0..self.columns.len()).filter(rises);
        let called = |place: &usize| TIME_NAMES.contains(&self.columns[*place].name.to_lowercase().as_str());
        let of_time = |place: &usize| {
            self.columns[*place].unit.as_deref().is_some_and(|unit| measure::seconds(unit).is_ok())
        };
        let found = places().find(called).map(|place| (place, "by its name"));
        let found = found.or_else(|| places().find(of_time).map(|place| (place, "by its unit")));
        let Some((place, why)) = found
            .or_else(|| places().next().map(|place| (place, "the first column that rises from row to row")))
        else {
            let wanted = "no column rises from row to row: wanted is one with the time as a number, or --rate HZ for rows at a rate";
            let problem =
                [wanted.to_owned()].into_iter().chain(self.left_out.clone()).collect::<Vec<_>>().join("; ");
            return Err(Error::Manifest { path: self.path.clone(), line: 1, problem });
        };
        let head = &self.columns[place];
        let (unit, reason) = match head.unit.as_deref().filter(|unit| measure::seconds(unit).is_ok()) {
            Some(unit) => (unit.to_owned(), "unit from the header".to_owned()),
            None => self.time_unit(place, description),
        };
        let seconds = measure::seconds(&unit).unwrap_or(1.0);
        let told = format!("time is {:?}, {why}; {reason}", head.text);
        Ok((Time { place, name: head.text.clone(), unit, seconds }, told))
    }

    /// A unit of time by size: what makes rows as far apart as the unit's own step suggests.
    fn time_unit(&self, place: usize, description: &Description) -> (String, String) {
        let gap = self.usual_gap(place);
        let last = self.rows.last().map_or(0.0, |row| row[place]);
        for (unit, seconds) in units_to_seconds() {
            if (EPOCH..SINCE_1970.end).contains(&(last * seconds)) {
                return (unit.into(), format!("taken as {unit} since 1970, by its size"));
            }
        }
        if self.columns[place].name == TIME {
            return ("s".into(), "taken as s, as everywhere where a column is called time".into());
        }
        let own = description.default_experiment.step_size.filter(|step| *step > 0.0);
        let whole = self.rows.iter().all(|row| row[place].fract() == 0.0);
        match own {
            Some(own) if whole && gap / own > 100.0 && gap / own < 1e5 => {
                ("ms".into(), format!("rows are {gap} apart, the unit's own step is {own} s: taken as ms"))
            }
            None if whole && (5.0..1e3).contains(&gap) => {
                ("ms".into(), format!("whole numbers {gap} apart: taken as ms, look at this"))
            }
            _ => ("s".into(), format!("rows are {gap:.6} apart: taken as s")),
        }
    }

    /// The median distance of rows in the log's own unit.
    pub(super) fn usual_gap(&self, place: usize) -> f64 {
        usual_step(&self.column(place)).unwrap_or(0.0)
    }

    /// Tells where rows are missing, and how uneven they are.
    pub(super) fn gaps(&self, time: &Time, notices: &mut Vec<String>) -> Result<(), Error> {
        let Some(place) = self.place(&time.name) else {
            let problem = format!("there is no column {:?} of time", time.name);
            return Err(Error::Manifest { path: self.path.clone(), line: 1, problem });
        };
        let usual = self.usual_gap(place);
        let far = self.rows.windows(2).filter(|pair| pair[1][place] - pair[0][place] > IMPORT.gap * usual);
        let far: Vec<(f64, f64)> = far.map(|pair| (pair[0][place], pair[1][place])).collect();
        if let Some((from, to)) = far.first() {
            notices.push(format!(
                "{}: {} gap(s) in time, the first from {from} to {to} {}; nothing is filled in, rows are used at their own times",
                self.path.display(),
                far.len(),
                time.unit
            ));
        }
        Ok(())
    }
}

/// A number, with a decimal comma where commas don't separate cells.
pub(super) fn number(cell: &str, comma: bool) -> Option<f64> {
    match cell {
        "true" | "True" | "TRUE" => return Some(1.0),
        "false" | "False" | "FALSE" => return Some(0.0),
        "nan" | "NaN" | "NAN" | "null" | "-" => return Some(f64::NAN),
        _ => {}
    }
    let point = if comma && !cell.contains('.') { cell.replacen(',', ".", 1) } else { cell.to_owned() };
    point.parse::<f64>().ok().filter(|number| !number.is_infinite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_heads_that_are_names_of_variables() {
        let columns = ["M_A", "v[2]", "u_V", "x [mm]"].map(header).to_vec();
        let mut sheet = Sheet {
            path: "log.csv".into(),
            columns,
            rows: vec![],
            lines: (1, vec![]),
            dialect: None,
            left_out: vec![],
        };
        sheet.with_names(&|text| ["M_A", "v[2]"].contains(&text));
        let heads: Vec<_> =
            sheet.columns.iter().map(|head| (head.name.as_str(), head.unit.as_deref())).collect();
        assert_eq!(heads, [("M_A", None), ("v[2]", None), ("u", Some("V")), ("x", Some("mm"))]);
    }

    #[test]
    fn value_numbers_of_spreadsheets() {
        assert_eq!(
            (number("1,5", true), number("-2.5e3", false), number("1,5", false)),
            (Some(1.5), Some(-2500.0), None)
        );
        assert!(number("NaN", false).is_some_and(f64::is_nan));
    }
}
