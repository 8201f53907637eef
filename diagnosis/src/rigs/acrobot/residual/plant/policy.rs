//! Numbers by which logs of a plant are cut into windows and these are fitted, each with its reason.

use crate::rigs::acrobot::dataset::policy::LOGS;
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
    /// Rows in half a window, from which these are plenty: windows of an arm that tumbles are half as long then.
    pub plenty: f64,
    /// Most bins of a window and signal, each the mean of its rows: more would cost time and tell no more.
    pub bins: usize,
    /// Parts of a window that each get a torque the model may lack.
    pub parts: usize,
    /// Rows that tell a curvature from noise.
    pub curved: usize,
    /// Fewest rows of a window.
    pub fewest: usize,
    /// Rows on either side of a time that tell the state of an arm that tumbles, over no less than a step of a motion: at 50 rad/s a
    /// parabola through 0.06 s is off by 10 rad/s, and a fit that begins there ends anywhere.
    pub near_rows: f64,
    /// Most usual windows that are compared, 320 s of a balanced arm: the time goes with them, what they tell with their root.
    pub most: usize,
    /// Times the fastest rate in the logs, or that of the upright's growth (1/s), from which a link has run away.
    pub lost: f64,
    /// Standard deviations of the residual from which the plant is first held to the log by slack torques, so that everything is linearised
    /// about the motion that was measured and not about one that the lacking model invents.
    pub slack: f64,
    /// Mean square of the whitened residual from which a window is lost: no noise gives it.
    pub far: f64,
    /// Share of a window's squares up to which the window before has to have squares to know its start better.
    pub better: f64,
    /// Standard deviations by which noise alone gives more squares than in the usual window, beyond which a fit is doubted.
    pub doubt: f64,
    /// Share of the squares of what was found that a fit from another start may have at most, to be taken instead.
    pub deeper: f64,
    /// Smallest scatter of timestamps that is tried, s: a plant's log tells its clock no better; then twice as much, up to a step of a motion.
    pub smallest: f64,
    /// Share of the windows in which something else than timestamps may have happened: a saturation of the torque that cut two windows of sixty
    /// passed for timestamps that scatter, which then hid it.
    pub events: f64,
    /// Share of the time between rows by which timestamps that stand evenly scatter at most: rows that each hold the value before are late by
    /// 0.29 of it, root mean square. More is what a model lacks that is far from the log (a delay of 10 ms passed for 6 ms at rows
    /// every 5 ms).
    pub evenly: f64,
    /// Share of their scatter that timestamps must keep with effects on.
    pub still: f64,
    /// Length of a piece, s: friction changes its sign within one or two of them.
    pub piece: f64,
    /// Torque for derivatives, and root mean square to which one along a motion is scaled for its column, N·m at an arm of inertia scale 1: far
    /// above the integrator's 1e-9, far below where the plant bends.
    pub push: f64,
    /// Scatter of timestamps at which their columns are taken, at least, s.
    pub jitter: f64,
    /// Simulations of a window that are remembered, a kilobyte each: some linearisations with a column for each candidate, and the fits between.
    pub remembered: usize,
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
    smallest: LOGS.known,
    events: SMALL,
    evenly: PART,
    still: HALF,
    piece: POLICY.motion_step,
    push: 2e-4,
    jitter: 1e-4,
    remembered: FAR as usize * SAMPLE,
};
