//! The residual unit: what a data set asks for beside every listed effect, as labelled torques on the plant.
//!
//! ```text
//! q1 q2 dq1 dq2 ──► terms of q1, dq1 ───────────► roll ──►(+)──► tau_1
//!                                                          │−
//!                └► terms of q2 − q1, dq2 − dq1 ► joint ───┴►(+)──► tau_2
//! tau_1_in, tau_2_in ────────────────────────────────────► both (+)
//! ```
//!
//! It stands between the plant's state and the plant's external torques, past the actuator: a command is left alone.
//! The diagnosis writes it into `amended.toml` where no listed effect explains what is left. It is a correction, no
//! explanation: its coefficients say which shape the rest has, not what makes it. With all coefficients 0 torques pass
//! unchanged, to the last bit.
//!
//! Torques are those at the state at the end of a step; a master that steps the plant first holds them over the plant's
//! next step, which delays them by half a step on average.

#![forbid(unsafe_code)]

pub mod terms;
mod variables;

pub use variables::{Common, Inputs, Joint, Outputs, Roll, Variables};

use fmi2_export::{
    Dependencies, Description, Experiment, Log, Model, ModelError, Step, Table, Variable, serde,
};

/// The unit has no memory.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
#[serde(crate = "fmi2_export::serde")]
pub struct Residual {}

/// Adds what there is to add: without it the bits stay.
fn with(torque: f64, correction: Option<f64>) -> f64 {
    correction.map_or(torque, |correction| torque + correction)
}

/// Writes the outputs. If the master gave rates of the inputs, the values at the end of the step are meant.
fn answer(variables: &mut Variables, step: Option<&Step<'_>>) -> Result<(), ModelError> {
    check(variables)?;
    let inputs = &variables.inputs;
    let at_end = |name, value: f64| match step.and_then(|step| Some((step.input_rate(name)?, step.size()))) {
        Some((rate, size)) => value + rate * size,
        None => value,
    };
    let q = [at_end("q1", inputs.link1_angle), at_end("q2", inputs.link2_angle)];
    let dq = [at_end("dq1", inputs.link1_rate), at_end("dq2", inputs.link2_rate)];
    let given = [at_end("tau_1_in", inputs.link1_given), at_end("tau_2_in", inputs.link2_given)];
    let smooth = variables.common.smooth;
    let roll = variables.roll.axis().torque(q[0], dq[0], smooth);
    let joint = variables.joint.axis().torque(q[1] - q[0], dq[1] - dq[0], smooth);
    let outputs = Outputs {
        link1_torque: with(with(given[0], roll), joint.map(|joint| -joint)),
        link2_torque: with(given[1], joint),
        roll_torque: roll.unwrap_or(0.0),
        joint_torque: joint.unwrap_or(0.0),
    };
    let shown = [outputs.link1_torque, outputs.link2_torque, outputs.roll_torque, outputs.joint_torque];
    if !shown.iter().all(|value| value.is_finite()) {
        return Err(ModelError::Failed(format!("numbers overflow: {outputs:?} for {inputs:?}")));
    }
    variables.outputs = outputs;
    Ok(())
}

/// Refuses inputs and parameters that can't be used.
fn check(variables: &Variables) -> Result<(), ModelError> {
    let refused = |variable: &Variable, value: f64, expected: &str| {
        Err(ModelError::Value { name: variable.name, value: value.to_string(), expected: expected.into() })
    };
    for (index, variable) in declared().iter().enumerate() {
        let Some(fmi2_export::Slot::Real(value)) = variables.get(index) else { continue };
        let positive = matches!(variable.name, "smooth" | "slow_roll" | "slow_joint");
        match *value {
            value if !value.is_finite() => return refused(variable, value, "must be finite"),
            value if positive && value <= 0.0 => return refused(variable, value, "must be > 0"),
            value if variable.min.is_some_and(|min| value < min) => {
                return refused(variable, value, "must be >= 0");
            }
            _ => {}
        }
    }
    Ok(())
}

/// The declarations, made once.
fn declared() -> &'static [Variable] {
    static DECLARED: std::sync::OnceLock<Vec<Variable>> = std::sync::OnceLock::new();
    DECLARED.get_or_init(Variables::variables)
}

impl Model for Residual {
    type Variables = Variables;

    fn description() -> Description {
        Description {
            identifier: "acrobot_residual",
            description: "Labelled correction of the acrobot's torques: a linear sum of simple terms, no explanation",
            version: env!("CARGO_PKG_VERSION"),
            stop_time: 30.0,
            step_size: 1.0 / 600.0,
            provides_derivatives: true,
            log_categories: &[],
        }
    }

    fn dependencies(output: &str) -> Dependencies {
        let while_stepping: &'static [&'static str] = match output {
            "roll" => &["q1", "dq1"],
            "joint" => &["q1", "q2", "dq1", "dq2"],
            "tau_1" => &["q1", "q2", "dq1", "dq2", "tau_1_in"],
            _ => &["q1", "q2", "dq1", "dq2", "tau_2_in"],
        };
        Dependencies { while_stepping, at_start: None }
    }

    fn initialize(
        &mut self,
        variables: &mut Variables,
        _: &Experiment,
        _: &mut dyn Log,
    ) -> Result<(), ModelError> {
        answer(variables, None)
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
        answer(variables, Some(step))
    }

    /// Exact, at the inputs as they are.
    fn derivative(&self, variables: &Variables, unknown: &str, known: &str) -> Option<f64> {
        let inputs = &variables.inputs;
        let smooth = variables.common.smooth;
        let [roll_x, roll_v] = variables.roll.axis().slopes(inputs.link1_angle, inputs.link1_rate, smooth);
        let across = (inputs.link2_angle - inputs.link1_angle, inputs.link2_rate - inputs.link1_rate);
        let [joint_x, joint_v] = variables.joint.axis().slopes(across.0, across.1, smooth);
        let (roll, joint, given) = match known {
            "q1" => (roll_x, -joint_x, [0.0, 0.0]),
            "q2" => (0.0, joint_x, [0.0, 0.0]),
            "dq1" => (roll_v, -joint_v, [0.0, 0.0]),
            "dq2" => (0.0, joint_v, [0.0, 0.0]),
            "tau_1_in" => (0.0, 0.0, [1.0, 0.0]),
            "tau_2_in" => (0.0, 0.0, [0.0, 1.0]),
            _ => return None,
        };
        match unknown {
            "roll" => Some(roll),
            "joint" => Some(joint),
            "tau_1" => Some(given[0] + roll - joint),
            "tau_2" => Some(given[1] + joint),
            _ => None,
        }
    }
}
