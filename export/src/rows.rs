//! The rows of a `results.csv`, one at a time.

use crate::error::{Error, file};
use std::path::{Path, PathBuf};

/// Reads rows; a last line that was cut off in the middle ends them.
pub struct Rows {
    path: PathBuf,
    reader: csv::Reader<std::fs::File>,
    record: csv::StringRecord,
    /// Names of all columns; the first is the time.
    pub head: Vec<String>,
}

impl Rows {
    /// Opens the file and reads its head.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let mut reader = csv::Reader::from_path(path).map_err(file(path))?;
        let head = reader.headers().map_err(file(path))?.iter().map(str::to_owned).collect();
        Ok(Self { path: path.to_owned(), reader, record: csv::StringRecord::new(), head })
    }

    /// Goes to the next row; false at the end.
    pub fn advance(&mut self) -> Result<bool, Error> {
        let read = self.reader.read_record(&mut self.record);
        match &read {
            Err(error) if matches!(error.kind(), csv::ErrorKind::UnequalLengths { .. }) => {
                // the last line may have been cut off; one before it is damage
                let is_last = matches!(self.reader.read_record(&mut csv::StringRecord::new()), Ok(false));
                if is_last { Ok(false) } else { read.map_err(file(&self.path)) }
            }
            _ => read.map_err(file(&self.path)),
        }
    }

    /// The text in a column.
    pub fn text(&self, column: usize) -> &str {
        self.record.get(column).unwrap_or_default()
    }

    /// The number in a column.
    pub fn number(&self, column: usize) -> Result<f64, Error> {
        let text = self.text(column);
        text.parse().map_err(|_| Error::Value {
            path: self.path.clone(),
            line: self.record.position().map_or(0, csv::Position::line),
            column: self.head.get(column).cloned().unwrap_or_default(),
            value: text.to_owned(),
        })
    }
}
