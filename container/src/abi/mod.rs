//! The C functions of FMI 2.0: the only place of this crate where pointers are followed. The shell gives them their names.
//!
//! All follow one pattern: `call` finds the instance, turns errors and panics into a status and a log line.
//!
//! # Safety
//! All functions here: pointers are as `fmi2FunctionTypes.h` wants them, or null. A component came from [`instantiate`] and
//! was not freed.
#![allow(unsafe_code)] // is called through the C functions of FMI
#![allow(clippy::missing_safety_doc)] // said once above

pub mod states;
pub mod stepping;
pub mod values;

use crate::error::Error;
use crate::instance::Instance;
use crate::{pack, xml};
use fmi2_export::abi::types::{
    Boolean, CO_SIMULATION, Callbacks, Component, ERROR, OK, Real, Sink, Status, Text, Type, WARNING,
};
use fmi2_export::abi::{bytes, panic_message, slice, slice_out};
use fmi2_export::logger::{Logger, STATUS_ERROR, STATUS_WARNING};
use std::cell::UnsafeCell;
use std::ffi::{CStr, CString, c_int, c_void};
use std::mem::MaybeUninit;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};

/// What an `fmi2Component` points to.
struct Handle {
    /// A call is under way. A second one, from another thread or from within a log callback, is refused.
    busy: AtomicBool,
    inside: UnsafeCell<Inside>,
}

struct Inside {
    instance: Instance,
    log: Logger,
    /// What the last `fmi2DoStep` answered.
    last_step: Status,
    /// Strings lent to the master until its next call.
    lent: Vec<CString>,
}

/// Runs `body` on the instance; what goes wrong is logged.
unsafe fn call(
    component: Component,
    function: &'static str,
    body: impl FnOnce(&mut Inside) -> Result<Status, Error>,
) -> Status {
    if component.is_null() {
        return ERROR;
    }
    // SAFETY: by the module's contract.
    let handle = unsafe { &*component.cast::<Handle>() };
    if handle.busy.swap(true, Ordering::Acquire) {
        return ERROR;
    }
    // SAFETY: `busy` was free and is ours now, so there is no other reference.
    let inside = unsafe { &mut *handle.inside.get() };
    let status = match catch_unwind(AssertUnwindSafe(|| body(inside))) {
        Ok(Ok(status)) => status,
        Ok(Err(error)) => report(inside, function, &error),
        Err(payload) => {
            inside.instance.fail();
            report(inside, function, &Error::Panic(panic_message(payload)))
        }
    };
    handle.busy.store(false, Ordering::Release);
    status
}

fn report(inside: &Inside, function: &str, error: &Error) -> Status {
    inside.log.send(ERROR, STATUS_ERROR.name, &|| format!("{function}: {error}"));
    ERROR
}

/// `fmi2GetTypesPlatform`
pub fn types_platform() -> Text {
    c"default".as_ptr()
}

/// `fmi2GetVersion`
pub fn version() -> Text {
    c"2.0".as_ptr()
}

