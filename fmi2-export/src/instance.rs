//! One instance of a unit: its state, the calling sequence, initialisation and steps.
//!
//! Everything here is safe Rust; `abi` hands in slices and strings that it has checked. Access to variables lies
//! in `access`, what a saved state is in `saved`.

use crate::abi::types::{ERROR, OK, Status, WARNING};
use crate::description;
use crate::error::Error;
use crate::logger::{self, Logger};
use crate::model::{Description, Experiment, Model, Step};
use crate::saved::GUID_LENGTH;
use crate::state_machine::{Call, Mode, legal};
use crate::table::{Causality, Kind, Slot, Table, Variable};
use serde::{Deserialize, Serialize};
use std::any::TypeId;
use std::ffi::CString;
use std::sync::{Mutex, PoisonError};

/// Rounding that a master may have made when it computed a time, relative to the times at hand. A million steps
/// of an accumulating master stay below 1e-10, and no step that a unit can feel is that short.
const TIME_TOLERANCE: f64 = 1e-9;

/// What `fmi2GetFMUstate` copies: all that decides how the unit goes on.
#[derive(Clone, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct State<M: Model> {
    pub(crate) model: M,
    pub(crate) values: M::Variables,
    pub(crate) mode: Mode,
    /// In initialisation mode: something was set since the outputs were computed.
    pub(crate) stale: bool,
    pub(crate) experiment: Option<Experiment>,
    /// Current communication point in s.
    pub(crate) time: f64,
    /// Derivatives of inputs for the next step.
    pub(crate) input_rates: Vec<(u32, f64)>,
}

impl<M: Model> State<M> {
    fn new(model: M) -> Self {
        Self {
            model,
            values: M::Variables::default(),
            mode: Mode::Instantiated,
            stale: true,
            experiment: None,
            time: 0.0,
            input_rates: Vec::new(),
        }
    }
}

/// An instance.
pub struct Instance<M: Model> {
    pub(crate) declared: Vec<Variable>,
    /// Places of the Reals that the unit computes.
    computed: Vec<usize>,
    pub(crate) description: Description,
    pub(crate) guid: String,
    pub(crate) log: Logger,
    pub(crate) state: State<M>,
    /// The master promised never to go back before this time.
    no_state_before: Option<f64>,
    /// It was told that it did.
    warned_of_return: bool,
    /// What the last `fmi2DoStep` answered.
    pub(crate) last_step: Status,
    /// Strings lent to the master until its next call.
    pub(crate) lent: Vec<CString>,
}

impl<M: Model> Instance<M> {
    /// A new instance with start values. `guid` is the unit's own.
    pub fn new(log: Logger, guid: String) -> Self {
        let declared = M::Variables::variables();
        let is_computed = |variable: &Variable| {
            let by_unit = matches!(variable.causality, Causality::Output | Causality::Local);
            by_unit && matches!(variable.kind, Kind::Real(_))
        };
        let computed = (0..declared.len()).filter(|&at| is_computed(&declared[at])).collect();
        Self {
            declared,
            computed,
            description: M::description(),
            guid,
            log,
            state: State::new(M::default()),
            no_state_before: None,
            warned_of_return: false,
            last_step: OK,
            lent: Vec::new(),
        }
    }

    /// Logs why `function` was refused.
    pub fn report(&self, function: &str, status: Status, error: &Error) {
        let message = || format!("{function}: {error}");
        let category = if status == ERROR { logger::STATUS_ERROR } else { logger::STATUS_DISCARD };
        self.log.send(status, category.name, &message);
    }

    /// Whether the calling sequence allows `call` now.
    pub fn check(&self, call: Call) -> Result<(), Error> {
        if legal(call, self.state.mode) {
            Ok(())
        } else {
            Err(Error::Illegal { mode: self.state.mode.name() })
        }
    }

    /// `fmi2SetupExperiment`.
    pub fn setup_experiment(&mut self, experiment: Experiment) -> Result<(), Error> {
        let Experiment { start, stop, tolerance } = experiment;
        let refused = |argument, value, expected: &str| {
            Err(Error::Argument { argument, value, expected: expected.to_owned() })
        };
        if !start.is_finite() {
            return refused("startTime", start, "a finite number is needed");
        }
        if let Some(stop) = stop.filter(|stop| !stop.is_finite() || *stop < start) {
            return refused("stopTime", stop, "a finite number that is not before startTime is needed");
        }
        if let Some(tolerance) = tolerance.filter(|tolerance| !tolerance.is_finite() || *tolerance <= 0.0) {
            return refused("tolerance", tolerance, "a positive number is needed");
        }
        self.state.experiment = Some(experiment);
        self.state.time = start;
        Ok(())
    }

    /// `fmi2EnterInitializationMode`.
    pub fn enter_initialization(&mut self) -> Result<(), Error> {
        if self.state.experiment.is_none() {
            return Err(Error::NoExperiment);
        }
        self.state.mode = Mode::Initialization;
        self.state.stale = true;
        Ok(())
    }

