//! Torque bias: what the drive gives without a command.

use super::finite;
use crate::actuator::{Memory, Signal, Stage};
use fmi2_export::{ModelError, unit, variables};

variables! {
    /// Torque bias.
    pub struct Bias {
        effect torque: f64 = 0.0, "tau_bias", "τ_b", unit::NEWTON_METRE,
            "Torque of the actuator without a command, added last; off at 0.";
    }
}

impl Stage for Bias {
    fn check(&self) -> Result<(), ModelError> {
        finite("tau_bias", self.torque)
    }

    fn feedthrough(&self, _: f64) -> f64 {
        1.0
    }

    fn shape(&self, _: &Memory, _: f64, torque: &mut Signal, _: &mut f64) {
        if self.torque != 0.0 {
            torque.value += self.torque;
        }
    }
}
