//! Why a run does not come about or does not end well, and with which exit status.

use std::io;
use std::path::PathBuf;

/// Why a run, or something that all commands do, failed.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The orchestrator refused or failed.
    #[error(transparent)]
    Orchestrator(#[from] orchestrator::Error),
    /// A graph can't be drawn.
    #[error(transparent)]
    Report(#[from] report::Error),
    /// There is no such scenario, or it can't be read.
    #[error(transparent)]
    Scenario(#[from] scenarios::Error),
    /// Results can't be written in another format.
    #[error("{0}")]
    Format(String),
    /// An override that is none.
    #[error("--set {given}: expected UNIT.VARIABLE=VALUE, e.g. --set camera.k1=0.1")]
    Override {
        /// As typed.
        given: String,
    },
    /// The scenario's table for the report is wrong.
    #[error("{scenario}: [report]: {why}")]
    Layout {
        /// The scenario.
        scenario: String,
        /// What is wrong and what would be right.
        why: String,
    },
    /// A signal asked for the end.
    #[error("{} at t = {time} s; what there is of the run is kept", crate::signals::name(*signal))]
    Interrupted {
        /// Its number.
        signal: i32,
        /// Simulated time in s.
        time: f64,
    },
    /// Words that are no command.
    #[error("{0}")]
    Words(String),
    /// A file or folder can't be read or written.
    #[error("{}: {why}", path.display())]
    File {
        /// Which one.
        path: PathBuf,
        /// What the system or the reader says.
        why: String,
    },
}

impl Error {
    /// 2 if the user can mend the input, 128 + its number after a signal, else 1.
    pub fn exit_status(&self) -> u8 {
        match self {
            Self::Interrupted { signal, .. } => crate::signals::exit_status(*signal),
            Self::Orchestrator(error) if !error.is_input() => 1,
            // A disk that is full or broken is the machine's, whatever was being written.
            other if orchestrator::machine::failed(&other.to_string()) => 1,
            Self::Orchestrator(_) | Self::Scenario(_) | Self::Override { .. } | Self::Layout { .. } => 2,
            // A folder that can't be written: another one will do.
            Self::File { .. } | Self::Words(_) => 2,
            Self::Report(_) | Self::Format(_) => 1,
        }
    }

    /// For `map_err` on something that was done with a file.
    pub fn file(path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |why| Self::File { path, why: why.to_string() }
    }
}
