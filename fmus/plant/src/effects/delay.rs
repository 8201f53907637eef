//! Dead time between command and torque: u(t) = τ(t − T).
//!
//! Commands wait in a line, each with the time from which it holds, so that the delay need not be a multiple of
//! anything. Before the first command there is `tau_0`.

use super::non_negative;
use crate::actuator::{Command, Ended, Memory, SHORTEST, Signal, Stage};
use fmi2_export::{ModelError, unit, variables};

variables! {
    /// Dead time.
    pub struct Delay {
        fixed_effect time: f64 = 0.0, "tau_delay", "T_τ", unit::SECOND,
            "Dead time of the actuator; off at 0.", min = 0.0;
    }
}

impl Stage for Delay {
    fn check(&self) -> Result<(), ModelError> {
        non_negative("tau_delay", self.time)
    }

    fn settle(&self, memory: &mut Memory, input: f64) -> f64 {
        memory.before = input;
        input
    }

    fn accept(&self, memory: &mut Memory, command: Command) {
        if self.time != 0.0 {
            memory.line_up(command);
        }
    }

    fn feedthrough(&self, _: f64) -> f64 {
        if self.time == 0.0 { 1.0 } else { 0.0 }
    }

    fn shape(&self, memory: &Memory, now: f64, torque: &mut Signal, span: &mut f64) {
        if self.time == 0.0 {
            return;
        }
        *torque = Signal::constant(memory.before);
        for command in &memory.commands {
            let wait = command.from + self.time - now;
            if wait > SHORTEST {
                *span = span.min(wait);
                break;
            }
            *torque = Signal::linear(command.value - command.rate * wait, command.rate);
        }
    }

    fn remember(&self, memory: &mut Memory, ended: &Ended<'_>) {
        if self.time == 0.0 {
            memory.commands.clear();
        }
        // The front command is needed until the one behind it arrives.
        while memory.commands.get(1).is_some_and(|next| next.from + self.time - ended.end <= SHORTEST) {
            memory.commands.pop_front();
        }
    }
}
