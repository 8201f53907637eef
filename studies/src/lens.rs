//! The paper's equations of image formation for the centres of the circles: what the camera unit's frames are held
//! against. Written from (1)-(10), not taken from the unit.
//!
//! Image plane: u to the right, v up, −1..1 across the picture of 20 × 20 world units. The ground line lies at −8, the
//! drum rolls, circle 1 sits at its centre (the only choice that gives Table 3). The distortion takes ideal
//! coordinates as arguments. A centre's image stands for its circle here; in a frame it is the outline that moves.

use mechanics::{Theta, place::ARM_END};

/// Image units of a world unit: half of the field of view is 1.
const IMAGE_FROM_WORLD: f64 = 0.1;
/// Height of the drum's centre, world units.
const DRUM_HEIGHT: f64 = -7.0;
/// Radius of the drum, lengths of the links, world units (Section 4).
pub const DRUM_RADIUS: f64 = 1.0;
const LINK_1: f64 = 6.19;
const LINK_2: f64 = 6.9;

/// The five distortions, in 1/unit and 1/unit².
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Lens {
    /// Radial, (3), (4).
    pub k1: f64,
    /// Decentering, (5), (6).
    pub p1: f64,
    /// Decentering, (5), (6).
    pub p2: f64,
    /// Thin prism, (7).
    pub s1: f64,
    /// Thin prism, (8).
    pub s2: f64,
}

/// The names of the distortions, in the paper's order.
pub const DISTORTIONS: [&str; 5] = ["k1", "p1", "p2", "s1", "s2"];

impl Lens {
    /// A lens with one distortion, named as in [`DISTORTIONS`]; a perfect one for any other name.
    pub fn with(name: &str, value: f64) -> Self {
        let mut lens = Self::default();
        match name {
            "k1" => lens.k1 = value,
            "p1" => lens.p1 = value,
            "p2" => lens.p2 = value,
            "s1" => lens.s1 = value,
            "s2" => lens.s2 = value,
            _ => {}
        }
        lens
    }

    /// All distortions times a factor.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        let Self { k1, p1, p2, s1, s2 } = self;
        Self { k1: k1 * factor, p1: p1 * factor, p2: p2 * factor, s1: s1 * factor, s2: s2 * factor }
    }

    /// The parameters of the camera unit that make this lens.
    pub fn settings(self) -> Vec<(&'static str, f64)> {
        DISTORTIONS.into_iter().zip([self.k1, self.p1, self.p2, self.s1, self.s2]).collect()
    }

    /// (δᵤ, δᵥ) at an ideal point.
    pub fn displacement(self, [u, v]: [f64; 2]) -> [f64; 2] {
        let Self { k1, p1, p2, s1, s2 } = self;
        let r2 = u * u + v * v;
        let radial = [k1 * u * r2, k1 * v * r2]; // (3), (4)
        let decentering = [
            p1 * (3.0 * u * u + v * v) + 2.0 * p2 * u * v, // (5)
            2.0 * p1 * u * v + p2 * (u * u + 3.0 * v * v), // (6)
        ];
        let prism = [s1 * r2, s2 * r2]; // (7), (8)
        [radial[0] + decentering[0] + prism[0], radial[1] + decentering[1] + prism[1]]
    }

    /// Where an ideal point is seen, (9), (10).
    pub fn image(self, ideal: [f64; 2]) -> [f64; 2] {
        let [du, dv] = self.displacement(ideal);
        [ideal[0] + du, ideal[1] + dv]
    }

    /// The state that somebody who takes the lens for perfect reads from the centres.
    pub fn estimate(self, pose: [f64; 2]) -> [f64; 2] {
        let [drum, joint, tip] = circles_image(pose).map(|ideal| self.image(ideal));
        let angle = |from: [f64; 2], to: [f64; 2]| libm::atan2(to[0] - from[0], to[1] - from[1]);
        [angle(drum, joint), angle(joint, tip)]
    }

    /// Actual less estimated (q₁, q₂) on the manifold at q₂.
    pub fn error(self, q2: f64) -> [f64; 2] {
        let pose = on_manifold(q2);
        let estimate = self.estimate(pose);
        [pose[0] - estimate[0], pose[1] - estimate[1]]
    }
}

/// (q₁, q₂) of the equilibrium at q₂ for Table 2.
pub fn on_manifold(q2: f64) -> [f64; 2] {
    let Theta { theta_9, theta_10, .. } = Theta::TABLE_2;
    [-libm::asin(theta_10 / theta_9 * libm::sin(q2)), q2] // (13)
}

/// Ideal image coordinates of the centres of circles 1, 2, 3.
pub fn circles_image([q1, q2]: [f64; 2]) -> [[f64; 2]; 3] {
    let drum = [DRUM_RADIUS * q1, DRUM_HEIGHT];
    let joint = [drum[0] + LINK_1 * libm::sin(q1), drum[1] + LINK_1 * libm::cos(q1)];
    let tip = [joint[0] + LINK_2 * libm::sin(q2), joint[1] + LINK_2 * libm::cos(q2)];
    [drum, joint, tip].map(|[x, y]| [IMAGE_FROM_WORLD * x, IMAGE_FROM_WORLD * y])
}

/// q₂ of the places at which errors are taken: both arms of the manifold in steps of 5 mrad, from −2.35 to 2.35.
pub fn places() -> Vec<f64> {
    (-STEPS_OF_ARM..=STEPS_OF_ARM).map(place).collect()
}

/// Steps from the upright to the end of an arm.
pub const STEPS_OF_ARM: i32 = 470;

/// q₂ at a number of steps from the upright.
pub fn place(step: i32) -> f64 {
    ARM_END * f64::from(step) / f64::from(STEPS_OF_ARM)
}
