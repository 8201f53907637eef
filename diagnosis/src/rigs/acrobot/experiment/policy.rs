//! Numbers that the next experiment is chosen by, each with its reason.

use crate::rigs::acrobot::channels::{Measures, guess_of};
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::selection::CLASS;
use crate::statistics::levels::{DOUBTED, FEW, MORE, SEVERAL, SMALL, STEP};
use std::f64::consts::FRAC_PI_2;

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Design {
    /// Times by which a simulated loss flatters: a lab's model lacks more than one thing, and its noise is not white.
    pub caution: f64,
    /// Certainties that differ by less are equal; the cheaper experiment is taken then.
    pub equal: f64,
    /// Loss that is wished for: one that is expected scatters by twice its root, and of ten such nine stay above `CLASS` then.
    pub enough: f64,
    /// Times the duration of what was recorded before that a lab records at most.
    pub longest: f64,
    /// How many of the best are simulated with every member as the truth; the rest with the most probable one.
    pub finalists: usize,
    /// How many members besides the most probable one are each the truth there.
    pub truths: usize,
    /// Noise of an angle that was not logged before, rad: that of good encoders.
    pub encoder: f64,
    /// Noise of a torque that was not logged before, N·m: that of a torque cell.
    pub torque: f64,
    /// Length of a run without an image in the loop, s: it is logged at a higher rate. One of it stands for all where poses must be read
    /// off frames that are rendered again.
    pub short: f64,
    /// A repeated z_desired is given in straight lines of this length, s.
    pub thinned: f64,
    /// Time for which each torque is held while an arm hangs, s.
    pub held: f64,
    /// Angle from which an arm hangs rather than balances, rad.
    pub hanging: f64,
    /// Frames that are rendered for a prediction: enough to visit the image, few enough to be quick.
    pub frames: usize,
    /// A tangent in the plant is taken over this share of the step at which a candidate is tried: far above the
    /// integrator's 1e-9, far below where a window bends.
    pub tangent: f64,
    /// Rows of the encoders per second where none were logged before.
    pub encoder_rate: f64,
    /// Expected loss above which two members count as told apart: odds of 1 to 90.
    pub told: f64,
    /// Torque at the joint and at the first link, as shares of the second link's weight: swings of half a radian to one.
    pub swings: [f64; 2],
    /// A sweep is given in straight lines of this length, s.
    pub sweep_step: f64,
}

/// Those in force.
pub const DESIGN: Design = Design {
    caution: SEVERAL,
    equal: STEP,
    enough: SEVERAL * CLASS,
    longest: 5.0,
    finalists: 2,
    truths: FEW,
    encoder: POLICY.read,
    torque: guess_of(Measures::AppliedTorque),
    short: 10.0,
    thinned: SMALL,
    held: POLICY.motion_step,
    hanging: FRAC_PI_2,
    frames: 100,
    tangent: STEP,
    encoder_rate: 30.0,
    told: DOUBTED * DOUBTED,
    swings: [SMALL, MORE * SMALL],
    sweep_step: SMALL,
};
