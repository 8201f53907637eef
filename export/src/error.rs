//! What can go wrong.

use std::path::{Path, PathBuf};

/// Errors of an export.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file can't be read or written.
    #[error("{}: {why}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        why: String,
    },
    /// A time that MCAP has no number for.
    #[error("{}: a row at {time} s: MCAP counts nanoseconds from 0 up to 584 years; Parquet takes any time", path.display())]
    Time {
        /// The file.
        path: PathBuf,
        /// The time in s.
        time: f64,
    },
    /// The results hold something that no number is.
    #[error("{}:{line}: {column} is {value:?}, not a number", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// Its line, from 1.
        line: u64,
        /// The column.
        column: String,
        /// What stands there.
        value: String,
    },
}

/// For `map_err`: this file, for that reason.
pub(crate) fn file<E: std::fmt::Display>(path: &Path) -> impl Fn(E) -> Error {
    move |why| Error::File { path: path.to_owned(), why: why.to_string() }
}
