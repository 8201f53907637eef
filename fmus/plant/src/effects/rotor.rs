//! Inertia of the motor's rotor, reflected at the joint: gear ratio squared times the rotor's own.
//!
//! It turns with the joint, so its kinetic energy is ½I(q̇₂ − q̇₁)²: M gains I·[1 −1; −1 1]. The rotor's share in the
//! motion of link 1 itself (of the order of I over the gear ratio) is left out, as usual.
//! Source: Spong, "Modeling and control of elastic joint robots", 1987, with a stiff joint.

use super::{Mechanical, Motion, non_negative};
use fmi2_export::{ModelError, unit, variables};
use mechanics::Equation;

variables! {
    /// The motor's rotor.
    pub struct Rotor {
        effect inertia: f64 = 0.0, "I_rotor", "I_m", unit::KILOGRAM_METRE_SQUARED,
            "Inertia of the motor's rotor reflected at the joint, acts on ddq2 - ddq1; off at 0.", min = 0.0;
    }
}

impl Mechanical for Rotor {
    fn check(&self) -> Result<(), ModelError> {
        non_negative("I_rotor", self.inertia)
    }

    fn act(&self, _: &Motion, equation: &mut Equation) {
        if self.inertia != 0.0 {
            equation.m11 += self.inertia;
            equation.m12 -= self.inertia;
            equation.m22 += self.inertia;
        }
    }

    fn kinetic_energy(&self, motion: &Motion) -> f64 {
        let rate = motion.joint_rate();
        0.5 * self.inertia * rate * rate
    }
}
