//! Results in the formats of other tools, from the files that a run left: a new format is one file here.
//!
//! Reads `results.csv` row by row, so memory doesn't grow with the run.

#![forbid(unsafe_code)]

mod error;
mod mcap_file;
mod parquet_file;
mod rows;

pub use error::Error;
pub use mcap_file::write_mcap;
pub use parquet_file::write_parquet;

use std::path::PathBuf;

/// What is known of a column of `results.csv` beside its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// `unit.variable`
    pub name: String,
    /// What it counts in, if the unit's description says.
    pub unit: Option<String>,
    /// Its type.
    pub kind: Kind,
}

/// Type of a column's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A floating-point number.
    Real,
    /// A whole number.
    Integer,
    /// 0 or 1.
    Boolean,
    /// A text.
    Text,
}

/// Pictures that a unit wrote during the run.
#[derive(Debug, Clone, PartialEq)]
pub struct Pictures {
    /// The unit's name: the topic is `/UNIT/image`.
    pub unit: String,
    /// Column with the number of the newest picture.
    pub index: String,
    /// PNG files with their numbers.
    pub files: Vec<(PathBuf, u64)>,
}
