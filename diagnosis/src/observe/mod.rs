//! The general data set (`format = 2`): any model, any logs, as plain structures in which every name is resolved.
//!
//! [`load`] reads `dataset.toml`, opens the units, and turns every log column into a [`Series`] in the unit of the
//! variable it measures. What is unknown (a key, a variable, a unit of measurement, a file, a column) is an error with
//! file, line and a suggestion. Nothing here judges the model.
//!
//! - `raw.rs`: the keys of the file and their lines
//! - `nominal.rs`: the scenario, or one unit alone, with `[set]`
//! - `own.rs`: start values that a unit has against its description
//! - `resolve.rs`, `candidates.rs`: names become variables, gaps become defaults
//! - `measure.rs`: units of measurement
//! - `unlogged.rs`: inputs that no log feeds
//! - `run_files.rs`: the files of runs
//! - `log.rs`: CSV
//! - `clock.rs`: units of time, and times since 1970
//! - `implausible.rs`: values that nothing can have been measured at
//! - `seen.rs`: whether a start is seen where a run begins, and its line

mod candidates;
mod clock;
pub(crate) mod csv_text;
mod implausible;
mod log;
pub mod measure;
mod nominal;
mod own;
mod raw;
mod resolve;
mod run_files;
mod seen;
mod unlogged;

pub(crate) use clock::{EPOCH, SINCE_1970, UNITS, shorter_unit, units_below_seconds, units_to_seconds};
pub(crate) use implausible::implausible;
pub(crate) use log::is_date;
pub(crate) use seen::{is_seen, line_of_state};
pub use unlogged::Unlogged;

use crate::error::{Error, Notice};
use crate::statistics::median::median;
use crate::step_budget::StepBudget;
use orchestrator::fmu::{Description, Variable};
use orchestrator::{Fmu, Isolation, Scenario, UnitPath, Value};
pub(crate) use resolve::shows_its_start;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A data set, read and resolved: what the inference gets.
#[derive(Debug, Clone)]
pub struct Problem {
    /// The folder.
    pub path: PathBuf,
    /// The nominal model.
    pub model: Nominal,
    /// What was measured. One entry a variable.
    pub channels: Vec<Channel>,
    /// Inputs that no log feeds.
    pub unlogged: Vec<Unlogged>,
    /// How a run is started.
    pub states: Vec<State>,
    /// What may be missing in the model.
    pub candidates: Vec<Candidate>,
    /// What the master adds at ports by itself.
    pub ports: Ports,
    /// The logs.
    pub runs: Vec<Run>,
    /// Whether a row's outputs were read before or after its held inputs began to act.
    pub reading: Reading,
    /// When a model that doesn't come to an end is given up.
    pub deadline: Option<Instant>,
    /// How many steps its units may make.
    pub(crate) budget: Option<StepBudget>,
    /// Outputs are computed in a step only: the unit makes a short one before a row is read.
    pub late: bool,
    /// Each run is simulated whole from its start: rows can't be begun anew from the states that can be set.
    pub whole: bool,
    /// What a user should know of how the data set was read.
    pub notices: Vec<Notice>,
}

/// When a row's outputs were read: it matters where an output follows an input at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reading {
    /// With the inputs that acted up to the row: read, compute, write, as a sampled controller and most masters do.
    Before,
    /// With the row's own inputs.
    After,
}

/// The nominal model: a scenario whose values hold `[set]`, and its units, opened.
#[derive(Debug, Clone)]
pub struct Nominal {
    /// What `acroscope run` would run. For one unit alone, its interval divides the usual distance of the logs' rows.
    pub scenario: Scenario,
    /// The units, in the scenario's order.
    pub fmus: Vec<Fmu>,
    /// Values that differ from the units' start values: `[units.set]` of the scenario, and over it `[set]`.
    pub set: Vec<(VariableId, Value)>,
}

/// A variable of a unit of the nominal model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VariableId {
    /// Place of its unit in [`Nominal::fmus`] and in the scenario.
    pub instance: usize,
    /// Place of the variable in the unit's description.
    pub place: usize,
}

