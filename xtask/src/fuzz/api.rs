//! The functions of a loaded unit, and a logger that listens for panics.

use crate::Result;
use fmi2_export::abi::types::{
    Boolean, Byte, Callbacks, Component, FmuState, Integer, LoggerCallback, Real, Status, StatusKind, Text,
    Type, ValueReference,
};
use libloading::Library;
use std::cell::RefCell;
use std::ffi::{CStr, c_void};
use std::path::Path;

macro_rules! api {
    ($($field:ident = $symbol:literal: fn($($argument:ty),*) -> $answer:ty;)*) => {
        /// The functions, and the library that must live as long.
        pub struct Api {
            $( pub $field: unsafe extern "C" fn($($argument),*) -> $answer, )*
            _library: std::mem::ManuallyDrop<Library>,
        }

        impl Api {
            /// Loads a library with all functions. It is never unloaded, so that a leak checker can tell what
            /// still is reachable.
            pub fn load(path: &Path) -> Result<Self> {
                let named = |error: libloading::Error| format!("{}: {error}", path.display());
                // SAFETY: a unit, which does nothing when loaded.
                let library = unsafe { Library::new(path) }.map_err(named)?;
                // SAFETY: the types are those of the standard's header.
                unsafe {
                    Ok(Self {
                        $( $field: *library.get($symbol).map_err(named)?, )*
                        _library: std::mem::ManuallyDrop::new(library),
                    })
                }
            }
        }
    };
}

type References = *const ValueReference;

api! {
    platform = b"fmi2GetTypesPlatform": fn() -> Text;
    version = b"fmi2GetVersion": fn() -> Text;
    debug = b"fmi2SetDebugLogging": fn(Component, Boolean, usize, *const Text) -> Status;
    instantiate = b"fmi2Instantiate": fn(Text, Type, Text, Text, *const Callbacks, Boolean, Boolean) -> Component;
    free = b"fmi2FreeInstance": fn(Component) -> ();
    setup = b"fmi2SetupExperiment": fn(Component, Boolean, Real, Real, Boolean, Real) -> Status;
    enter = b"fmi2EnterInitializationMode": fn(Component) -> Status;
    exit = b"fmi2ExitInitializationMode": fn(Component) -> Status;
    terminate = b"fmi2Terminate": fn(Component) -> Status;
    reset = b"fmi2Reset": fn(Component) -> Status;
    get_real = b"fmi2GetReal": fn(Component, References, usize, *mut Real) -> Status;
    get_integer = b"fmi2GetInteger": fn(Component, References, usize, *mut Integer) -> Status;
    get_boolean = b"fmi2GetBoolean": fn(Component, References, usize, *mut Boolean) -> Status;
    get_string = b"fmi2GetString": fn(Component, References, usize, *mut Text) -> Status;
    set_real = b"fmi2SetReal": fn(Component, References, usize, *const Real) -> Status;
    set_integer = b"fmi2SetInteger": fn(Component, References, usize, *const Integer) -> Status;
    set_boolean = b"fmi2SetBoolean": fn(Component, References, usize, *const Boolean) -> Status;
    set_string = b"fmi2SetString": fn(Component, References, usize, *const Text) -> Status;
    get_state = b"fmi2GetFMUstate": fn(Component, *mut FmuState) -> Status;
    set_state = b"fmi2SetFMUstate": fn(Component, FmuState) -> Status;
    free_state = b"fmi2FreeFMUstate": fn(Component, *mut FmuState) -> Status;
    state_size = b"fmi2SerializedFMUstateSize": fn(Component, FmuState, *mut usize) -> Status;
    serialize = b"fmi2SerializeFMUstate": fn(Component, FmuState, *mut Byte, usize) -> Status;
    deserialize = b"fmi2DeSerializeFMUstate": fn(Component, *const Byte, usize, *mut FmuState) -> Status;
    derivative = b"fmi2GetDirectionalDerivative":
        fn(Component, References, usize, References, usize, *const Real, *mut Real) -> Status;
    set_rates = b"fmi2SetRealInputDerivatives":
        fn(Component, References, usize, *const Integer, *const Real) -> Status;
    get_rates = b"fmi2GetRealOutputDerivatives":
        fn(Component, References, usize, *const Integer, *mut Real) -> Status;
    step = b"fmi2DoStep": fn(Component, Real, Real, Boolean) -> Status;
    cancel = b"fmi2CancelStep": fn(Component) -> Status;
    status = b"fmi2GetStatus": fn(Component, StatusKind, *mut Status) -> Status;
    real_status = b"fmi2GetRealStatus": fn(Component, StatusKind, *mut Real) -> Status;
    integer_status = b"fmi2GetIntegerStatus": fn(Component, StatusKind, *mut Integer) -> Status;
    boolean_status = b"fmi2GetBooleanStatus": fn(Component, StatusKind, *mut Boolean) -> Status;
    string_status = b"fmi2GetStringStatus": fn(Component, StatusKind, *mut Text) -> Status;
}

thread_local! {
    static PANIC: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// What a unit said of a panic since the last question.
pub fn panic_in_log() -> Option<String> {
    PANIC.take()
}

unsafe extern "C" fn listen(_: *mut c_void, _: Text, _: Status, _: Text, message: Text) {
    // SAFETY: the unit passes a terminated string.
    let message = unsafe { CStr::from_ptr(message) }.to_string_lossy();
    if message.contains("panicked") {
        PANIC.set(Some(message.into_owned()));
    }
}

/// Callbacks with the listening logger.
pub fn callbacks() -> Callbacks {
    // SAFETY: a function with the fixed arguments only, in place of a variadic one that is called without others:
    // the same calling convention on x86-64 and AArch64 Linux.
    let logger: LoggerCallback = unsafe { std::mem::transmute(listen as *const ()) };
    Callbacks {
        logger: Some(logger),
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        environment: std::ptr::null_mut(),
    }
}
