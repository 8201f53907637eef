//! Numbers that several rooms share, each with its reason. What one file alone decides by stands in that file.

use crate::rigs::acrobot::channels::{Measures, guess_of};
use crate::statistics::levels::{CERTAIN, DOUBTED, FAR, FEW, HALF, MORE, ROWS, SLIGHT, SMALL};

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Policy {
    /// Standard errors from which what images show is named, a noise, too, and a clock drifts.
    pub clear: f64,
    /// Decrease of the deviance that the log's own faults and a torque that lacks must bring: as much as one value that is certain, and
    /// chance, on one side, once in 300 000.
    pub evidence: f64,
    /// Decrease of the deviance that values of their own in each run must bring: half as much again, since any of some
    /// thirty candidates may have them.
    pub runs_apart: f64,
    /// By how much a clock must explain more than an effect that its sensitivity resembles (deviance): forwards it has the sensitivity of a
    /// delay.
    pub clock_behind: f64,
    /// Times the median's squares from which a fit, a block or a torque is of no noise: a circle that was mistaken, a loss of balance, a window
    /// that nothing holds to the log.
    pub wild: f64,
    /// Rows from which a log tells anything.
    pub rows: usize,
    /// Times the usual step of a log, from which a row is missing in between; a torque is held for as long after its last row.
    pub steps: f64,
    /// Rows this far to either side of a time tell the state there, s: an arm of the paper's size moves along a cubic for that long.
    pub around: f64,
    /// Largest angle whose sine it is, rad.
    pub small_angle: f64,
    /// Standard deviation of a pose read off an image and smoothed by the plant, of good encoders, too, rad.
    pub read: f64,
    /// Standard deviation of an angle of which nothing is stated, and of a motion that needed slack torques, rad.
    pub guess: f64,
    /// Fewest rows that tell a curvature from noise.
    pub curved: usize,
    /// Most windows or frames that are compared, 320 s of a balanced arm: the time goes with them, what they tell with their root.
    pub most: usize,
    /// Most time between states at which the unit is asked, and step of a motion that is handed on, s: the cubic between is good to 1e-8 rad.
    pub motion_step: f64,
    /// How well a fitted motion is known beside its noise, as a share of the encoder's standard deviation.
    pub motion_share: f64,
    /// Times that differ by less are one, s: recorded times are rounded doubles of exact points.
    pub same_time: f64,
    /// Time between rows times the unstable pole, beyond which an arm loses its balance in between: 30 Hz gives 0.2, milliseconds taken for
    /// seconds 6 and more at 1 kHz.
    pub coarse: f64,
    /// Motion below this tells neither units nor signs, rad.
    pub least_motion: f64,
    /// Share of the disagreement below which a signal isn't listed.
    pub listed: f64,
    /// Neighbouring frames of one fit, which has seven values.
    pub floor_frames: usize,
    /// Fewest fits that tell a scatter.
    pub floor_fits: usize,
    /// Times its floor, from which a gap is worth closing.
    pub gap_above: f64,
    /// Share of the torques' gap by which effects must widen it on runs left out to be withdrawn.
    pub gap_widened: f64,
    /// Standard errors by which they must widen it.
    pub gap_clearly: f64,
    /// Loss of who was no member, three standard deviations, squared. A truth is left out of its class at most once in 140 (see `CLASS`):
    /// 2 ln 140 = 9.9, of which it is the round number below.
    pub excluded: f64,
    /// Rows at the beginning of a log from which its rates are read, s: an arm hardly moves away meanwhile.
    pub replay_first: f64,
    /// Fewest rows from which these rates are read.
    pub replay_rows: usize,
}

/// Those in force.
pub const POLICY: Policy = Policy {
    clear: CERTAIN,
    evidence: CERTAIN * CERTAIN,
    runs_apart: MORE * CERTAIN * CERTAIN,
    clock_behind: DOUBTED * DOUBTED,
    wild: FAR,
    rows: ROWS,
    steps: MORE,
    around: 0.03,
    small_angle: 0.1,
    read: 2e-4,
    guess: guess_of(Measures::Angle),
    curved: 7,
    most: 640,
    motion_step: 0.008,
    motion_share: HALF,
    same_time: 5e-7,
    coarse: MORE,
    least_motion: 0.02,
    listed: SLIGHT,
    floor_frames: ROWS,
    floor_fits: FEW,
    gap_above: 1.0 + SMALL,
    gap_widened: SMALL,
    gap_clearly: 2.0,
    excluded: DOUBTED * DOUBTED,
    replay_first: 0.1,
    replay_rows: FEW,
};
