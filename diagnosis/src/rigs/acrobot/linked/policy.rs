//! Numbers of the linked states, each with its reason.

use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::selection::HOPELESS;
use crate::statistics::levels::{CERTAIN, FAR, FEW, FINE, ROWS, SEVERAL};

/// When they are asked, and of how much.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Policy {
    /// Deviance that process noise may gain beside the best member: as much as one effect more. Beyond
    /// it the model lacks something, and the wrong member may be what stands in for it.
    pub quiet: f64,
    /// Loss by windows up to which linked states are asked, four times what ends a class: at that, theta_2 was called theta_1 alone,
    /// and T_act tau_delay.
    pub near: f64,
    /// Rows of all runs together, beyond which each run gives its first part: half a minute at 200 Hz.
    pub most: usize,
    /// Fewest rows of a piece that tell of a motion.
    pub fewest: usize,
    /// Most waves a turn that a law is tried with: an encoder's lines.
    pub waves: f64,
    /// Fewest of them along all that an angle went through.
    pub seen: f64,
    /// Waves a second from which what an angle reads may hum: three times as fast as an arm moves.
    pub hum: f64,
    /// Robust standard deviations from which a reading lies far off: of a billion with normal noise two do.
    pub lone: f64,
    /// Times as much as a row's own time puts a reading off that is further from the middle of its neighbours' than it should be.
    pub uneven: f64,
    /// One in so many rows is among the fastest, which timestamps that scatter put off most.
    pub fastest: usize,
    /// Times the usual distance of rows, from which two rows are not linked: at the upright what noise leaves grows by e^7 in a second.
    pub torn: f64,
}

/// These.
pub const LINKED: Policy = Policy {
    quiet: CERTAIN * CERTAIN,
    near: 2.0 * HOPELESS,
    most: FAR as usize * POLICY.most,
    fewest: ROWS,
    waves: 1.0 / FINE,
    seen: 2.0,
    hum: SEVERAL,
    lone: 2.0 * SEVERAL,
    uneven: SEVERAL,
    fastest: FEW,
    torn: SEVERAL,
};
