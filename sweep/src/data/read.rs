//! Reads back what was written: what a file is a part of, and columns for the page.

use super::{Counts, FAILED, NOT_FINITE, PART, STUDY};
use crate::error::Error;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use std::fs::File;
use std::path::Path;

/// What a file says of itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Marks {
    pub(crate) fingerprint: String,
    pub(crate) part: u64,
    pub(crate) of: u64,
    pub(crate) counts: Counts,
}

fn open(path: &Path) -> Result<SerializedFileReader<File>, Error> {
    let file = File::open(path).map_err(Error::file(path))?;
    SerializedFileReader::new(file).map_err(Error::parquet(path))
}

/// What a file says of itself; `None` if it was not made here.
pub(crate) fn marks(path: &Path) -> Result<Option<Marks>, Error> {
    let reader = match open(path) {
        Ok(reader) => reader,
        Err(_) if path.is_file() => return Ok(None),
        Err(error) => return Err(error),
    };
    let marks = reader.metadata().file_metadata().key_value_metadata();
    let find = |key: &str| marks?.iter().find(|mark| mark.key == key)?.value.clone();
    let read = || {
        let (fingerprint, part) = (find(STUDY)?, find(PART)?);
        let (part, of) = part.split_once('/')?;
        let (part, of) = (part.parse().ok()?, of.parse().ok()?);
        let counts = Counts::read(&find(FAILED)?, find(NOT_FINITE).as_deref())?;
        Some(Marks { fingerprint, part, of, counts })
    };
    Ok(read())
}

/// Values of a column of numbers at some places, NaN where there is none; texts are NaN, too.
pub(crate) fn numbers(path: &Path, columns: &[usize], into: &mut [Vec<f64>]) -> Result<(), Error> {
    let reader = open(path)?;
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(Error::parquet(path))?;
        for (column, into) in columns.iter().zip(into.iter_mut()) {
            let values = match group.get_column_reader(*column).map_err(Error::parquet(path))? {
                ColumnReader::DoubleColumnReader(values) => all(values, |value| *value),
                ColumnReader::Int32ColumnReader(values) => all(values, |value| f64::from(*value)),
                ColumnReader::Int64ColumnReader(values) => all(values, |value| *value as f64),
                ColumnReader::BoolColumnReader(values) => all(values, |value| f64::from(u8::from(*value))),
                _ => Ok(vec![Some(f64::NAN); usize::try_from(group.metadata().num_rows()).unwrap_or(0)]),
            };
            into.extend(
                values.map_err(Error::parquet(path))?.into_iter().map(|value| value.unwrap_or(f64::NAN)),
            );
        }
    }
    Ok(())
}

/// The texts of a column and their rows, at most so many.
pub(crate) fn texts(path: &Path, column: usize, most: usize) -> Result<Vec<(usize, String)>, Error> {
    let reader = open(path)?;
    let (mut found, mut row) = (Vec::new(), 0);
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(Error::parquet(path))?;
        if let ColumnReader::ByteArrayColumnReader(values) =
            group.get_column_reader(column).map_err(Error::parquet(path))?
        {
            let text = |value: &ByteArray| String::from_utf8_lossy(value.data()).into_owned();
            let values = all(values, text).map_err(Error::parquet(path))?;
            let rows = values.into_iter().enumerate();
            found.extend(rows.filter_map(|(at, text)| Some((row + at, text?))).take(most - found.len()));
        }
        row += usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        if found.len() >= most {
            break;
        }
    }
    Ok(found)
}

/// All values of a column, row by row.
fn all<T: DataType, V>(
    mut reader: ColumnReaderImpl<T>,
    value: impl Fn(&T::T) -> V,
) -> parquet::errors::Result<Vec<Option<V>>> {
    let mut rows = Vec::new();
    loop {
        let (mut values, mut there) = (Vec::new(), Vec::new());
        let (records, ..) = reader.read_records(1 << 14, Some(&mut there), None, &mut values)?;
        if records == 0 {
            return Ok(rows);
        }
        let mut values = values.iter().map(&value);
        // A column that always has a value has no levels.
        match there.is_empty() {
            true => rows.extend(values.map(Some)),
            false => rows.extend(there.iter().map(|level| if *level > 0 { values.next() } else { None })),
        }
    }
}
