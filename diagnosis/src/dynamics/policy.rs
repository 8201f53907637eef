//! Numbers that units are followed by, each with its reason.

use crate::statistics::levels::{FAR, FEW, FINE, HALF, PART, ROUNDING, ROWS, SAMPLE, SEVERAL, SMALL, STEP};

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dynamics {
    /// Rows that are tried for what a unit shows at once, and for a parameter's step.
    pub tried_rows: usize,
    /// An output follows where it moves by more than this share of its noise for the input's whole size.
    pub follows: f64,
    /// A parameter's first step, as a share of its nominal value or of its range. Numerical only: it is taken anew by what it tells.
    pub first_step: f64,
    /// What a step should change in a row, as a share of a channel's noise: far above rounding, far below where models bend.
    /// Numerical only.
    pub telling_step: f64,
    /// Share of a scale by which a state is moved: rounding of a unit that answers to 1e-12 stays below 1e-7 of a column, bending
    /// over so small a move, too. Numerical only.
    pub state_step: f64,
    /// The prior of a start state is so many times wider than its motion, and process noise makes as much of it within a row at most.
    pub widest: f64,
    /// Least process noise, as a share of the motion over one run: below it the sweep can't tell it from none.
    pub least_process: f64,
    /// Process noise is begun at these shares of the motion; maximum likelihood goes on from the best. Numerical only.
    pub first_process: [f64; 6],
    /// A stated noise of 0 or a channel without scatter has at least this share of its size: no variance is 0. Numerical only.
    pub exact_sensor: f64,
    /// Timestamps scatter by at most this share of the usual interval.
    pub most_jitter: f64,
    /// Two lengths of a step, as shares of it: a unit that makes less than ten steps of its own within one ends both at the same.
    pub lengths: (f64, f64),
    /// Where an input moves, a unit makes at least so many steps in an interval: held at its mean over one, a ramp reaches a unit that is faster
    /// than a row up to half a row late. A motor whose current settles within 4 ms had a lag of 14.5 ms found as 14.24 ± 0.02 in rows of
    /// 10 ms, and a sensor's lag beside it; with ten steps 14.5.
    pub moving_parts: f64,
    /// An interval is cut into at most so many steps of a unit.
    pub most_parts: f64,
    /// A value that counted as an outlier comes back where the model leaves less than this share of its distance from its neighbours.
    pub explained: f64,
    /// A held input jumps where it changes by more than so many times its usual change.
    pub jump: f64,
    /// Times closer than this share of the usual distance are one row: timestamps of two columns written by hand.
    pub same_row: f64,
    /// Rows of an input that are so many times as far apart as usual lack some between them, if a held input is another after it; twice
    /// as far in any case.
    pub missing: f64,
    /// Where more than this share of an input's rows would lack some, it is logged irregularly by intent and none is.
    pub seldom: f64,
    /// A stretch in which an input is unknown is so many pieces at most, in each of which it may have been another: more than most units
    /// have states that remember it.
    pub lost_pieces: usize,
    /// Reads of a lagged channel within an interval, which runs along lines between them: with three a current that settles within two rows, behind a lag as
    /// short, had a gain of 1.001 as well.
    pub lag_reads: usize,
    /// Two ends of a row that differ by this share of the state's size lie apart: solvers that begin anew differ by far less.
    pub apart: f64,
    /// Where ends of rows are off to one side, all of them together lie apart by this share of the state's size: a state that isn't
    /// listed does most of the motion, a solver that begins anew a thousandth of it.
    pub drifts: f64,
    /// Rows over which a unit is watched after a fresh start, and over which states and inputs of which no log tells are expected to show.
    pub watched: usize,
    /// Longest horizon over which a state is read through the outputs that follow, rows.
    pub farthest: usize,
    /// Such a horizon is long enough when a small move of all states is read back to this share.
    pub read_back: f64,
    /// Damping of a step that made it worse, and what it grows by. Numerical only.
    pub damping: (f64, f64),
}

/// Those in force.
pub(super) const DYNAMICS: Dynamics = Dynamics {
    tried_rows: ROWS,
    follows: SMALL,
    first_step: FINE,
    telling_step: STEP,
    state_step: 1e-4,
    widest: FAR,
    least_process: ROUNDING,
    first_process: [1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5],
    exact_sensor: 1e-7,
    most_jitter: PART,
    lengths: (1.0 - SMALL, 1.0 - STEP),
    moving_parts: FAR,
    most_parts: 1.0 / FINE,
    explained: HALF,
    jump: SEVERAL,
    same_row: FINE,
    missing: 1.8,
    seldom: SMALL,
    lost_pieces: FEW,
    lag_reads: FAR as usize,
    apart: STEP,
    drifts: HALF,
    watched: SAMPLE,
    farthest: SAMPLE,
    read_back: FINE,
    damping: (0.1, 10.0),
};
