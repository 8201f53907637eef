//! One instance, in safe Rust: the scenario inside, held to the calling sequence of FMI 2.0.

use crate::error::Error;
use crate::host;
use crate::interface::{Interface, Variable};
use crate::state::State;
use crate::xml;
use orchestrator::fmu::{Causality, Variability};
use orchestrator::time::Rational;
use orchestrator::{Kind, Scenario, Simulation, UnitPath, Value};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Rounding that a master may have made when it computed a time, relative to the times at hand: a million steps of an
/// accumulating master stay below 1e-10.
const TIME_TOLERANCE: f64 = 1e-9;

/// The scenario's file in `resources/`.
pub(crate) const SCENARIO: &str = "scenario.toml";

/// State of the calling sequence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// After `fmi2Instantiate` or `fmi2Reset`.
    Instantiated,
    /// Between `fmi2EnterInitializationMode` and `fmi2ExitInitializationMode`.
    Initialization,
    /// At a communication point.
    Step,
    /// A unit inside has ended the run.
    Ended,
    /// After `fmi2Terminate`.
    Terminated,
    /// After a call that failed half-way.
    Error,
}

impl Mode {
    /// What the standard calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Instantiated => "instantiated",
            Self::Initialization => "initialization mode",
            Self::Step => "step complete",
            Self::Ended => "step failed",
            Self::Terminated => "terminated",
            Self::Error => "error",
        }
    }
}

/// What became of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stepped {
    /// It was made.
    Whole,
    /// A unit inside wants the run to end; so far it came.
    Ended(f64),
}

/// An instance.
pub struct Instance {
    pub(crate) interface: Interface,
    pub(crate) guid: String,
    scenario: Scenario,
    /// What of the scenario can't be had here.
    note: Option<String>,
    units: UnitPath,
    pub(crate) simulation: Simulation,
    pub(crate) mode: Mode,
    /// In initialisation mode: something was set since the units were initialised.
    pub(crate) stale: bool,
    /// Start and stop, as `fmi2SetupExperiment` gave them.
    pub(crate) experiment: Option<(f64, Option<f64>)>,
    /// Current communication point in s.
    pub(crate) time: f64,
    pub(crate) starts: BTreeMap<u32, Value>,
    pub(crate) saved: BTreeMap<usize, State>,
    pub(crate) next_handle: usize,
}

impl Instance {
    /// Reads the scenario in a folder of resources. Units that are isolated are served by this program.
    ///
    /// # Errors
    /// If it can't be built there.
    pub fn new(resources: &Path) -> Result<Self, Error> {
        Self::hosted(resources, |_| None)
    }

    /// As [`Instance::new`], in the library of a container, which serves isolated units itself.
    pub(crate) fn in_library(resources: &Path) -> Result<Self, Error> {
        Self::hosted(resources, host::by_this_library)
    }

    fn hosted(resources: &Path, host: impl FnOnce(&mut Scenario) -> Option<String>) -> Result<Self, Error> {
        let file = resources.join(SCENARIO);
        let text = std::fs::read_to_string(&file)
            .map_err(|error| Error::File { path: file.clone(), why: error.to_string() })?;
        let mut scenario = Scenario::parse(&text, &file)?;
        let note = host(&mut scenario);
        let units = UnitPath::new();
        let simulation = Simulation::new(&scenario, &units)?;
        let interface = Interface::of(&simulation);
        let inside: Vec<&str> =
            simulation.units().map(|(_, description)| description.guid.as_str()).collect();
        let guid = xml::guid(&interface, &text, &inside);
        Ok(Self {
            interface,
            guid,
            scenario,
            note,
            units,
            simulation,
            mode: Mode::Instantiated,
            stale: true,
            experiment: None,
            time: 0.0,
            starts: BTreeMap::new(),
            saved: BTreeMap::new(),
            next_handle: 1,
        })
    }

    /// The GUID that belongs to the scenario.
    pub fn guid(&self) -> &str {
        &self.guid
    }

    /// What the outside sees.
    pub fn interface(&self) -> &Interface {
        &self.interface
    }

    /// Where the calling sequence stands.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// After a panic, nothing is known of what is inside.
    pub(crate) fn fail(&mut self) {
        self.mode = Mode::Error;
    }

    /// What a person should know.
    pub fn notices(&self) -> Vec<String> {
        self.note.iter().cloned().chain(self.simulation.notices()).collect()
    }

