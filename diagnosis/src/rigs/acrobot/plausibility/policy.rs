//! Numbers by which logs are doubted before any fit, each with its reason.

use crate::rigs::acrobot::dataset::policy::LOGS;
use crate::statistics::levels::{DOUBTED, FAR, HALF, PART, SAMPLE, SMALL};

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plausible {
    /// Share of a motion that may be left where images and encoders agree.
    pub agrees: f64,
    /// Share of a motion that is left from which on they surely don't agree.
    pub differs: f64,
    /// Fewest frames that are compared.
    pub frames: usize,
    /// Share of itself to which another way of counting must bring the torque that the model lacks, to be beyond doubt.
    pub better: f64,
    /// Share of what the second best way leaves, up to which the best one may leave.
    pub clearly: f64,
    /// Times what noise gives, from which a lacking torque is worth asking about other ways of counting.
    pub noise: f64,
    /// The share of gravity's torque beyond which a torque may be in thousandths.
    pub drives: f64,
    /// Distance from where circle 1 should roll within which it does, px: lenses and mounts move it by less, and any other origin by more.
    pub near: f64,
    /// Share by which links in images may be longer or shorter than the nominal camera shows them: lenses and scales change them by less, and
    /// another circle's distance is another by more.
    pub length: f64,
    /// Times as far apart as the nominal camera takes them, from which frames are stamped in another unit: none is that slow.
    pub other_unit: f64,
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
    near: LOGS.off_line,
    length: SMALL,
    other_unit: FAR * FAR,
};
