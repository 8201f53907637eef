//! Numbers of the effects at ports, each with its reason.

use crate::statistics::levels::SMALL;

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ports {
    /// A delay or lag is looked for up to this share of the shortest run.
    pub latest: f64,
    /// A gain of less than a twentieth or more than twenty is a broken wire or a wrong unit.
    pub gain: (f64, f64),
    /// A decay is cut into so many pieces, until as many time constants are over: then 1e-7 of it is left. States that integrate it
    /// twice are off by the height times 27 / 12 / 16² T², 0.9 % of T².
    pub cuts: u32,
    /// Times that differ by less than this share are the same: a delay of whole rows, rounded. Numerical only.
    pub same_time: f64,
}

/// Those in force.
pub(crate) const PORTS: Ports = Ports { latest: SMALL, gain: (0.05, 20.0), cuts: 16, same_time: 1e-12 };
