//! Numbers that noises are inferred by, each with its reason.

use crate::statistics::levels::{MORE, SAMPLE, SLIGHT};
use crate::statistics::linear::RANK_TOLERANCE;

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Infer {
    /// Least curvature that is believed: a size that tells of nothing moves by its gradient alone. Numerical only.
    pub flat: f64,
    /// Shares of the process noise with which its search is begun, too. Numerical only: it goes on from the best.
    pub less_process: [f64; 3],
    /// Longest move of a logarithm at once: a factor of 4.5. Numerical only.
    pub longest_move: f64,
    /// A search ends when a round gains less deviance than this; an effect must gain hundreds of times that. Numerical
    /// only.
    pub ends: f64,
    /// Rounds of a search. Six sizes settle in ten. Numerical only: it ends what never would.
    pub rounds: usize,
    /// A channel's noise is at most so much more than its least.
    pub widest: f64,
    /// Stretches of all runs together: enough to know a deviation to an eighth, each long against what an input remembers.
    pub stretches: usize,
}

/// Those in force.
pub(super) const INFER: Infer = Infer {
    flat: 1.0,
    less_process: [0.1, 1e-2, 1e-4],
    longest_move: MORE,
    ends: SLIGHT,
    rounds: 30,
    widest: 1.0 / RANK_TOLERANCE,
    stretches: SAMPLE,
};
