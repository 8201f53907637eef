//! A study that was checked against its scenario and units: which runs are to be made, which columns come of them, and a
//! checksum of all that they depend on.

mod parameters;

use crate::design::Sampler;
use crate::error::Error;
use crate::scalar::Scalar;
use crate::study::{Parameter, Study, Until};
use crate::sweep::Limits;
use orchestrator::fmu::{Description, Variable};
use orchestrator::scenario::{Placed, SignalEntry};
use orchestrator::time::Rational;
use orchestrator::{Column, Comparison, Isolation, Kind, Place, Scenario, Simulation, UnitPath, Value};
use parameters::{parameters, typed};
use report::Origin;
use report::tally::{Reduce, Test};
use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// A study that can be run.
pub struct Plan {
    pub(crate) name: String,
    /// As it was written.
    pub(crate) text: String,
    pub(crate) scenario: Scenario,
    units: UnitPath,
    /// A unit can live only once in a process as it is loaded: each thread loads its own.
    loads_apart: bool,
    pub(crate) parameters: Vec<Column>,
    pub(crate) sampler: Sampler,
    pub(crate) scalars: Vec<Scalar>,
    /// Places of each scalar's signals among the recorded columns.
    pub(crate) columns: Vec<(usize, Option<usize>)>,
    /// Physical units of the scalars.
    pub(crate) scalar_units: Vec<Option<String>>,
    /// The signals that are kept: the first recorded columns.
    pub(crate) signals: Vec<Column>,
    pub(crate) every: Option<Rational>,
    until: Option<Until>,
    /// Every value that the cases share.
    pub(crate) resolved: String,
    /// Of all that the rows depend on.
    pub(crate) fingerprint: String,
    /// What a person should know.
    pub(crate) notices: Vec<String>,
    /// The units and what they were made by.
    pub(crate) origins: Vec<Origin>,
}

impl Plan {
    /// Checks a study against its scenario and units.
    ///
    /// # Errors
    /// If anything in it doesn't fit, naming file and line.
    pub fn new(study: &Study, units: &UnitPath, limits: &Limits) -> Result<Self, Error> {
        let mut scenario = scenario(study, limits)?;
        let patterns = study.signals.as_ref().map_or(Vec::new(), |signals| signals.variables.clone());
        scenario.record = Some(patterns);
        let mut simulation = Simulation::new(&scenario, units).map_err(|error| set_in(study, error))?;
        let parameters = parameters(study, &mut simulation)?;
        let design = typed(study, &parameters, &mut simulation)?;
        let signals = simulation.columns().to_vec();
        let mut recorded: Vec<String> = signals.iter().map(|column| column.name.clone()).collect();
        let (mut columns, mut scalar_units) = (Vec::new(), Vec::new());
        for scalar in &study.scalars {
            scalar_units.push(checked(scalar, &simulation)?);
            let minus = scalar.minus.as_ref().map(|minus| place(&mut recorded, minus));
            columns.push((place(&mut recorded, &scalar.signal), minus));
        }
        if let Some(until) = &study.until {
            let found = number(&simulation, &until.signal, &until.place)?;
            boolean(found, &until.signal, until.test, &until.place)?;
            place(&mut recorded, &until.signal);
        }
        let loads_apart =
            simulation.units().any(|(_, description)| description.co_simulation.only_one_instance);
        let named = |value: String| Placed { place: Place::Override(value.clone()), value };
        scenario.record = Some(recorded.into_iter().map(named).collect());
        let mut plan = Self {
            name: study.name.clone(),
            text: study.text.clone(),
            units: units.clone(),
            loads_apart,
            parameters,
            sampler: Sampler::new(design),
            scalars: study.scalars.clone(),
            columns,
            scalar_units,
            signals,
            every: study.signals.as_ref().and_then(|signals| signals.every),
            until: study.until.clone(),
            resolved: String::new(),
            fingerprint: String::new(),
            notices: simulation.notices(),
            origins: origins(&simulation)?,
            scenario,
        };
        // Before others are made: some units can live only once in a process.
        drop(simulation);
        let simulation = plan.simulation(&plan.units)?;
        plan.resolved = simulation.resolved();
        plan.fingerprint = plan.sum(&simulation)?;
        Ok(plan)
    }

    /// How many cases there are.
    pub fn cases(&self) -> u64 {
        self.sampler.cases()
    }

    /// Where a thread finds its units: what is unpacked is shared, unless a unit doesn't allow that.
    pub(crate) fn units(&self) -> UnitPath {
        match self.loads_apart {
            true => self.units.folders().iter().fold(UnitPath::new(), UnitPath::with),
            false => self.units.clone(),
        }
    }

