//! Numbers that noise and outliers are told by, each with its reason.

use crate::statistics::levels::{FAR, FEW, HALF, SEVERAL, SLIGHT};

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Nuisance {
    /// Highest order of differences that is tried: beyond it they amplify noise as fast as they damp motion.
    pub orders: usize,
    /// A log looks rounded where fewer of its values are different than this share.
    pub rounded: f64,
    /// An outlier lies so many robust deviations beyond its neighbours: of 1e6 values of normal noise none does.
    pub beyond: f64,
    /// And so many times as far as the neighbours are from each other: an edge lies one time away.
    pub alone: f64,
    /// Longest stretch of outliers.
    pub longest: usize,
    /// What an input did may show for so many rows.
    pub rings: usize,
    /// More than this share of a channel is no accident but the way it behaves.
    pub seldom: f64,
    /// Fewest rows that were held over, and most in turn where that isn't how a sensor works.
    pub in_turn: usize,
    /// Readings are held over if they repeat the row before so many times as often as others are alike.
    pub times: f64,
    /// A sensor that is slower than its log holds no value for so many times as long as it usually does.
    pub steady: f64,
}

/// Those in force.
pub(super) const NUISANCE: Nuisance = Nuisance {
    orders: 5,
    rounded: HALF,
    beyond: FAR,
    alone: SEVERAL,
    longest: FEW,
    rings: 5,
    seldom: SLIGHT,
    in_turn: FEW,
    times: FAR,
    steady: SEVERAL,
};
