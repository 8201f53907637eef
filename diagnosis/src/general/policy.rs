//! Numbers that a diagnosis of any unit decides by, each with its reason.

use crate::statistics::levels::{CERTAIN, DOUBTED, FAR, FEW, HALF, MORE, PART, ROWS, SAMPLE};

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct General {
    /// Rows times parameters that a search takes at once: what two cores do in half a minute with a unit of some microseconds a step. What
    /// more rows would tell grows with their root only, and the values are fitted to all of them in the end.
    pub searched: usize,
    /// Rows of a stretch: each begins at a state of its own, which takes a thirtieth of them.
    pub stretch: usize,
    /// Of a single run the last share is left out.
    pub left_out: f64,
    /// Rows of a window at first; halved where a window can't be followed.
    pub window: usize,
    /// Windows shorter than this say nothing of a model.
    pub shortest_window: usize,
    /// A window is as good as followed when this many values for each start state are compared.
    pub compared: f64,
    /// Correlation times with which an unlisted input is begun, in rows; an input that stands for it may have the last, too.
    pub memories: [f64; 3],
    /// An unlisted input is begun at so many times the least process noise at least: from the floor itself no slope leads up.
    /// Numerical only.
    pub above_least: f64,
    /// An event is a stretch where the course is above this share of its largest value.
    pub event: f64,
    /// Highest number of waves in a turn that is tried of an angle.
    pub waves: usize,
    /// A declared input stands for the unlisted one where it gains at least this share of its deviance.
    pub stands_for: f64,
    /// Linearisations about the course of such an input. Numerical only.
    pub linearisations: usize,
    /// What a sensor shows beyond noise is so many times the scatter of neighbouring rows: in 335 channels of sets whose sensors are listed it was
    /// 1.2 at most, and as many times what neighbouring residuals differ by.
    pub larger: f64,
    /// Standard deviations by which neighbouring residuals resemble each other then.
    pub resembles: f64,
    /// Residuals are compared that are up to so many rows apart: of longer waves neighbours resemble each other.
    pub apart: usize,
    /// Highest probability that a name is given.
    pub sure: f64,
    /// Highest probability that a name is given in doubt: beside an unlisted input, where a gap stays, or where its interval holds the value at
    /// which it is off. Of the names that a blind tester's 69 sets of waves, noise, coarse steps and unlisted terms led to there, 3 of 20 were right.
    pub beside: f64,
    /// Steps of a row where an input is delayed or lags: a jump is off by half a step, a fortieth of a row.
    pub steps_a_row: f64,
    /// Rows that are so many times as far apart as those of other runs, or as the unit's own steps, may be in a shorter unit of time: nobody logs so
    /// seldom what moves so fast, while ten times as seldom is usual.
    pub rows_apart: f64,
    /// A step is divided by at most this number, for the delay to be a multiple of the step.
    pub finest: i64,
}

impl General {
    /// Rows times parameters that are fitted at all: with 22 of these 90 000 rows, which take 1.4 gigabytes of memory, and some 45 s of processor. Six
    /// times as many took 4.5 gigabytes, and came to no end within the usual budget.
    pub(super) const fn fitted(&self) -> usize {
        FAR as usize * self.searched
    }

    /// Steps of units in which a search in a few rows must come to its end, whatever the clock says: twice the most that nine sets needed.
    pub(super) const fn glanced_steps(&self) -> u64 {
        (MORE * FAR * FAR) as u64 * self.searched as u64
    }
}

/// Those in force.
pub(super) const GENERAL: General = General {
    searched: 200_000,
    stretch: SAMPLE * ROWS,
    left_out: PART,
    window: 200,
    shortest_window: ROWS,
    compared: DOUBTED,
    memories: [5.0, 60.0, 1000.0],
    above_least: 1e4,
    event: PART,
    waves: 24,
    stands_for: HALF,
    linearisations: 4,
    larger: MORE,
    resembles: CERTAIN,
    apart: ROWS,
    sure: 0.999,
    beside: PART,
    steps_a_row: 20.0,
    rows_apart: FAR * FAR,
    finest: FEW as i64,
};
