//! One instance of a unit: every call with its lengths checked and its status looked at.

use crate::error::Error;
use crate::fmu::library::{Callbacks, Component, Functions};
use crate::fmu::logger::{LogLine, Sink, calloc, free, orchestrator_logger};
use crate::fmu::{Fmu, Function, Status, control_word};
use crate::guard::{self, Label};
use crate::isolation::Isolation;
#[cfg(isolation)]
use crate::isolation::Remote;
use std::ffi::{CString, c_char, c_int, c_void};
use std::sync::Arc;

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

/// A component with what goes with it.
type Made = (Component, Functions, Arc<Sink>, Option<Box<Callbacks>>);

/// An instance of a unit. Dropping it terminates and frees it.
pub struct Instance {
    component: Component,
    pub(super) functions: Functions,
    phase: Phase,
    warnings: u64,
    name: String,
    label: &'static Label,
    /// The processor's control word, as it was before there was a unit.
    word: u32,
    /// Real variables that were asked for lately, and whether all of them can be set in initialization mode.
    pub(super) late: (Vec<u32>, bool),
    pub(super) sink: Arc<Sink>,
    // Read by the unit through the pointer it was given; never moved. None for a unit in another process.
    _callbacks: Option<Box<Callbacks>>,
    // Last, so that the library outlives everything above.
    fmu: Fmu,
}

// SAFETY: FMI 2.0 section 2.1.1 asks for no thread affinity: calls on one instance must only not overlap, and every
// call here takes `&mut self`. The sink is behind a mutex.
unsafe impl Send for Instance {}

impl Instance {
    pub(super) fn new(fmu: Fmu, name: &str) -> Result<Self, Error> {
        let (label, word) = (guard::label(name), control_word::read());
        let (component, functions, sink, callbacks) = match fmu.isolation() {
            Some(isolation) => Self::made_elsewhere(&fmu, name, isolation)?,
            None => Self::made_here(&fmu, name, label)?,
        };
        let mut instance = Self {
            component,
            functions,
            phase: Phase::Instantiated,
            warnings: 0,
            name: name.into(),
            label,
            word,
            late: (Vec::new(), true),
            sink,
            _callbacks: callbacks,
            fmu,
        };
        instance.quieten();
        Ok(instance)
    }

    fn made_here(fmu: &Fmu, name: &str, label: &'static Label) -> Result<Made, Error> {
        let functions = fmu.library(label)?.functions;
        let text = |text: &str| CString::new(text.replace('\0', "")).unwrap_or_default();
        let (instance_name, guid) = (text(name), text(fmu.guid()));
        let resources = text(&fmu.resource_uri());
        let sink = Sink::new(functions.instantiate as *const c_void);
        let callbacks = Box::new(Callbacks {
            logger: orchestrator_logger,
            allocate: calloc,
            free,
            step_finished: None,
            environment: sink.environment() as *mut c_void,
        });
        const CO_SIMULATION: c_int = 1;
        guard::beat();
        // SAFETY: all strings end in zero and live over the call; callbacks and sink outlive the instance.
        let component = guard::around(label, Function::Instantiate, || unsafe {
            (functions.instantiate)(
                instance_name.as_ptr(),
                CO_SIMULATION,
                guid.as_ptr(),
                resources.as_ptr(),
                &*callbacks,
                0,
                1,
            )
        });
        if component.is_null() {
            return Err(Error::Instantiate { unit: name.into(), path: fmu.path().into(), log: sink.lines() });
        }
        Ok((component, functions, sink, Some(callbacks)))
    }

    #[cfg(isolation)]
    fn made_elsewhere(fmu: &Fmu, name: &str, isolation: &Isolation) -> Result<Made, Error> {
        let sink = Sink::new(std::ptr::null());
        let (component, functions) = Remote::start(fmu, name, isolation, sink.clone())?;
        Ok((component, functions, sink, None))
    }

    #[cfg(not(isolation))]
    fn made_elsewhere(fmu: &Fmu, _: &str, _: &Isolation) -> Result<Made, Error> {
        let reason = "units in processes of their own need 64-bit Linux".into();
        Err(Error::Library { path: fmu.path().into(), reason })
    }