/// `[[channel]]`: a measured variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// `instance.variable`.
    pub name: String,
    /// The variable.
    pub variable: VariableId,
    /// What is done with it.
    pub role: Role,
    /// Standard deviation of the measurement in the variable's own unit, if it was stated.
    pub noise: Option<f64>,
    /// Column of the logs.
    pub column: String,
    /// How a number of the log becomes one of the model.
    pub conversion: Affine,
    /// Line in `dataset.toml`; 0 where the file doesn't say.
    pub line: usize,
    /// Whether `hold` is said; where it isn't, an input is held.
    pub hold_is_said: bool,
}

/// What is done with a measured variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// An input: fed to the model.
    Fed(Hold),
    /// An output or local variable: compared with the model.
    Compared,
}

/// The course of an input between its rows. Before the first row its value holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// The value of the last row.
    Zero,
    /// A straight line.
    Linear,
}

/// model = scale · log + offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine {
    /// Factor.
    pub scale: f64,
    /// Summand, in the model's unit.
    pub offset: f64,
}

impl Affine {
    /// Changes nothing.
    pub const SAME: Self = Self { scale: 1.0, offset: 0.0 };

    /// A number of the log as one of the model.
    pub fn apply(self, log: f64) -> f64 {
        self.scale * log + self.offset
    }
}

/// `[[state]]`: a start value that the diagnosis sets, run by run, before initialisation.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// `instance.variable` of the start value.
    pub name: String,
    /// A parameter, or an output or local variable of initial "exact".
    pub start: VariableId,
    /// The variable that shows its value at the start; `None`: started free.
    pub shows: Option<VariableId>,
    /// Place in [`Problem::channels`] of the channel that measures `shows`, if one does.
    pub channel: Option<usize>,
}

/// How a candidate moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// By differences in the variable's unit.
    Absolute,
    /// By shares of the nominal value, which is not 0.
    Relative,
    /// A limit, of which 0 means none.
    Saturation,
    /// Off or on.
    Switch,
    /// By whole numbers.
    Count,
}

/// `[[candidate]]`: a parameter that may differ from its neutral value.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// `instance.variable`.
    pub name: String,
    /// The parameter.
    pub variable: VariableId,
    /// The value at which the model is the nominal one.
    pub neutral: f64,
    /// Smallest and largest value; infinite where neither file nor description says.
    pub range: (f64, f64),
    /// What a person calls it.
    pub phrase: String,
    /// How it moves.
    pub scale: Scale,
    /// Line in `dataset.toml`; 0 where the file lists no candidates.
    pub line: usize,
}

macro_rules! kinds {
    ($(#[$doc:meta])* $name:ident { $($(#[$item:meta])* $variant:ident = $text:literal),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum $name { $($(#[$item])* $variant),* }

        impl $name {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$variant),*];

            /// As in `dataset.toml` and after the colon of a name, `heater.u:delay`.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => $text),* }
            }
        }
    };
}

kinds! {
    /// What the master may add between a signal and an input.
    InputEffect {
        /// Factor, neutral at 1.
        Gain = "gain",
        /// Summand.
        Bias = "bias",
        /// Transport delay, s.
        Delay = "delay",
        /// Time constant of a first-order lag, s.
        Lag = "lag",
        /// Largest magnitude; 0 is none.
        Saturation = "saturation",
        /// Largest rate, per s; 0 is none.
        RateLimit = "rate_limit",
    }
}

kinds! {
    /// What the master may add between an output and its log.
    OutputEffect {
        /// Factor, neutral at 1.
        Gain = "gain",
        /// Summand.
        Offset = "offset",
        /// Transport delay, s.
        Delay = "delay",
        /// Time constant of a first-order lag, s.
        Lag = "lag",
        /// Summand that grows with time, per s.
        Drift = "drift",
    }
}

/// `[ports]`: what the master adds at every measured port by itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ports {
    /// At inputs that are fed.
    pub inputs: Vec<InputEffect>,
    /// At outputs that are compared.
    pub outputs: Vec<OutputEffect>,
    /// An input that nobody listed may act on any equation that a declared input or state reaches.
    pub unknown_inputs: bool,
}

impl Default for Ports {
    fn default() -> Self {
        Self { inputs: InputEffect::ALL.to_vec(), outputs: OutputEffect::ALL.to_vec(), unknown_inputs: true }
    }
}

