//! What can go wrong, with the place where a person can put it right.

use orchestrator::Place;

/// Why a package can't be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The archive, a unit or the scenario is wrong.
    #[error(transparent)]
    Orchestrator(#[from] orchestrator::Error),
    /// A document of the package is wrong, or says what can't be expressed.
    #[error("{place}: {what}: {expected}")]
    Document {
        /// Package, document and line.
        place: Place,
        /// What is wrong, with the element's name.
        what: String,
        /// What would be right.
        expected: String,
    },
    /// A scenario has something that a package can't hold.
    #[error("{what}: {expected}")]
    Scenario {
        /// What.
        what: String,
        /// What would be right.
        expected: String,
    },
    /// A file can't be read.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: std::path::PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

impl Error {
    /// The user can mend it: exit status 2 of the command line.
    pub fn is_input(&self) -> bool {
        match self {
            Self::Orchestrator(error) => error.is_input(),
            _ => true,
        }
    }
}
