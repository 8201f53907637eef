//! `modelDescription.xml`: what a unit says of itself (FMI 2.0 sections 2.2 and 4.3.1).
//!
//! Everything legal is accepted, and everything unknown (annotations, flags of other versions, `xsi:` attributes)
//! is passed over. Only what a master needs is kept. `read.rs` reads it.

use crate::fmu::places::{Names, Places};
use crate::fmu::read;
use crate::value::{Kind, Value};
use std::collections::HashSet;
use std::io::Read;
use std::ops::Deref;
use std::sync::Arc;

/// What a variable is to a master.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Causality {
    /// Chosen by the user.
    Parameter,
    /// Computed from parameters at initialisation.
    CalculatedParameter,
    /// Set by the master before a step.
    Input,
    /// Read by the master after a step.
    Output,
    /// Visible, not to be connected.
    Local,
    /// Time.
    Independent,
}

/// When a variable may change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variability {
    /// Never.
    Constant,
    /// Not after initialisation.
    Fixed,
    /// Between communication points.
    Tunable,
    /// At communication points.
    Discrete,
    /// Always.
    Continuous,
}

/// Where the value at the start comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Initial {
    /// The start value holds.
    Exact,
    /// The start value is a guess.
    Approx,
    /// The unit computes it.
    Calculated,
}

/// One `ScalarVariable`.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name in the description.
    pub name: String,
    /// What the calls use in place of the name.
    pub reference: u32,
    /// One sentence; empty if there is none.
    pub description: String,
    /// What it is to a master.
    pub causality: Causality,
    /// When it may change.
    pub variability: Variability,
    /// Where the value at the start comes from; `None` for inputs.
    pub initial: Option<Initial>,
    /// Type. An enumeration is an Integer to the calls.
    pub kind: Kind,
    /// Start value.
    pub start: Option<Value>,
    /// What it has in common with others; read as if it were its own: `variable.unit`.
    pub traits: Arc<Traits>,
    /// The variable (place in [`Description::variables`]) of which this is the derivative.
    pub derivative_of: Option<usize>,
}

/// What a declared type can say for many variables. Of a million variables few differ in it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Traits {
    /// The names and values of an enumeration.
    pub items: Option<Arc<[(String, i32)]>>,
    /// Name of the physical unit.
    pub unit: Option<String>,
    /// Name of the unit for people.
    pub display_unit: Option<String>,
    /// A difference: conversions leave the offset out.
    pub relative_quantity: bool,
    /// Smallest legal value.
    pub min: Option<f64>,
    /// Largest legal value.
    pub max: Option<f64>,
}

impl Deref for Variable {
    type Target = Traits;

    fn deref(&self) -> &Traits {
        &self.traits
    }
}

/// One `Unit`.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitDefinition {
    /// Name that variables refer to.
    pub name: String,
    /// SI base units, if given.
    pub base: Option<BaseUnit>,
    /// Units for people: name, factor, offset, with shown = factor · value + offset.
    pub display: Vec<(String, f64, f64)>,
}

/// value in base units = factor · value + offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BaseUnit {
    /// Exponents of kg, m, s, A, K, mol, cd, rad.
    pub exponents: [i32; 8],
    /// Factor to base units.
    pub factor: f64,
    /// Offset in base units.
    pub offset: f64,
}

/// An entry of `ModelStructure`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unknown {
    /// The variable, as its place in [`Description::variables`].
    pub variable: usize,
    /// What it depends on; `None`: not said, so on everything.
    pub dependencies: Option<Vec<usize>>,
}

/// `DefaultExperiment`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DefaultExperiment {
    /// Start time in s.
    pub start: Option<f64>,
    /// Stop time in s.
    pub stop: Option<f64>,
    /// Relative tolerance.
    pub tolerance: Option<f64>,
    /// Communication interval in s.
    pub step_size: Option<f64>,
}

/// Attributes of `CoSimulation`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CoSimulation {
    /// Stem of the library.
    pub model_identifier: String,
    /// It only talks to another program.
    pub needs_execution_tool: bool,
    /// Steps may differ in size.
    pub can_handle_variable_step: bool,
    /// `fmi2SetRealInputDerivatives` works.
    pub can_interpolate_inputs: bool,
    /// How many output derivatives there are.
    pub max_output_derivative_order: u32,
    /// A step may answer `fmi2Pending`.
    pub can_run_asynchronously: bool,
    /// A second instance in one process is not possible.
    pub only_one_instance: bool,
    /// It brings its own memory management.
    pub can_not_use_memory_functions: bool,
    /// States can be saved.
    pub can_get_and_set_state: bool,
    /// States can be turned into bytes.
    pub can_serialize_state: bool,
    /// Directional derivatives work.
    pub provides_directional_derivative: bool,
}

/// The whole description.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// `modelName`.
    pub model_name: String,
    /// `guid`.
    pub guid: String,
    /// `description`; empty if there is none.
    pub description: String,
    /// `version`; empty if there is none.
    pub version: String,
    /// `generationTool`; empty if there is none.
    pub generation_tool: String,
    /// Capabilities.
    pub co_simulation: CoSimulation,
    /// `UnitDefinitions`.
    pub units: Vec<UnitDefinition>,
    /// `ModelVariables`, in order.
    pub variables: Vec<Variable>,
    /// `ModelStructure/Outputs`.
    pub outputs: Vec<Unknown>,
    /// `ModelStructure/InitialUnknowns`.
    pub initial_unknowns: Vec<Unknown>,
    /// `DefaultExperiment`.
    pub default_experiment: DefaultExperiment,
    /// Names of the log categories.
    pub log_categories: Vec<String>,
    pub(super) names: Names,
    pub(super) repeated: HashSet<String>,
    /// Of outputs and of initial unknowns, by their variables.
    pub(super) places: [Places; 2],
}

impl Description {
    /// Reads a description; an error is the line and what is wrong there.
    pub fn parse(text: &str) -> Result<Self, (usize, String)> {
        read::description(text.as_bytes())
    }

    /// The same as it is read, without the whole text in memory.
    pub(super) fn read(text: impl Read) -> Result<Self, (usize, String)> {
        read::description(text)
    }

    /// A variable by name.
    pub fn variable(&self, name: &str) -> Option<&Variable> {
        self.place(name).map(|place| &self.variables[place])
    }

    /// Place of a variable in [`Description::variables`].
    pub fn place(&self, name: &str) -> Option<usize> {
        self.names.find(name, &self.variables)
    }

    /// Whether several variables have the name, or none has one: whoever names it may mean another one.
    pub fn is_ambiguous(&self, name: &str) -> bool {
        name.is_empty() || self.repeated.contains(name)
    }

    /// The definition of a physical unit.
    pub fn unit(&self, name: &str) -> Option<&UnitDefinition> {
        self.units.iter().find(|unit| unit.name == name)
    }

    /// On which variables an output depends while stepping; `None`: on every input.
    pub fn step_dependencies(&self, variable: usize) -> Option<&[usize]> {
        self.places[0].find(variable, &self.outputs)?.dependencies.as_deref()
    }

    /// On which variables an output depends at initialisation; `None`: on every input.
    pub fn initial_dependencies(&self, variable: usize) -> Option<&[usize]> {
        match self.places[1].find(variable, &self.initial_unknowns) {
            Some(unknown) => unknown.dependencies.as_deref(),
            // An exact start value is no unknown, it comes from nowhere.
            None if self.variables[variable].initial == Some(Initial::Exact) => Some(&[]),
            None => self.step_dependencies(variable),
        }
    }
}
