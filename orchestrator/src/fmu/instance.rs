//! One instance of a unit: every call with its lengths checked and its status looked at.

use crate::error::Error;
use crate::fmu::library::{Callbacks, Component, Functions};
use crate::fmu::logger::{LogLine, Sink, calloc, free, orchestrator_logger};
use crate::fmu::{Fmu, Status};
use crate::value::{Kind, Value};
use std::ffi::{CString, c_char, c_int};
use std::ptr;

/// Where an instance is in the state machine of FMI 2.0 section 4.2.4, as far as freeing it needs to know.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    Instantiated,
    Initialising,
    Stepping,
    Terminated,
    Failed,
    /// After a fatal status nothing may be called any more, not even the freeing.
    Dead,
}

/// An instance of a unit. Dropping it terminates and frees it.
pub struct Instance {
    component: Component,
    pub(super) functions: Functions,
    phase: Phase,
    warnings: u64,
    name: String,
    sink: Box<Sink>,
    // Read by the unit through the pointer it was given; never moved.
    _callbacks: Box<Callbacks>,
    // Last, so that the library outlives everything above.
    fmu: Fmu,
}

// SAFETY: FMI 2.0 section 2.1.1 asks for no thread affinity: calls on one instance must only not overlap, and every
// call here takes `&mut self`. The sink is behind a mutex.
unsafe impl Send for Instance {}

impl Instance {
    pub(super) fn new(fmu: Fmu, name: &str) -> Result<Self, Error> {
        let functions = fmu.library()?.functions;
        let text = |text: &str| CString::new(text.replace('\0', "")).unwrap_or_default();
        let (instance_name, guid) = (text(name), text(&fmu.description().guid));
        let resources = text(&fmu.inner.archive.resource_uri());
        let sink = Sink::new();
        let callbacks = Box::new(Callbacks {
            logger: orchestrator_logger,
            allocate: calloc,
            free,
            step_finished: None,
            environment: ptr::from_ref(&*sink).cast_mut().cast(),
        });
        const CO_SIMULATION: c_int = 1;
        // SAFETY: all strings end in zero and live over the call; callbacks and sink outlive the instance.
        let component = unsafe {
            (functions.instantiate)(
                instance_name.as_ptr(),
                CO_SIMULATION,
                guid.as_ptr(),
                resources.as_ptr(),
                &*callbacks,
                0,
                1,
            )
        };
        if component.is_null() {
            return Err(Error::Instantiate { unit: name.into(), path: fmu.path().into(), log: sink.lines() });
        }
        let mut instance = Self {
            component,
            functions,
            phase: Phase::Instantiated,
            warnings: 0,
            name: name.into(),
            sink,
            _callbacks: callbacks,
            fmu,
        };
        instance.quieten();
        Ok(instance)
    }

    /// Asks for errors and warnings only, where the unit tells them apart: logging every call would cost more
    /// than the call.
    fn quieten(&mut self) {
        let wanted: Vec<CString> = (self.fmu.description().log_categories.iter())
            .filter(|name| name.starts_with("logStatus"))
            .filter_map(|name| CString::new(name.as_str()).ok())
            .collect();
        let (Some(set), false) = (self.functions.set_debug_logging, wanted.is_empty()) else { return };
        let pointers: Vec<*const c_char> = wanted.iter().map(|name| name.as_ptr()).collect();
        // SAFETY: the pointers are to terminated strings that live over the call. The status says only how much is
        // logged, so it doesn't matter.
        unsafe { set(self.component, 1, pointers.len(), pointers.as_ptr()) };
    }

    /// Name in the scenario.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The unit this is an instance of.
    pub fn fmu(&self) -> &Fmu {
        &self.fmu
    }

    /// The newest log lines, oldest first.
    pub fn log(&self) -> Vec<LogLine> {
        self.sink.lines()
    }

    /// Takes the log lines away.
    pub fn take_log(&mut self) -> Vec<LogLine> {
        self.sink.take()
    }

    /// How many calls answered with a warning so far.
    pub fn warnings(&self) -> u64 {
        self.warnings
    }

    pub(super) fn component(&self) -> Component {
        self.component
    }

    /// Looks at a status: warnings are counted, everything worse is an error.
    #[inline]
    pub(super) fn checked(&mut self, function: &'static str, status: c_int) -> Result<(), Error> {
        if status == 0 { Ok(()) } else { self.not_ok(function, Status::from(status)) }
    }

    #[cold]
    fn not_ok(&mut self, function: &'static str, status: Status) -> Result<(), Error> {
        if self.note(status) {
            return Ok(());
        }
        Err(self.failure(function, status, None))
    }

    /// Keeps in mind what a status means for later calls; true if the run goes on.
    pub(crate) fn note(&mut self, status: Status) -> bool {
        match status {
            Status::Ok => return true,
            Status::Warning => {
                self.warnings += 1;
                return true;
            }
            Status::Fatal => self.phase = Phase::Dead,
            Status::Error | Status::Unknown(_) | Status::Pending => self.phase = Phase::Failed,
            Status::Discard => {}
        }
        false
    }

