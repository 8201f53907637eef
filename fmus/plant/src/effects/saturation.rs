//! The largest torque: u = max(−τ_max, min(τ_max, τ)).

use super::non_negative;
use crate::actuator::{Memory, Signal, Stage};
use fmi2_export::{ModelError, unit, variables};

variables! {
    /// Saturation.
    pub struct Saturation {
        effect limit: f64 = 0.0, "tau_max", "τ_max", unit::NEWTON_METRE,
            "Largest torque either way; off (no limit) at 0.", min = 0.0;
    }
}

impl Stage for Saturation {
    fn check(&self) -> Result<(), ModelError> {
        non_negative("tau_max", self.limit)
    }

    fn settle(&self, _: &mut Memory, input: f64) -> f64 {
        if self.limit > 0.0 { input.clamp(-self.limit, self.limit) } else { input }
    }

    fn feedthrough(&self, input: f64) -> f64 {
        if self.limit != 0.0 && input.abs() >= self.limit { 0.0 } else { 1.0 }
    }

    fn shape(&self, _: &Memory, _: f64, torque: &mut Signal, span: &mut f64) {
        let limit = self.limit;
        if limit == 0.0 {
            return;
        }
        let Signal { value, rate, .. } = *torque; // a line: the lag comes later
        let outwards = rate * value.signum();
        if value.abs() > limit || (value.abs() == limit && outwards >= 0.0) {
            if outwards < 0.0 {
                *span = span.min((value.abs() - limit) / -outwards);
            }
            *torque = Signal::constant(limit.copysign(value));
            return;
        }
        if rate != 0.0 {
            let ahead = (limit.copysign(rate) - value) / rate;
            *span = span.min(ahead);
        }
    }
}
