//! Coulomb friction: a torque of constant size against the motion, at the ground and at the joint.
//!
//! *Deviations*: the sign is smoothed, sign(v) → tanh(v/v_s) with v_s = 1 mrad/s, so that the equations stay smooth
//! and a state needs no memory of sticking. A joint that ought to stick creeps instead, by less than 1 mrad/s while
//! the torque is below three quarters of the friction; sliding above 4 mrad/s is within 0.1 % of Coulomb's law.

use super::{Mechanical, Motion, non_negative};
use fmi2_export::{ModelError, unit, variables};
use mechanics::Equation;

/// v_s in rad/s. Two orders below the rates at which the acrobot balances, and large enough for the integrator: with
/// 0.1 N·m at the joint the plant's fastest eigenvalue is about 4e3 1/s.
pub const SMOOTHING_RATE: f64 = 1e-3;

variables! {
    /// Coulomb friction.
    pub struct Coulomb {
        effect roll: f64 = 0.0, "fc_roll", "f_r", unit::NEWTON_METRE,
            "Coulomb friction of rolling, against dq1; off at 0.", min = 0.0;
        effect joint: f64 = 0.0, "fc_joint", "f_j", unit::NEWTON_METRE,
            "Coulomb friction of the joint, against dq2 - dq1; off at 0.", min = 0.0;
    }
}

impl Mechanical for Coulomb {
    fn check(&self) -> Result<(), ModelError> {
        non_negative("fc_roll", self.roll)?;
        non_negative("fc_joint", self.joint)
    }

    fn act(&self, motion: &Motion, equation: &mut Equation) {
        if self.roll != 0.0 {
            equation.f1 -= self.roll * libm::tanh(motion.dq[0] / SMOOTHING_RATE);
        }
        if self.joint != 0.0 {
            equation.add_joint_torque(-self.joint * libm::tanh(motion.joint_rate() / SMOOTHING_RATE));
        }
    }
}
