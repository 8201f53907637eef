//! A log as loggers and spreadsheets write it: decimal commas; units in the header or in a line of their own; columns of words.

use super::cells::{BOOLEANS_READ, Marks, booleans, is_missing, is_value, is_word};
use super::heads::{self, Header, header};
use super::policy::IMPORT;
use super::text::{Separator, Text};
use super::times::TIME_NAMES;
use super::timestamps::{READ, Timestamps};
use crate::error::Error;
use crate::observe::{csv_text, implausible, is_date};
use std::path::{Path, PathBuf};

/// A line of a log and its cells.
type Record = (usize, csv::StringRecord);

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
    /// The column whose dates and times were read as seconds.
    pub(super) clock: Option<String>,
    /// How it was read, where that is not plain; and what was left out.
    pub(super) told: Vec<String>,
}

/// How many cells of a column are numbers and words, and the first of what is not plain with its line.
#[derive(Debug, Clone, Default)]
struct Cells {
    numbers: usize,
    words: usize,
    first: Option<(usize, String)>,
    /// Words for what is missing.
    missing: usize,
    first_missing: Option<(usize, String)>,
    /// A number with marks between thousands, and what it is.
    grouped: Option<(usize, String, f64)>,
}

impl Cells {
    /// Counts a cell of a line, and gives its number; `NaN` where it holds none.
    fn count(&mut self, cell: &str, marks: Marks, line: usize) -> f64 {
        if cell.is_empty() {
            return f64::NAN;
        }
        if let Some((value, grouped)) = marks.number(cell) {
            self.numbers += 1;
            if grouped {
                self.grouped.get_or_insert_with(|| (line, cell.to_owned(), value));
            }
            return value;
        }
        let (count, first) = match is_missing(cell) {
            true => (&mut self.missing, &mut self.first_missing),
            false => (&mut self.words, &mut self.first),
        };
        *count += 1;
        first.get_or_insert_with(|| (line, cell.to_owned()));
        f64::NAN
    }

    /// What is told of a column of numbers.
    fn told(&self, text: &str) -> Vec<String> {
        let missing = self.first_missing.as_ref().map(|(line, cell)| {
            let count = self.missing;
            format!("column {text:?}: {count} cells hold no measurement, the first {cell:?} in line {line}")
        });
        let grouped = self.grouped.as_ref().map(|(line, cell, value)| {
            format!(
                "column {text:?}: thousands are marked in its numbers: {cell:?} in line {line} is {value}"
            )
        });
        missing.into_iter().chain(grouped).collect()
    }
}

/// Whether a line below the names holds units of measurement: something, and no number.
fn is_line_of_units(record: &csv::StringRecord) -> bool {
    record.iter().any(is_word) && !record.iter().any(is_value)
}

/// What is wrong with a line of more cells than there are names, where a further one holds a number.
fn nameless(record: &csv::StringRecord, names: usize) -> Option<String> {
    let cell = record.iter().skip(names).find(|cell| is_value(cell))?;
    Some(format!("{} cells below {names} names: {cell} stands below none", record.len()))
}

/// Takes out the rows that end before their last cell, and tells them: the last cell that is there may be cut, too. Where many rows do, a logger
/// leaves empty cells at their end out, and nothing is cut.
fn without_cut_rows(columns: &[Header], records: &mut Vec<Record>) -> Option<String> {
    let names = columns.iter().rposition(|column| !column.text.is_empty()).map_or(0, |last| last + 1);
    let is_short = |(_, record): &&Record| record.len() < names;
    let (line, first) = records.iter().find(is_short)?;
    let (line, cells) = (*line, first.len());
    let count = records.iter().filter(is_short).count();
    let found = format!("{cells} cells below {names} names in line {line}");
    let such = if count > 1 { format!(" ({count} such rows, this is the first)") } else { String::new() };
    if count as f64 > IMPORT.cut_rows * records.len() as f64 {
        return Some(format!("{found}{such}: what is missing at the end of so many rows was not measured"));
    }
    records.retain(|(_, record)| record.len() >= names);
    Some(format!("{found}{such}: the row is cut and left out, since its last cell may be cut, too"))
}