    /// The other process, if there is one.
    #[cfg(isolation)]
    pub(super) fn remote(&mut self) -> Option<&mut Remote> {
        // SAFETY: without callbacks the component is what `Remote::start` made, alive until it is freed.
        self._callbacks.is_none().then(|| unsafe { &mut *self.component.cast::<Remote>() })
    }

    #[cold]
    #[inline(never)]
    fn put_control_word_back(&self) {
        control_word::put_back(self.word);
        self.label.note_rounding();
    }

    /// What stands for the unit while it is called.
    #[inline(always)]
    pub(crate) fn label(&self) -> &'static Label {
        self.label
    }

    /// Something done with the unit, which is said to be called meanwhile.
    #[inline(always)]
    pub(super) fn entered<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        guard::within(self.label, || work(self))
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
        guard::around(self.label, Function::SetDebugLogging, || unsafe {
            set(self.component, 1, pointers.len(), pointers.as_ptr());
        });
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

    /// How many calls answered with a warning so far.
    pub fn warnings(&self) -> u64 {
        self.warnings
    }

    /// As many as at a checkpoint.
    pub(crate) fn set_warnings(&mut self, warnings: u64) {
        self.warnings = warnings;
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
                #[cfg(isolation)]
                if let Some(remote) = self.remote() {
                    self.warnings += remote.take_warned();
                }
                return true;
            }
            Status::Fatal => self.phase = Phase::Dead,
            Status::Error | Status::Unknown(_) | Status::Pending => self.phase = Phase::Failed,
            Status::Discard => {}
        }
        false
    }

    /// `fmi2SetupExperiment`, with the tolerance that the unit's own description proposes, as other masters do: a unit is as
    /// exact as its maker meant it to be.
    ///
    /// # Errors
    /// The unit failed; its status and its log lines are in the error.
    pub fn setup_experiment(&mut self, start: f64, stop: Option<f64>) -> Result<(), Error> {
        let proposed = self.fmu.description().default_experiment.tolerance;
        let tolerance = proposed.filter(|tolerance| tolerance.is_finite() && *tolerance > 0.0);
        // SAFETY: plain values.
        let status = guard::around(self.label, Function::SetupExperiment, || unsafe {
            (self.functions.setup_experiment)(
                self.component,
                c_int::from(tolerance.is_some()),
                tolerance.unwrap_or(0.0),
                start,
                c_int::from(stop.is_some()),
                stop.unwrap_or(0.0),
            )
        });
        self.checked("fmi2SetupExperiment", status)
    }

    /// `fmi2EnterInitializationMode`.
    ///
    /// # Errors
    /// The unit failed; its status and its log lines are in the error.
    pub fn enter_initialization(&mut self) -> Result<(), Error> {
        // SAFETY: the component is alive.
        let call = || unsafe { (self.functions.enter_initialization)(self.component) };
        let status = guard::around(self.label, Function::EnterInitializationMode, call);
        self.checked("fmi2EnterInitializationMode", status)?;
        self.phase = Phase::Initialising;
        Ok(())
    }

    /// `fmi2ExitInitializationMode`.
    ///
    /// # Errors
    /// The unit failed; its status and its log lines are in the error.
    pub fn exit_initialization(&mut self) -> Result<(), Error> {
        // SAFETY: the component is alive.
        let call = || unsafe { (self.functions.exit_initialization)(self.component) };
        let status = guard::around(self.label, Function::ExitInitializationMode, call);
        self.checked("fmi2ExitInitializationMode", status)?;
        self.phase = Phase::Stepping;
        Ok(())
    }

    /// `fmi2DoStep`. The status is returned as it is, since a discarded step is the master's business; what it means for later
    /// calls is kept in mind.
    pub fn do_step(&mut self, from: f64, size: f64, no_return: bool) -> Status {
        let status = self.entered(|instance| instance.step(from, size, no_return));
        if status != Status::Ok {
            self.note(status);
        }
        status
    }

    /// What a step's status other than Ok and Warning means: with the words of the unit, or how its process ended.
    pub fn step_error(&mut self, status: Status, from: f64) -> Error {
        self.failure("fmi2DoStep", status, Some(from))
    }

    /// As [`Instance::do_step`] of a unit that was entered.
    #[inline]
    pub(crate) fn step(&mut self, from: f64, size: f64, no_return: bool) -> Status {
        guard::calls(Function::DoStep);
        // SAFETY: plain values.
        let status = unsafe { (self.functions.do_step)(self.component, from, size, c_int::from(no_return)) };
        if control_word::read() != self.word {
            self.put_control_word_back();
        }
        if status == 0 { Status::Ok } else { Status::from(status) }
    }

    /// `fmi2Terminate`.
    pub fn terminate(&mut self) -> Result<(), Error> {
        // SAFETY: the component is alive.
        let call = || unsafe { (self.functions.terminate)(self.component) };
        let status = guard::around(self.label, Function::Terminate, call);
        self.phase = Phase::Terminated;
        self.checked("fmi2Terminate", status)
    }

    /// Whether it was initialised and is neither terminated nor broken.
    pub(crate) fn is_stepping(&self) -> bool {
        self.phase == Phase::Stepping
    }

    /// `fmi2Reset`: back to the state after instantiation. An instance that can't, or whose unit only claims to, is replaced by a
    /// fresh one.
    pub fn reset(&mut self) -> Result<(), Error> {
        if self.phase == Phase::Instantiated {
            return Ok(());
        }
        self.warnings = 0;
        self.sink.take();
        if self.phase != Phase::Dead && self.fmu.restores() && self.reset_itself().is_ok() {
            self.warnings = 0;
            return Ok(());
        }
        *self = self.fmu.instantiate(&self.name.clone())?;
        Ok(())
    }

    /// `fmi2Reset` and nothing else: an error where the unit can't.
    pub fn reset_itself(&mut self) -> Result<(), Error> {
        const NAME: &str = "fmi2Reset";
        let Some(reset) = self.functions.reset else { return Err(self.missing(NAME)) };
        // SAFETY: the component is alive.
        let status = guard::around(self.label, Function::Reset, || unsafe { reset(self.component) });
        self.checked(NAME, status)?;
        self.phase = Phase::Instantiated;
        Ok(())
    }

    /// Last time that the unit reached, if it can tell (`fmi2LastSuccessfulTime`).
    pub fn last_successful_time(&mut self) -> Option<f64> {
        const LAST_SUCCESSFUL_TIME: c_int = 2;
        let mut time = f64::NAN;
        // SAFETY: the pointer is to a value that lives over the call.
        let function = self.functions.get_real_status?;
        let status = guard::around(self.label, Function::GetRealStatus, || unsafe {
            function(self.component, LAST_SUCCESSFUL_TIME, &mut time)
        });
        (status == 0 && time.is_finite()).then_some(time)
    }

    /// Whether a discarded step means that the unit wants the run to end (`fmi2Terminated`).
    pub fn wants_to_end(&mut self) -> bool {
        const TERMINATED: c_int = 3;
        let Some(function) = self.functions.get_boolean_status else { return false };
        let mut wants = 0;
        // SAFETY: the pointer is to a value that lives over the call.
        let call = || unsafe { function(self.component, TERMINATED, &mut wants) };
        let status = guard::around(self.label, Function::GetBooleanStatus, call);
        status == 0 && wants != 0
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // After a fatal status a unit must not be called; what stands for one in another process knows that.
        if self.phase == Phase::Dead && self._callbacks.is_some() {
            return;
        }
        let Functions { terminate, free_instance, .. } = self.functions;
        // SAFETY: the component is alive and not used afterwards; its answer to the last call changes nothing.
        unsafe {
            if self.phase == Phase::Stepping {
                guard::around(self.label, Function::Terminate, || terminate(self.component));
            }
            guard::around(self.label, Function::FreeInstance, || free_instance(self.component));
        }
    }
}
