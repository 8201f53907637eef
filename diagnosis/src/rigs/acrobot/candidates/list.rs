//! The list. To add a candidate, add an entry.

use super::{Attribute, Cuts, Entry, Motion, Side};
use crate::observe::InputEffect;
use Attribute::{
    AtPort, Bias, CameraRoll, Exposure, Friction, Gain, Ground, ImageDelay, InActuator, JointWeight,
    LinkInertia, LostFrames, OverTime, RadialSeries, Retards, Rolls, SensorNoise, Sticks, Zero,
};

/// A candidate that moves by steps in its own unit.
const fn real(
    name: &'static str,
    side: Side,
    steps: &'static [f64],
    range: (f64, f64),
    phrase: &'static str,
) -> Entry {
    Entry {
        name,
        side,
        motion: Motion::Real { steps, range },
        nonlinear: false,
        phrase,
        attributes: &[],
        twin: None,
    }
}

/// A candidate that scales with the arm's inertias.
const fn load(name: &'static str, steps: &'static [f64], range: (f64, f64), phrase: &'static str) -> Entry {
    Entry {
        name,
        side: Side::Plant,
        motion: Motion::Load { steps, range },
        nonlinear: false,
        phrase,
        attributes: &[],
        twin: None,
    }
}

/// A candidate that moves by shares of its nominal value.
const fn share(name: &'static str, steps: &'static [f64], range: (f64, f64), phrase: &'static str) -> Entry {
    Entry {
        name,
        side: Side::Plant,
        motion: Motion::Share { steps, range },
        nonlinear: false,
        phrase,
        attributes: &[],
        twin: None,
    }
}

/// A candidate that is nonlinear in its size.
const fn bent(entry: Entry) -> Entry {
    Entry { nonlinear: true, ..entry }
}

/// A candidate with attributes.
const fn is(attributes: &'static [Attribute], entry: Entry) -> Entry {
    Entry { attributes, ..entry }
}

/// Says the same as a term of a correction.
const fn twin(term: &'static str, entry: Entry) -> Entry {
    Entry { twin: Some(term), ..entry }
}

/// How long an image is exposed, in frame intervals.
pub const EXPOSURE: &str = "camera.E_t";
/// Passes of the mask that blurs an image.
pub const DEFOCUS: &str = "camera.N";
/// Where friction, N·m(·s/rad) at inertia scale 1, holds an arm fast whatever drives it. What flees there is no friction, and a unit takes
/// a thousand times as long over what is stiffer still.
const FAST: (f64, f64) = (0.0, 200.0);
/// Whatever pushes harder throws the arm out of every log.
const PUSHED: (f64, f64) = (-200.0, 200.0);
/// An inertia or a gain stays a fair part of itself: without this, all of them and the torque gain going to zero
/// together would fit anything.
const PART: (f64, f64) = (0.25, 4.0);
/// A rotor behind a gear outweighs its link at most some ten times, kg·m² at inertia scale 1; and where it is infinite nothing moves.
const ROTOR: (f64, f64) = (0.0, 1.0);
const THOUSANDTH: &[f64] = &[0.001];

