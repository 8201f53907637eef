//! The plant: the free-standing acrobot of Section 3.1, eq. (12), as a co-simulation unit.
//!
//! ```text
//! tau   ──► delay ─► saturation ─► rate limit ─► lag ─► gain ─► bias ──► tau_applied ─┐
//! tau_1, tau_2 ──────────────────────────────────────────────────────────────────────┤
//!                    M(q)·q̈ + c(q, q̇) = [−1, 1]ᵀ·tau_applied + [tau_1, tau_2]ᵀ + friction   (12)
//!                                                                          └──► q1 q2 dq1 dq2 z contact
//! ```
//!
//! State: q₁, q₂, q̇₁, q̇₂, absolute angles in rad from the upright vertical, positive towards +u; the commands in
//! the actuator's delay, the outputs of its rate limit and lag. The equations lie in the crate `mechanics`, what the
//! paper's plant lacks in [`effects`].
//!
//! Inputs hold over a step, or run along a line if the master gives their rates. The actuator starts from
//! `tau_0`, at rest there.

#![forbid(unsafe_code)]

pub mod actuator;
mod derivative;
mod dynamics;
pub mod effects;
mod integrator;
mod places;
mod variables;

pub use integrator::TOLERANCE;
pub use variables::{Inputs, Locals, Outputs, Parameters, Solver, Variables};

use actuator::{Command, Memory, SHORTEST, Signal};
use dynamics::Dynamics;
use effects::{Motion, finite, positive};
use fmi2_export::{Dependencies, Description, Experiment, Log, Model, ModelError, Step, serde};
use integrator::{End, LONGEST_STEP, State, Stretch};
use places::Places;

/// The plant's state.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
#[serde(crate = "fmi2_export::serde")]
pub struct Plant {
    state: State,
    contact: bool,
    actuator: Memory,
    /// Step size that the integrator would try next, s.
    next_step: f64,
    /// z(q2), rebuilt from theta where it is missing.
    #[serde(skip)]
    places: Places,
}

impl Plant {
    fn motion(&self) -> Motion {
        let [q1, q2, dq1, dq2] = self.state;
        Motion { q: [q1, q2], dq: [dq1, dq2] }
    }

    /// From here on the links touch.
    fn hold(&mut self, variables: &Variables, time: f64, log: &mut dyn Log) {
        self.contact = true;
        self.state[2] = 0.0;
        self.state[3] = 0.0;
        let (q2, limit) = (self.state[1], variables.parameters.contact_angle);
        log.log("logEvents", &|| {
            format!("contact at t = {time} s: q2 = {q2} rad reached q2_max = {limit} rad; the state is held")
        });
    }

    /// Sends the torque through the actuator and integrates, corner by corner.
    fn advance(
        &mut self,
        variables: &Variables,
        step: &Step<'_>,
        log: &mut dyn Log,
    ) -> Result<Finish, ModelError> {
        let rates = ["tau_1", "tau_2"].map(|name| step.input_rate(name).unwrap_or(0.0));
        let dynamics = Dynamics::new(variables, rates);
        let (command, rate) = (variables.inputs.torque, step.input_rate("tau").unwrap_or(0.0));
        let effects = &variables.effects;
        effects.accept(&mut self.actuator, Command { from: step.from, value: command, rate });
        let size = step.size();
        let mut offset = 0.0;
        loop {
            let left = size - offset;
            let input = Signal::linear(if rate == 0.0 { command } else { command + rate * offset }, rate);
            let mut passage = effects.pass(&self.actuator, step.from + offset, input, left);
            passage.span = if passage.span + SHORTEST >= left { left } else { passage.span.max(SHORTEST) };
            let mut accelerations = [0.0; 2];
            if !self.contact {
                let torque = passage.torque();
                let stretch = Stretch {
                    dynamics: &dynamics,
                    torque,
                    offset,
                    span: passage.span,
                    contact_angle: variables.parameters.contact_angle,
                    tolerance: variables.solver.tolerance,
                };
                match stretch.integrate(&mut self.state, &mut self.next_step)? {
                    End::Reached(reached) => accelerations = reached,
                    End::Contact(after) => self.hold(variables, step.from + offset + after, log),
                }
            }
            let torque = passage.torque().at(passage.span);
            let at_end = passage.span == left;
            offset = if at_end { size } else { offset + passage.span };
            effects.remember(&mut self.actuator, &passage, if at_end { step.to } else { step.from + offset });
            if at_end {
                return Ok(Finish { torque, accelerations });
            }
        }
    }

