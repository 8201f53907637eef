//! A finished run to look at: the acrobot in the plane, what the camera saw, the signals, and a clock that moves through all
//! of them; or two runs side by side. For a scenario without our machine: signals, units and connections.
//!
//! [`page`] makes one self-contained HTML file of the folders that `acroscope run` wrote. What moves in the browser lies in `assets/`.

#![forbid(unsafe_code)]

mod frames;
mod machine;
mod page;
mod results;
mod rows;
mod signals;
mod wiring;

pub use page::{Shown, page};

use std::path::PathBuf;

/// Why a result can't be shown.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// No folder of a run.
    #[error("{} is no folder that `acroscope run` wrote: it has no {lacks}", folder.display())]
    NoResult {
        /// As given.
        folder: PathBuf,
        /// The file that is missing.
        lacks: &'static str,
    },
    /// A file that can't be read.
    #[error("{}: {why}", path.display())]
    File {
        /// Which one.
        path: PathBuf,
        /// What the system or the reader says, with the line where there is one.
        why: String,
    },
    /// The scenario of the run is not readable.
    #[error(transparent)]
    Scenario(#[from] orchestrator::Error),
    /// A graph can't be drawn.
    #[error(transparent)]
    Report(#[from] report::Error),
}

impl Error {
    /// Whether the user can mend the input.
    pub fn is_input(&self) -> bool {
        match self {
            Self::NoResult { .. } | Self::File { .. } => true,
            Self::Scenario(error) => error.is_input(),
            Self::Report(_) => false,
        }
    }
}