/// The names of a table and its records with their lines.
fn records(text: &Text, path: &Path) -> Result<(Vec<Header>, Vec<Record>), Error> {
    let wrong = |line: usize, problem: String| Error::Manifest { path: path.to_owned(), line, problem };
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(text.separator.byte())
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.table.as_bytes());
    let headers = reader.headers().map_err(|error| wrong(text.above + 1, format!("not CSV: {error}")))?;
    let mut columns: Vec<Header> = headers.iter().map(header).collect();
    heads::told_apart(&mut columns);
    let mut records = Vec::new();
    for record in reader.records() {
        let line = |error: &csv::Error| error.position().map_or(1, |at| at.line() as usize);
        let record = record.map_err(|error| wrong(text.above + line(&error), format!("not CSV: {error}")))?;
        let line = text.above + record.position().map_or(0, |position| position.line() as usize);
        if let Some(problem) = nameless(&record, columns.len()) {
            return Err(wrong(line, problem));
        }
        records.push((line, record));
    }
    Ok((columns, records))
}

impl Sheet {
    /// Reads a file.
    pub(super) fn read(path: &Path) -> Result<Self, Error> {
        let bytes =
            orchestrator::plain::read(path).map_err(|source| Error::Io { path: path.to_owned(), source })?;
        let text = Text::decode(&bytes, path)?;
        let (mut columns, mut records) = records(&text, path)?;
        if records.first().is_some_and(|(_, record)| is_line_of_units(record)) {
            let (_, units) = records.remove(0);
            columns.iter_mut().zip(units.iter()).for_each(|(column, cell)| column.measured_in(cell));
        }
        let mut told = text.left_out;
        told.extend(without_cut_rows(&columns, &mut records));
        let cells = records.iter().flat_map(|(_, record)| record.iter());
        let marks = Marks::of(cells, text.separator == Separator::Comma);
        let mut kinds: Vec<Cells> = vec![Cells::default(); columns.len()];
        let row = |(line, record): &Record| {
            let cells = record.iter().take(columns.len()).zip(&mut kinds);
            let mut row: Vec<f64> = cells.map(|(cell, kind)| kind.count(cell, marks, *line)).collect();
            row.resize(columns.len(), f64::NAN);
            row
        };
        let rows = records.iter().map(row).collect();
        let lines = (text.above + 1, records.iter().map(|(line, _)| *line).collect());
        let (path, named) = (path.to_owned(), columns.clone());
        let mut sheet = Self { path, columns, rows, lines, dialect: None, clock: None, told };
        sheet.with_clock(&records, &mut kinds)?;
        sheet.with_booleans(&records, &mut kinds);
        sheet.without_words(&kinds)?;
        sheet.check_numbers(&named)?;
        sheet.join_rows();
        if sheet.rows.len() < 3 {
            let problem = format!("{} rows: too few to compare", sheet.rows.len());
            return Err(sheet.wrong(sheet.lines.0, problem));
        }
        let is_comma =
            |cell: &str| cell.contains(',') && marks != Marks::Point && marks.number(cell).is_some();
        let commas = records.iter().any(|(_, record)| record.iter().any(is_comma));
        let separated = text.separator.in_words().map(|name| format!("columns were separated by {name}"));
        let commas = commas.then(|| "numbers had decimal commas".to_owned());
        let dialect: Vec<String> = separated.into_iter().chain(commas).collect();
        sheet.dialect = (!dialect.is_empty()).then(|| dialect.join(", "));
        Ok(sheet)
    }

    fn wrong(&self, line: usize, problem: String) -> Error {
        Error::Manifest { path: self.path.clone(), line, problem }
    }

