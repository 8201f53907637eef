//! Numbers that logs and a unit are made a data set by, each with its reason.

use crate::options::GIVEN_UP;
use crate::statistics::levels::{CERTAIN, FAR, FINE, HALF, ROUNDING, SEVERAL, SLIGHT, SMALL, STEP};
use std::time::Duration;

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Import {
    /// Rows further apart than this many usual distances have a gap between them.
    pub gap: f64,
    /// Least likeness of the names of a column and of its variable.
    pub alike: f64,
    /// What a fitting unit of measurement adds to the likeness.
    pub fitting_unit: f64,
    /// What the same initial adds to the likeness of names with the same number.
    pub same_initial: f64,
    /// A start value is moved by this share of its size. Numerical only: far above `start_shown`.
    pub start_move: f64,
    /// A variable shows a start where it shows that move to this share of it.
    pub start_shown: f64,
    /// Begun anew in its states a model goes on as it did, but for this share of its motion.
    pub goes_on: f64,
    /// And but for this one through half of a run each, where no name tells of a start: a constant that stands in for a state does it less well.
    pub goes_on_long: f64,
    /// A start is no constant where the model then misses so many times as much with it as a constant.
    pub is_state: f64,
    /// Correlation below which model and log say nothing of each other.
    pub tells: f64,
    /// Correlation from which a slope tells a unit of measurement, and how near the slope must be to its factor: a model that
    /// lacks something may well be off by a fifth, units of measurement differ by more.
    pub unit: (f64, f64),
    /// How near a slope must be to a unit's factor for that unit to be said to be the log's: a few times what is slight. A foot and a yard a
    /// second are further apart from a kilometre an hour, and what the model lacks moves a slope as far as that, too.
    pub unit_is: f64,
    /// What each turned sign must gain in mean squared correlation: of two ways that explain the same, the one with fewer turns.
    pub turn: f64,
    /// Inputs whose signs are tried; beyond that all are taken as they are.
    pub turned_inputs: usize,
    /// Most rows of a log on which the model is tried.
    pub rows: usize,
    /// An offset is proposed from so many deviations of the measured course: a smaller one may be what the model lacks.
    pub offset: f64,
    /// A start shifts a course where, on the mean of a trial, this share is left of what it moves at its begin: what dies away sooner is no offset.
    pub lasting: f64,
    /// What a number that may change nothing is multiplied by; one that is 0 is set to these and to their opposites.
    pub idle_moves: [f64; 4],
    /// Real time that such a run may take in any case: to start a process takes some of it.
    pub idle_least: Duration,
    /// Rows so many of the unit's own steps apart may be in a shorter unit of time: whole numbers then, if no unit is said, are ms.
    pub rows_apart: f64,
    /// And from so many steps on they are not even that.
    pub rows_too_far: f64,
    /// Real time, s, that each look at the unit may take (its first run, the stretches of the logs, its signs): then a diagnosis, which takes hundreds
    /// of such, has no chance, and the guesses that are left have to do.
    pub patience: f64,
    /// The same where rows are so many steps apart: in the right unit a look takes a second.
    pub short_patience: f64,
    /// Rows with fewer cells than there are names are cut where they are at most this share; where more are, a logger leaves empty cells out.
    pub cut_rows: f64,
    /// Numbers up to here are told with three decimals.
    pub written: f64,
}

/// Those in force.
pub(super) const IMPORT: Import = Import {
    gap: SEVERAL,
    alike: HALF,
    fitting_unit: 0.2,
    same_initial: SMALL,
    start_move: STEP,
    start_shown: ROUNDING,
    goes_on: STEP,
    goes_on_long: FINE,
    is_state: FAR,
    tells: 0.6,
    unit: (0.9, 0.3),
    unit_is: SEVERAL * SLIGHT,
    turn: STEP,
    turned_inputs: 4,
    rows: 3000,
    offset: CERTAIN,
    lasting: SMALL,
    idle_moves: [SMALL, HALF, 2.0, FAR],
    idle_least: Duration::from_secs(1),
    rows_apart: FAR * FAR,
    rows_too_far: FAR * FAR * FAR * FAR * FAR,
    patience: SEVERAL * GIVEN_UP,
    short_patience: HALF * GIVEN_UP,
    cut_rows: SMALL,
    written: 1.0 / ROUNDING,
};
