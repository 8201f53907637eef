//! Viscous friction: torque proportional to a rate and against it.
//!
//! At the ground (rolling resistance of the drum) it acts on q̇₁, at the joint on q̇₂ − q̇₁, there on both links.
//! Source: the linear term of the usual joint friction model, e.g. Siciliano et al., *Robotics: Modelling, Planning
//! and Control*, 2009, chapter 7.

use super::{Mechanical, Motion, non_negative};
use fmi2_export::{ModelError, unit, variables};
use mechanics::Equation;

variables! {
    /// Viscous friction.
    pub struct Viscous {
        effect roll: f64 = 0.0, "b_roll", "b_r", unit::NEWTON_METRE_SECOND_PER_RADIAN,
            "Viscous friction of rolling: the torque -b_roll*dq1 on link 1; off at 0.", min = 0.0;
        effect joint: f64 = 0.0, "b_joint", "b_j", unit::NEWTON_METRE_SECOND_PER_RADIAN,
            "Viscous friction of the joint: the torque -b_joint*(dq2 - dq1) between the links; off at 0.", min = 0.0;
    }
}

impl Mechanical for Viscous {
    fn check(&self) -> Result<(), ModelError> {
        non_negative("b_roll", self.roll)?;
        non_negative("b_joint", self.joint)
    }

    fn act(&self, motion: &Motion, equation: &mut Equation) {
        if self.roll != 0.0 {
            equation.f1 -= self.roll * motion.dq[0];
        }
        if self.joint != 0.0 {
            equation.add_joint_torque(-self.joint * motion.joint_rate());
        }
    }
}