/// `fmi2Instantiate`
pub unsafe fn instantiate(
    name: Text,
    kind: Type,
    guid: Text,
    resources: Text,
    callbacks: *const Callbacks,
    logging_on: Boolean,
) -> Component {
    // SAFETY: null or a struct of the master's; copied, since it may go after the call.
    let callbacks = (!callbacks.is_null()).then(|| unsafe { *callbacks });
    let logger = callbacks.and_then(|callbacks| callbacks.logger);
    let environment = callbacks.map_or(ptr::null_mut(), |callbacks| callbacks.environment);
    // SAFETY: null or terminated strings.
    let [given_name, guid, resources] = unsafe { [bytes(name), bytes(guid), bytes(resources)] };
    // SAFETY: not null in this arm.
    let c_name = if given_name.is_some() { unsafe { CStr::from_ptr(name) } } else { c"" };
    let make = || {
        let log = Logger::new(logger, environment, c_name, &[], logging_on != 0);
        match checked(given_name, kind, guid, resources) {
            Ok(instance) => {
                for notice in instance.notices() {
                    log.send(WARNING, STATUS_WARNING.name, &|| notice.clone());
                }
                let inside = Inside { instance, log, last_step: OK, lent: Vec::new() };
                let handle = Handle { busy: AtomicBool::new(false), inside: UnsafeCell::new(inside) };
                Box::into_raw(Box::new(handle)).cast()
            }
            Err(error) => {
                log.send(ERROR, STATUS_ERROR.name, &|| format!("fmi2Instantiate: {error}"));
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

fn checked(
    name: Option<&[u8]>,
    kind: Type,
    guid: Option<&[u8]>,
    resources: Option<&[u8]>,
) -> Result<Instance, Error> {
    if name.is_none_or(|name| name.trim_ascii().is_empty()) {
        return Err(Error::Arguments("instanceName is missing or blank".to_owned()));
    }
    if kind != CO_SIMULATION {
        let what = format!("fmuType = {kind}: this unit is for co-simulation (1) only");
        return Err(Error::Arguments(what));
    }
    let guid = guid.ok_or(Error::Null { argument: "fmuGUID" })?;
    let resources = resources.ok_or(Error::Null { argument: "fmuResourceLocation" })?;
    let instance = Instance::in_library(&folder(&String::from_utf8_lossy(resources))?)?;
    match instance.guid().as_bytes() == guid {
        true => Ok(instance),
        false => {
            let given = String::from_utf8_lossy(guid).into_owned();
            Err(Error::Guid { given, own: instance.guid().to_owned() })
        }
    }
}

/// The folder that a `file` URI means. Some masters pass a bare path, which is taken as it is.
fn folder(uri: &str) -> Result<PathBuf, Error> {
    let wrong = |expected: &str| Error::Resources { given: uri.to_owned(), expected: expected.to_owned() };
    let Some(rest) = uri.strip_prefix("file:") else {
        return match uri.contains("://") {
            true => Err(wrong("a URI of the scheme file")),
            false => Ok(PathBuf::from(uri)),
        };
    };
    // file:///path, file://localhost/path, file:/path
    let path = match rest.strip_prefix("//") {
        Some(rest) => rest.find('/').map(|at| &rest[at..]).unwrap_or_default(),
        None => rest,
    };
    let mut decoded = Vec::with_capacity(path.len());
    let mut rest = path.bytes();
    while let Some(byte) = rest.next() {
        let code = |byte: Option<u8>| byte.and_then(|byte| (byte as char).to_digit(16));
        match byte {
            b'%' => match (code(rest.next()), code(rest.next())) {
                (Some(high), Some(low)) => decoded.push((high * 16 + low) as u8),
                _ => return Err(wrong("a URI, in which % is followed by two hexadecimal digits")),
            },
            byte => decoded.push(byte),
        }
    }
    let path = String::from_utf8(decoded).map_err(|_| wrong("a path in UTF-8"))?;
    // file:///C:/path
    let has_drive = cfg!(windows) && path.as_bytes().get(2) == Some(&b':');
    Ok(PathBuf::from(if has_drive { &path[1..] } else { &path }))
}

/// `fmi2FreeInstance`
pub unsafe fn free_instance(component: Component) {
    if component.is_null() {
        return;
    }
    // SAFETY: by the module's contract.
    let handle = unsafe { &*component.cast::<Handle>() };
    if handle.busy.swap(true, Ordering::Acquire) {
        return; // from within a log callback: the instance is still in use
    }
    // SAFETY: made by `Box::into_raw` in `instantiate`; `busy` says that nobody uses it.
    let free = || drop(unsafe { Box::from_raw(component.cast::<Handle>()) });
    if let Err(payload) = catch_unwind(AssertUnwindSafe(free)) {
        drop(panic_message(payload)); // there is no status to tell it
    }
}

/// `fmi2SetDebugLogging`
pub unsafe fn set_debug_logging(c: Component, on: Boolean, n: usize, names: *const Text) -> Status {
    // SAFETY: by the module's contract, here and inside.
    unsafe {
        call(c, "fmi2SetDebugLogging", |inside| {
            let mut texts = Vec::new();
            for &name in array(names, n, "categories")? {
                let name = bytes(name).ok_or(Error::Null { argument: "categories" })?;
                texts.push(String::from_utf8_lossy(name));
            }
            let names: Vec<&str> = texts.iter().map(AsRef::as_ref).collect();
            inside.log.select(on != 0, &names).map_err(|error| Error::Arguments(error.to_string()))?;
            Ok(OK)
        })
    }
}

/// `fmi2SetupExperiment`
pub unsafe fn setup_experiment(
    c: Component,
    _tolerance_defined: Boolean,
    _tolerance: Real,
    start: Real,
    stop_defined: Boolean,
    stop: Real,
) -> Status {
    let stop = (stop_defined != 0).then_some(stop);
    // SAFETY: by the module's contract.
    unsafe {
        call(c, "fmi2SetupExperiment", |inside| inside.instance.setup_experiment(start, stop).map(|()| OK))
    }
}

/// `fmi2EnterInitializationMode`
pub unsafe fn enter_initialization(c: Component) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        call(c, "fmi2EnterInitializationMode", |inside| inside.instance.enter_initialization().map(|()| OK))
    }
}

/// `fmi2ExitInitializationMode`
pub unsafe fn exit_initialization(c: Component) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        call(c, "fmi2ExitInitializationMode", |inside| inside.instance.exit_initialization().map(|()| OK))
    }
}

