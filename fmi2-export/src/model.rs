//! What the physics of a unit provides; the shell does the rest.

use crate::table::Table;
use serde::{Deserialize, Serialize, de::DeserializeOwned};

/// A co-simulation unit.
///
/// A value of this type is the unit's *internal* state; the variables lie beside it in [`Model::Variables`]. Both
/// together are what `fmi2GetFMUstate` copies, so a clone must restore the unit to the bit.
pub trait Model: Default + Clone + Send + Serialize + DeserializeOwned + 'static {
    /// All FMI variables of the unit.
    type Variables: Table + Serialize + DeserializeOwned;

    /// What the description says of the unit as a whole.
    fn description() -> Description;

    /// What an output (or derivative) depends on directly.
    fn dependencies(output: &str) -> Dependencies;

    /// Reads parameters and inputs, sets up the internal state and writes the outputs at the start time. Called
    /// in initialisation mode as often as an input or parameter changes and an output is asked for, so it starts
    /// from nothing each time.
    fn initialize(
        &mut self,
        variables: &mut Self::Variables,
        experiment: &Experiment,
        log: &mut dyn Log,
    ) -> Result<(), ModelError>;

    /// A model as [`Default`] makes it, which may keep tables that this one has built already, if nothing that comes
    /// out of it depends on whether it has them. A reset and each initialisation begin with it, so that a sweep
    /// doesn't build the same tables for each of its runs.
    fn renewed(self) -> Self {
        Self::default()
    }

    /// Advances from `step.from` to `step.to` and writes the outputs at `step.to`.
    fn step(
        &mut self,
        variables: &mut Self::Variables,
        step: &Step<'_>,
        log: &mut dyn Log,
    ) -> Result<(), ModelError>;

    /// Partial derivative of `unknown` with respect to `known` at the current communication point, if the unit
    /// provides it (FMI 2.0 section 2.1.9).
    fn derivative(&self, variables: &Self::Variables, unknown: &str, known: &str) -> Option<f64> {
        let _ = (variables, unknown, known);
        None
    }
}

/// The head of `modelDescription.xml`.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// Model identifier: the stem of the `.fmu` and of the library inside.
    pub identifier: &'static str,
    /// One sentence.
    pub description: &'static str,
    /// Version of the model.
    pub version: &'static str,
    /// Default stop time in s.
    pub stop_time: f64,
    /// Default communication interval in s.
    pub step_size: f64,
    /// The unit answers [`Model::derivative`].
    pub provides_derivatives: bool,
    /// Categories of its own for log messages; the standard ones are added.
    pub log_categories: &'static [LogCategory],
}

/// A category of log messages, FMI 2.0 section 2.2.4.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LogCategory {
    /// Name, e.g. `"logVision"`.
    pub name: &'static str,
    /// One sentence.
    pub description: &'static str,
}

/// ModelStructure: what an unknown depends on, by FMI names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dependencies {
    /// Inputs (and states) that act at the same communication point.
    pub while_stepping: &'static [&'static str],
    /// Inputs and parameters that act at the start time; `None`: every one of them.
    pub at_start: Option<&'static [&'static str]>,
}

/// `fmi2SetupExperiment`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Experiment {
    /// Start time in s.
    pub start: f64,
    /// Stop time in s, if defined.
    pub stop: Option<f64>,
    /// Relative tolerance, if defined.
    pub tolerance: Option<f64>,
}

/// One communication step.
#[derive(Debug, Clone, Copy)]
pub struct Step<'a> {
    /// Where the step begins, in s: what the master passed, never a sum of steps.
    pub from: f64,
    /// Where it ends, in s.
    pub to: f64,
    /// First derivatives of inputs that the master set for this step (`fmi2SetRealInputDerivatives`), by FMI name,
    /// in 1/s. An input that is not listed is constant over the step.
    pub input_rates: &'a [(&'static str, f64)],
}

impl Step<'_> {
    /// The rate of an input that the master gave for this step.
    pub fn input_rate(&self, name: &str) -> Option<f64> {
        self.input_rates.iter().find(|(input, _)| *input == name).map(|(_, rate)| *rate)
    }

    /// Length of the step in s.
    pub fn size(&self) -> f64 {
        self.to - self.from
    }
}

/// Where a unit writes what a user should know. Messages go out only if the master wants their category.
pub trait Log {
    /// Writes a message of a category of the unit's own.
    fn log(&mut self, category: &'static str, message: &dyn Fn() -> String);
}

/// Why a unit can't go on. The shell logs it and answers `fmi2Error`; never `fmi2Discard`, which masters treat in
/// as many ways as there are masters.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// A value that the user chose can't be used.
    #[error("variable {name} = {value}: {expected}")]
    Value {
        /// FMI name.
        name: &'static str,
        /// The value, as written.
        value: String,
        /// What would be right.
        expected: String,
    },
    /// The model can't be evaluated there.
    #[error("{0}")]
    Failed(String),
}
