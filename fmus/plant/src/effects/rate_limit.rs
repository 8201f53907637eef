//! The largest rate of change of the torque: the output follows its input as fast as it may.
//!
//! du/dt = clamp(dτ/dt, ±R) once u = τ, and R·sign(τ − u) until then. Starts from `tau_0`. The paper names this
//! limit as future work (Section 5).

use super::non_negative;
use crate::actuator::{Ended, Memory, SHORTEST, Signal, Stage};
use fmi2_export::{ModelError, unit, variables};

variables! {
    /// Rate limit.
    pub struct RateLimit {
        effect limit: f64 = 0.0, "dtau_max", "τ̇_max", unit::NEWTON_METRE_PER_SECOND,
            "Largest rate of change of the torque; off (no limit) at 0.", min = 0.0;
    }
}

impl Stage for RateLimit {
    fn check(&self) -> Result<(), ModelError> {
        non_negative("dtau_max", self.limit)
    }

    fn settle(&self, memory: &mut Memory, input: f64) -> f64 {
        memory.limited = input;
        input
    }

    fn feedthrough(&self, _: f64) -> f64 {
        if self.limit == 0.0 { 1.0 } else { 0.0 }
    }

    fn shape(&self, memory: &Memory, _: f64, torque: &mut Signal, span: &mut f64) {
        let limit = self.limit;
        if limit == 0.0 {
            return;
        }
        let Signal { value, rate, .. } = *torque; // a line: the lag comes later
        let gap = value - memory.limited;
        // What is left of a gap that was just closed: rounding, and a stretch that can't be shorter than it is.
        let closed =
            4.0 * f64::EPSILON * (value.abs() + memory.limited.abs()) + 2.0 * SHORTEST * (limit + rate.abs());
        if gap.abs() <= closed {
            if rate.abs() > limit {
                torque.rate = limit.copysign(rate);
            }
            return;
        }
        let chase = limit.copysign(gap);
        let closing = chase - rate;
        if closing * gap > 0.0 {
            *span = span.min(gap / closing);
        }
        *torque = Signal::linear(memory.limited, chase);
    }

    fn remember(&self, memory: &mut Memory, ended: &Ended<'_>) {
        memory.limited = ended.torque();
    }
}