    fn expect(&self, modes: &[Mode]) -> Result<(), Error> {
        if modes.contains(&self.mode) { Ok(()) } else { Err(Error::Illegal { mode: self.mode.name() }) }
    }

    /// The scenario built anew, with what was set before the start.
    pub(crate) fn rebuild(&mut self) -> Result<(), Error> {
        let mut scenario = self.scenario.clone();
        let exact = |time: f64| Rational::recover(&Value::Real(time).to_string()).map(|(time, _)| time);
        if let Some((start, _)) = self.experiment.filter(|(start, _)| *start != scenario.start.to_f64()) {
            let expected = || "a time that fits 64-bit fractions".to_owned();
            let wrong = || Error::Argument { argument: "startTime", value: start, expected: expected() };
            scenario.start = exact(start).ok_or_else(wrong)?;
            // The stop inside plays no part but for the tick.
            scenario.stop = scenario.start;
        }
        let stop = self.experiment.and_then(|(_, stop)| stop);
        self.simulation = Simulation::new(&scenario, &self.units)?;
        if !self.end(stop)
            && let Some(stop) = stop.and_then(exact)
        {
            // A stop that has no common tick with the rest is one that no step ends at.
            scenario.stop = stop;
            if let Ok(ending) = Simulation::new(&scenario, &self.units) {
                self.simulation = ending;
                self.end(Some(stop.to_f64()));
            }
        }
        for (reference, value) in &self.starts {
            self.simulation.set(&self.interface.variables[*reference as usize].name, value.clone())?;
        }
        Ok(())
    }

    /// Has the units end at the master's stop, if it gives one; false where none of their steps can.
    fn end(&mut self, stop: Option<f64>) -> bool {
        let ends = stop.is_none_or(|stop| self.simulation.end_at(stop));
        if stop.is_none() || !ends {
            self.simulation.open_end(stop);
        }
        ends
    }

    /// `fmi2SetupExperiment`.
    pub fn setup_experiment(&mut self, start: f64, stop: Option<f64>) -> Result<(), Error> {
        self.expect(&[Mode::Instantiated])?;
        let refused = |argument, value, expected: &str| {
            Err(Error::Argument { argument, value, expected: expected.to_owned() })
        };
        if !start.is_finite() {
            return refused("startTime", start, "a finite number is needed");
        }
        if let Some(stop) = stop.filter(|stop| !stop.is_finite() || *stop < start) {
            return refused("stopTime", stop, "a finite number that is not before startTime is needed");
        }
        let before = self.experiment.replace((start, stop));
        let fits = start == self.simulation.span().0 && self.end(stop);
        if !fits && let Err(error) = self.rebuild() {
            self.experiment = before;
            return Err(error);
        }
        self.time = start;
        Ok(())
    }

    /// `fmi2EnterInitializationMode`.
    pub fn enter_initialization(&mut self) -> Result<(), Error> {
        self.expect(&[Mode::Instantiated])?;
        if self.experiment.is_none() {
            return Err(Error::NoExperiment);
        }
        self.mode = Mode::Initialization;
        self.stale = true;
        Ok(())
    }

    /// `fmi2ExitInitializationMode`.
    pub fn exit_initialization(&mut self) -> Result<(), Error> {
        self.expect(&[Mode::Initialization])?;
        self.refresh().inspect_err(|_| self.mode = Mode::Error)?;
        self.mode = Mode::Step;
        Ok(())
    }

    /// In initialisation mode: initialises the units if something was set since they were.
    fn refresh(&mut self) -> Result<(), Error> {
        if self.mode == Mode::Initialization && self.stale {
            self.simulation.reset();
            self.simulation.initialize()?;
            self.stale = false;
        }
        Ok(())
    }

    fn variable(&self, reference: u32, kind: Kind) -> Result<&Variable, Error> {
        let last = self.interface.variables.len().saturating_sub(1);
        let variable =
            self.interface.variables.get(reference as usize).ok_or(Error::Reference { reference, last })?;
        match variable.kind == kind {
            true => Ok(variable),
            false => Err(Error::Type { name: variable.name.clone(), reference, is: variable.kind }),
        }
    }

