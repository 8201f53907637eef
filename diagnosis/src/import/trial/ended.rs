//! How a run of the model ends that is no whole one: by an error, or since it takes too long.

use crate::import::policy::IMPORT;
use orchestrator::Progress;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// Why a model didn't run.
#[derive(Debug)]
pub(in super::super) struct Failed {
    pub why: String,
    /// The process of its unit ended.
    pub died: bool,
}

impl Failed {
    pub fn other(why: impl ToString) -> Self {
        Self { why: why.to_string(), died: false }
    }

    /// It took longer than anybody waits.
    pub fn too_slow() -> Self {
        Self::other(format!("the model takes more than {} s", IMPORT.patience))
    }

    /// In a line.
    pub fn in_short(&self) -> &str {
        self.why.lines().next().unwrap_or_default()
    }
}

impl From<orchestrator::Error> for Failed {
    fn from(error: orchestrator::Error) -> Self {
        Self { why: error.to_string(), died: matches!(error, orchestrator::Error::Died { .. }) }
    }
}

/// Ends a run that takes too long.
pub(super) struct Within {
    began: Instant,
    limit: Option<Duration>,
    pub over: bool,
}

impl Within {
    pub fn new(limit: Option<Duration>) -> Self {
        Self { began: Instant::now(), limit, over: false }
    }
}

impl Progress for Within {
    fn at(&mut self, _: f64, _: f64) -> ControlFlow<()> {
        orchestrator::beat();
        self.over |= self.limit.is_some_and(|limit| self.began.elapsed() > limit);
        if self.over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
