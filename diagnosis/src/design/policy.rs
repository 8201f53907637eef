//! Numbers that experiments are chosen by, each with its reason.

use crate::search::SEARCHING;

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Experiments {
    /// Most rows of a simulated run.
    pub rows: usize,
    /// Most members of a class that are told apart.
    pub members: usize,
    /// Experiments of each length that are simulated with every member as the truth.
    pub finalists: usize,
    /// Expected loss of deviance above which two members count as told apart: the class's own threshold.
    pub told: f64,
    /// Share of an input's range that is used.
    pub used: f64,
}

/// Those in force.
pub(crate) const EXPERIMENTS: Experiments =
    Experiments { rows: 400, members: 4, finalists: 2, told: SEARCHING.class, used: 0.95 };
