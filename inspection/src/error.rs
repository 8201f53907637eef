//! Why a unit can't be looked at, or no scenario be made of it.

use std::io;
use std::path::PathBuf;

/// What ends the work before there are findings.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file can't be read.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A unit can't be opened for a scenario.
    #[error(transparent)]
    Unit(#[from] orchestrator::Error),
    /// There is no such rule.
    #[error("the rule {rule:?} does not run a unit: {known}")]
    Rule {
        /// As it was named.
        rule: String,
        /// What would be right.
        known: String,
    },
    /// No process can be started in which the unit could run.
    #[error("the rules that run a unit need a process of their own: {0}")]
    Host(String),
}

impl Error {
    /// The user's input is wrong, rather than the machine.
    pub fn is_input(&self) -> bool {
        match self {
            Self::File { .. } | Self::Rule { .. } => true,
            Self::Unit(error) => error.is_input(),
            Self::Host(_) => false,
        }
    }
}
