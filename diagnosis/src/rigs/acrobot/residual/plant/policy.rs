//! Numbers by which logs of a plant are cut into windows and these are fitted, each with its reason.

use crate::rigs::acrobot::policy::POLICY;
use crate::statistics::levels::{CERTAIN, DOUBTED, FAR, FEW, HALF, PART, SAMPLE, SEVERAL, SMALL};

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Windows {
    /// Scored length of a window, s. Long enough for four start values to cost little, short against the plant's
    /// growth: e^(7 · 0.5) = 33 times the error of the start state. Half of it for an arm that tumbles, where rows are plenty.
    pub window: f64,
    /// Growth at the upright up to which windows are as long, 1/s: an arm of 30 cm has 10. Quicker ones have shorter windows.
    pub quick: f64,
    pub plenty: f64,
    /// Rows closer than this are averaged: a bin per window and signal; more would cost time and tell no more.
    pub bins: usize,
    /// Parts of a window that each get a torque the model may lack.
    pub parts: usize,
    /// So many rows tell a curvature from noise; the fewest that are used.
    pub curved: usize,
    pub fewest: usize,
    /// Where an arm tumbles, so many rows on either side, and no less than a step of a motion: at 50 rad/s a parabola through 0.06 s is
    /// off by 10 rad/s, and a fit that begins there ends anywhere.
    pub near_rows: f64,
    /// Most usual windows that are compared, 320 s of a balanced arm: the time goes with them, what they tell with their root.
    pub most: usize,
    /// A link that turns so many times as fast as in the logs, or as the upright grows (1/s), has run away.
    pub lost: f64,
    /// Where the residual is this many standard deviations, the plant is first held to the log by slack torques, so that
    /// everything is linearised about the motion that was measured and not about one that the lacking model invents.
    pub slack: f64,
    /// A mean square of the whitened residual that no noise gives.
    pub far: f64,
    /// The window before says more than this one where it has no more than this share of its squares.
    pub better: f64,
    /// Standard deviations by which noise alone gives more squares than in the usual window, beyond which a fit is doubted.
    pub doubt: f64,
    /// A valley is left for one that is deeper by this share.
    pub deeper: f64,
    /// Smallest scatter of timestamps that is tried, s; then twice as much, up to a step of a motion.
    pub smallest: f64,
    /// Share of the windows in which something else than timestamps may have happened: a saturation of the torque that cut two windows of sixty
    /// passed for timestamps that scatter, which then hid it.
    pub events: f64,
    /// Share of the time between rows by which timestamps that stand evenly scatter at most: rows that each hold the value before are late by
    /// 0.29 of it, root mean square. More is what a model lacks that is far from the log (a delay of 10 ms passed for 6 ms at rows
    /// every 5 ms).
    pub evenly: f64,
    /// Share of it that timestamps must scatter by still with effects on.
    pub still: f64,
    /// Length of a piece, s: friction changes its sign within one or two of them.
    pub piece: f64,
    /// Torque for derivatives, and root mean square to which one along a motion is scaled for its column, N·m at an arm of inertia scale 1: far
    /// above the integrator's 1e-9, far below where the plant bends.
    pub push: f64,
    /// Scatter of timestamps at which their columns are taken, at least, s.
    pub jitter: f64,
}

/// Those in force.
pub const WINDOWS: Windows = Windows {
    window: 0.5,
    quick: FAR,
    plenty: SAMPLE as f64,
    bins: SAMPLE,
    parts: 2,
    curved: POLICY.curved,
    fewest: FEW,
    near_rows: SEVERAL,
    most: POLICY.most,
    lost: 2.0 * FAR,
    slack: CERTAIN,
    far: SEVERAL,
    better: PART,
    doubt: DOUBTED,
    deeper: 1.0 - SMALL,
    smallest: 2e-5,
    events: SMALL,
    evenly: PART,
    still: HALF,
    piece: POLICY.motion_step,
    push: 2e-4,
    jitter: 1e-4,
};
