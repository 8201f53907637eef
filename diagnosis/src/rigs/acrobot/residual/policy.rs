//! Numbers by which torques and poses are read off logs, each with its reason.

use crate::rigs::acrobot::dataset::policy::LOGS;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::trajectory::PREROLL;
use crate::statistics::levels::{DOUBTED, FAR, FINE, HALF, SAMPLE, SEVERAL, SMALL};

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Three standard deviations of an angle read off an image, rad.
    pub near: f64,
    /// Tolerance of such an angle by its place on the pixel lattice, rad: a thirtieth of a pixel over the length of a link.
    pub place: f64,
    /// Length of a stretch, s: no longer than a torque may be missing unseen. The next one begins half of it later.
    pub length: f64,
    /// Most time between states at which the unit is asked, s.
    pub grid: f64,
    /// Rows about a time that tell the state there.
    pub around_rows: usize,
    /// Times a stretch's usual length that these rows may take: at 20 rows a second they do once.
    pub seen: f64,
    /// Share of a stretch's length by which rows may be apart at least, whatever is usual, for it to be whole.
    pub torn_share: f64,
    /// Standard deviation of an angle where none is stated, rad.
    pub first_guess: f64,
    /// Times the typical size of a torque, from which it counts less (Huber).
    pub outlying: f64,
    /// Length of a block, s: stretches that overlap belong to one.
    pub block: f64,
    /// Fewest blocks: logs of fewer are cut into shorter ones, down to a stretch each. A statistic over n blocks is at most √n, and none
    /// below 4.5 counts.
    pub blocks: f64,
    /// Longest step between readings, s; a torque that is logged more often than this is averaged.
    pub step: f64,
    /// Fewest rows of a stretch.
    pub fewest: usize,
    /// Images of a frame that are averaged where the sensor is noisy.
    pub averaged: i32,
    /// Tolerance of the plant's integrator, per second: after a second of a wild arm 1e-9 rad are wrong, far below any encoder. A
    /// tenth of it takes 1.2 times as long, and the unit's own, a hundredth, 1.8 times.
    pub integrator: f64,
    /// Time before a window within which a slow actuator's commands count, s: a lag of a tenth of a second keeps 5e-5 of what was before.
    pub remembered: f64,
    /// Share of a frame's interval that the tiny step takes in which the arm is put where the interval begins.
    pub jump: f64,
}

/// Those in force.
pub const RESIDUAL: Residual = Residual {
    near: DOUBTED * POLICY.guess,
    place: POLICY.read,
    length: LOGS.hole,
    grid: POLICY.motion_step,
    around_rows: POLICY.curved,
    seen: 1.0 + SMALL,
    torn_share: SMALL,
    first_guess: POLICY.guess,
    outlying: SEVERAL,
    block: 1.0,
    blocks: SAMPLE as f64,
    step: HALF * POLICY.motion_step,
    fewest: POLICY.curved,
    averaged: 4,
    integrator: 1e-7,
    remembered: FAR * PREROLL,
    jump: FINE,
};