    /// A simulation that is ready to run.
    pub(crate) fn simulation(&self, units: &UnitPath) -> Result<Simulation, Error> {
        let mut simulation = Simulation::new(&self.scenario, units)?;
        if let Some(until) = &self.until {
            let (comparison, limit) = match until.test {
                // Booleans are 0 and 1.
                Test::True => (Comparison::Above, 0.5),
                Test::Above(limit) => (Comparison::Above, limit),
                Test::Below(limit) => (Comparison::Below, limit),
            };
            simulation.stop_when(&until.signal, comparison, limit)?;
        }
        Ok(simulation)
    }

    /// Whether every unit lives in a process of its own.
    pub(crate) fn is_isolated(&self) -> bool {
        self.scenario.units.iter().all(|unit| unit.isolation.is_some())
    }

    /// Gives a simulation the values of a case.
    pub(crate) fn set(&self, simulation: &mut Simulation, case: u64) -> Result<(), orchestrator::Error> {
        for (at, parameter) in self.parameters.iter().enumerate() {
            simulation.set(&parameter.name, self.sampler.value(case, at))?;
        }
        Ok(())
    }

    fn sum(&self, simulation: &Simulation) -> Result<String, Error> {
        let mut sum = Sha256::new();
        let mut add = |what: &str, bytes: &[u8]| {
            // With their lengths, so that nothing can move from one to the next.
            sum.update(format!("{what} {}\n", bytes.len()));
            sum.update(bytes);
        };
        add("version", env!("CARGO_PKG_VERSION").as_bytes());
        add("scenario", self.resolved.as_bytes());
        add("design", format!("{:?}", self.sampler.design()).as_bytes());
        let names: Vec<&str> = self.parameters.iter().map(|column| column.name.as_str()).collect();
        add("parameters", names.join("\n").as_bytes());
        for Scalar { name, signal, minus, reduce, .. } in &self.scalars {
            add("scalar", format!("{name:?} {signal:?} {minus:?} {reduce:?}").as_bytes());
        }
        let signals: Vec<&str> = self.signals.iter().map(|column| column.name.as_str()).collect();
        add("signals", format!("{signals:?} {:?}", self.every).as_bytes());
        add(
            "until",
            format!("{:?}", self.until.as_ref().map(|until| (&until.signal, until.test))).as_bytes(),
        );
        let folder = self.scenario.origin.parent().unwrap_or(Path::new(""));
        let files = self.scenario.sources.iter().filter_map(|source| match &source.signal {
            SignalEntry::Csv { file, .. } => Some(folder.join(file)),
            _ => None,
        });
        for path in simulation.files().map(Path::to_owned).chain(files) {
            add("file", &std::fs::read(&path).map_err(Error::file(&path))?);
        }
        Ok(digits(&sum.finalize()))
    }
}

fn digits(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing into a String can't fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// Checksum in hexadecimal digits.
pub(crate) fn hex(bytes: &[u8]) -> String {
    digits(&Sha256::digest(bytes))
}

fn origins(simulation: &Simulation) -> Result<Vec<Origin>, Error> {
    let units = simulation.units().zip(simulation.files());
    let origin = |((name, description), path): ((&str, &Description), &Path)| {
        Ok(Origin {
            name: name.to_owned(),
            file: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            guid: description.guid.clone(),
            tool: description.generation_tool.clone(),
            sha256: hex(&std::fs::read(path).map_err(Error::file(path))?),
        })
    };
    units.map(origin).collect()
}

/// The scenario with what all cases share.
fn scenario(study: &Study, limits: &Limits) -> Result<Scenario, Error> {
    let mut scenario = scenarios::load(&study.scenario).map_err(|source| Error::Scenario {
        place: study.scenario_place.clone(),
        source: Box::new(source),
    })?;
    if let Some((stop, place)) = &study.stop {
        scenario.set_stop(stop).map_err(placed(place))?;
    }
    for Parameter { name, place, value } in &study.set {
        let text = value.as_ref().map_or_else(String::new, |value| match value {
            Value::String(text) => text.clone(),
            value => value.to_string(),
        });
        scenario.set(name, &text).map_err(placed(place))?;
    }
    for (name, value) in &limits.set {
        not_varied(study, name, value)?;
        scenario.set(name, value)?;
    }
    if let Some(stop) = &limits.stop {
        scenario.set_stop(stop)?;
    }
    for unit in &mut scenario.units {
        if limits.isolate && unit.isolation.is_none() {
            unit.isolation = Some(Isolation::default());
        }
        let Some(isolation) = &mut unit.isolation else { continue };
        isolation.step_limit = limits.step.unwrap_or(isolation.step_limit);
        isolation.memory_limit = limits.memory.or(isolation.memory_limit);
    }
    let given = [("--step-limit", limits.step.is_some()), ("--memory-limit", limits.memory.is_some())];
    if let Some((option, _)) = given.into_iter().find(|(_, given)| *given)
        && scenario.units.iter().all(|unit| unit.isolation.is_none())
    {
        return Err(Error::Limit { option });
    }
    Ok(scenario)
}

/// A value for all cases of a parameter that has one of its own in each would change nothing.
fn not_varied(study: &Study, name: &str, value: &str) -> Result<(), Error> {
    match study.parameters.iter().find(|varied| varied.name == name) {
        None => Ok(()),
        Some(varied) => Err(Error::Study {
            place: format!("--set {name}={value}"),
            what: format!("{} varies {name}, so that this value would be in no case", varied.place),
            expected: "leave --set out, or let the study not vary it".into(),
        }),
    }
}

/// What is wrong with a value of `[set]` is told with the study's line.
fn set_in(study: &Study, error: orchestrator::Error) -> Error {
    let place = match &error {
        orchestrator::Error::Scenario { place: Place::Override(typed), .. } => {
            let of =
                |one: &&Parameter| typed.strip_prefix(&one.name).is_some_and(|rest| rest.starts_with('='));
            study.set.iter().find(of).map(|one| one.place.clone())
        }
        _ => None,
    };
    match place {
        Some(place) => placed(&place)(error),
        None => error.into(),
    }
}

/// For `map_err` on what the orchestrator says of something that stands in the study.
fn placed(place: &str) -> impl Fn(orchestrator::Error) -> Error + '_ {
    use orchestrator::Error as Inner;
    move |error| {
        let (what, expected) = match error {
            Inner::Name { what, name, expected } => (format!("{what} {name:?} does not exist"), expected),
            Inner::Value { name, value, expected } => (format!("{name} = {value}"), expected),
            Inner::Scenario { what, expected, .. } => (what, expected),
            other => return Error::Orchestrator(other),
        };
        Error::Study { place: place.to_owned(), what, expected }
    }
}

