//! Reads `results.csv`. A row that can't be read is an error with its line, since what comes after it would be missing without a
//! word; the last line of a run that was killed may be cut off.

use crate::Error;
use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::path::Path;

/// A recorded column.
#[derive(Debug, PartialEq)]
pub struct Column {
    /// `unit.variable`
    pub name: String,
    /// What is no number is NaN.
    pub values: Vec<f64>,
    /// Every cell is a whole number without a point, as Booleans and Integers are written: its values hold until they change.
    pub held: bool,
}

/// What the file holds.
#[derive(Debug, PartialEq)]
pub struct Rows {
    /// Time of each row, s.
    pub times: Vec<f64>,
    /// The other columns.
    pub columns: Vec<Column>,
    /// What a person should know of it.
    pub note: Option<String>,
}

/// A column while it is read.
struct Reading {
    column: Column,
    /// Cells that are no numbers: how many, line and text of the first one.
    words: usize,
    first: Option<(u64, String)>,
}

/// Reads the file.
pub fn read(path: &Path) -> Result<Rows, Error> {
    let refused = |why: String| Error::File { path: path.to_owned(), why };
    let (file, bytes, is_whole) = opened(path).map_err(|why| refused(why.to_string()))?;
    let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(file);
    let head = reader.headers().map_err(|why| refused(why.to_string()))?.clone();
    if head.get(0) != Some("time") {
        let found = head.get(0).unwrap_or_default();
        return Err(refused(format!("line 1: the first column is {found:?}; it must be \"time\"")));
    }
    let mut times: Vec<f64> = Vec::new();
    let mut columns: Vec<Reading> = head.iter().skip(1).map(Reading::new).collect();
    let mut note = None;
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record).map_err(|why| refused(why.to_string()))? {
        let line = record.position().map_or(0, csv::Position::line);
        let is_cut = !is_whole && reader.position().byte() == bytes;
        match row(&record, &head, times.last().copied(), line) {
            Ok(time) => times.push(time),
            Err(_) if is_cut => {
                note = Some(format!(
                    "{}: line {line} is cut off in its middle, as by the end of a run that was killed, and is left out",
                    path.display()
                ));
                break;
            }
            Err(why) => return Err(refused(why)),
        }
        columns.iter_mut().zip(record.iter().skip(1)).for_each(|(column, cell)| column.add(cell, line));
    }
    if times.len() < 2 {
        return Err(refused("it has fewer than two rows: there is nothing to look at".to_owned()));
    }
    let columns = columns.into_iter().map(Reading::finish).collect::<Result<_, _>>().map_err(refused)?;
    Ok(Rows { times, columns, note })
}

/// The file, how long it is, and whether its last line has an end.
fn opened(path: &Path) -> io::Result<(File, u64, bool)> {
    let mut file = orchestrator::plain::open(path)?;
    let bytes = file.seek(SeekFrom::End(0))?;
    let mut last = [0];
    if bytes > 0 {
        file.seek(SeekFrom::End(-1))?;
        file.read_exact(&mut last)?;
    }
    file.seek(SeekFrom::Start(0))?;
    Ok((file, bytes, last == *b"\n"))
}

/// The time of a row, or what is wrong with it.
fn row(
    record: &csv::StringRecord,
    head: &csv::StringRecord,
    before: Option<f64>,
    line: u64,
) -> Result<f64, String> {
    if record.len() != head.len() {
        let cell = record.get(0).unwrap_or_default();
        let cells = if record.len() == 1 { "1 cell".to_owned() } else { format!("{} cells", record.len()) };
        return Err(format!(
            "line {line}: it has {cells}, the first of them {cell:?}; expected {}, as in line 1",
            head.len()
        ));
    }
    let cell = record.get(0).unwrap_or_default();
    let time = cell.parse::<f64>().ok().filter(|time| time.is_finite());
    time.filter(|time| before.is_none_or(|before| *time > before))
        .ok_or_else(|| format!("line {line}: time {cell:?} is no number after that of the row before"))
}

impl Reading {
    fn new(name: &str) -> Self {
        Self {
            column: Column { name: name.to_owned(), values: Vec::new(), held: true },
            words: 0,
            first: None,
        }
    }

    fn add(&mut self, cell: &str, line: u64) {
        let value = cell.parse().ok();
        if value.is_none() {
            self.words += 1;
            self.first.get_or_insert_with(|| (line, cell.to_owned()));
        }
        self.column.held &= cell.parse::<i64>().is_ok();
        self.column.values.push(value.unwrap_or(f64::NAN));
    }

    /// A String has words in most of its rows; one among numbers is damage.
    fn finish(self) -> Result<Column, String> {
        match self.first {
            Some((line, cell)) if 2 * self.words < self.column.values.len() => {
                let name = self.column.name;
                Err(format!("line {line}: {name} is {cell:?}; expected a number, as in most of its rows"))
            }
            _ => Ok(self.column),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::read;

    #[test]
    fn law_wrong_rows_are_told_by_their_line() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("results.csv");
        let told = |text: &str| {
            std::fs::write(&path, text).expect("written");
            read(&path).map(|rows| (rows.times, rows.note)).map_err(|error| error.to_string())
        };
        let cut = told("time,a.b\n0,1\n1,NaN\n2").expect("a line that was cut off is none");
        assert_eq!(cut.0, [0.0, 1.0]);
        assert!(cut.1.is_some_and(|note| note.contains("results.csv: line 4 is cut off")), "and told");
        assert_eq!(told("time,a.b\n0,1\n1,NaN\n2,3"), Ok((vec![0.0, 1.0, 2.0], None)), "this one is whole");
        for (rows, line, said) in [
            ("0,1\n1,1\nx,2\n", 4, "time \"x\""),
            ("1,1\n0,2\n", 3, "after that of the row before"),
            (
                "0,1\n1,2\njunk\n3,4\n",
                4,
                "it has 1 cell, the first of them \"junk\"; expected 2, as in line 1",
            ),
            ("0,1\n1,2\n3\n", 4, "it has 1 cell"),
            ("0,1\n1,2,3\n2,3\n", 3, "it has 3 cells"),
            ("0,1\n1,2\n2,x\n3,4\n", 4, "a.b is \"x\"; expected a number"),
        ] {
            let error = told(&format!("time,a.b\n{rows}")).expect_err(said);
            assert!(error.contains(&format!("line {line}: ")) && error.contains(said), "{rows}: {error}");
        }
        assert!(told("t,a.b\n1,1\n").expect_err("no time").contains("\"t\""));
        assert!(told("time,a.b\n1,1\n").expect_err("one row").contains("two rows"));
    }

    #[test]
    fn value_what_holds_and_what_is_text() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("results.csv");
        std::fs::write(&path, "time,a.on,a.x,a.s\n0.0,0,0.0,\n1.0,1,1.0,so\n").expect("written");
        let columns = read(&path).expect("readable").columns;
        assert_eq!(columns.iter().map(|column| column.held).collect::<Vec<_>>(), [true, false, false]);
        assert!(columns[2].values.iter().all(|value| value.is_nan()), "a String");
    }
}
