//! Numbers that several rooms share, each with its reason. What one file alone decides by stands in that file.

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Policy {
    /// Standard errors from which what images show is named, a noise, too, and a clock drifts: at 3x the minimum detectable effect no
    /// right effect had less than 6.9 on five seeds, and a vignetting that wasn't there had 3.1.
    pub clear: f64,
    /// Fall of the deviance that the log's own faults and a torque that lacks must bring: a chi-squared mixture of one degree gives it
    /// once in 10⁵.
    pub evidence: f64,
    /// Fall of the deviance that values of their own in each run must bring: by chance, of two or three runs and some thirty
    /// candidates, once in 10⁵.
    pub runs_apart: f64,
    /// By how much a clock must explain more than an effect that its sensitivity resembles (deviance): forwards it looks just like a
    /// delay.
    pub clock_behind: f64,
    /// Times the median's squares from which a fit, a block or a torque is of no noise: a circle that was mistaken, a fall, a window
    /// that nothing holds to the log.
    pub wild: f64,
    /// Rows from which a log tells anything: more than four start values and what is asked of them.
    pub rows: usize,
    /// Steps of a log, as many times the usual one, from which a row is missing in between; and for which a torque is held after its last.
    pub steps: f64,
    /// Rows this far to either side of a time tell the state there, s: an arm of the paper's size moves along a cubic for that long.
    pub around: f64,
    /// Step of a motion that is handed on, s: the cubic between is good to 1e-8 rad.
    pub motion_step: f64,
    /// How well a fitted motion is known beside its noise, as a share of the encoder's standard deviation.
    pub motion_share: f64,
    /// Times that differ by less are one, s: recorded times are rounded doubles of exact points.
    pub same_time: f64,
    /// Time between rows over the time of falling, beyond which an arm falls in between: 30 Hz gives 0.2, milliseconds taken for
    /// seconds 6 and more at 1 kHz.
    pub fallen: f64,
    /// Motion below this tells neither units nor signs, rad.
    pub least_motion: f64,
    /// Share of the disagreement below which a signal isn't listed.
    pub listed: f64,
    /// Neighbouring frames of a fit, which has seven numbers.
    pub floor_frames: usize,
    /// Fits that tell a scatter.
    pub floor_fits: usize,
    /// A gap must stand this far above the floor to be worth closing.
    pub gap_above: f64,
    /// A share of the torques' gap, and standard errors, by which effects must widen it on runs left out to be withdrawn.
    pub gap_widened: f64,
    pub gap_clearly: f64,
    /// Loss of who was no member: a truth is left out of its class at most once in 140 (see `CLASS`), 2 ln 140.
    pub excluded: f64,
    /// Rows at the beginning of a log from which its rates are read, s: an arm hardly falls meanwhile.
    pub replay_first: f64,
    /// And at least so many.
    pub replay_rows: usize,
}

/// Those in force.
pub const POLICY: Policy = Policy {
    clear: 4.5,
    evidence: 20.0,
    runs_apart: 30.0,
    clock_behind: 10.0,
    wild: 10.0,
    rows: 12,
    steps: 1.5,
    around: 0.03,
    motion_step: 1.0 / 120.0,
    motion_share: 0.5,
    same_time: 5e-7,
    fallen: 1.5,
    least_motion: 0.02,
    listed: 0.02,
    floor_frames: 12,
    floor_fits: 3,
    gap_above: 1.05,
    gap_widened: 0.1,
    gap_clearly: 2.0,
    excluded: 10.0,
    replay_first: 0.1,
    replay_rows: 4,
};
