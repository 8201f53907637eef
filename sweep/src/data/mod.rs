//! The data set: Parquet files, written whole or not at all, and read back for the page.

mod cases;
mod counts;
mod file;
mod read;
mod signals;

pub(crate) use cases::CaseFile;
pub(crate) use counts::Counts;
pub(crate) use file::{Stamp, temporary};
pub(crate) use read::{Marks, marks, numbers, texts};
pub(crate) use signals::SignalFile;

/// Keys of a file's metadata: of what study it is, which part of how many, how many of its cases failed, and how many read what is not
/// finite.
pub(crate) const STUDY: &str = "acroscope.study";
pub(crate) const PART: &str = "acroscope.part";
pub(crate) const FAILED: &str = "acroscope.failed";
pub(crate) const NOT_FINITE: &str = "acroscope.not-finite";
