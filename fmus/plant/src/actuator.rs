//! The way of the torque from command to joint, solved in closed form.
//!
//! Within a communication step the command is a line. Delay, saturation and rate limit turn it into lines with
//! corners, the lag into lines with decaying transients. The plant is integrated from corner to corner, so that the
//! integrator only ever meets smooth torques.

use fmi2_export::{ModelError, serde};
use std::collections::VecDeque;

/// The shortest stretch, s. Time stamps carry rounding of about 1e-14 s; corners closer than this are one.
pub const SHORTEST: f64 = 1e-12;

/// A torque over a stretch of time: value + rate·s + transient·e^(−decay·s), s from the stretch's beginning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Signal {
    /// N·m
    pub value: f64,
    /// N·m/s
    pub rate: f64,
    /// N·m
    pub transient: f64,
    /// 1/s
    pub decay: f64,
}

impl Signal {
    /// A line.
    pub fn linear(value: f64, rate: f64) -> Signal {
        Signal { value, rate, transient: 0.0, decay: 0.0 }
    }

    /// A constant.
    pub fn constant(value: f64) -> Signal {
        Signal::linear(value, 0.0)
    }

    /// The torque `s` seconds after the beginning. Terms that are zero are left out, not added.
    pub fn at(&self, s: f64) -> f64 {
        let mut torque = self.line(s);
        if self.transient != 0.0 {
            torque += self.transient * libm::exp(-self.decay * s);
        }
        torque
    }

    /// The same without the transient.
    pub fn line(&self, s: f64) -> f64 {
        if self.rate != 0.0 { self.value + self.rate * s } else { self.value }
    }
}

/// A command and the time from which it holds.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(crate = "fmi2_export::serde")]
pub struct Command {
    /// s
    pub from: f64,
    /// N·m, at `from`
    pub value: f64,
    /// N·m/s
    pub rate: f64,
}

/// What the actuator remembers between stretches.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(crate = "fmi2_export::serde")]
pub struct Memory {
    /// Commands on their way through the delay, the oldest first. At most one a step within the delay, and only
    /// where the command changes.
    pub commands: VecDeque<Command>,
    /// Command before the first one in the delay, N·m.
    pub before: f64,
    /// Output of the rate limit, N·m.
    pub limited: f64,
    /// Output of the lag, N·m.
    pub lagged: f64,
}

impl Memory {
    /// Lines a command up for the delay.
    pub fn line_up(&mut self, command: Command) {
        match self.commands.back_mut() {
            Some(last) if last.value == command.value && last.rate == 0.0 && command.rate == 0.0 => {}
            Some(last) if last.from == command.from => *last = command,
            _ => self.commands.push_back(command),
        }
    }
}

/// A stage of the actuator.
pub trait Stage {
    /// Refuses parameters that can't be used.
    fn check(&self) -> Result<(), ModelError>;

    /// What comes out where `input` (N·m) has gone in for ever, and is remembered of that.
    fn settle(&self, memory: &mut Memory, input: f64) -> f64 {
        let _ = memory;
        input
    }

    /// A command goes in from a time on (s), at this value (N·m) and rate (N·m/s).
    fn accept(&self, memory: &mut Memory, command: Command) {
        let _ = (memory, command);
    }

    /// How much of a change of `input` (N·m) comes out at once: ∂output/∂input.
    fn feedthrough(&self, input: f64) -> f64;

    /// Makes what comes out of what goes in from `now` on. Shortens `span` to where the output has a corner.
    fn shape(&self, memory: &Memory, now: f64, torque: &mut Signal, span: &mut f64);

    /// The stretch ended.
    fn remember(&self, memory: &mut Memory, ended: &Ended<'_>) {
        let _ = (memory, ended);
    }
}

/// How a stretch ended for a stage.
pub struct Ended<'a> {
    /// What came out over the stretch.
    pub output: &'a Signal,
    /// Length of the stretch, s.
    pub span: f64,
    /// The time at its end, s.
    pub end: f64,
}

impl Ended<'_> {
    /// What came out at the end, N·m.
    pub fn torque(&self) -> f64 {
        self.output.at(self.span)
    }
}
