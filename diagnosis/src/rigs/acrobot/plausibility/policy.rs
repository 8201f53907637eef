//! Numbers by which logs are doubted before any fit, each with its reason.

use crate::rigs::acrobot::residual::policy::RESIDUAL;
use crate::statistics::levels::{DOUBTED, FAR, FEW, HALF, PART, SAMPLE, SMALL};

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plausible {
    /// Share of a motion that may be left where images and encoders agree, and from which on they surely don't.
    pub agrees: f64,
    pub differs: f64,
    /// Frames that are compared at least.
    pub frames: usize,
    /// To what share of itself another way of counting must bring the torque that the model lacks, to be beyond doubt; and how far the
    /// second best must be behind.
    pub better: f64,
    pub clearly: f64,
    /// And by how much what is lacking must stand above what noise gives before anything is asked.
    pub noise: f64,
    /// The share of gravity's torque beyond which a torque may be in thousandths.
    pub drives: f64,
    /// Circle 1 rolls at one height. So near to where it should be it is there, px: lenses and mounts move it by less, and any other
    /// origin by more.
    pub near: f64,
    /// Frames so many times as far apart as the nominal camera takes them are stamped in another unit: none is that slow.
    pub other_unit: f64,
    /// Logs pause where none has a row for so long, s, and for so many times what is usual.
    pub pause: f64,
    pub times: f64,
    /// A torque is missing where it has no row for so long, s, and for so many times what is usual, while others go on by so many rows.
    pub hole: f64,
    pub hole_times: f64,
    pub go_on: usize,
    /// A torque is logged by a clock, not where it changes, if so many of its rows come within half of the usual time between them.
    pub regular: f64,
}

/// Those in force.
pub const PLAUSIBLE: Plausible = Plausible {
    agrees: PART,
    differs: HALF,
    frames: SAMPLE,
    better: PART,
    clearly: 1.0 - PART,
    noise: DOUBTED,
    drives: HALF,
    near: 60.0,
    other_unit: FAR * FAR,
    pause: 1.0,
    times: FAR,
    hole: RESIDUAL.length,
    hole_times: FAR,
    go_on: FEW,
    regular: 1.0 - SMALL,
};
