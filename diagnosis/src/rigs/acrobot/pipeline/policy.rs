//! Numbers that the workflow decides by, each with its reason.

use crate::rigs::acrobot::policy::POLICY;
use crate::statistics::levels::{DOUBTED, FAR, FEW, HALF, MORE, PART, SEVERAL, SLIGHT, SMALL, WITHIN};

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pipeline {
    /// By how much logs may be off whose clocks are doubted, s: what setting them right by the motion leaves is the camera's delay.
    pub any: f64,
    /// Standard deviations of the timestamps' scatter by which a log may be late: where a computer stamps its rows, never early but late,
    /// those of a uniform scatter are late by 1.7 in the mean, of half a normal one by 1.3.
    pub late_by_hand: f64,
    /// Share of windows in which the plant needs slack torques, beyond which torques are compared instead of angles.
    pub mostly_slack: f64,
    /// Candidates that are tried where torques show nothing certain, those that these resemble most.
    pub hints: usize,
    /// Standard deviation of a motion's angles where the model needed slack torques to follow the log, rad.
    pub coarse_motion: f64,
    /// Effects in an image beyond which these aren't one blur alone, which may scatter like noise.
    pub sensor_alone: usize,
    /// Effects from which a search that began with another noise has not found what is missing: a blur moves the scatter, too.
    pub sensor_few: usize,
    /// Linearisations that are averaged for a value that images alone tell.
    pub linearisations: usize,
    /// Standard errors by which each of them lies off the fit.
    pub off: f64,
    /// Standard errors of the clock that a delay or an exposure must be larger than.
    pub doubted: f64,
    /// Times its standard error alone, up to which the clock's standard error beside what was found leaves the logs of plant and torque
    /// something to say of it.
    pub blurred: f64,
    /// Time by which an actuator's delay and a clock may differ to be one, s.
    pub same: f64,
    /// Share of the clock's time by which they may differ beside that: a lag and a delay of the same size differ by about that.
    pub close: f64,
    /// Most times that logs are corrected by their clocks, or by their zeros, and all is compared again.
    pub rounds: usize,
    /// Loss by which another member of the class must be better to be named first.
    pub first: f64,
    /// Times its value, at which the interval of a saturation ends that includes none: no log tells of one that it never comes near.
    pub never_reached: f64,
    /// Share of its certainty that a name keeps where names only stand for something else (none of 23 names beside `unknown` that did was right, one
    /// of 23 in all), as measured on blind sets whose answers were opened afterwards.
    pub confounded: f64,
    /// Share of its certainty that any name keeps beside something that has none, if it explains all that is explained: that may have a part of
    /// which nobody can say that it isn't this effect (rows exposed one after the other are late in the mean, backlash swings like a rotor).
    /// Of such names 4 of some 29 were right on blind sets of six seeds, and 7 of 10 where a listed effect was hidden beside one that is on no
    /// list; of those that explained less 2 of some 106.
    pub beside: f64,
    /// Probability that a name keeps at most which a repeated search could find and doesn't: half of the runs show less. Of 15 such names on the sets of
    /// four testers 12 were right.
    pub missed: f64,
    /// Share that a name keeps where half of what could be asked was: of noises in another light, and where time was up.
    pub half_asked: f64,
    /// Share of what the data say of a value beyond which one run says it all.
    pub interval_alone: f64,
    /// Readings of one and the same model, over which certainty is shared: nothing in the data prefers either.
    pub readings: f64,
    /// Share of what effects leave that a correction alone may leave, to take their place with as many numbers.
    pub far_less: f64,
    /// Effects, those that were named last, that are tried without, one at a time.
    pub singles: usize,
    /// Times the noise, from which torques that are read off windows may show that the nominal model has run away.
    pub far_above: f64,
    /// Times what the model lacks at the logged states themselves that they must show there, too: what its tangent asks for is no torque
    /// then.
    pub ran_away: f64,
    /// Most parts that runs are left out in: each costs a search, and with three a diagnosis took 1.6 to 1.9 times as long as without.
    pub parts: usize,
    /// Best hits of each screen that are candidates again in a repeated search.
    pub screened: usize,
    /// Times the stated noise by which rows must scatter for it to be too small: it was 1.6 to 2.4 times on 3 of 152 sets whose noise is
    /// stated right, where clocks drift or torques lack in high noise.
    pub understated: f64,
    /// Correlation from row to row below which such rows are noise.
    pub alike_rows: f64,
    /// Standard errors by which a clock must miss the time that the image asks for, not to be taken for it.
    pub misses: f64,
}

/// Those in force.
pub const PIPELINE: Pipeline = Pipeline {
    any: 0.1,
    late_by_hand: 2.0,
    mostly_slack: HALF,
    hints: FEW,
    coarse_motion: POLICY.guess,
    sensor_alone: 2,
    sensor_few: 2,
    linearisations: 6,
    off: HALF,
    doubted: WITHIN,
    blurred: 2.0,
    same: 5e-4,
    close: SMALL,
    rounds: FEW,
    first: PART,
    never_reached: FAR * FAR,
    confounded: 0.05,
    beside: PART,
    missed: 1.0 - PART,
    half_asked: HALF,
    interval_alone: 1.0 - SLIGHT,
    readings: 2.0,
    far_less: 1.0 - PART,
    singles: FEW,
    far_above: FAR,
    ran_away: MORE,
    parts: 2,
    screened: FEW,
    understated: SEVERAL,
    alike_rows: PART,
    misses: DOUBTED,
};
