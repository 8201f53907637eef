//! The catalogue: what a lab can do next. To add an experiment, add an entry.
//!
//! An entry is data: what a person is to do, what that changes in the nominal scenario, what is logged in addition.
//! Which one tells candidates apart is never written here; it comes from simulating it.

/// One experiment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Experiment {
    /// A few words, for a table.
    pub name: &'static str,
    /// What is to be done, as an order to a person.
    pub what: &'static str,
    /// Machines that can do it.
    pub rig: Rig,
    /// How much work it is: 1 a number in a program, 2 a hand at the camera or the arm, 3 an instrument, 4 two of them.
    pub cost: u8,
    /// What becomes different.
    pub changes: &'static [Change],
}

/// Which machines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rig {
    /// Any.
    Any,
    /// The acrobot that rolls on its drum.
    Rolling,
    /// An arm whose first link turns about a fixed axis.
    Pinned,
}

/// A difference to the runs that were made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// A signal is logged that was not.
    Log(Log),
    /// Angles and torque are logged so many times a second, or oftener as before.
    Rate(f64),
    /// Another z_desired.
    Desired(Profile),
    /// A parameter times a factor.
    Times(&'static str, f64),
    /// A parameter plus something.
    Plus(&'static str, f64),
    /// The camera's mount is turned about its axis by so many rad, and the vision knows.
    Turned(f64),
    /// The arm starts at rest, hanging, and is driven by torques that don't depend on its motion.
    Hang,
}

/// A log.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Log {
    /// Both joint angles.
    Encoders,
    /// `tau_applied`.
    Torque,
}

/// z_desired over time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Profile {
    /// Points (s, z) with smooth steps between.
    Points(&'static [(f64, f64)]),
    /// A sinusoid whose frequency rises evenly, Hz.
    Sweep {
        /// Largest z.
        size: f64,
        /// Frequency at the begin.
        from: f64,
        /// Frequency at the end.
        to: f64,
    },
}

const PI_HALF: f64 = std::f64::consts::FRAC_PI_2;
/// Length of a run, s.
pub const LENGTH: f64 = 15.0;
/// Steps of up to 0.4 in 0.8 s: the balanced arm tolerates them.
#[rustfmt::skip]
const FAST: Profile = Profile::Points(&[
    (0.0, 0.0), (1.2, 0.0), (2.0, 0.18), (3.0, 0.18), (3.8, -0.12), (4.8, -0.12), (5.6, 0.2), (6.6, 0.2), (7.4, -0.2),
    (8.4, -0.2), (9.2, 0.08), (10.2, 0.08), (11.0, -0.15), (12.0, -0.15), (12.8, 0.2), (13.8, 0.2), (14.6, -0.05),
]);
#[rustfmt::skip]
const LARGE: Profile = Profile::Points(&[
    (0.0, 0.0), (1.0, 0.0), (4.0, 0.3), (5.0, 0.3), (9.0, -0.3), (10.0, -0.3), (14.0, 0.3), (15.0, 0.3),
]);
#[rustfmt::skip]
const SMALL: Profile = Profile::Points(&[
    (0.0, 0.0), (1.0, 0.0), (2.0, 0.05), (4.0, 0.05), (5.0, -0.05), (7.0, -0.05), (8.0, 0.05), (10.0, 0.05), (11.0, -0.05),
    (13.0, -0.05), (14.0, 0.05),
]);
const RAMP: Profile = Profile::Points(&[(0.0, 0.0), (1.0, 0.0), (6.0, 0.45), (14.0, -0.45), (15.0, -0.45)]);
const SWING: Profile = Profile::Sweep { size: 0.2, from: 0.08, to: 0.5 };
const FAST_SWING: Profile = Profile::Sweep { size: 0.12, from: 0.3, to: 0.9 };

use crate::rigs::acrobot::candidates::{DEFOCUS, EXPOSURE};
use crate::rigs::acrobot::parameters::{FIELD_OF_VIEW, FRAME_RATE};
use Change::{Desired, Hang, Plus, Rate, Times, Turned};

/// No experiment but the control of the predictions: what the data at hand should have told.
pub const AGAIN: Experiment =
    Experiment { name: "the same again", what: "Repeat the runs.", rig: Rig::Any, cost: 0, changes: &[] };