    fn write_outputs(
        &mut self,
        variables: &mut Variables,
        finish: Finish,
        log: &mut dyn Log,
    ) -> Result<(), ModelError> {
        let [q1, q2, dq1, dq2] = self.state;
        let place = self.places.at(&variables.parameters.theta(), log).map_or(0.0, |place| place.z(q2));
        let energy = Dynamics::new(variables, [0.0; 2]).energy(&self.motion());
        variables.outputs = Outputs {
            link1_angle: q1,
            link2_angle: q2,
            link1_rate: dq1,
            link2_rate: dq2,
            applied_torque: finish.torque,
            place,
            contact: self.contact,
        };
        let [link1_acceleration, link2_acceleration] = finish.accelerations;
        variables.locals = Locals { link1_acceleration, link2_acceleration, energy };
        let shown = [q1, q2, dq1, dq2, finish.torque, link1_acceleration, link2_acceleration, energy];
        if shown.iter().all(|value| value.is_finite()) {
            return Ok(());
        }
        Err(ModelError::Failed(format!(
            "numbers overflow: {:?}, {:?} for {:?}",
            variables.outputs, variables.locals, variables.inputs
        )))
    }
}

/// What a step ends with beside the state.
struct Finish {
    torque: f64,
    accelerations: [f64; 2],
}

/// Refuses inputs and parameters that can't be used.
fn check(variables: &Variables) -> Result<(), ModelError> {
    let (inputs, parameters) = (&variables.inputs, &variables.parameters);
    finite("tau", inputs.torque)?;
    finite("tau_1", inputs.link1_torque)?;
    finite("tau_2", inputs.link2_torque)?;
    positive("theta_1", parameters.theta_1)?;
    finite("theta_2", parameters.theta_2)?;
    positive("theta_5", parameters.theta_5)?;
    finite("theta_7", parameters.theta_7)?;
    finite("theta_8", parameters.theta_8)?;
    finite("theta_9", parameters.theta_9)?;
    finite("theta_10", parameters.theta_10)?;
    positive("q2_max", parameters.contact_angle)?;
    variables.effects.check()
}

impl Model for Plant {
    type Variables = Variables;

    fn description() -> Description {
        Description {
            identifier: "acrobot_plant",
            description: "Free-standing acrobot: eq. (12) with Table 2, friction and actuator effects",
            version: env!("CARGO_PKG_VERSION"),
            stop_time: 30.0,
            step_size: 1.0 / 600.0,
            provides_derivatives: true,
            log_categories: &[],
        }
    }

    fn dependencies(output: &str) -> Dependencies {
        derivative::dependencies(output)
    }

    fn renewed(self) -> Self {
        Self { places: self.places.renewed(), ..Self::default() }
    }

    fn initialize(
        &mut self,
        variables: &mut Variables,
        experiment: &Experiment,
        log: &mut dyn Log,
    ) -> Result<(), ModelError> {
        let parameters = &variables.parameters;
        let start = [
            ("q1_0", parameters.link1_start),
            ("q2_0", parameters.link2_start),
            ("dq1_0", parameters.link1_start_rate),
            ("dq2_0", parameters.link2_start_rate),
        ];
        for (name, value) in start {
            finite(name, value)?;
        }
        finite("tau_0", parameters.start_torque)?;
        variables.solver.check()?;
        check(variables)?;
        let actuator = variables.effects.settled(parameters.start_torque);
        let places = std::mem::take(&mut self.places); // a table for the same theta can be used again
        *self = Plant {
            state: start.map(|(_, value)| value),
            actuator,
            next_step: LONGEST_STEP,
            places,
            ..Plant::default()
        };

        let command = Signal::constant(variables.inputs.torque);
        let passage = variables.effects.pass(&self.actuator, experiment.start, command, f64::INFINITY);
        let torque = passage.torque().at(0.0);
        let equation = Dynamics::new(variables, [0.0; 2]).equation(&self.motion(), torque, 0.0);
        if !equation.is_regular() {
            let [q1, q2, ..] = self.state;
            return Err(ModelError::Failed(format!(
                "the inertia matrix is not positive definite at q1_0 = {q1} rad, q2_0 = {q2} rad: M11 = {} kg.m2, \
                 det M = {} kg2.m4, both must be > 0; see theta_1, theta_2, theta_5, theta_7, theta_8",
                equation.m11,
                equation.determinant()
            )));
        }
        let mut accelerations = equation.accelerations();
        if self.state[1].abs() >= variables.parameters.contact_angle {
            self.hold(variables, experiment.start, log);
            accelerations = [0.0; 2];
        }
        self.write_outputs(variables, Finish { torque, accelerations }, log)
    }

    fn step(
        &mut self,
        variables: &mut Variables,
        step: &Step<'_>,
        log: &mut dyn Log,
    ) -> Result<(), ModelError> {
        check(variables)?;
        if let Some((name, rate)) = step.input_rates.iter().find(|(_, rate)| !rate.is_finite()) {
            let expected = "must be finite, being the rate of this input".into();
            return Err(ModelError::Value { name, value: rate.to_string(), expected });
        }
        let finish = self.advance(variables, step, log)?;
        self.write_outputs(variables, finish, log)
    }

    fn derivative(&self, variables: &Variables, unknown: &str, known: &str) -> Option<f64> {
        derivative::derivative(self, variables, unknown, known)
    }
}
