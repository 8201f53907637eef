//! Coulomb friction: a torque of constant size against the motion, at the ground and at the joint.
//!
//! *Deviations*: the sign is smoothed, sign(v) → tanh(v/v_s), so that the equations stay smooth and a state needs no memory of
//! sticking. v_s is 1 mrad/s where friction is 0.1 N·m or more, and in proportion to it below: 0.1 mrad/s for 0.01 N·m. A joint that
//! ought to stick creeps instead, by less than v_s while the torque is below three quarters of the friction; sliding above 4 v_s is
//! within 0.1 % of Coulomb's law.

use super::{Mechanical, Motion, non_negative};
use fmi2_export::{ModelError, unit, variables};
use mechanics::Equation;

/// Largest v_s in rad/s: two orders below the rates at which the acrobot balances.
pub const SMOOTHING_RATE: f64 = 1e-3;
/// Friction over v_s where it is smaller, N·m·s/rad: at rest it is as stiff as 0.1 N·m with the largest v_s, the plant's fastest
/// eigenvalue about 4e3 1/s. Friction of a hundredth of a newton metre, as bearings have, would creep by ten times what encoders read
/// in half a second if it were smoothed as far.
const STIFFNESS: f64 = 0.1 / SMOOTHING_RATE;

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
            equation.f1 -= self.roll * libm::tanh(motion.dq[0] / smoothing(self.roll));
        }
        if self.joint != 0.0 {
            equation.add_joint_torque(-self.joint * libm::tanh(motion.joint_rate() / smoothing(self.joint)));
        }
    }
}

/// v_s of a friction, rad/s.
fn smoothing(friction: f64) -> f64 {
    SMOOTHING_RATE.min(friction / STIFFNESS).max(f64::MIN_POSITIVE)
}

impl Coulomb {
    /// Derivatives of the torques of rolling and at the joint by their rates, N·m·s/rad.
    pub fn slopes(&self, motion: &Motion) -> [f64; 2] {
        [(self.roll, motion.dq[0]), (self.joint, motion.joint_rate())].map(|(friction, rate)| {
            let sign = libm::tanh(rate / smoothing(friction));
            -friction / smoothing(friction) * (1.0 - sign * sign)
        })
    }
}
