//! Numbers of the linked states, each with its reason.

/// When they are asked, and of how much.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Policy {
    /// Deviance that process noise may gain beside the best member: as much as one effect more, 4.5 standard deviations squared. Beyond
    /// it the model lacks something, and the wrong member may be what stands in for it.
    pub quiet: f64,
    /// Loss by windows up to which linked states are asked, four times what ends a class: at that, theta_2 was called theta_1 alone,
    /// and T_act tau_delay.
    pub near: f64,
    /// Rows of all runs together, beyond which each run gives its first part: half a minute at 200 Hz, the longest that tests log.
    pub most: usize,
    /// Fewer rows in one piece tell of no motion.
    pub fewest: usize,
    /// Rows this many times as far apart as usual are not linked: at the upright what noise leaves grows by e^7 in a second.
    pub torn: f64,
}

/// These.
pub const LINKED: Policy = Policy { quiet: 20.25, near: 24.0, most: 6000, fewest: 12, torn: 5.0 };
