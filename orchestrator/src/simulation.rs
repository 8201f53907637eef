//! A scenario that was built: run it, step it, look into it, run it again with other values.

use crate::algorithm::{self, Algorithm};
use crate::checkpoint::{Checkpoint, Checkpoints};
use crate::error::Error;
use crate::fmu::{Causality, Description, Variability};
use crate::guard;
use crate::initialise::initialise;
use crate::pacing::Lateness;
use crate::progress::Progress;
use crate::recorder::{Column, Recorder, Row};
use crate::run::Stop;
use crate::scenario::{Scenario, UnitEntry};
use crate::system::{Point, System};
use crate::unit_path::UnitPath;
use crate::value::Value;
use crate::wiring::{self, Wiring, start_value};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Where a simulation is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Built or reset; the units are not initialised.
    Ready,
    /// Between two points.
    Running,
    /// At its end, or broken: only a reset leads on.
    Over,
}

/// A built scenario. Building loads and instantiates the units; every run reuses them.
pub struct Simulation {
    pub(crate) scenario: Scenario,
    pub(crate) wiring: Wiring,
    pub(crate) algorithm: Box<dyn Algorithm>,
    pub(crate) phase: Phase,
    pub(crate) now: Point,
    pub(crate) stops: Vec<Stop>,
    /// Simulated seconds a second, if runs keep to the real clock.
    pub(crate) pace: Option<f64>,
    pub(crate) lateness: Option<Lateness>,
    pub(crate) notices: Vec<String>,
    replaced_starts: Vec<String>,
    pub(crate) from_unit_path: Vec<bool>,
    /// What tells the units' files apart, once that was asked.
    pub(crate) sums: OnceLock<String>,
}

impl Simulation {
    /// Builds a scenario: finds and loads its units, checks every name, type, unit and value, and lays out all
    /// copies.
    ///
    /// # Errors
    /// If anything in the scenario doesn't fit the units, naming file and line.
    pub fn new(scenario: &Scenario, path: &UnitPath) -> Result<Self, Error> {
        let algorithm = algorithm::of(scenario)?;
        let wiring = wiring::wire(scenario, path, algorithm.needs())?;
        algorithm::fits(scenario, algorithm.as_ref(), &wiring.system)?;
        let in_folders = |(file, unit): (&PathBuf, &UnitEntry)| {
            path.folders().iter().any(|folder| *file == folder.join(&unit.fmu.value))
        };
        Ok(Self {
            from_unit_path: wiring.files.iter().zip(&scenario.units).map(in_folders).collect(),
            scenario: scenario.clone(),
            now: wiring.start,
            wiring,
            algorithm,
            phase: Phase::Ready,
            stops: Vec::new(),
            pace: None,
            lateness: None,
            notices: Vec::new(),
            replaced_starts: Vec::new(),
            sums: OnceLock::new(),
        })
    }

    /// Runs from the start to the stop time, or until a stop condition holds or the progress says so. Resets first
    /// where that is needed.
    ///
    /// # Errors
    /// If a unit fails, a value passed between units is NaN, or results can't be written. What was recorded until
    /// then stays.
    pub fn run(
        &mut self,
        recorder: &mut dyn Recorder,
        progress: &mut dyn Progress,
    ) -> Result<crate::Ended, Error> {
        crate::run::run(self, recorder, progress)
    }

    /// As [`Simulation::run`], with a checkpoint each time that a number of simulated seconds is full, and from one on.
    /// The recorder must keep its place: [`crate::CsvRecorder::resume`].
    ///
    /// # Errors
    /// As [`Simulation::run`]; if a unit can't save its state; if the checkpoint belongs to another run.
    pub fn run_on(
        &mut self,
        from: Option<&Checkpoint>,
        checkpoints: Option<&Checkpoints>,
        recorder: &mut dyn Recorder,
        progress: &mut dyn Progress,
    ) -> Result<crate::Ended, Error> {
        crate::run::run_on(self, from, checkpoints, recorder, progress)
    }

    /// Has further runs keep to the real clock: so many simulated seconds a second, which are above zero, or as fast as it
    /// goes. Results are the same.
    pub fn pace(&mut self, factor: Option<f64>) {
        self.pace = factor.filter(|factor| *factor > 0.0);
    }

    /// How well the last run kept to it.
    pub fn lateness(&self) -> Option<&Lateness> {
        self.lateness.as_ref()
    }