/// `fmi2Terminate`
pub unsafe fn terminate(c: Component) -> Status {
    // SAFETY: by the module's contract.
    unsafe { call(c, "fmi2Terminate", |inside| inside.instance.terminate().map(|()| OK)) }
}

/// `fmi2Reset`
pub unsafe fn reset(c: Component) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        call(c, "fmi2Reset", |inside| {
            inside.last_step = OK;
            inside.instance.reset().map(|()| OK)
        })
    }
}

unsafe fn array<'a, T>(pointer: *const T, n: usize, argument: &'static str) -> Result<&'a [T], Error> {
    // SAFETY: by the module's contract.
    unsafe { slice(pointer, n, argument) }.map_err(|error| Error::Arguments(error.to_string()))
}

unsafe fn array_out<'a, T>(
    pointer: *mut T,
    n: usize,
    argument: &'static str,
) -> Result<&'a mut [MaybeUninit<T>], Error> {
    // SAFETY: by the module's contract.
    unsafe { slice_out(pointer, n, argument) }.map_err(|error| Error::Arguments(error.to_string()))
}

/// A function that a unit with these flags does not offer.
pub unsafe fn not_provided(c: Component, function: &'static str, n: usize, expected: &'static str) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        call(c, function, |_| match n {
            0 => Ok(OK),
            _ => Err(Error::NotProvided { what: function, expected }),
        })
    }
}

/// `fmi2_export_describe`: what the packer reads from the library; see `fmi2_export::abi::lifecycle::describe`. The blank unit
/// has no variables, so nothing for the notation.
pub unsafe fn describe(what: c_int, sink: Option<Sink>, context: *mut c_void) -> Status {
    let text = match what {
        0 => pack::IDENTIFIER.to_owned(),
        1 => xml::blank(),
        2 => "<!DOCTYPE html>\n<title>Containers</title>\n<p>The library of containers, without a scenario.</p>\n".to_owned(),
        3 | 4 => String::new(),
        _ => return ERROR,
    };
    let Some(sink) = sink else { return ERROR };
    // SAFETY: the bytes live until the sink returns.
    unsafe { sink(context, text.as_ptr(), text.len()) };
    OK
}

#[cfg(test)]
mod tests {
    use super::folder;

    #[test]
    fn value_resource_locations_are_read() {
        for (uri, path) in [
            ("file:///tmp/a%20b/resources", "/tmp/a b/resources"),
            ("file://localhost/tmp/r", "/tmp/r"),
            ("file:/tmp/r", "/tmp/r"),
            ("/tmp/r", "/tmp/r"),
            ("file:///tmp/%C3%A4", "/tmp/ä"),
        ] {
            assert_eq!(folder(uri).ok(), Some(path.into()), "{uri}");
        }
        for wrong in ["http://x/y", "file:///tmp/%", "file:///%zz", "file:///%ff"] {
            assert!(folder(wrong).is_err(), "{wrong}");
        }
    }
}