/// `[[run]]`: one log.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// The file as `dataset.toml` names it.
    pub name: String,
    /// Line in `dataset.toml`.
    pub line: usize,
    /// Seconds of a unit of its time column.
    pub seconds: f64,
    /// One entry a channel, in the order of [`Problem::channels`]; empty where the run didn't measure it.
    pub series: Vec<Series>,
}

/// What one channel measured in one run: a point for each row that holds a number.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// Times in s, strictly increasing, not evenly spaced.
    pub time: Vec<f64>,
    /// Values in the variable's own unit, all finite.
    pub values: Vec<f64>,
}

impl Series {
    /// The value that all rows have, if they have one and the same.
    pub(crate) fn one_value(&self) -> Option<f64> {
        let first = *self.values.first()?;
        self.values.iter().all(|value| *value == first).then_some(first)
    }
}

impl Problem {
    /// The same without candidates: the model as it is, of which no parameter is moved. A unit may hang, or end its process, with other values.
    pub(crate) fn as_it_is(&self) -> Self {
        Self { candidates: Vec::new(), ..self.clone() }
    }

    /// Usual distance of the logs' rows, s; 1 where no log has two.
    pub fn row(&self) -> f64 {
        let all = self.runs.iter().flat_map(|run| &run.series);
        median(all.flat_map(|series| series.time.windows(2).map(|pair| pair[1] - pair[0]))).unwrap_or(1.0)
    }

    /// All runs, each from its first row to its last, s.
    pub fn whole_runs(&self) -> Vec<(&Run, (f64, f64))> {
        self.runs.iter().map(|run| (run, run.span())).collect()
    }
}

impl Run {
    /// First and last time of any channel, s.
    pub fn span(&self) -> (f64, f64) {
        let first = self.series.iter().filter_map(|series| series.time.first());
        let last = self.series.iter().filter_map(|series| series.time.last());
        (first.copied().fold(f64::INFINITY, f64::min), last.copied().fold(f64::NEG_INFINITY, f64::max))
    }
}

impl Nominal {
    /// Units in processes of their own: those of which the scenario says so, and where it is asked for all.
    fn isolate(&mut self, all: Option<&Isolation>) {
        for (fmu, unit) in self.fmus.iter_mut().zip(&mut self.scenario.units) {
            unit.isolation = unit.isolation.take().or_else(|| all.cloned());
            if let Some(isolation) = &unit.isolation {
                *fmu = fmu.isolated(isolation.clone());
            }
        }
    }

    /// The description of a unit.
    pub fn description(&self, instance: usize) -> &Description {
        self.fmus[instance].description()
    }

    /// A variable's description.
    pub fn variable(&self, id: VariableId) -> &Variable {
        &self.description(id.instance).variables[id.place]
    }

    /// `instance.variable`.
    pub fn name(&self, id: VariableId) -> String {
        format!("{}.{}", self.scenario.units[id.instance].name, self.variable(id).name)
    }

    /// The nominal value: from `[set]` or the scenario, else the start value.
    pub fn value(&self, id: VariableId) -> Option<&Value> {
        let given = self.set.iter().rev().find(|(known, _)| *known == id).map(|(_, value)| value);
        given.or(self.variable(id).start.as_ref())
    }

    /// The nominal value as a number.
    pub fn number(&self, id: VariableId) -> Option<f64> {
        self.value(id).and_then(Value::as_f64)
    }

    /// Whether an input gets its values from another unit or a source of the scenario.
    pub fn is_driven(&self, id: VariableId) -> bool {
        let name = self.name(id);
        self.scenario.connections.iter().any(|connection| connection.to == name)
            || self.scenario.sources.iter().any(|source| source.to == name)
    }
}

/// The number after `format =` in the `dataset.toml` of a folder; `None` where there is none to be read.
pub fn format(folder: &Path) -> Option<i64> {
    let text = orchestrator::plain::read_text(&folder.join("dataset.toml")).ok()?;
    text.parse::<toml::Table>().ok()?.get("format")?.as_integer()
}

/// Reads a data set of `format = 2`. Units run in processes of their own where the scenario says so, or all of them if that is asked for.
///
/// # Errors
/// The file, the model or a log can't be read, or something in the file is unknown.
pub fn load(folder: &Path, units: &UnitPath, isolation: Option<&Isolation>) -> Result<Problem, Error> {
    let file = raw::File::read(&folder.join("dataset.toml"))?;
    resolve::problem(folder, &file, units, isolation)
}