fn place(recorded: &mut Vec<String>, name: &str) -> usize {
    recorded.iter().position(|known| known == name).unwrap_or_else(|| {
        recorded.push(name.to_owned());
        recorded.len() - 1
    })
}

/// A variable, or what is wrong with its name.
fn variable<'a>(simulation: &'a Simulation, name: &str, place: &str) -> Result<&'a Variable, Error> {
    let wrong = |what: String, expected: String| Error::Study { place: place.into(), what, expected };
    let (unit, bare) = name.split_once('.').unwrap_or((name, ""));
    // What the master adds to a variable, such as its age, stands after a colon; the simulation knows whether it is there.
    let bare = bare.split(':').next().unwrap_or(bare);
    let Some((_, description)) = simulation.units().find(|(known, _)| *known == unit) else {
        let expected = orchestrator::nearest(unit, simulation.units().map(|(known, _)| known));
        return Err(wrong(format!("{name:?}: there is no unit {unit:?}"), expected));
    };
    description.variable(bare).ok_or_else(|| {
        let names = description.variables.iter().map(|variable| variable.name.as_str());
        wrong(format!("unit {unit} has no variable {bare:?}"), orchestrator::nearest(bare, names))
    })
}

/// A variable that has numbers.
fn number<'a>(simulation: &'a Simulation, name: &str, place: &str) -> Result<&'a Variable, Error> {
    let found = variable(simulation, name, place)?;
    match found.kind {
        Kind::String => Err(Error::Study {
            place: place.into(),
            what: format!("{name} is a String"),
            expected: "a signal that has numbers".into(),
        }),
        _ => Ok(found),
    }
}

/// Without a limit only a Boolean is true or not.
fn boolean(found: &Variable, name: &str, test: Test, place: &str) -> Result<(), Error> {
    if test != Test::True || found.kind == Kind::Boolean {
        return Ok(());
    }
    let what = format!("{name} is of type {}, neither true nor false", found.kind);
    Err(Error::Study {
        place: place.into(),
        what,
        expected: "a limit: above = 2.0 or below = -2.0 (until: \"> 2\")".into(),
    })
}

/// Checks the signals of a scalar; answers its physical unit.
fn checked(scalar: &Scalar, simulation: &Simulation) -> Result<Option<String>, Error> {
    let found = number(simulation, &scalar.signal, &scalar.place)?;
    if let Some(minus) = &scalar.minus {
        number(simulation, minus, &scalar.place)?;
        if let Some(why) = simulation.unlike(&scalar.signal, minus) {
            let expected = "a signal of the same unit, which can be taken off it".to_owned();
            return Err(Error::Study { place: scalar.place.clone(), what: why, expected });
        }
    }
    match scalar.reduce {
        Reduce::FirstTrue(test) => {
            boolean(found, &scalar.signal, test, &scalar.place)?;
            Ok(Some("s".to_owned()))
        }
        _ => Ok(found.unit.clone()),
    }
}

/// The folder of the study's own files.
pub(crate) fn files(out: &Path) -> [PathBuf; 2] {
    [out.join("study.toml"), out.join("resolved.toml")]
}
