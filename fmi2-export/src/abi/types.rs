//! `fmi2TypesPlatform.h` and the types of `fmi2FunctionTypes.h` as Rust sees them.
//!
//! Enumerations are plain C integers here: a value outside a Rust `enum` would be undefined behaviour, and what
//! a master passes is not ours to trust.

use std::ffi::{c_char, c_int, c_uint, c_void};

/// `fmi2Component`
pub type Component = *mut c_void;
/// `fmi2FMUstate`
pub type FmuState = *mut c_void;
/// `fmi2ValueReference`
pub type ValueReference = c_uint;
/// `fmi2Real`
pub type Real = f64;
/// `fmi2Integer`
pub type Integer = c_int;
/// `fmi2Boolean`
pub type Boolean = c_int;
/// `fmi2String`
pub type Text = *const c_char;
/// `fmi2Byte`
pub type Byte = c_char;
/// `fmi2Status`
pub type Status = c_int;
/// `fmi2Type`
pub type Type = c_int;
/// `fmi2StatusKind`
pub type StatusKind = c_int;

/// `fmi2OK`
pub const OK: Status = 0;
/// `fmi2Warning`
pub const WARNING: Status = 1;
/// `fmi2Discard`
pub const DISCARD: Status = 2;
/// `fmi2Error`
pub const ERROR: Status = 3;
/// `fmi2CoSimulation`
pub const CO_SIMULATION: Type = 1;
/// `fmi2DoStepStatus`
pub const DO_STEP_STATUS: StatusKind = 0;
/// `fmi2LastSuccessfulTime`
pub const LAST_SUCCESSFUL_TIME: StatusKind = 2;
/// `fmi2Terminated`
pub const TERMINATED: StatusKind = 3;

/// `fmi2CallbackLogger`
pub type LoggerCallback = unsafe extern "C" fn(*mut c_void, Text, Status, Text, Text, ...);

/// `fmi2CallbackFunctions`. Memory and `stepFinished` callbacks are never called.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Callbacks {
    /// Receives log messages.
    pub logger: Option<LoggerCallback>,
    /// Unused: `canNotUseMemoryManagementFunctions`.
    pub allocate_memory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    /// Unused likewise.
    pub free_memory: Option<unsafe extern "C" fn(*mut c_void)>,
    /// Unused: steps are synchronous.
    pub step_finished: Option<unsafe extern "C" fn(*mut c_void, Status)>,
    /// Handed back to the callbacks.
    pub environment: *mut c_void,
}

/// How `fmi2_export_describe` hands a text over: context, first byte, length.
pub type Sink = unsafe extern "C" fn(*mut c_void, *const u8, usize);