    /// Back to before the start. Values set for the start stay as they are.
    pub fn reset(&mut self) {
        self.phase = Phase::Ready;
        self.now = self.wiring.start;
    }

    /// Initialises the units, if that has not been done.
    ///
    /// # Errors
    /// If a unit fails, or an algebraic loop has no solution.
    pub fn initialize(&mut self) -> Result<(), Error> {
        if self.phase != Phase::Ready {
            return Ok(());
        }
        let Wiring { system, clock, plan, sets, start, told_stop, names, .. } = &mut self.wiring;
        let by_reference: Vec<Vec<(u32, Value)>> = (sets.iter().enumerate())
            .map(|(unit, sets)| {
                let reference = |place: usize| names.variable((unit, place)).reference;
                sets.iter().map(|(place, value)| (reference(*place), value.clone())).collect()
            })
            .collect();
        self.notices.clear();
        self.replaced_starts.clear();
        self.phase = Phase::Over;
        let (notices, replaced) = (&mut self.notices, &mut self.replaced_starts);
        initialise(system, plan, &by_reference, *start, *told_stop, notices, replaced)?;
        system.age(clock, start.ticks);
        self.algorithm.start(system);
        self.now = *start;
        self.phase = Phase::Running;
        Ok(())
    }

    /// Goes on to the next communication point of any unit; `None` when there is none before the stop time.
    ///
    /// # Errors
    /// As [`Simulation::run`].
    pub fn advance(&mut self) -> Result<Option<f64>, Error> {
        self.initialize()?;
        if self.phase == Phase::Over {
            return Ok(None);
        }
        match self.advance_by(1) {
            Err(Error::Terminated { .. }) => Ok(None),
            made => Ok((made? == 1).then_some(self.now.time)),
        }
    }

    /// Goes over the next points, at most so many; fewer than these if there are no more.
    pub(crate) fn advance_by(&mut self, most: u32) -> Result<u32, Error> {
        let Wiring { system, clock, .. } = &mut self.wiring;
        let made = self.algorithm.advance(system, clock, &mut self.now, most);
        guard::leave();
        system.age(clock, self.now.ticks);
        let Err(mut error) = made else { return made.map_err(|error| *error) };
        self.phase = Phase::Over;
        if let Error::Terminated { time, .. } = &mut *error {
            // Others may have gone on to the point already; what they show is not earlier than that.
            let reached = self.wiring.system.units.iter().map(|unit| unit.begin);
            *time = reached.fold(*time, f64::max);
            self.now.time = *time;
        }
        Err(*error)
    }

    /// Tells all units that the run is over, which units do at the latest when they are dropped; what they answer is
    /// among the notices. Only a reset leads on.
    pub fn terminate(&mut self) {
        self.phase = Phase::Over;
        for unit in &mut self.wiring.system.units {
            if unit.instance.is_stepping()
                && let Err(error) = unit.instance.terminate()
            {
                self.notices.push(error.to_string());
            }
        }
    }

    /// Goes on to the last communication point that is not later than a time in s.
    ///
    /// # Errors
    /// As [`Simulation::run`].
    pub fn advance_to(&mut self, time: f64) -> Result<(), Error> {
        self.initialize()?;
        while self.phase == Phase::Running {
            match self.wiring.system.next() {
                Some(ticks) if self.wiring.clock.seconds(ticks) <= time => self.advance()?,
                _ => break,
            };
        }
        Ok(())
    }

    /// Simulated time in s.
    pub fn time(&self) -> f64 {
        self.now.time
    }

    /// Start and stop time in s.
    pub fn span(&self) -> (f64, f64) {
        (self.wiring.start.time, self.wiring.stop)
    }

    /// The value of `unit.variable` now, as a number (Booleans are 0 and 1).
    ///
    /// # Errors
    /// If there is no such variable, or it is a String.
    pub fn value(&mut self, name: &str) -> Result<f64, Error> {
        let value = self.get(name)?;
        let expected = || "a String has no number; use Simulation::get".into();
        value.as_f64().ok_or_else(|| Error::Value {
            name: name.into(),
            value: value.to_string(),
            expected: expected(),
        })
    }

