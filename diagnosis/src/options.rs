//! What a user may choose of a diagnosis, whoever makes it.

use crate::earlier::Earlier;
use crate::statistics::levels::SEVERAL;
use orchestrator::Isolation;
use std::time::{Duration, Instant};

/// What a user may choose.
#[derive(Debug, Clone)]
pub struct Options {
    /// Candidates that are not to be named.
    pub without: Vec<String>,
    /// Most frames that are compared.
    pub frames: usize,
    /// What is known of the machine from other data.
    pub earlier: Option<Earlier>,
    /// How long searches may take.
    pub budget: Budget,
    /// The clock by which searches end: [`Instant::now`], unless a test drives another. Units are given up by real time.
    pub now: fn() -> Instant,
    /// Units in processes of their own, within limits; any unit's data sets only. A scenario says so for its units by itself, too.
    pub isolation: Option<Isolation>,
    /// Parameters to be fitted in place of a search; any unit's data sets only.
    pub fit: Vec<String>,
}

/// How long searches may take, s: then they end with what they have.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Budget {
    /// As long as it takes: the answer depends on no machine's speed.
    #[default]
    Unlimited,
    /// So long for each run.
    EachRun(f64),
    /// So long in all.
    All(f64),
}

/// Real time in s that looks at a unit may take whatever the budget: one of 0 asks for what can be said without a search.
pub(crate) const GIVEN_UP: f64 = 60.0;

impl Budget {
    /// When time is up for so many runs; nothing where it never is.
    pub(crate) fn end(self, began: Instant, runs: usize) -> Option<Instant> {
        Duration::try_from_secs_f64(self.seconds(runs)).ok().and_then(|time| began.checked_add(time))
    }

    /// When a model that doesn't come to an end is given up: after the budget has passed several times, and not before the looks
    /// that need none had their time.
    pub(crate) fn deadline(self, began: Instant, runs: usize) -> Option<Instant> {
        Self::All((SEVERAL * self.seconds(runs)).max(GIVEN_UP)).end(began, runs)
    }

    /// How long searches in so many runs may take, s.
    pub(crate) fn seconds(self, runs: usize) -> f64 {
        match self {
            Self::Unlimited => f64::INFINITY,
            Self::EachRun(seconds) => seconds * runs as f64,
            Self::All(seconds) => seconds,
        }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            without: Vec::new(),
            frames: 2400,
            earlier: None,
            budget: Budget::Unlimited,
            now: Instant::now,
            isolation: None,
            fit: Vec::new(),
        }
    }
}
