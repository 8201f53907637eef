//! What can go wrong, with the values that a person needs to put it right.

use crate::fmu::{LogLine, Status};
use crate::words::{at, listed, reached, reasons, tail};
use std::fmt;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;

/// Where a person wrote something.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// A line of a file.
    Line {
        /// The file as it was named.
        file: Arc<str>,
        /// From 1.
        line: usize,
    },
    /// A value given beside the file, as `unit.variable=value`.
    Override(String),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line { file, line } => write!(f, "{file}:{line}"),
            Self::Override(text) => write!(f, "--set {text}"),
        }
    }
}

/// Why a scenario can't be loaded, built or run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file can't be read.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Something in a scenario is wrong.
    #[error("{place}: {what}: {expected}")]
    Scenario {
        /// Where.
        place: Place,
        /// What is wrong.
        what: String,
        /// What would be right.
        expected: String,
    },
    /// A name in a call of this library is wrong.
    #[error("{what} {name:?} does not exist: {expected}")]
    Name {
        /// What was looked for.
        what: &'static str,
        /// The name.
        name: String,
        /// What would be right.
        expected: String,
    },
    /// An input was to be taken from what drives it, and nothing does.
    #[error("{name:?} is no driven input, for nothing in the scenario drives it: {expected}")]
    NotDriven {
        /// The name.
        name: String,
        /// What is driven.
        expected: String,
    },
    /// A value in a call of this library is wrong.
    #[error("{name} = {value}: {expected}")]
    Value {
        /// `unit.variable`.
        name: String,
        /// The value.
        value: String,
        /// What would be right.
        expected: String,
    },
    /// A `.fmu` file is broken.
    #[error("{}: not a usable FMU: {reason}", path.display())]
    Archive {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A package can't be read.
    #[error("{}: {reason}", path.display())]
    Package {
        /// The package.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A description breaks the standard.
    #[error("{}: modelDescription.xml:{line}: {what}", path.display())]
    Description {
        /// The `.fmu` file.
        path: PathBuf,
        /// Line of the description.
        line: usize,
        /// What is wrong.
        what: String,
    },
    /// The library of a unit can't be used.
    #[error("{}: {reason}", path.display())]
    Library {
        /// The `.fmu` file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// There is no place to unpack a file.
    #[error("{}: it can't be unpacked in {}: {reason} (TMPDIR names another folder)", path.display(), folder.display())]
    Unpack {
        /// The archive.
        path: PathBuf,
        /// Where temporary folders are made.
        folder: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// A unit refused to be instantiated.
    #[error("unit {unit} ({}): fmi2Instantiate gave no instance{}", path.display(), reasons(log))]
    Instantiate {
        /// Name in the scenario.
        unit: String,
        /// The `.fmu` file.
        path: PathBuf,
        /// What the unit logged.
        log: Vec<LogLine>,
    },
    /// A unit lacks a function that is needed.
    #[error("unit {unit}: its library has no {function}, which this run needs")]
    Missing {
        /// Name in the scenario.
        unit: String,
        /// The function.
        function: &'static str,
    },
    /// A call with as many references as values was needed.
    #[error("unit {unit}: {function} called with {references} references and {values} values")]
    Lengths {
        /// Name in the scenario.
        unit: String,
        /// The function.
        function: &'static str,
        /// How many references.
        references: usize,
        /// How many values.
        values: usize,
    },
    /// A call failed.
    #[error("unit {unit}: {function}{} answered {status}{}", at(*time), tail(log))]
    Call {
        /// Name in the scenario.
        unit: String,
        /// The function.
        function: &'static str,
        /// What it answered.
        status: Status,
        /// Simulated time in s, if there was one.
        time: Option<f64>,
        /// What the unit logged.
        log: Vec<LogLine>,
    },
    /// A call that reads or writes variables failed.
    #[error("unit {unit}: {function} of {variables}{} answered {status}{}", at(*time), tail(log))]
    Access {
        /// Name in the scenario.
        unit: String,
        /// The function.
        function: &'static str,
        /// The variables that it was about, in words: the first few by name.
        variables: String,
        /// What it answered.
        status: Status,
        /// Simulated time in s, if there was one.
        time: Option<f64>,
        /// What the unit logged.
        log: Vec<LogLine>,
    },
    /// A unit's state takes more memory than there is.
    #[error("unit {unit}: fmi2SerializedFMUstateSize asks for {bytes} bytes, for which there is no memory")]
    StateSize {
        /// Name in the scenario.
        unit: String,
        /// What it asked for.
        bytes: usize,
    },
    /// The process of a unit that had one of its own ended.
    #[error("unit {unit}: in {function}{} its process {post_mortem}", at(*time))]
    Died {
        /// Name in the scenario.
        unit: String,
        /// The function that was under way.
        function: &'static str,
        /// Simulated time in s, if there was one.
        time: Option<f64>,
        /// How it ended, and what it was at.
        post_mortem: Box<PostMortem>,
    },
    /// A unit ended a step early.
    #[error("unit {unit}: the step from t = {from} s by {size} s was discarded{}; a smaller interval may help{}{}",
            reached(*last), if *retried { ", pieces as small as are tried with `retry = true` did not" } else { ", or `retry = true` of the unit" }, tail(log))]
    Discarded {
        /// Name in the scenario.
        unit: String,
        /// Begin of the step in s.
        from: f64,
        /// Its size in s.
        size: f64,
        /// How far the unit came, if it can tell.
        last: Option<f64>,
        /// It was tried again in smaller pieces (`retry = true`).
        retried: bool,
        /// What the unit logged.
        log: Vec<LogLine>,
    },
    /// A unit wants the run to end: it discarded a step and says `fmi2Terminated`. To a run this is a regular end,
    /// [`crate::Ended::ByUnit`].
    #[error("unit {unit}: it wants the run to end at t = {time} s")]
    Terminated {
        /// Name in the scenario.
        unit: String,
        /// How far it came in s.
        time: f64,
    },
    /// A unit delivered no finite number.
    #[error("{variable} is {value} at t = {time} s; the run stops before another unit gets it{}", tail(log))]
    NotFinite {
        /// `unit.variable`.
        variable: String,
        /// NaN or an infinity.
        value: f64,
        /// Simulated time in s.
        time: f64,
        /// What the unit logged.
        log: Vec<LogLine>,
    },
    /// A loop of direct dependencies has no solution that iteration or Newton's method finds.
    #[error(
        "algebraic loop at initialisation: {path}: no fixed point after {iterations} iterations (last change of \
         {variable}: {change}), nor by Newton's method; give one of its connections a delay, or declare the dependencies that don't exist"
    )]
    Loop {
        /// The loop, variable by variable.
        path: String,
        /// How many iterations were made.
        iterations: u32,
        /// The variable that moved most.
        variable: String,
        /// By how much, in the last iteration.
        change: f64,
    },
    /// What units give each other does not settle, or can't be made as exact as was asked for.
    #[error(
        "{variable} at t = {time} s: it still changes by {change} after {tried}, more than the tolerance of {tolerance}; {advice}"
    )]
    Coupling {
        /// `unit.variable`.
        variable: String,
        /// Simulated time in s.
        time: f64,
        /// Relative to the larger of the value and one.
        change: f64,
        /// What was asked for.
        tolerance: f64,
        /// What was done.
        tried: String,
        /// What may help.
        advice: &'static str,
    },
    /// The times of a scenario have no common tick within 64 bits.
    #[error(
        "{place}: the intervals, delays, start and stop ({times}) have no common tick that fits 64 bits: use rounder numbers"
    )]
    Tick {
        /// The scenario.
        place: Place,
        /// All of them.
        times: String,
    },
    /// A checkpoint can't be used.
    #[error("{}: {reason}; without --resume the run begins anew", path.display())]
    Checkpoint {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// Results can't be written.
    #[error("cannot write results{}: {source}", target.as_ref().map_or_else(String::new, |path| format!(" to {}", path.display())))]
    Record {
        /// The file, if it is one.
        target: Option<PathBuf>,
        /// Why.
        source: io::Error,
    },
}