    /// The value of `unit.variable` now, in its own type.
    ///
    /// # Errors
    /// If there is no such variable, or initialisation fails.
    pub fn get(&mut self, name: &str) -> Result<Value, Error> {
        if let Some(&slot) = self.wiring.derived.get(name) {
            self.initialize()?;
            return Ok(self.wiring.system.values.get(slot));
        }
        let variable = self.wiring.names.named(name)?;
        self.initialize()?;
        if let Some(slot) = self.wiring.slots.get(&variable) {
            return Ok(self.wiring.system.values.get(*slot));
        }
        let description = self.wiring.names.variable(variable);
        self.wiring.system.units[variable.0].instance.get(description.kind, description.reference)
    }

    /// Gives `unit.variable` a value. Before a run it is a start value and stays for all further runs; while
    /// stepping it must be an input that nothing drives or a tunable parameter, and holds until the reset.
    ///
    /// # Errors
    /// If there is no such variable, the type or range is wrong, or it can't be set now.
    pub fn set(&mut self, name: &str, value: impl Into<Value>) -> Result<(), Error> {
        let value = value.into();
        let variable = self.wiring.names.named(name)?;
        let description = self.wiring.names.variable(variable);
        let wrong = |expected: String| Error::Value { name: name.into(), value: value.to_string(), expected };
        let by_name = || match &value {
            Value::String(name) => wiring::item(description, name),
            _ => None,
        };
        let typed = value.cast(description.kind).or_else(by_name);
        let typed = typed.ok_or_else(|| wrong(wiring::expected(description)))?;
        start_value(description, &typed).map_err(wrong)?;
        if self.phase != Phase::Running {
            let settable = self.wiring.names.settable(variable.0, &description.name);
            settable.map_err(|(what, expected)| wrong(format!("{what}: {expected}")))?;
            if let Some(expected) = self.wiring.overwritten(variable) {
                return Err(wrong(expected));
            }
            let sets = &mut self.wiring.sets[variable.0];
            match sets.iter_mut().find(|(place, _)| *place == variable.1) {
                Some((_, known)) => *known = typed,
                None => sets.push((variable.1, typed)),
            }
            return Ok(());
        }
        if let Some(place) = self.wiring.driven.get(&variable) {
            return Err(wrong(wiring::overwriting(place)));
        }
        let tunable = description.causality == Causality::Input
            || description.causality == Causality::Parameter
                && description.variability == Variability::Tunable;
        if !tunable {
            return Err(wrong(
                "only inputs and tunable parameters change while stepping, and reading a value or saving begins that; reset first"
                    .into(),
            ));
        }
        let System { units, values, .. } = &mut self.wiring.system;
        units[variable.0].instance.set(description.reference, &typed)?;
        if let Some(slot) = self.wiring.slots.get(&variable) {
            values.put(*slot, &typed);
        }
        if description.causality == Causality::Parameter {
            units[variable.0].read_fixed(values, self.now.time).map_err(|error| *error)?;
        }
        Ok(())
    }

    /// What is recorded.
    pub fn columns(&self) -> &[Column] {
        &self.wiring.columns
    }

    /// The recorded values now.
    pub fn row(&self) -> Row<'_> {
        let values = &self.wiring.system.values;
        Row {
            slots: &self.wiring.recorded,
            reals: &values.reals,
            integers: &values.integers,
            strings: &values.strings,
        }
    }

    /// Inputs whose start value gave way to the output that they are connected to, each as `unit.variable = value (now
    /// value)`: ordinary, but worth a look when a start value was meant to count.
    pub fn replaced_starts(&self) -> &[String] {
        &self.replaced_starts
    }

    /// The names of the units with their descriptions, in the order of the scenario.
    pub fn units(&self) -> impl Iterator<Item = (&str, &Description)> {
        self.wiring.names.units.iter().map(|(name, fmu)| (name.as_str(), fmu.description()))
    }

    /// Whether every unit begins anew after a reset, as a fresh one does ([`Fmu::restores`](crate::Fmu::restores)).
    pub fn restores(&self) -> bool {
        self.wiring.names.units.iter().all(|(_, fmu)| fmu.restores())
    }

    /// In which order units step where they do one after the other, by their places in the scenario.
    pub fn order(&self) -> &[usize] {
        &self.wiring.system.order
    }

    /// The files of the units, in the order of the scenario.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.wiring.files.iter().map(PathBuf::as_path)
    }

    /// The scenario it was built from.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }
}
