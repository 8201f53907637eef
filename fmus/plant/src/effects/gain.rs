//! Torque gain: what the drive gives for one newton metre of command, e.g. a torque constant off its data sheet.

use super::finite;
use crate::actuator::{Memory, Signal, Stage};
use fmi2_export::{ModelError, unit, variables};

variables! {
    /// Torque gain.
    pub struct Gain {
        effect factor: f64 = 1.0, "k_tau", "k_τ", unit::ONE,
            "Gain of the actuator: torque over command; off at 1.";
    }
}

impl Stage for Gain {
    fn check(&self) -> Result<(), ModelError> {
        finite("k_tau", self.factor)
    }

    fn feedthrough(&self, _: f64) -> f64 {
        self.factor
    }

    fn shape(&self, _: &Memory, _: f64, torque: &mut Signal, _: &mut f64) {
        if self.factor != 1.0 {
            torque.value *= self.factor;
            torque.rate *= self.factor;
            torque.transient *= self.factor;
        }
    }
}
