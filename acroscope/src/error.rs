//! What ends the program, and with which exit status.

use std::io;
use std::path::PathBuf;

/// Why a command did not do its work.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A run failed, or something that all commands do.
    #[error(transparent)]
    Run(#[from] runner::Error),
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
    /// Recorded frames can't be used.
    #[error(transparent)]
    Frames(#[from] frames::Error),
    /// A sweep can't be made.
    #[error(transparent)]
    Sweep(#[from] sweep::Error),
    /// A sweep was interrupted by a signal.
    #[error("{}: {why}", runner::signals::name(*signal))]
    SweepInterrupted {
        /// Its number.
        signal: i32,
        /// What there is of the sweep.
        why: String,
    },
    /// A result can't be shown.
    #[error(transparent)]
    View(#[from] viewer::Error),
    /// A page can't be served.
    #[error("can't serve the page on 127.0.0.1: {0}")]
    Serve(String),
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
}

impl Error {
    /// 2 if the user can mend the input, 128 + its number after a signal, else 1.
    pub fn exit_status(&self) -> u8 {
        match self {
            Self::Run(error) => error.exit_status(),
            Self::SweepInterrupted { signal, .. } => runner::signals::exit_status(*signal),
            other if orchestrator::machine::failed(&other.to_string()) => 1,
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
            Self::Serve(_) | Self::Faulty { .. } => 1,
        }
    }

    /// For `map_err` on something that was done with a file.
    pub fn file(path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |why| runner::Error::file(path)(why).into()
    }

    /// Words that are no command.
    pub fn words(text: impl Into<String>) -> Self {
        runner::Error::Words(text.into()).into()
    }
}

impl From<orchestrator::Error> for Error {
    fn from(error: orchestrator::Error) -> Self {
        Self::Run(error.into())
    }
}

impl From<scenarios::Error> for Error {
    fn from(error: scenarios::Error) -> Self {
        Self::Run(error.into())
    }
}
