//! The signal unit: what happens to a value on its way between two ports, as a unit to put between them.
//!
//! ```text
//! u ──► delay ─► saturation ─► rate limit ─► lag ─► gain ─► bias ─► drift ──►(+)──► y
//! d ───────────────────────────────────────────────────────────────────────────┘
//! ```
//!
//! Before an input it is an actuator, behind an output a sensor (its offset is `bias`); with nothing but a delay it is a delay
//! line. The order is that of the plant's actuator, and so is what comes out: y at a communication point is what
//! the plant's `tau_applied` is there. Each effect at its neutral value leaves the bits alone; all off: y = u + d, and u to
//! the last bit where d is 0.
//!
//! All of it is computed in closed form, so that y doesn't depend on how a master cuts time into steps, as long as the
//! signal is the same. What the signal is between communication points:
//!
//! - The value set before a step from t to t + h holds over it (`linear` = false; what FMI says of an input), or is the value
//!   at t + h, with a line to it from the one before (`linear` = true). At a jump the value before it counts as the one there:
//!   a delay of a whole number of steps gives the value of so many steps ago, one of half a step still the newest.
//! - With `fmi2SetRealInputDerivatives` it is the value at t, and the signal goes on from there with the rate given.
//!
//! Before the start u has always been what it was at the start: delay, rate limit and lag begin settled there.

#![forbid(unsafe_code)]

pub mod delay;
pub mod line;
mod variables;

pub use variables::{Effects, Hold, Inputs, Outputs, Variables};

use delay::DelayLine;
use fmi2_export::{Dependencies, Description, Experiment, Log, Model, ModelError, Step, serde};
use line::Line;

/// What the unit remembers.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
#[serde(crate = "fmi2_export::serde")]
pub struct SignalEffects {
    /// Where drift begins, s.
    start: f64,
    /// The input at the communication point.
    newest: f64,
    delay: DelayLine,
    /// Output of the rate limit.
    limited: f64,
    /// Output of the lag.
    lagged: f64,
}

impl SignalEffects {
    /// Sends what the input does over a step through the stages that need time.
    fn advance(&mut self, effects: &Effects, step: &Step<'_>, input: Line) {
        let Self { delay, limited, lagged, .. } = self;
        let mut shape = |line: Line| {
            line.saturate(effects.saturation, |line| {
                line.limit_rate(effects.rate_limit, limited, |line| *lagged = line.lag(effects.lag, *lagged));
            });
        };
        if effects.delay == 0.0 {
            shape(input)
        } else {
            delay.pass(step, effects.delay, input, shape)
        }
        self.newest = input.last;
    }

    /// Writes y at a time, from what the lag gives and the disturbance there.
    fn answer(&self, variables: &mut Variables, time: f64, disturbance: f64) {
        let effects = &variables.effects;
        let mut value = self.lagged;
        if effects.gain != 1.0 {
            value *= effects.gain;
        }
        if effects.bias != 0.0 {
            value += effects.bias;
        }
        if effects.drift != 0.0 {
            value += effects.drift * (time - self.start);
        }
        if disturbance != 0.0 {
            value += disturbance;
        }
        variables.outputs.value = value;
    }
}

impl Model for SignalEffects {
    type Variables = Variables;

    fn description() -> Description {
        Description {
            identifier: "signal_effects",
            description: "What happens to a value between two ports: delay, saturation, rate limit, lag, gain, bias, \
                          drift, disturbance",
            version: env!("CARGO_PKG_VERSION"),
            stop_time: 10.0,
            step_size: 0.01,
            provides_derivatives: true,
            log_categories: &[],
        }
    }

    fn dependencies(_: &str) -> Dependencies {
        Dependencies {
            while_stepping: &["u", "d"],
            at_start: Some(&["u", "d", "saturation", "gain", "bias"]),
        }
    }

    fn initialize(
        &mut self,
        variables: &mut Variables,
        experiment: &Experiment,
        _: &mut dyn Log,
    ) -> Result<(), ModelError> {
        let Inputs { value, disturbance } = variables.inputs;
        let limit = variables.effects.saturation;
        let settled = if limit > 0.0 { value.clamp(-limit, limit) } else { value };
        let delay = DelayLine::new(experiment.start, value);
        *self = Self { start: experiment.start, newest: value, delay, limited: settled, lagged: settled };
        self.answer(variables, experiment.start, disturbance);
        Ok(())
    }

    fn step(
        &mut self,
        variables: &mut Variables,
        step: &Step<'_>,
        _: &mut dyn Log,
    ) -> Result<(), ModelError> {
        let Inputs { value, disturbance } = variables.inputs;
        let size = step.size();
        let (first, last) = match step.input_rate("u") {
            Some(rate) => (value, value + rate * size),
            None if variables.hold.linear => (self.newest, value),
            None => (value, value),
        };
        self.advance(&variables.effects, step, Line { span: size, first, last });
        let disturbance = step.input_rate("d").map_or(disturbance, |rate| disturbance + rate * size);
        self.answer(variables, step.to, disturbance);
        Ok(())
    }

    /// y follows u at once only where no effect needs time or cuts it off.
    fn derivative(&self, variables: &Variables, unknown: &str, known: &str) -> Option<f64> {
        let Effects { delay, saturation, rate_limit, lag, gain, .. } = variables.effects;
        let needs_time = [delay, rate_limit, lag].iter().any(|effect| *effect != 0.0);
        let is_cut = saturation != 0.0 && self.newest.abs() >= saturation;
        match (unknown, known) {
            ("y", "u") => Some(if needs_time || is_cut { 0.0 } else { gain }),
            ("y", "d") => Some(1.0),
            _ => None,
        }
    }
}
