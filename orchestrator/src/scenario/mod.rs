//! What is to be run: the scenario file.
//!
//! ```toml
//! format = 1
//! description = "text"             # optional
//! [experiment]
//! start = 0.0                      # optional
//! stop = 30.0                      # times: a number or a text such as "1/3", taken exactly; a decimal as long as
//!                                  # 0.0016666666666666668 for the fraction that it came from, 1/600
//! algorithm = "gauss-seidel"       # or another one of the table in docs/scenario.md; optional
//! options = { tolerance = 1e-6 }   # of the algorithm; optional
//! seed = 0                         # of jitter and drop below; optional
//! [[units]]                        # Gauss-Seidel steps units in this order
//! name = "plant"
//! fmu = "acrobot_plant.fmu"        # beside the scenario file, then in the folders of the unit path
//! interval = "1/600"               # communication interval in s
//! offset = "1/1200"                # optional: its points lie at start + offset + k interval; less than the interval
//! retry = true                     # optional: a step that the unit discards is made in shorter ones
//! isolate = true                   # optional: the unit runs in a process of its own, where
//! step_limit = 30                  # a call may take so many seconds,
//! memory_limit = 1024              # and the process may have so many MiB
//! [units.set]                      # start values and parameters, by bare name
//! q1_0 = -0.05
//! [[connections]]
//! from = "plant.q1"
//! to = "camera.q1"
//! latency = "1/60"                 # optional, s (`delay` in older files); until it is over the input keeps its start value
//! jitter = 0.001                   # optional, s: standard deviation of the latency
//! drop = 0.1                       # optional: share of values that are lost
//! hold = "zero"                    # or "linear": between values on the line through the newest two; optional
//! seed = 1                         # of this connection alone; optional
//! gain = 2.0                       # optional, with bias: input = gain · value + bias, for Real inputs
//! convert_units = false            # optional: the value passes as a number, whatever its physical unit
//! map = [["low", 1], ["high", 7]]  # optional, for Integers, Booleans and enumerations: what becomes of single values
//! [[sources]]
//! to = "controller.z_desired"
//! kind = "smooth"                  # constant | hold | linear | smooth | csv
//! points = [[0.0, 0.0], [10.0, 0.5]]
//! [record]                         # optional; without it all inputs and outputs
//! variables = ["plant.*", "camera.q1_est"]
//! [report]                         # anything; kept for the command line
//! ```
//!
//! A `constant` source has `value = …`; `hold`, `linear` and `smooth` have `points = [[time, value], …]`; `csv` has
//! `file = "…"` (relative to the scenario file, its first column is the time), `column = "…"` and optionally
//! `interpolation = "hold"` instead of `"linear"`. In `record`, `*` stands for any text; a pattern with it matches
//! inputs, outputs and locals, parameters are recorded only by their full name. Unknown keys are errors.

mod connection;
mod raw;
mod source;
pub(crate) mod write;

pub use crate::wiring::table;
pub use connection::{Channel, ConnectionEntry, Hold, Transform};
pub use raw::name_of_file;
pub(crate) use write::resolved;

use crate::error::{Error, Place};
use crate::isolation::Isolation;
use crate::suggest::nearest;
use crate::time::Rational;
use std::path::{Path, PathBuf};

/// A scenario as it was written. Whether its names and types fit the units shows when it is built.
#[derive(Debug, Clone)]
pub struct Scenario {
    /// The file, or the name given to [`Scenario::parse`].
    pub origin: PathBuf,
    /// What it is about.
    pub description: String,
    /// Start time in s.
    pub start: Rational,
    /// Stop time in s.
    pub stop: Rational,
    /// Name of the master algorithm.
    pub algorithm: Placed<String>,
    /// `[experiment.options]`: what is set of the algorithm.
    pub options: Vec<(String, Placed<f64>)>,
    /// Of whatever chance decides.
    pub seed: u64,
    /// The units, in the order of stepping.
    pub units: Vec<UnitEntry>,
    /// The connections.
    pub connections: Vec<ConnectionEntry>,
    /// The signals from outside.
    pub sources: Vec<SourceEntry>,
    /// Patterns of what is recorded; `None`: all inputs and outputs.
    pub record: Option<Vec<Placed<String>>>,
    /// The table `[report]`, unread.
    pub report: toml::Table,
    /// Line 1 of the file.
    pub(crate) place: Place,
    /// What was read otherwise than it was written.
    pub(crate) notes: Vec<String>,
}

/// Something and where it was written.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed<T> {
    /// What.
    pub value: T,
    /// Where.
    pub place: Place,
}

/// `[[units]]`
#[derive(Debug, Clone)]
pub struct UnitEntry {
    /// Name in this scenario.
    pub name: String,
    /// Name of the `.fmu` file.
    pub fmu: Placed<String>,
    /// Communication interval in s.
    pub interval: Rational,
    /// How much later than the start its points begin, in s, if that is not zero; less than the interval.
    pub offset: Option<Placed<Rational>>,
    /// A step that the unit discards is made in shorter ones.
    pub retry: bool,
    /// A process of its own, and its limits.
    pub isolation: Option<Isolation>,
    /// Start values and parameters: name and value, each name once.
    pub set: Vec<(String, Placed<Given>)>,
    /// Where the entry begins.
    pub place: Place,
}

