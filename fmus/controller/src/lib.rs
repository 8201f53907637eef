//! The controller: pseudolinearization along the manifold of equilibria, Section 3.1, as a co-simulation unit.
//!
//! ```text
//! q1 q2 dq1 dq2 ──► schedule on q2 (B-splines from theta_*) ──► y₁..y₄ ──► v(z_desired) ──► tau (held), z_hat
//! frame ──────────► new estimate?
//! ```
//!
//! The torque is computed when a new estimate arrives and held until the next. An estimate is new when `frame` has
//! changed; with `frame` = -1 (not connected) at every communication point. Before the first estimate (`frame` = 0)
//! the torque is 0.
//!
//! Beyond the table's ends (abs(q2) > 2.60 rad, or where controllability ends) the schedule stays at the end and
//! the law goes on linearly from that equilibrium: the links have touched long before.

#![forbid(unsafe_code)]

pub mod law;
pub mod schedule;
pub mod spline;
mod variables;

pub use variables::{Inputs, Outputs, Parameters, Variables};

use fmi2_export::{Dependencies, Description, Experiment, Log, Model, ModelError, Step, serde};
use schedule::Schedule;
use std::sync::Arc;

/// The controller's state; the torque that it holds is its output.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
#[serde(crate = "fmi2_export::serde")]
pub struct Controller {
    /// `frame` of the estimate to which the torque belongs; 0 before the first.
    last_frame: i32,
    /// Rebuilt from theta where it is missing.
    #[serde(skip)]
    schedule: Option<Arc<Schedule>>,
}

impl Controller {
    /// The tables for the present theta.
    fn schedule(&mut self, parameters: &Parameters) -> Result<&Schedule, ModelError> {
        let theta = parameters.theta();
        if self.schedule.as_ref().is_none_or(|schedule| *schedule.theta() != theta) {
            let built = Schedule::new(&theta)
                .map_err(|error| ModelError::Failed(format!("theta_* allow no controller: {error}")))?;
            self.schedule = Some(Arc::new(built));
        }
        Ok(self.schedule.as_ref().expect("built above if it was missing")) // so it can't be missing
    }

    /// Computes the torque if an estimate has arrived. If the master gave rates of the inputs, the estimate at the
    /// end of the step is meant.
    fn answer(&mut self, variables: &mut Variables, step: Option<&Step<'_>>) -> Result<(), ModelError> {
        check(variables)?;
        let inputs = &variables.inputs;
        let frame = inputs.frame;
        let is_new = frame == -1 || frame != self.last_frame;
        self.last_frame = frame;
        let schedule = self.schedule(&variables.parameters)?;
        let at_end =
            |name, value: f64| match step.and_then(|step| Some((step.input_rate(name)?, step.size()))) {
                Some((rate, size)) => value + rate * size,
                None => value,
            };
        if frame == 0 {
            variables.outputs = Outputs::default();
        } else if is_new {
            let answer = law::torque(
                schedule,
                &variables.parameters.polynomial(),
                [at_end("q1", inputs.link1_angle), at_end("q2", inputs.link2_angle)],
                [at_end("dq1", inputs.link1_rate), at_end("dq2", inputs.link2_rate)],
                at_end("z_desired", inputs.desired_place),
            );
            if !(answer.torque.is_finite() && answer.place.is_finite()) {
                let (torque, place) = (answer.torque, answer.place);
                return Err(ModelError::Failed(format!(
                    "tau = {torque} N.m, z_hat = {place} are not finite: the law overflows for {inputs:?}"
                )));
            }
            variables.outputs = Outputs { torque: answer.torque, estimated_place: answer.place };
        }
        Ok(())
    }
}

