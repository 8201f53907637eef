//! Numbers that logs are doubted by, each with its reason.

use crate::dynamics::stretch::Glance;
use crate::statistics::levels::{FAR, HALF, MORE, ROUNDING, SEVERAL, SLIGHT, SMALL, STEP};

/// Rows of a stretch that is judged: a motor of a log at 100 Hz turns and settles within a second.
pub(crate) const STRETCH: usize = 100;

/// How much is enough.
pub(super) struct Doubts {
    /// Rows of one value, at least, that a sensor which stood still has.
    pub still_rows: usize,
    /// Elsewhere at most this share of neighbouring rows are the same: a log that is rounded coarsely, that repeats what a slower sensor
    /// said, or of a machine at rest, repeats its values anyway. Of noise as large as a quantum 28 % are the same.
    pub repeats: f64,
    /// Elsewhere third differences change their sign from row to row at least so often: noise does so in 77 of 100 rows
    /// (arccos(-15/20)/π), a smooth course without noise seldom, and that may well stand still.
    pub alternates: f64,
    /// Rows outside of the stretch that must be there to say so.
    pub other_rows: usize,
    /// At zero, or at the end of its range, a sensor may well stay: there it must have jumped to it by so many times its noise.
    pub jump: f64,
    /// The model moves what a log says to stay throughout a run: its standard deviation is more than this share of the largest value of either.
    pub moves: f64,
    /// A channel tells where motion or error are so many times its sensor's variance: five standard deviations.
    pub tells: f64,
    /// Rows that scatter by so many times the stated noise have another noise, and no crude number for the same.
    pub too_small: f64,
    /// Rows off the steps of a unit that can't vary them: beyond this share they are no slips of a clock.
    pub odd_rows: f64,
    /// Rows of one run that are so many times as close as those of others: 10 Hz and 200 Hz are two loggers, s and min two units.
    pub other_clock: f64,
    /// Rows are so many steps apart to this: to a share of a step that no output shows.
    pub apart: f64,
    /// An input that runs along lines bends from row to row by less than this share of what it moves: noise bends by more than it moves.
    pub smooth: f64,
    /// A stated noise counts up to so many times what the log scatters by.
    pub stated: f64,
    /// As they are read the model leaves at least this share of a telling channel's motion.
    pub wrong: f64,
    /// Read otherwise it leaves at most this share of every telling channel's motion.
    pub right: f64,
    /// Read otherwise the model leaves at most this share of what it leaves as they are read.
    pub less: f64,
    /// Another unit of time, factors beyond all gains, exchanged columns: the same two, where neither a gain nor what a machine lacks
    /// comes near.
    pub extreme: (f64, f64),
    /// A little beside the other way it leaves so many times as much: it is this sign or unit and no other gain. A shorter unit of time must
    /// do with this, without a look at the logs as they are read.
    pub exact: f64,
    /// And it leaves more by at least this number of variances of the sensors, summed over all values.
    pub clear: f64,
    /// Ways that leave at most so many times what the best one leaves can't be told from it.
    pub same: f64,
    /// Stretches, rows and rounds by which ways are chosen.
    pub short: Glance,
    /// Stretches, rows and rounds by which the chosen way is judged.
    pub long: Glance,
    /// Rows as near as this are none of a logger's, s.
    pub nearest: f64,
    /// Rows as far apart as this are none of a machine's: so many steps of the unit, or so long, s.
    pub farthest: (f64, f64),
    /// Pairs of columns that are tried: of more ports, names tell. And pairs of readings that are looked at closely, the likeliest first.
    pub pairs: usize,
}

/// Those in force.
pub(super) const DOUBTS: Doubts = Doubts {
    still_rows: 20,
    repeats: 0.35,
    alternates: 0.65,
    other_rows: 40,
    jump: 8.0,
    moves: SMALL,
    tells: 25.0,
    too_small: FAR,
    odd_rows: SLIGHT,
    other_clock: FAR * SEVERAL,
    apart: STEP,
    smooth: HALF,
    stated: MORE,
    wrong: SLIGHT,
    right: SMALL,
    less: SMALL,
    extreme: (HALF, SLIGHT),
    exact: 2.0,
    clear: FAR * FAR,
    same: MORE,
    short: Glance { stretches: 2, rows: 60, rounds: 3 },
    long: Glance { stretches: 8, rows: STRETCH, rounds: 5 },
    nearest: ROUNDING,
    farthest: (300.0, 3600.0),
    pairs: 28,
};