/// Everything that a lab can do without building another machine.
#[rustfmt::skip]
pub const CATALOGUE: &[Experiment] = &[
    Experiment { name: "faster steps", rig: Rig::Rolling, cost: 1, changes: &[Desired(FAST)], what: "Repeat with faster steps of z_desired: up to 0.4, each in 0.8 s." },
    Experiment { name: "larger steps", rig: Rig::Rolling, cost: 1, changes: &[Desired(LARGE)], what: "Repeat with larger steps of z_desired: 0.6, each in 4 s." },
    Experiment { name: "swing", rig: Rig::Rolling, cost: 1, changes: &[Desired(SWING)], what: "Swing: let z_desired be a sinusoid whose frequency rises from 0.08 to 0.5 Hz." },
    Experiment { name: "faster swing", rig: Rig::Rolling, cost: 1, changes: &[Desired(FAST_SWING)], what: "Swing fast: let z_desired be a sinusoid whose frequency rises from 0.3 to 0.9 Hz." },
    Experiment { name: "slow ramps", rig: Rig::Rolling, cost: 1, changes: &[Desired(RAMP)], what: "Repeat with slow ramps of z_desired from one end of the range to the other." },
    Experiment { name: "small steps", rig: Rig::Rolling, cost: 1, changes: &[Desired(SMALL)], what: "Repeat with small steps of z_desired, 0.1 each." },
    Experiment { name: "faster steps, logged often", rig: Rig::Rolling, cost: 2, changes: &[Desired(FAST), Rate(200.0)], what: "Repeat with faster steps of z_desired, up to 0.4, each in 0.8 s, and log the joint angles 200 times a second." },
    Experiment { name: "swing, logged often", rig: Rig::Rolling, cost: 2, changes: &[Desired(SWING), Rate(200.0)], what: "Swing: let z_desired be a sinusoid whose frequency rises from 0.08 to 0.5 Hz, and log the joint angles 200 times a second." },
    Experiment { name: "exposure halved", rig: Rig::Any, cost: 1, changes: &[Times(EXPOSURE, 0.5)], what: "Halve the exposure and repeat the runs." },
    Experiment { name: "exposure doubled", rig: Rig::Any, cost: 1, changes: &[Times(EXPOSURE, 2.0)], what: "Double the exposure and repeat the runs." },
    Experiment { name: "frame rate doubled", rig: Rig::Any, cost: 1, changes: &[Times(FRAME_RATE, 2.0)], what: "Double the frames a second of the camera and repeat the runs." },
    Experiment { name: "refocused", rig: Rig::Any, cost: 2, changes: &[Plus(DEFOCUS, 1.0)], what: "Refocus the camera one pass of the mask (camera.N) off its focus and repeat the runs." },
    Experiment { name: "camera nearer", rig: Rig::Any, cost: 2, changes: &[Times(FIELD_OF_VIEW, 0.85)], what: "Move the camera nearer, until it sees 0.85 of the width that it saw, and repeat the runs." },
    Experiment { name: "camera farther", rig: Rig::Any, cost: 2, changes: &[Times(FIELD_OF_VIEW, 1.2)], what: "Move the camera farther away, until it sees 1.2 of the width that it saw, and repeat the runs." },
    Experiment { name: "mount turned by 90 degrees", rig: Rig::Any, cost: 2, changes: &[Turned(PI_HALF)], what: "Turn the camera mount by 90 degrees about its axis (camera.roll = pi/2), tell the vision so (camera.mount), and repeat the runs." },
    Experiment { name: "mount turned by 40 degrees", rig: Rig::Any, cost: 3, changes: &[Turned(0.7)], what: "Turn the camera mount by 40 degrees about its axis (camera.roll = 0.7), tell the vision so (camera.mount), and repeat the runs." },
    Experiment { name: "mount turned by 40 degrees, ramps", rig: Rig::Rolling, cost: 3, changes: &[Turned(0.7), Desired(RAMP)], what: "Turn the camera mount by 40 degrees about its axis (camera.roll = 0.7), tell the vision so (camera.mount), and make slow ramps of z_desired from one end of the range to the other." },
    Experiment { name: "hanging down", rig: Rig::Pinned, cost: 2, changes: &[Hang], what: "Let the arm hang down: start at rest and drive it with a sum of sines from 0.2 to 3 Hz." },
    Experiment { name: "joint angles logged", rig: Rig::Any, cost: 3, changes: &[Change::Log(Log::Encoders)], what: "Log the joint angles by encoders (or motion capture) beside the image and repeat the runs." },
    Experiment { name: "joint angles logged often, faster steps", rig: Rig::Rolling, cost: 3, changes: &[Change::Log(Log::Encoders), Rate(200.0), Desired(FAST)], what: "Log the joint angles by encoders (or motion capture) 200 times a second beside the image, and make faster steps of z_desired: up to 0.4, each in 0.8 s." },
    Experiment { name: "torque logged", rig: Rig::Any, cost: 4, changes: &[Change::Log(Log::Torque), Change::Log(Log::Encoders)], what: "Log the applied torque (tau_applied) together with the joint angles by encoders and repeat the runs." },
    Experiment { name: "torque logged often", rig: Rig::Any, cost: 4, changes: &[Change::Log(Log::Torque), Change::Log(Log::Encoders), Rate(200.0)], what: "Log the applied torque (tau_applied) together with the joint angles by encoders, 200 times a second, and repeat the runs." },
    Experiment { name: "torque logged often, faster steps", rig: Rig::Rolling, cost: 4, changes: &[Change::Log(Log::Torque), Change::Log(Log::Encoders), Rate(200.0), Desired(FAST)], what: "Log the applied torque (tau_applied) together with the joint angles by encoders, 200 times a second, and make faster steps of z_desired: up to 0.4, each in 0.8 s." },
];