    /// The error for a call that failed.
    #[cold]
    pub(crate) fn failure(&self, function: &'static str, status: Status, time: Option<f64>) -> Error {
        Error::Call { unit: self.name.clone(), function, status, time, log: self.sink.lines() }
    }

    /// `fmi2SetupExperiment`.
    pub fn setup_experiment(&mut self, start: f64, stop: Option<f64>) -> Result<(), Error> {
        // SAFETY: plain values.
        let status = unsafe {
            (self.functions.setup_experiment)(
                self.component,
                0,
                0.0,
                start,
                c_int::from(stop.is_some()),
                stop.unwrap_or(0.0),
            )
        };
        self.checked("fmi2SetupExperiment", status)
    }

    /// `fmi2EnterInitializationMode`.
    pub fn enter_initialization(&mut self) -> Result<(), Error> {
        // SAFETY: the component is alive.
        let status = unsafe { (self.functions.enter_initialization)(self.component) };
        self.checked("fmi2EnterInitializationMode", status)?;
        self.phase = Phase::Initialising;
        Ok(())
    }

    /// `fmi2ExitInitializationMode`.
    pub fn exit_initialization(&mut self) -> Result<(), Error> {
        // SAFETY: the component is alive.
        let status = unsafe { (self.functions.exit_initialization)(self.component) };
        self.checked("fmi2ExitInitializationMode", status)?;
        self.phase = Phase::Stepping;
        Ok(())
    }

    /// `fmi2DoStep`. The status is returned as it is, since a discarded step is the master's business.
    #[inline]
    pub fn do_step(&mut self, from: f64, size: f64, no_return: bool) -> Status {
        // SAFETY: plain values.
        let status = unsafe { (self.functions.do_step)(self.component, from, size, c_int::from(no_return)) };
        if status == 0 { Status::Ok } else { Status::from(status) }
    }

    /// `fmi2Terminate`.
    pub fn terminate(&mut self) -> Result<(), Error> {
        // SAFETY: the component is alive.
        let status = unsafe { (self.functions.terminate)(self.component) };
        self.phase = Phase::Terminated;
        self.checked("fmi2Terminate", status)
    }

    /// `fmi2Reset`: back to the state after instantiation. A unit that can't is replaced by a fresh instance.
    pub fn reset(&mut self) -> Result<(), Error> {
        if self.phase == Phase::Instantiated {
            return Ok(());
        }
        self.warnings = 0;
        self.sink.take();
        if self.phase != Phase::Dead
            && let Some(reset) = self.functions.reset
        {
            // SAFETY: the component is alive.
            let status = Status::from(unsafe { reset(self.component) });
            if matches!(status, Status::Ok | Status::Warning) {
                self.phase = Phase::Instantiated;
                return Ok(());
            }
            self.note(status);
        }
        *self = Self::new(self.fmu.clone(), &self.name.clone())?;
        Ok(())
    }

    /// Last time that the unit reached, if it can tell (`fmi2LastSuccessfulTime`).
    pub fn last_successful_time(&mut self) -> Option<f64> {
        const LAST_SUCCESSFUL_TIME: c_int = 2;
        let mut time = f64::NAN;
        // SAFETY: the pointer is to a value that lives over the call.
        let status =
            unsafe { (self.functions.get_real_status?)(self.component, LAST_SUCCESSFUL_TIME, &mut time) };
        (status == 0 && time.is_finite()).then_some(time)
    }

    /// Reads one variable.
    pub fn get(&mut self, kind: Kind, reference: u32) -> Result<Value, Error> {
        Ok(match kind {
            Kind::Real => {
                let mut value = [0.0];
                self.get_real(&[reference], &mut value)?;
                Value::Real(value[0])
            }
            Kind::Integer => {
                let mut value = [0];
                self.get_integer(&[reference], &mut value)?;
                Value::Integer(value[0])
            }
            Kind::Boolean => {
                let mut value = [0];
                self.get_boolean(&[reference], &mut value)?;
                Value::Boolean(value[0] != 0)
            }
            Kind::String => {
                let mut value = [String::new()];
                self.get_string(&[reference], &mut value)?;
                let [text] = value;
                Value::String(text)
            }
        })
    }

    /// Writes one variable.
    pub fn set(&mut self, reference: u32, value: &Value) -> Result<(), Error> {
        match value {
            Value::Real(value) => self.set_real(&[reference], &[*value]),
            Value::Integer(value) => self.set_integer(&[reference], &[*value]),
            Value::Boolean(value) => self.set_boolean(&[reference], &[i32::from(*value)]),
            Value::String(value) => self.set_string(&[reference], std::slice::from_ref(value)),
        }
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        if self.phase == Phase::Dead {
            return;
        }
        // SAFETY: the component is alive and not used afterwards; its answer to the last call changes nothing.
        unsafe {
            if self.phase == Phase::Stepping {
                (self.functions.terminate)(self.component);
            }
            (self.functions.free_instance)(self.component);
        }
    }
}