/// Everything that docs/units.md ("What a diagnosis may name") lists.
///
/// Plant steps move a window's end by some milliradians at most: it grows by e^(7 · 0.6), and columns must not bend.
/// Lens steps move the edge of the image by two to five pixels: well above the pixel lattice, which is not noise.
#[rustfmt::skip]
pub const LIST: &[Entry] = &[
    is(&[Friction], twin("damp_roll", load("plant.b_roll", &[5e-4], FAST, "viscous friction of the first link (rolling)"))),
    is(&[Friction], twin("damp_joint", load("plant.b_joint", &[2e-4], FAST, "viscous friction at the joint"))),
    is(&[Friction, Sticks], twin("stick_roll", bent(load("plant.fc_roll", &[5e-4], FAST, "Coulomb friction of the first link (rolling)")))),
    is(&[Friction, Sticks], twin("stick_joint", bent(load("plant.fc_joint", &[5e-4], FAST, "Coulomb friction at the joint")))),
    load("plant.I_rotor", &[2e-5], ROTOR, "rotor inertia at the joint"),
    is(&[InActuator, AtPort(InputEffect::Saturation)], Entry { name: "plant.tau_max", side: Side::Plant, motion: Motion::Saturation { cuts: Cuts::Torque }, nonlinear: true, attributes: &[], twin: None, phrase: "torque saturation" }),
    is(&[InActuator, OverTime, AtPort(InputEffect::RateLimit)], Entry { name: "plant.dtau_max", side: Side::Plant, motion: Motion::Saturation { cuts: Cuts::TorqueRate }, nonlinear: true, attributes: &[], twin: None, phrase: "limit on the rate of the torque" }),
    is(&[InActuator, OverTime, Retards, AtPort(InputEffect::Lag)], real("plant.T_act", Side::Plant, &[5e-4, 4e-3, 2e-2], (0.0, 1.0), "lag of the actuator")),
    is(&[InActuator, OverTime, Retards, AtPort(InputEffect::Delay)], real("plant.tau_delay", Side::Plant, &[5e-4, 4e-3, 2e-2], (0.0, 0.2), "delay of the actuator")),
    is(&[Bias, AtPort(InputEffect::Bias)], twin("bias_joint", load("plant.tau_bias", &[2.5e-4], PUSHED, "constant torque bias"))),
    is(&[Gain, AtPort(InputEffect::Gain)], share("plant.k_tau", THOUSANDTH, PART, "torque gain")),
    is(&[Ground], twin("bias_roll", real("plant.slope", Side::Plant, &[2.5e-4], (-1.0, 1.0), "inclined ground"))),
    is(&[Ground], real("plant.incline", Side::Plant, &[2.5e-4], (-1.0, 1.0), "inclined rig: ground, camera and the zeros of its angles")),
    Entry { name: "plant.velocity_terms", side: Side::Plant, motion: Motion::Switch, nonlinear: true, attributes: &[], twin: None, phrase: "velocity terms of the equations of motion" },
    is(&[LinkInertia], share("plant.theta_1", THOUSANDTH, PART, "inertia of the first link")),
    is(&[Rolls], share("plant.theta_2", THOUSANDTH, PART, "inertia coupling of rolling and first link")),
    is(&[LinkInertia], share("plant.theta_5", THOUSANDTH, PART, "inertia of the second link")),
    is(&[Rolls], share("plant.theta_7", THOUSANDTH, PART, "inertia coupling of rolling and second link")),
    share("plant.theta_8", THOUSANDTH, PART, "inertia coupling of the links"),
    twin("spring_roll", share("plant.theta_9", THOUSANDTH, PART, "gravity torque of the first link")),
    is(&[JointWeight], twin("spring_joint", share("plant.theta_10", THOUSANDTH, PART, "gravity torque of the second link"))),
    is(&[RadialSeries], real("camera.k1", Side::Camera, &[0.04], (-2.0, 2.0), "radial distortion of the lens")),
    is(&[RadialSeries], real("camera.k2", Side::Camera, &[0.04], (-4.0, 4.0), "fifth-order radial distortion of the lens")),
    real("camera.p1", Side::Camera, &[0.02], (-1.0, 1.0), "decentring distortion along u"),
    real("camera.p2", Side::Camera, &[0.02], (-1.0, 1.0), "decentring distortion along v"),
    real("camera.s1", Side::Camera, &[0.02], (-1.0, 1.0), "thin-prism distortion along u"),
    real("camera.s2", Side::Camera, &[0.02], (-1.0, 1.0), "thin-prism distortion along v"),
    real("camera.beta", Side::Camera, &[1.0], (0.0, 100.0), "vignetting"),
    Entry { name: DEFOCUS, side: Side::Camera, motion: Motion::Count { tried: 4, most: 16 }, nonlinear: true, attributes: &[], twin: None, phrase: "defocus" },
    is(&[CameraRoll], real("camera.roll", Side::Camera, &[0.01], (-3.2, 3.2), "camera rolled about its axis")),
    real("camera.pan", Side::Camera, &[0.005], (-0.5, 0.5), "camera panned"),
    real("camera.tilt", Side::Camera, &[0.005], (-0.5, 0.5), "camera tilted"),
    real("camera.u0", Side::Camera, &[0.0083], (-1.0, 1.0), "principal point off along u"),
    real("camera.v0", Side::Camera, &[0.0083], (-1.0, 1.0), "principal point off along v"),
    real("camera.scale", Side::Camera, &[0.01], (0.1, 10.0), "image scale"),
    is(&[Exposure], bent(real(EXPOSURE, Side::Camera, &[0.02, 0.2, 0.7], (0.0, 1.0), "exposure time"))),
    // no variables of a unit: how late the plant's log is stamped, s, and by how much its angles read too large, rad
    real("plant log's clock", Side::Clock, &[2e-3], (-0.02, 0.02), "offset of the plant log's clock"),
    is(&[Zero(0)], real("zero of q1", Side::Zero, &[1e-3], (-0.5, 0.5), "zero of the first link's angle")),
    is(&[Zero(1)], real("zero of q2", Side::Zero, &[1e-3], (-0.5, 0.5), "zero of the second link's angle")),
    // below 0 only to tell a clock that is off: no camera is that quick
    is(&[ImageDelay], real("camera.T_delay", Side::Camera, &[2e-3], (-0.05, 1.0), "delay of the camera's results")),
    is(&[LostFrames], real("camera.drop_rate", Side::Count, &[0.01], (0.0, 1.0), "lost frames")),
    is(&[SensorNoise], real("camera.sigma", Side::SensorNoise, &[8.0], (0.0, 100.0), "noise of the sensor")),
];