    /// Reads dates and times of day as seconds: a column of both, or of times of day with one of dates beside it.
    fn with_clock(&mut self, records: &[Record], kinds: &mut [Cells]) -> Result<(), Error> {
        let mut found: Vec<(usize, Timestamps)> = Vec::new();
        for (place, kind) in kinds.iter().enumerate() {
            let Some((line, _)) = kind.first.as_ref().filter(|_| kind.numbers == 0) else { continue };
            let cell = |(_, record): &'_ Record| {
                record.get(place).filter(|cell| !is_missing(cell)).unwrap_or("").to_owned()
            };
            let cells: Vec<String> = records.iter().map(cell).collect();
            let timestamps = Timestamps::read(&cells).map_err(|problem| {
                self.wrong(*line, format!("column {:?}: {problem}", self.columns[place].text))
            })?;
            found.extend(timestamps.map(|timestamps| (place, timestamps)));
        }
        let timed = found.iter().position(|(_, timestamps)| timestamps.timed).unwrap_or(0);
        let Some((place, timestamps)) = found.get(timed).cloned() else { return Ok(()) };
        let days = found.iter().find(|(_, timestamps)| !timestamps.timed).filter(|_| !timestamps.dated);
        self.told.extend(days.map(|(days, _)| {
            let [time, date] = [place, *days].map(|at| &self.columns[at].text);
            format!("column {time:?}: its days are those of column {date:?}")
        }));
        let seconds = days.map_or(timestamps.clone(), |(_, days)| timestamps.on(days)).seconds();
        let known = || seconds.values.iter().filter(|value| value.is_finite());
        if known().all(|value| *value <= 0.0) {
            return Ok(());
        }
        let text = self.columns[place].text.clone();
        self.told.extend(seconds.midnights.iter().map(|row| {
            format!("column {text:?}: midnight passes before line {}: a day is added", self.lines.1[*row])
        }));
        self.rows.iter_mut().zip(&seconds.values).for_each(|(row, value)| row[place] = *value);
        kinds[place] = Cells::default();
        self.columns[place].unit = Some("s".into());
        self.clock = Some(text);
        Ok(())
    }

    /// Reads columns of words for yes and no as 1 and 0, and tells them.
    fn with_booleans(&mut self, records: &[Record], kinds: &mut [Cells]) {
        for (place, kind) in kinds.iter_mut().enumerate() {
            let Some((line, cell)) = kind.first.as_ref() else { continue };
            let cells = records.iter().map(|(_, record)| record.get(place).unwrap_or(""));
            let Some(values) = booleans(cells) else { continue };
            let first = values.iter().find(|value| value.is_finite()).unwrap_or(&f64::NAN);
            let text = &self.columns[place].text;
            self.told.push(format!(
                "column {text:?}: words are read as 1 and 0: {cell:?} in line {line} is {first}"
            ));
            self.rows.iter_mut().zip(values).for_each(|(row, value)| row[place] = value);
            kind.first = None;
        }
    }

    /// Leaves out columns that hold words. One of numbers with a word in it is an error, as is one of time: another would pass for it.
    fn without_words(&mut self, kinds: &[Cells]) -> Result<(), Error> {
        for (place, cells) in kinds.iter().enumerate().rev() {
            let Header { text, name, .. } = &self.columns[place];
            let told = cells.told(text);
            let Some((line, cell)) = &cells.first else {
                self.told.extend(told);
                continue;
            };
            let is_time = TIME_NAMES.contains(&name.to_lowercase().as_str());
            if is_time || cells.words <= cells.numbers {
                let wanted = match cell.contains(',') {
                    _ if is_time || is_date(cell) => READ,
                    true => "a comma stands before three digits, or before decimals in all of the log",
                    false => "where nothing was measured the cell is empty, NaN or N/A",
                };
                return Err(self.wrong(*line, format!("column {text:?}: {cell:?} is no number; {wanted}")));
            }
            let read = match is_date(cell) {
                true if self.clock.is_none() => format!("; {READ}"),
                true => String::new(),
                false => format!("; {BOOLEANS_READ}"),
            };
            self.told
                .push(format!("column {text:?} holds words (line {line}: {cell:?}) and is left out{read}"));
            self.columns.remove(place);
            for row in &mut self.rows {
                row.remove(place);
            }
        }
        Ok(())
    }

    /// No two columns of numbers have one name, of all that were `named`, and each number can have been measured.
    fn check_numbers(&self, named: &[Header]) -> Result<(), Error> {
        let twice = self.names().iter().enumerate().any(|(at, text)| self.names()[..at].contains(text));
        let is_kept = |head: &&Header| self.place(&head.text).is_some();
        let names = named.iter().map(|head| if is_kept(&head) { head.text.as_str() } else { "" });
        if let Some(problem) = csv_text::named_twice(names).filter(|_| twice) {
            return Err(self.wrong(self.lines.0, problem));
        }
        for (place, head) in self.columns.iter().enumerate() {
            if let Some((row, told)) = implausible(&self.column(place)) {
                return Err(self.wrong(self.lines.1[row], format!("column {:?}: {told}", head.text)));
            }
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

    /// Columns that are named after a variable to the letter have that name: `M_A` is no M in ampere, `v[2]` no v in units of 2. What a head leaves
    /// open, `T/K`, a variable's name in it tells.
    pub(super) fn with_names(&mut self, known: &dyn Fn(&str) -> bool, is_name: &dyn Fn(&str) -> bool) {
        for column in &mut self.columns {
            // a unit from the line below stays
            let is_of_head = column.unit == header(&column.text).unit;
            if known(&column.text) {
                column.unit = column.unit.take().filter(|_| !is_of_head);
                column.name.clone_from(&column.text);
            } else if let Some(head) = heads::beside_variables(&column.text, is_name).filter(|_| is_of_head) {
                *column = head;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A log with this text; `name` is the test's own.
    fn read(name: &str, text: &str) -> Result<Sheet, String> {
        let path = std::env::temp_dir().join(format!("diagnosis-{name}-{}.csv", std::process::id()));
        std::fs::write(&path, text).expect("a temporary file can be written");
        let sheet = Sheet::read(&path).map_err(|error| error.to_string());
        let _ = std::fs::remove_file(&path);
        sheet
    }

    #[test]
    fn bad_data_a_row_that_is_cut_is_left_out_and_told() {
        let rows: String = (0..30).map(|row| format!("{row},1,{row}.5\n")).collect();
        let sheet = read("cut", &format!("t,u,w\n{rows}30,2\n31,1,2\n32,-1\n")).expect("it is read");
        assert_eq!((sheet.rows.len(), sheet.rows[30][0], sheet.lines.1[30]), (31, 31.0, 33));
        let told = sheet.told.join("; ");
        assert!(
            told.contains("2 cells below 3 names in line 32 (2 such rows, this is the first): the row is cut and left out"),
            "{told}"
        );
        // a logger that leaves empty cells at the end out
        let sheet = read("ends", "t,u,note\n0,1\n1,2\n2,1,7\n3,1\n").expect("it is read");
        assert_eq!((sheet.rows.len(), sheet.rows[1][1]), (4, 2.0));
        assert!(sheet.told.join(";").contains("was not measured"), "{:?}", sheet.told);
        // and a comma behind all names
        assert_eq!(read("comma", "t,u,\n0,1\n1,2\n2,1\n").expect("it is read").told, [""; 0]);
    }

    #[test]
    fn bad_data_columns_of_one_name_and_what_no_sensor_gives() {
        let told = read("twice", "t,i [mA],mode,i [mA]\n0,1,on,2\n1,1,off,2\n2,1,on,3\n").unwrap_err();
        assert!(told.contains(":1: columns 2 and 4 are both called \"i [mA]\""), "{told}");
        // words are left out, whatever they are called
        assert!(read("words", "t,i,i\n0,1,idle\n1,1,run\n2,1,idle\n").is_ok());
        let told = read("huge", "# rig\nt,i [mA]\n0,1\n1,-2\n2,1e308\n3,1\n").unwrap_err();
        assert!(told.contains(":5: column \"i [mA]\": 1e308 is no measurement"), "{told}");
    }

    #[test]
    fn value_columns_of_words_for_yes_and_no() {
        let sheet = read("words-on", "t,brake,fan,valve\n0,on,No,open\n1,OFF,,closed\n2,On,yes,open\n");
        let sheet = sheet.expect("it is read");
        assert_eq!(sheet.names(), ["t", "brake", "fan"]);
        assert_eq!((sheet.column(1), sheet.rows[2][2]), (vec![1.0, 0.0, 1.0], 1.0));
        assert!(sheet.rows[1][2].is_nan() && sheet.rows[0][2] == 0.0);
        let told = sheet.told.join("; ");
        assert!(told.contains("\"brake\": words are read as 1 and 0: \"on\" in line 2 is 1"), "{told}");
        assert!(told.contains("\"valve\" holds words") && told.contains("on and off, yes and no"), "{told}");
    }

    #[test]
    fn value_heads_that_are_names_of_variables() {
        let columns = ["M_A", "v[2]", "u_V", "x [mm]", "T/K"].map(header).to_vec();
        let mut sheet = Sheet {
            path: "log.csv".into(),
            columns,
            rows: vec![],
            lines: (1, vec![]),
            dialect: None,
            clock: None,
            told: vec![],
        };
        sheet.with_names(&|text| ["M_A", "v[2]"].contains(&text), &|text| text == "T");
        let heads: Vec<_> =
            sheet.columns.iter().map(|head| (head.name.as_str(), head.unit.as_deref())).collect();
        let wanted = [("M_A", None), ("v[2]", None), ("u", Some("V")), ("x", Some("mm")), ("T", Some("K"))];
        assert_eq!(heads, wanted);
    }
}
