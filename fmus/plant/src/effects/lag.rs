//! First-order lag between command and torque: T·du/dt = τ − u, solved exactly for a command that is a line.
//!
//! u(s) = v − rT + r·s + (u₀ − v + rT)·e^(−s/T). Starts from `tau_0`.

use super::{non_negative, refused};
use crate::actuator::{Memory, Signal, Stage};
use fmi2_export::{ModelError, unit, variables};

variables! {
    /// First-order lag.
    pub struct Lag {
        effect time: f64 = 0.0, "T_act", "T_a", unit::SECOND,
            "Time constant of the actuator's first-order lag; off at 0.", min = 0.0;
    }
}

impl Stage for Lag {
    fn check(&self) -> Result<(), ModelError> {
        non_negative("T_act", self.time)?;
        if self.time.is_subnormal() {
            return Err(refused("T_act", self.time, "must be 0 or so large that its inverse is finite"));
        }
        Ok(())
    }

    fn settle(&self, memory: &mut Memory, input: f64) -> f64 {
        memory.lagged = input;
        input
    }

    fn feedthrough(&self, _: f64) -> f64 {
        if self.time == 0.0 { 1.0 } else { 0.0 }
    }

    fn shape(&self, memory: &Memory, _: f64, input: Signal, _: &mut f64) -> Signal {
        if self.time == 0.0 {
            return input;
        }
        let settled = input.value - input.rate * self.time;
        Signal {
            value: settled,
            rate: input.rate,
            transient: memory.lagged - settled,
            decay: 1.0 / self.time,
        }
    }

    fn remember(&self, memory: &mut Memory, output: f64, _: f64) {
        memory.lagged = output;
    }
}
