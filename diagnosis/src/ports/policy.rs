//! Numbers of the effects at ports, each with its reason.

use crate::statistics::levels::SMALL;

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ports {
    /// A delay or lag is looked for up to this share of the shortest run.
    pub latest: f64,
    /// A gain of less than a twentieth or more than twenty is a broken wire or a wrong unit.
    pub gain: (f64, f64),
    /// An exponential is cut into so many lines over one time constant: off its mean by (1/8)²/12 of its height, 0.1 %.
    pub cuts: f64,
    /// Times that differ by less than this share are the same: a delay of whole rows, rounded. Numerical only.
    pub same_time: f64,
}

/// Those in force.
pub(crate) const PORTS: Ports = Ports { latest: SMALL, gain: (0.05, 20.0), cuts: 8.0, same_time: 1e-12 };