/// A start value before its type is known.
#[derive(Debug, Clone, PartialEq)]
pub enum Given {
    /// From the file: TOML has types.
    Toml(toml::Value),
    /// From the command line: text, read as the variable's type.
    Text(String),
}

/// `[[sources]]`
#[derive(Debug, Clone)]
pub struct SourceEntry {
    /// `unit.variable` of an input.
    pub to: String,
    /// What it is fed with.
    pub signal: SignalEntry,
    /// Where the entry begins.
    pub place: Place,
}

/// What a source delivers.
#[derive(Debug, Clone, PartialEq)]
pub enum SignalEntry {
    /// One value.
    Constant(toml::Value),
    /// A table of times and values.
    Table {
        /// How values between the points come about.
        shape: Shape,
        /// Times in s and values.
        points: Vec<(f64, f64)>,
    },
    /// A column of a CSV file.
    Csv {
        /// The file, relative to the scenario's.
        file: String,
        /// Name of the column.
        column: String,
        /// How values between the rows come about.
        shape: Shape,
    },
}

/// How a table is read between its points. Before the first point its value holds, after the last one the last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// The value of the last point that has come.
    Hold,
    /// A straight line.
    Linear,
    /// A polynomial of degree nine, four times continuously differentiable: flat in every point.
    Smooth,
}

impl Scenario {
    /// Reads a scenario file.
    ///
    /// # Errors
    /// If it can't be read, is no TOML, or says something that the format doesn't have.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let text =
            crate::plain::read_text(path).map_err(|source| Error::File { path: path.into(), source })?;
        Self::parse(&text, path)
    }

    /// Reads a scenario from text. Errors name `origin`; files are looked for beside it.
    ///
    /// # Errors
    /// If the text is no TOML, or says something that the format doesn't have.
    pub fn parse(text: &str, origin: impl AsRef<Path>) -> Result<Self, Error> {
        raw::parse(text, origin.as_ref())
    }

    /// Gives a start value or parameter beside the file: `scenario.set("camera.k1", "0.1")`. The variable and its
    /// type are checked when the scenario is built.
    ///
    /// # Errors
    /// If the name has no dot or there is no such unit.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), Error> {
        let place = Place::Override(format!("{name}={value}"));
        let Some((unit, variable)) = name.split_once('.') else {
            let expected = "write unit.variable=value, e.g. camera.k1=0.1".into();
            return Err(Error::Scenario { place, what: format!("{name:?} names no unit"), expected });
        };
        match self.units.iter_mut().find(|entry| entry.name == unit) {
            Some(entry) => {
                entry.set.retain(|(known, _)| known != variable);
                entry.set.push((variable.into(), Placed { value: Given::Text(value.into()), place }));
                Ok(())
            }
            None => {
                let expected = nearest(unit, self.units.iter().map(|entry| entry.name.as_str()));
                Err(Error::Scenario { place, what: format!("there is no unit {unit:?}"), expected })
            }
        }
    }

    /// Takes away the connection or source that drives an input, so that whoever steps the simulation can set it.
    ///
    /// # Errors
    /// If nothing drives it.
    pub fn release(&mut self, input: &str) -> Result<(), Error> {
        let driven = self.connections.iter().map(|entry| entry.to.as_str());
        let driven: Vec<&str> = driven.chain(self.sources.iter().map(|entry| entry.to.as_str())).collect();
        if !driven.contains(&input) {
            let expected = nearest(input, driven.into_iter());
            return Err(Error::NotDriven { name: input.into(), expected });
        }
        self.connections.retain(|entry| entry.to != input);
        self.sources.retain(|entry| entry.to != input);
        Ok(())
    }

    /// An empty scenario for one that is made by a program or read from another format; `origin` is what errors name, and
    /// files are looked for beside it.
    #[must_use]
    pub fn new(origin: impl Into<PathBuf>, start: Rational, stop: Rational, place: Place) -> Self {
        Self {
            origin: origin.into(),
            description: String::new(),
            start,
            stop,
            algorithm: Placed { value: "gauss-seidel".into(), place: place.clone() },
            options: Default::default(),
            units: Vec::new(),
            connections: Vec::new(),
            sources: Vec::new(),
            seed: 0,
            record: None,
            report: toml::Table::new(),
            place,
            notes: Vec::new(),
        }
    }

    /// Adds what a person should know of how it was read; it is among the notices of a simulation.
    pub fn note(&mut self, note: String) {
        self.notes.push(note);
    }

    /// Replaces the stop time: a number or a fraction, in s.
    ///
    /// # Errors
    /// If it is no time or lies before the start.
    pub fn set_stop(&mut self, stop: &str) -> Result<(), Error> {
        let wrong = |expected: String| Error::Value { name: "stop".into(), value: stop.into(), expected };
        let (time, recovered) =
            Rational::recover(stop).ok_or_else(|| wrong("a time in s, such as 30, 0.5 or 1/3".into()))?;
        if time < self.start {
            return Err(wrong(format!("not before the start, {} s", self.start)));
        }
        self.stop = time;
        if recovered {
            self.notes.push(format!("stop = {stop} is read as {time}"));
        }
        Ok(())
    }

    /// The folder of the file.
    pub(crate) fn folder(&self) -> &Path {
        self.origin.parent().unwrap_or(Path::new(""))
    }
}
