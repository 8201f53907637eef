//! First-order lag between command and torque: T·du/dt = τ − u, solved exactly for a command that is a line.
//!
//! u(s) = v − rT + r·s + (u₀ − v + rT)·e^(−s/T). Starts from `tau_0`.

use super::{non_negative, refused};
use crate::actuator::{Ended, Memory, Signal, Stage};
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

    fn shape(&self, memory: &Memory, _: f64, torque: &mut Signal, _: &mut f64) {
        if self.time == 0.0 {
            return;
        }
        torque.value -= torque.rate * self.time; // where it settles
        torque.transient = memory.lagged - torque.value;
        torque.decay = 1.0 / self.time;
    }

    fn remember(&self, memory: &mut Memory, ended: &Ended<'_>) {
        memory.lagged = ended.torque();
    }
}
