//! Numbers that the reading of logs decides by, each with its reason.

use crate::rigs::acrobot::plausibility::policy::PLAUSIBLE;
use crate::rigs::acrobot::plausibility::time::EPOCH;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::plant::policy::WINDOWS;
use crate::statistics::levels::{FAR, FEW, FINE, HALF, MORE, PART, ROWS, SAMPLE, SEVERAL, SLIGHT, SMALL};

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Logs {
    /// One in so many rows without a torque is one that is missing.
    pub few_bare: usize,
    /// Share of its period by which a clock's rows scatter at most where a gap among them tells of a row that is missing, and by which
    /// such a gap is off a whole number of periods: more is a loop that took longer.
    pub even: f64,
    pub whole: f64,
    /// Images are missing beside a torque where they pause for this share of the time.
    pub most: f64,
    /// Links that touch may give way by this, or be logged a little off, rad.
    pub touching: f64,
    /// Links this near to their mechanical limit may touch it, rad, by encoders and in images, which a lens bends.
    pub near: f64,
    pub seen: f64,
    /// Six turns: what moves less is not tested for degrees, and 38 degrees is little motion.
    pub largest_angle: f64,
    /// A torque is held from its row to the next: one row is a log of it.
    pub fewest_torques: usize,
    /// Three hundred years: beyond it, doubles are microseconds apart, and such a time is in other units anyhow, s.
    pub latest: f64,
    /// A torque so many times that of gravity is none, and no rate so many times that of a fall.
    pub absurd: f64,
    /// A circle so many images away from the origin is none, wherever that lies.
    pub outside: f64,
    /// An angle that jumps by less than this and back was moved, whatever the time, rad: encoders scatter by far less.
    pub glitch: f64,
    /// Rows further apart than so many usual distances are no neighbours.
    pub neighbour: f64,
    /// A rate is a difference of angles if it is one in more than this share of its rows.
    pub nearly_all: f64,
    /// Root mean square, as a share of a decimal, by which times are off their ticks at least where they were rounded to it: 0.29 of any
    /// interval, 0.25 of one that is a half off.
    pub spread: f64,
    /// Share of its size by which a rate differs from a difference of angles where both were rounded for the log.
    pub rounded: f64,
    /// Share of a rate's square that the angle's differences explain where one is the other in another unit.
    pub in_proportion: f64,
    /// Logarithm of the least factor that is another unit: differences over a tenth of a swing are 7 % too small.
    pub other_scale: f64,
    /// A column that holds impossible values in more than this share of its rows is in other units.
    pub few_impossible: f64,
    /// An arm that is below the horizontal in this share of the rows is not being balanced.
    pub below: f64,
    /// Fewest rows that show a clock.
    pub even_rows: usize,
    /// How well ticks must be known, s: a plant's log tells its clock to some 20 µs, and a line through few timestamps would be off by more.
    pub known: f64,
    /// Correlation of the scatter from row to row beyond which the clock itself wanders, or rows were lost.
    pub wanders: f64,
    /// A mount that is turned by more than this moves what lies at the edge of an image by more than a check of heights allows, rad.
    pub turned: f64,
    /// So many images of a run tell where circle 1 rolls.
    pub first: usize,
    /// A circle this near to that height is on the line, and circle 1 this far from it is not, px: lenses bend that line by less,
    /// and a mount that is turned by 40 degrees inclines it by 16 px for each radian that the arm rolls.
    pub on_line: f64,
    pub off_line: f64,
    /// Step of the search, s; a tenth of it in the end.
    pub step: f64,
    /// Logs that are longer together than this (s), maybe for one absurd stamp, are not searched.
    pub longest: f64,
    /// Rows that are compared in the search.
    pub stamps_rows: usize,
    /// Share of the motion that may be left where two logs agree: lenses bend, encoders slip.
    pub agrees: f64,
    /// So many times more must be left at any other time, or a motion that repeats itself would fit anywhere.
    pub clearly: f64,
    /// So often a clock may have been set in a run.
    pub few: usize,
    /// Scatter about the ticks that is worth a test, as a share of the interval, and beyond which there are no ticks.
    pub tick_scatter: (f64, f64),
    /// Rows of a plant log further apart than this (s) don't tell the motion in between: a machine whose unstable pole is at 7 1/s goes where no
    /// cubic does.
    pub torn: f64,
    /// Images that are late by this much against the encoders are late, and not stamped by another clock, s.
    pub late: (f64, f64),
}

/// Those in force.
pub const LOGS: Logs = Logs {
    few_bare: SAMPLE,
    even: SMALL,
    whole: PART,
    most: HALF,
    touching: POLICY.small_angle,
    near: POLICY.least_motion,
    seen: POLICY.small_angle,
    largest_angle: 6.0 * std::f64::consts::TAU,
    fewest_torques: 1,
    latest: EPOCH.end,
    absurd: FAR * FAR * FAR,
    outside: MORE,
    few_impossible: SMALL,
    glitch: PART,
    neighbour: MORE,
    nearly_all: 1.0 - SMALL,
    spread: SMALL,
    rounded: FINE,
    in_proportion: 1.0 - SMALL,
    other_scale: PART,
    below: PART,
    even_rows: SAMPLE,
    known: WINDOWS.smallest,
    wanders: PART,
    turned: POLICY.small_angle,
    first: ROWS,
    on_line: SMALL * PLAUSIBLE.near,
    off_line: PLAUSIBLE.near,
    step: 0.02,
    longest: 7200.0,
    stamps_rows: POLICY.most,
    agrees: PART,
    clearly: SEVERAL,
    few: FEW,
    tick_scatter: (SLIGHT, PART),
    torn: FAR * POLICY.motion_step,
    late: (-0.05, 1.0),
};