    /// `fmi2GetReal` and its like.
    pub fn get(&mut self, reference: u32, kind: Kind) -> Result<Value, Error> {
        self.expect(&[Mode::Initialization, Mode::Step, Mode::Ended, Mode::Terminated, Mode::Error])?;
        self.variable(reference, kind)?;
        self.refresh()?;
        Ok(self.simulation.get(&self.interface.variables[reference as usize].name)?)
    }

    /// `fmi2SetReal` and its like.
    pub fn set(&mut self, reference: u32, value: Value) -> Result<(), Error> {
        self.expect(&[Mode::Instantiated, Mode::Initialization, Mode::Step])?;
        let mode = self.mode;
        let variable = self.variable(reference, value.kind())?;
        let what = match (variable.causality, variable.variability) {
            (Causality::Input, _) => None,
            (Causality::Parameter, _) if mode != Mode::Step => None,
            (Causality::Parameter, Variability::Tunable) => None,
            (Causality::Parameter, _) => Some("a fixed parameter"),
            (Causality::Output, _) => Some("an output"),
            _ => Some("a local variable"),
        };
        if let Some(what) = what {
            return Err(Error::NotSettable { name: variable.name.clone(), what, mode: mode.name() });
        }
        if mode != Mode::Step {
            self.simulation.reset();
            self.stale = true;
        }
        let name = &self.interface.variables[reference as usize].name;
        self.simulation.set(name, value.clone())?;
        if mode != Mode::Step {
            self.starts.insert(reference, value);
        }
        Ok(())
    }

    /// `fmi2DoStep`: each unit goes on to the last of its own points that is not later than the end of the step.
    pub fn do_step(&mut self, from: f64, size: f64) -> Result<Stepped, Error> {
        self.expect(&[Mode::Step])?;
        let to = self.check_step(from, size)?;
        // A master's sum of steps may end a rounding error before the point that it means.
        let tick = self.simulation.tick().to_f64();
        let allowance = (TIME_TOLERANCE * to.abs().max(from.abs()).max(size)).min(tick / 4.0);
        if let Err(error) = self.simulation.advance_to(to + allowance) {
            self.mode = Mode::Error;
            return Err(error.into());
        }
        if !self.simulation.is_running() {
            self.mode = Mode::Ended;
            self.time = self.simulation.time();
            return Ok(Stepped::Ended(self.time));
        }
        self.time = to;
        Ok(Stepped::Whole)
    }

    fn check_step(&self, from: f64, size: f64) -> Result<f64, Error> {
        let refused = |argument, value, expected| Err(Error::Argument { argument, value, expected });
        let (time, to) = (self.time, from + size);
        if !(size.is_finite() && size > 0.0) {
            return refused("communicationStepSize", size, "a positive number is needed".to_owned());
        }
        let allowance = TIME_TOLERANCE * time.abs().max(from.abs()).max(size);
        if !(from.is_finite() && (from - time).abs() <= allowance) {
            return refused("currentCommunicationPoint", from, format!("the instance is at t = {time} s"));
        }
        if !(to.is_finite() && to > from) {
            return refused(
                "communicationStepSize",
                size,
                format!("too small or large to step from {from} s"),
            );
        }
        if let Some((_, Some(stop))) = self.experiment
            && to - stop > TIME_TOLERANCE * to.abs().max(stop.abs()).max(size)
        {
            return refused("communicationStepSize", size, format!("it leads past stopTime = {stop} s"));
        }
        Ok(to)
    }

    /// How far the last step came, in s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// `fmi2Terminate`.
    pub fn terminate(&mut self) -> Result<(), Error> {
        self.expect(&[Mode::Step, Mode::Ended])?;
        self.simulation.terminate();
        self.mode = Mode::Terminated;
        Ok(())
    }

    /// `fmi2Reset`.
    pub fn reset(&mut self) -> Result<(), Error> {
        let starts = std::mem::take(&mut self.starts);
        self.experiment = None;
        let own = starts.keys().map(|reference| &self.interface.variables[*reference as usize]);
        if self.simulation.span().0 == self.scenario.start.to_f64()
            && self.simulation.scenario().stop == self.scenario.stop
            && own.clone().all(|own| own.start.is_some())
        {
            self.simulation.reset();
            for variable in own {
                if let Some(start) = &variable.start {
                    self.simulation.set(&variable.name, start.clone())?;
                }
            }
        } else {
            self.rebuild()?;
        }
        (self.mode, self.stale, self.time) = (Mode::Instantiated, true, 0.0);
        Ok(())
    }
}
