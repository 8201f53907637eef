//! Numbers that a correction is offered by, each with its reason.

use crate::statistics::levels::{DOUBTED, SLIGHT, SMALL, STEP};

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Offered {
    /// Standard deviations, by the scatter between blocks, that a coefficient must be away from 0. Fewer than for a name:
    /// terms resemble one another, and it is the runs left out that decide.
    pub certain: f64,
    /// Share of what is left above the floor, on runs left out, that a term must take away.
    pub worth: f64,
    /// Share of the gap that all terms together must close on runs left out, or none is offered: of nine that closed less than a
    /// tenth, two left runs worse on which all was fitted anew.
    pub together: f64,
    /// Share of the first residual that a term must amount to: torques between rows are about as exact beside large ones, which are held over steps.
    /// A drag of 0.18 N·m came with a spring of 0.0015 N·m.
    pub exact: f64,
    /// Rates over which a Stribeck term may fall, rad/s: what is seen from machine tools to balancing arms.
    pub slow: [f64; 5],
}

/// Those in force.
pub const CORRECTION: Offered = Offered {
    certain: DOUBTED,
    worth: SLIGHT,
    together: SMALL,
    exact: STEP,
    slow: [0.05, 0.1, 0.2, 0.4, 0.8],
};
