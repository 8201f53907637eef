//! Instances: made, set up, initialised, ended, freed; and what a unit says of itself.
//!
//! # Safety
//! All functions here: pointers are as `fmi2FunctionTypes.h` wants them, or null. A component came from
//! [`instantiate`] of the same model and was not freed.
#![allow(clippy::missing_safety_doc)] // said once above

use super::types::{Boolean, CO_SIMULATION, Callbacks, Component, ERROR, Real, Sink, Status, Text, Type};
use super::{Handle, bytes, call, panic_message, slice};
use crate::description::Unit;
use crate::error::Error;
use crate::instance::{self, Instance};
use crate::logger::{Logger, STATUS_ERROR};
use crate::model::{Experiment, Model};
use crate::saved;
use crate::state_machine::Call;
use std::ffi::{CStr, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use std::sync::atomic::Ordering;

/// `fmi2GetTypesPlatform`
pub fn types_platform() -> Text {
    c"default".as_ptr()
}

/// `fmi2GetVersion`
pub fn version() -> Text {
    c"2.0".as_ptr()
}

/// `fmi2Instantiate`
pub unsafe fn instantiate<M: Model>(
    name: Text,
    kind: Type,
    guid: Text,
    callbacks: *const Callbacks,
    logging_on: Boolean,
) -> Component {
    // SAFETY: null or a struct of the master's; copied, since it may go after the call.
    let callbacks = (!callbacks.is_null()).then(|| unsafe { *callbacks });
    let logger = callbacks.and_then(|callbacks| callbacks.logger);
    let environment = callbacks.map_or(ptr::null_mut(), |callbacks| callbacks.environment);
    let make = || {
        // SAFETY: null or terminated strings.
        let given_name = unsafe { bytes(name) };
        // SAFETY: not null in this arm.
        let c_name = if given_name.is_some() { unsafe { CStr::from_ptr(name) } } else { c"" };
        let own_categories = M::description().log_categories;
        let log = Logger::new(logger, environment, c_name, own_categories, logging_on != 0);
        // SAFETY: null or a terminated string.
        let given_guid = unsafe { bytes(guid) };
        match check::<M>(given_name, kind, given_guid) {
            Ok(guid) => Box::into_raw(Box::new(Handle::new(Instance::<M>::new(log, guid)))).cast(),
            Err(message) => {
                log.send(ERROR, STATUS_ERROR.name, &|| format!("fmi2Instantiate: {message}"));
                ptr::null_mut()
            }
        }
    };
    catch_unwind(AssertUnwindSafe(make)).unwrap_or_else(|payload| {
        let message = panic_message(payload);
        let log = Logger::new(logger, environment, c"", &[], logging_on != 0);
        log.send(ERROR, STATUS_ERROR.name, &|| format!("fmi2Instantiate: panicked: {message}"));
        ptr::null_mut()
    })
}

/// The unit's GUID if it is the one that the master means.
fn check<M: Model>(name: Option<&[u8]>, kind: Type, given: Option<&[u8]>) -> Result<String, String> {
    if name.is_none_or(|name| name.trim_ascii().is_empty()) {
        return Err("instanceName is missing or blank".to_owned());
    }
    if kind != CO_SIMULATION {
        return Err(format!("fmuType = {kind}: this unit is for co-simulation (1) only"));
    }
    let guid = instance::guid::<M>();
    match given {
        None => Err("fmuGUID is a null pointer".to_owned()),
        Some(given) if given != guid.as_bytes() => {
            let given = String::from_utf8_lossy(given);
            Err(format!(
                "fmuGUID = {given}: modelDescription.xml does not belong to this library, {guid} does"
            ))
        }
        Some(_) => Ok(guid),
    }
}

/// `fmi2FreeInstance`
pub unsafe fn free_instance<M: Model>(component: Component) {
    if component.is_null() {
        return;
    }
    // SAFETY: by the module's contract.
    let handle = unsafe { &*component.cast::<Handle<M>>() };
    if handle.busy.swap(true, Ordering::Acquire) {
        return; // from within a log callback: the instance is still in use
    }
    let free = || {
        saved::free_all(component as usize);
        // SAFETY: made by `Box::into_raw` in `instantiate`; `busy` says that nobody uses it.
        drop(unsafe { Box::from_raw(component.cast::<Handle<M>>()) });
    };
    if let Err(payload) = catch_unwind(AssertUnwindSafe(free)) {
        drop(panic_message(payload)); // a destructor of the model panicked; there is no status to tell it
    }
}

/// `fmi2SetDebugLogging`
pub unsafe fn set_debug_logging<M: Model>(c: Component, on: Boolean, n: usize, names: *const Text) -> Status {
    // SAFETY: by the module's contract, here and inside.
    unsafe {
        call::<M>(c, "fmi2SetDebugLogging", Call::Always, |instance| {
            let mut texts = Vec::new();
            for &name in slice(names, n, "categories")? {
                let name = bytes(name).ok_or(Error::Null { argument: "categories" })?;
                texts.push(String::from_utf8_lossy(name));
            }
            let names: Vec<&str> = texts.iter().map(AsRef::as_ref).collect();
            instance.log.select(on != 0, &names)
        })
    }
}

/// `fmi2SetupExperiment`
pub unsafe fn setup_experiment<M: Model>(
    c: Component,
    tolerance_defined: Boolean,
    tolerance: Real,
    start: Real,
    stop_defined: Boolean,
    stop: Real,
) -> Status {
    let stop = (stop_defined != 0).then_some(stop);
    let tolerance = (tolerance_defined != 0).then_some(tolerance);
    let experiment = Experiment { start, stop, tolerance };
    // SAFETY: by the module's contract.
    unsafe {
        call::<M>(c, "fmi2SetupExperiment", Call::Setup, |instance| instance.setup_experiment(experiment))
    }
}

/// `fmi2EnterInitializationMode`
pub unsafe fn enter_initialization<M: Model>(c: Component) -> Status {
    // SAFETY: by the module's contract.
    unsafe { call::<M>(c, "fmi2EnterInitializationMode", Call::Setup, Instance::enter_initialization) }
}

/// `fmi2ExitInitializationMode`
pub unsafe fn exit_initialization<M: Model>(c: Component) -> Status {
    let kind = Call::ExitInitialization;
    // SAFETY: by the module's contract.
    unsafe { call::<M>(c, "fmi2ExitInitializationMode", kind, Instance::exit_initialization) }
}

/// `fmi2Terminate`
pub unsafe fn terminate<M: Model>(c: Component) -> Status {
    // SAFETY: by the module's contract.
    unsafe { call::<M>(c, "fmi2Terminate", Call::Step, Instance::terminate) }
}

/// `fmi2Reset`
pub unsafe fn reset<M: Model>(c: Component) -> Status {
    // SAFETY: by the module's contract.
    unsafe { call::<M>(c, "fmi2Reset", Call::Always, Instance::reset) }
}

/// `fmi2_export_describe`: what the packer reads from a built library. `what` is 0 for the model identifier,
/// 1 for `modelDescription.xml`, 2 for the HTML page, 3 for the notation table in Markdown, 4 for mistakes in
/// the declaration, one a line. Answers 0, or 3 if there is no such text.
pub unsafe fn describe<M: Model>(what: c_int, sink: Option<Sink>, context: *mut c_void) -> Status {
    let text = catch_unwind(|| {
        let unit = Unit::of::<M>();
        match what {
            0 => Some(unit.head.identifier.to_owned()),
            1 => Some(unit.xml()),
            2 => Some(unit.html()),
            3 => Some(unit.notation()),
            4 => Some(unit.mistakes().join("\n")),
            _ => None,
        }
    });
    match (text, sink) {
        (Ok(Some(text)), Some(sink)) => {
            // SAFETY: the bytes live until the sink returns.
            unsafe { sink(context, text.as_ptr(), text.len()) };
            super::types::OK
        }
        _ => ERROR,
    }
}