    /// `fmi2ExitInitializationMode`.
    pub fn exit_initialization(&mut self) -> Result<(), Error> {
        if let Err(error) = self.refresh() {
            self.state.mode = Mode::Error;
            return Err(error);
        }
        self.state.mode = Mode::Step;
        Ok(())
    }

    /// In initialisation mode: computes the outputs if something was set since they were. If that fails, the
    /// mode stays, so that better values may follow.
    pub fn refresh(&mut self) -> Result<(), Error> {
        if self.state.mode != Mode::Initialization || !self.state.stale {
            return Ok(());
        }
        let experiment = self.state.experiment.ok_or(Error::NoExperiment)?;
        self.state.model = std::mem::take(&mut self.state.model).renewed();
        self.state.model.initialize(&mut self.state.values, &experiment, &mut self.log)?;
        self.check_outputs()?;
        self.state.stale = false;
        Ok(())
    }

    /// `fmi2DoStep`. What is wrong with the arguments is refused and changes nothing; a model that fails leaves
    /// the instance in the error state.
    pub fn do_step(&mut self, from: f64, size: f64, keep_going: bool) -> Result<(), Error> {
        let to = self.check_step(from, size)?;
        if keep_going {
            self.no_state_before = Some(from);
        }
        self.last_step = ERROR;
        let outcome = self.advance(from, to);
        self.state.input_rates.clear();
        if let Err(error) = outcome {
            self.state.mode = Mode::Error;
            return Err(error);
        }
        self.state.time = to;
        self.last_step = OK;
        Ok(())
    }

    fn advance(&mut self, from: f64, to: f64) -> Result<(), Error> {
        let rates = self.state.input_rates.iter();
        let input_rates: Vec<_> = rates.map(|(at, rate)| (self.declared[*at as usize].name, *rate)).collect();
        let step = Step { from, to, input_rates: &input_rates };
        self.state.model.step(&mut self.state.values, &step, &mut self.log)?;
        self.check_outputs()
    }

    /// Where a legal step ends.
    fn check_step(&self, from: f64, size: f64) -> Result<f64, Error> {
        let refused = |argument, value, expected| Err(Error::Argument { argument, value, expected });
        let time = self.state.time;
        let to = from + size;
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
        if let Some(stop) = self.state.experiment.and_then(|experiment| experiment.stop)
            && to - stop > TIME_TOLERANCE * to.abs().max(stop.abs()).max(size)
        {
            return refused("communicationStepSize", size, format!("it leads past stopTime = {stop} s"));
        }
        Ok(to)
    }

    /// No output that isn't a number may leave the unit.
    fn check_outputs(&self) -> Result<(), Error> {
        for &at in &self.computed {
            if let Some(Slot::Real(value)) = self.state.values.get(at)
                && !value.is_finite()
            {
                return Err(Error::NotFinite { name: self.declared[at].name, value: *value });
            }
        }
        Ok(())
    }

    /// `fmi2Terminate`.
    pub fn terminate(&mut self) -> Result<(), Error> {
        self.state.mode = Mode::Terminated;
        Ok(())
    }

    /// `fmi2Reset`.
    pub fn reset(&mut self) -> Result<(), Error> {
        self.state = State::new(std::mem::take(&mut self.state.model).renewed());
        self.no_state_before = None;
        self.last_step = OK;
        Ok(())
    }

    /// `fmi2SetFMUstate`. A master that goes back further than it promised with `fmi2DoStep` is told once and let go on:
    /// FMPy's default makes that promise in each step, and nothing here was given up for it.
    pub fn restore(&mut self, state: State<M>) -> Result<(), Error> {
        if let Some(limit) = self.no_state_before.filter(|_| !self.warned_of_return) {
            let time = state.time;
            if limit - time > TIME_TOLERANCE * limit.abs().max(time.abs()) {
                self.warned_of_return = true;
                self.log.send(WARNING, logger::STATUS_WARNING.name, &|| {
                    format!(
                        "fmi2SetFMUstate: the state is of t = {time} s, though fmi2DoStep was told \
                         (noSetFMUStatePriorToCurrentPoint) that none before {limit} s would be set; it is restored all the \
                         same, and this is not said again"
                    )
                });
            }
        }
        self.state = state;
        Ok(())
    }
}

/// The GUID that belongs to `M`'s description. The last one is kept, since it takes the whole description and its digest, and an instance of
/// a small unit would cost little else; within the library, whose memory goes with it: what a static holds on the heap would stay behind.
pub fn guid<M: Model>() -> String {
    static LAST: Mutex<Option<(TypeId, [u8; GUID_LENGTH])>> = Mutex::new(None);
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, known)) = last.as_ref().filter(|(model, _)| *model == TypeId::of::<M>()) {
        return String::from_utf8_lossy(known).into_owned();
    }
    let guid = description::Unit::of::<M>().guid();
    *last = guid.as_bytes().try_into().ok().map(|bytes| (TypeId::of::<M>(), bytes));
    guid
}
