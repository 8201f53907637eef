//! Numbers that the reading of logs decides by, each with its reason.

use crate::observe::SINCE_1970;
use crate::rigs::acrobot::policy::POLICY;
use crate::statistics::levels::{FAR, FEW, FINE, HALF, MORE, PART, ROWS, SAMPLE, SEVERAL, SMALL};

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Logs {
    /// Rows of which one without a torque is one that is missing.
    pub few_bare: usize,
    /// Share of its period by which a clock's rows scatter at most, where a gap among them tells of a row that is missing.
    pub even: f64,
    /// Share of the period by which such a gap is off a whole number of periods at most: more is a loop that took longer.
    pub whole: f64,
    /// Share of such a gap for which images pause, from which they are missing as well.
    pub most: f64,
    /// Links that touch may give way by this, or be logged a little off, rad.
    pub touching: f64,
    /// Distance from their mechanical limit within which links may touch it by encoders, rad.
    pub near: f64,
    /// That distance in images, which a lens bends, rad.
    pub seen: f64,
    /// Six turns: what moves less is not tested for degrees, and 38 degrees is little motion.
    pub largest_angle: f64,
    /// A torque is held from its row to the next: one row is a log of it.
    pub fewest_torques: usize,
    /// Three hundred years: beyond it, doubles are microseconds apart, and such a time is in other units anyhow, s.
    pub latest: f64,
    /// Times the torque of gravity from which a torque is none, and times the rate of a fall from which a rate is none.
    pub absurd: f64,
    /// Image sizes from the origin, beyond which a circle is none, wherever the origin lies.
    pub outside: f64,
    /// An angle that jumps by less than this and back was moved, whatever the time, rad: encoders scatter by far less.
    pub glitch: f64,
    /// Usual distances of rows, beyond which two rows are no neighbours.
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
    /// How well ticks must be known, and by how much timestamps must scatter about them to be worth a test, s: a plant's log tells its clock to some 20 µs, and a line through few timestamps would be off by more.
    pub known: f64,
    /// Correlation of the scatter from row to row beyond which the clock itself wanders, or rows were lost.
    pub wanders: f64,
    /// A mount that is turned by more than this moves what lies at the edge of an image by more than a check of heights allows, rad.
    pub turned: f64,
    /// Images of a run that tell where circle 1 rolls.
    pub first: usize,
    /// Distance from that height within which a circle is on the line, px.
    pub on_line: f64,
    /// Distance from that height beyond which circle 1 isn't on the line, px: lenses bend that line by less, and a mount that is turned by
    /// 40 degrees inclines it by 16 px for each radian that the arm rolls.
    pub off_line: f64,
    /// Step of the search, s; a tenth of it in the end.
    pub step: f64,
    /// Time that two logs span together, beyond which they are not searched, s: it may be one absurd stamp.
    pub longest: f64,
    /// Most rows that are compared in the search.
    pub stamps_rows: usize,
    /// Share of the motion that may be left where two logs agree: lenses bend, encoders slip.
    pub agrees: f64,
    /// Times as much of the motion that must be left at any other time, or a motion that repeats itself would fit anywhere.
    pub clearly: f64,
    /// Most times that a clock was set in a run.
    pub few: usize,
    /// Scatter about the ticks beyond which there are none, as a share of the interval.
    pub tick_scatter: f64,
    /// Rows of a plant log further apart than this (s) don't tell the motion in between: a machine whose unstable pole is at 7 1/s goes where no
    /// cubic does.
    pub torn: f64,
    /// Images that are late by this much against the encoders are late, and not stamped by another clock, s.
    pub late: (f64, f64),
    /// Time without a row in any log, from which logs pause, s.
    pub pause: f64,
    /// Times the usual time between rows that such a pause lasts, too.
    pub times: f64,
    /// Time without a row from which a torque is missing, s.
    pub hole: f64,
    /// Times the usual time between its rows that this lasts, too.
    pub hole_times: f64,
    /// Rows of other logs meanwhile, from which these go on.
    pub go_on: usize,
    /// Share of a torque's rows that come within half of the usual time between them, from which it is logged by a clock and not where it
    /// changes.
    pub regular: f64,
}

/// Distance from its line beyond which circle 1 isn't on it, px; see `off_line`.
const OFF_LINE: f64 = 60.0;

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
    latest: SINCE_1970.end,
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
    known: 2e-5,
    wanders: PART,
    turned: POLICY.small_angle,
    first: ROWS,
    on_line: SMALL * OFF_LINE,
    off_line: OFF_LINE,
    step: 0.02,
    longest: 7200.0,
    stamps_rows: POLICY.most,
    agrees: PART,
    clearly: SEVERAL,
    few: FEW,
    tick_scatter: PART,
    torn: FAR * POLICY.motion_step,
    late: (-0.05, 1.0),
    pause: 1.0,
    times: FAR,
    hole: 0.3,
    hole_times: FAR,
    go_on: FEW,
    regular: 1.0 - SMALL,
};
