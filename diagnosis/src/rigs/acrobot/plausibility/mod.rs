//! What can't be, before anything is fitted: logs that count otherwise than the model does look like a machine that lacks everything,
//! and a diagnosis of them names effects that aren't there.
//!
//! An ordered list of pure functions of the logs. The first that is beyond doubt stops the diagnosis with one sentence and the line that
//! `dataset.toml` needs. Nothing is changed by guess. [`motion`] asks the same of the nominal model, which must be loaded for it.

mod angles;
mod circles;
pub mod motion;
mod pixels;
pub(crate) mod policy;
pub mod time;

pub use crate::error::Finding;
use crate::rigs::acrobot::dataset::{Nominal, Run};

/// What the functions are told.
#[derive(Debug, Clone, Copy)]
pub struct Facts<'a> {
    /// The logs, turned into ours as `[log]` says, without cells that are no measurement.
    pub runs: &'a [Run],
    /// Sizes that the nominal model has.
    pub nominal: Nominal,
    /// `[log]` says what is known of gaps.
    pub gaps_stated: bool,
}

/// A check: what it found, if that is beyond doubt.
pub type Check = fn(&Facts<'_>) -> Option<Finding>;

/// The checks, in the order in which one thing hides another: nothing of a motion can be said in a wrong unit of time, nor of
/// encoders beside images that stand on their head or in which one circle is taken for another.
pub const CHECKS: &[Check] = &[
    time::units_apart,
    time::unit,
    circles::exchanged,
    pixels::origin,
    angles::degrees,
    angles::against_pictures,
    time::pauses,
    time::torque_holes,
];

/// The first thing that can't be.
pub fn first(facts: &Facts<'_>) -> Option<Finding> {
    CHECKS.iter().find_map(|check| check(facts))
}
