//! What ends the program, and with which exit status.

use std::io;
use std::path::PathBuf;

/// Why a command did not do its work.
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
    /// A container can't be made.
    #[error(transparent)]
    Container(#[from] container::Error),
    /// A package can't be written.
    #[error(transparent)]
    Ssp(#[from] ssp::Error),
    /// A study can't be run.
    #[error(transparent)]
    Study(#[from] studies::Error),
    /// A data set can't be diagnosed.
    #[error(transparent)]
    Diagnosis(#[from] diagnosis::Error),
    /// Results can't be written in another format.
    #[error(transparent)]
    Export(#[from] export::Error),
    /// Recorded frames can't be used.
    #[error(transparent)]
    Frames(#[from] frames::Error),
    /// A sweep can't be made.
    #[error(transparent)]
    Sweep(#[from] sweep::Error),
    /// A sweep was interrupted by a signal.
    #[error("{}: {why}", crate::signals::name(*signal))]
    SweepInterrupted {
        /// Its number.
        signal: i32,
        /// What there is of the sweep.
        why: String,
    },
    /// A result can't be shown.
    #[error(transparent)]
    View(#[from] viewer::Error),
    /// A unit can't be looked at.
    #[error(transparent)]
    Inspection(#[from] inspection::Error),
    /// A unit is not as it should be; what is wrong has been told.
    #[error("{}: {errors} {}", path.display(), if *errors == 1 { "error" } else { "errors" })]
    Faulty {
        /// The unit.
        path: PathBuf,
        /// How many.
        errors: usize,
    },
    /// A file would be lost.
    #[error("{} is there already: --force replaces it", path.display())]
    There {
        /// The file.
        path: PathBuf,
    },
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
            Self::Orchestrator(error) if !error.is_input() => 1,
            Self::Container(error) if !error.is_input() => 1,
            Self::Ssp(error) if !error.is_input() => 1,
            Self::Study(error) if !error.is_input() => 1,
            Self::Diagnosis(error) if !error.is_input() => 1,
            Self::Sweep(error) if !error.is_input() => 1,
            Self::View(error) if !error.is_input() => 1,
            Self::Inspection(error) if !error.is_input() => 1,
            Self::Study(_) | Self::Diagnosis(_) | Self::Sweep(_) | Self::View(_) => 2,
            Self::Ssp(_) | Self::Container(_) => 2,
            Self::Inspection(_) | Self::There { .. } | Self::Frames(_) => 2,
            Self::Orchestrator(_) | Self::Scenario(_) | Self::Override { .. } | Self::Layout { .. } => 2,
            Self::Words(_) => 2,
            Self::Interrupted { signal, .. } | Self::SweepInterrupted { signal, .. } => {
                crate::signals::exit_status(*signal)
            }
            // A folder that can't be written, a disk that is full: another one will do.
            Self::File { .. } => 2,
            Self::Export(export::Error::File { .. }) => 2,
            Self::Report(_) | Self::Export(_) | Self::Faulty { .. } => 1,
        }
    }

    /// For `map_err` on something that was done with a file.
    pub fn file(path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |why| Self::File { path, why: why.to_string() }
    }
}