impl Error {
    /// The user's input is wrong, rather than a unit or the machine: exit status 2 of the command line. A unit that
    /// refuses a call before the first step refuses the values that it was given. A disk that is full or broken is the machine's.
    pub fn is_input(&self) -> bool {
        let theirs = matches!(
            self,
            Self::File { .. }
                | Self::Scenario { .. }
                | Self::Name { .. }
                | Self::NotDriven { .. }
                | Self::Value { .. }
                | Self::Archive { .. }
                | Self::Unpack { .. }
                | Self::Package { .. }
                | Self::Description { .. }
                | Self::Library { .. }
                | Self::Tick { .. }
                | Self::Checkpoint { .. }
                // The folder is not to be written: somebody can choose another.
                | Self::Record { .. }
                | Self::Loop { .. }
                | Self::Coupling { .. }
                | Self::Call { time: None, .. }
                | Self::Access { time: None, .. }
                | Self::Instantiate { .. }
        );
        theirs && !crate::machine::failed(&self.to_string())
    }

    /// An error with `time` put in, where a call during a step failed.
    #[cold]
    pub(crate) fn during(mut self: Box<Self>, now: f64) -> Box<Self> {
        if let Self::Call { time: time @ None, .. }
        | Self::Access { time: time @ None, .. }
        | Self::Died { time: time @ None, .. } = &mut *self
        {
            *time = Some(now);
        }
        self
    }
}

/// That a file can't be unpacked where temporary folders are made.
pub(crate) fn unpack(path: &std::path::Path, error: &std::io::Error) -> Error {
    Error::Unpack { path: path.into(), folder: std::env::temp_dir(), reason: error.to_string() }
}

/// How the process of a unit ended, and what it was at.
#[derive(Debug, Clone, PartialEq)]
pub struct PostMortem {
    /// Completes "its process ...".
    pub how: String,
    /// What the unit was given last: `variable = value`.
    pub inputs: Vec<String>,
    /// The last calls, the one under way last.
    pub calls: Vec<String>,
    /// What the unit logged.
    pub log: Vec<LogLine>,
}

impl fmt::Display for PostMortem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { how, inputs, calls, log } = self;
        write!(f, "{how}{}{}{}", listed("last inputs", inputs), listed("last calls", calls), tail(log))
    }
}