/// Refuses inputs and poles that can't be used.
fn check(variables: &Variables) -> Result<(), ModelError> {
    let (inputs, parameters) = (&variables.inputs, &variables.parameters);
    let refused =
        |name, value: String, expected: &str| ModelError::Value { name, value, expected: expected.into() };
    let finite = [
        ("q1", inputs.link1_angle),
        ("q2", inputs.link2_angle),
        ("dq1", inputs.link1_rate),
        ("dq2", inputs.link2_rate),
        ("z_desired", inputs.desired_place),
        ("zeta_1", parameters.zeta_1),
        ("zeta_2", parameters.zeta_2),
        ("theta_1", parameters.theta_1),
        ("theta_2", parameters.theta_2),
        ("theta_5", parameters.theta_5),
        ("theta_7", parameters.theta_7),
        ("theta_8", parameters.theta_8),
        ("theta_9", parameters.theta_9),
        ("theta_10", parameters.theta_10),
    ];
    if let Some((name, value)) = finite.into_iter().find(|(_, value)| !value.is_finite()) {
        return Err(refused(name, value.to_string(), "must be finite"));
    }
    let positive = [("omega_1", parameters.omega_1), ("omega_2", parameters.omega_2)];
    if let Some((name, value)) = positive.into_iter().find(|(_, value)| !(*value > 0.0 && value.is_finite()))
    {
        return Err(refused(name, value.to_string(), "must be finite and > 0"));
    }
    if inputs.frame < -1 {
        let expected = "must be -1 (not connected), 0 (no estimate yet) or the number of an estimate";
        return Err(refused("frame", inputs.frame.to_string(), expected));
    }
    Ok(())
}

impl Model for Controller {
    type Variables = Variables;

    fn description() -> Description {
        Description {
            identifier: "acrobot_controller",
            description: "Pseudolinearizing controller of the free-standing acrobot along its equilibrium manifold",
            version: env!("CARGO_PKG_VERSION"),
            stop_time: 30.0,
            step_size: 1.0 / 600.0,
            provides_derivatives: true,
            log_categories: &[],
        }
    }

    fn dependencies(output: &str) -> Dependencies {
        let while_stepping: &'static [&'static str] = match output {
            "z_hat" => &["q1", "q2", "dq1", "dq2", "frame"],
            _ => &["q1", "q2", "dq1", "dq2", "z_desired", "frame"],
        };
        Dependencies { while_stepping, at_start: None }
    }

    fn renewed(self) -> Self {
        Self { schedule: self.schedule, ..Self::default() }
    }

    fn initialize(
        &mut self,
        variables: &mut Variables,
        _: &Experiment,
        _: &mut dyn Log,
    ) -> Result<(), ModelError> {
        self.last_frame = 0;
        variables.outputs = Outputs::default();
        self.answer(variables, None)
    }

    fn step(
        &mut self,
        variables: &mut Variables,
        step: &Step<'_>,
        _: &mut dyn Log,
    ) -> Result<(), ModelError> {
        if let Some((name, rate)) = step.input_rates.iter().find(|(_, rate)| !rate.is_finite()) {
            let expected = "must be finite, being the rate of this input".into();
            return Err(ModelError::Value { name, value: rate.to_string(), expected });
        }
        self.answer(variables, Some(step))
    }

    /// That of the law at the inputs as they are, as an estimate that is new has it; none before the first one.
    fn derivative(&self, variables: &Variables, unknown: &str, known: &str) -> Option<f64> {
        let inputs = &variables.inputs;
        let known = law::INPUTS.iter().position(|name| *name == known)?;
        let outputs = ["tau", "z_hat"].iter().position(|name| *name == unknown)?;
        if inputs.frame == 0 {
            return Some(0.0);
        }
        // There since the first answer, but where the state came as bytes.
        let theta = variables.parameters.theta();
        let kept = self.schedule.clone().filter(|schedule| *schedule.theta() == theta);
        let schedule = kept.or_else(|| Schedule::new(&theta).ok().map(Arc::new))?;
        let slopes = law::slopes(
            &schedule,
            &variables.parameters.polynomial(),
            [inputs.link1_angle, inputs.link2_angle],
            [inputs.link1_rate, inputs.link2_rate],
        );
        Some(slopes[outputs][known])
    }
}
