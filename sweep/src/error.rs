//! Why a sweep can't be made.

use std::io;
use std::path::{Path, PathBuf};

/// Why a sweep can't be made. What goes wrong within a case is no such error: it stands in the case's row.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Something in a study is wrong.
    #[error("{place}: {what}: {expected}")]
    Study {
        /// File and line, or what was typed.
        place: String,
        /// What is wrong.
        what: String,
        /// What would be right.
        expected: String,
    },
    /// There is no such study.
    #[error("no study `{name}`: neither a file nor one of the shipped ones ({shipped}); {suggestion}")]
    Unknown {
        /// As typed.
        name: String,
        /// What there is.
        shipped: String,
        /// What may have been meant.
        suggestion: String,
    },
    /// The scenario can't be found or read.
    #[error("{place}: {source}")]
    Scenario {
        /// Where the study names it: file and line, or what was typed.
        place: String,
        /// Why.
        source: Box<scenarios::Error>,
    },
    /// The scenario can't be built.
    #[error(transparent)]
    Orchestrator(#[from] orchestrator::Error),
    /// A picture can't be drawn.
    #[error(transparent)]
    Report(#[from] report::Error),
    /// A part that can't be.
    #[error("--partition {part}/{of}: K/N with K from 1 to N")]
    Partition {
        /// The part, from 1.
        part: u64,
        /// How many there are.
        of: u64,
    },
    /// A limit without anything that it limits.
    #[error("{option} is for units in processes of their own, and no unit is in one: add --isolate")]
    Limit {
        /// Which one.
        option: &'static str,
    },
    /// The folder holds parts of something else.
    #[error("{}: it belongs to {what}; choose another --out, or remove that data set first", path.display())]
    Foreign {
        /// A part that is in the way.
        path: PathBuf,
        /// To what it belongs.
        what: String,
    },
    /// A library remembers what ran before in this process.
    #[error(
        "two runs of the first case differ, though both had fresh instances: the library of a unit keeps something from run to run \
         (static data), or goes by the time or by chance, and a row would depend on the cases before it; add --isolate, and every case \
         gets processes of its own"
    )]
    Kept,
    /// A file can't be read or written.
    #[error("{}: {why}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system or the library says.
        why: String,
    },
    /// Somebody asked for the end. What is finished stays.
    #[error(
        "interrupted after {cases} cases; {parts} finished parts are kept, and the same command goes on after them"
    )]
    Interrupted {
        /// Cases that were run.
        cases: u64,
        /// Parts that are whole.
        parts: u64,
    },
}

impl Error {
    /// The user's input is wrong, rather than a unit or the machine: exit status 2 of the command line.
    pub fn is_input(&self) -> bool {
        match self {
            Self::Orchestrator(error) => error.is_input(),
            Self::Report(_) | Self::Interrupted { .. } => false,
            _ => true,
        }
    }

    /// For `map_err` on something that was done with a file.
    pub(crate) fn file(path: &Path) -> impl Fn(io::Error) -> Self + '_ {
        move |why| Self::File { path: path.into(), why: why.to_string() }
    }

    /// The same for the Parquet library.
    pub(crate) fn parquet(path: &Path) -> impl Fn(parquet::errors::ParquetError) -> Self + '_ {
        move |why| Self::File { path: path.into(), why: why.to_string() }
    }
}
