//! The container as a shared library: nothing but the C names of `container::abi`.

#![allow(unsafe_code)] // gives functions the names of C
#![allow(missing_docs, non_snake_case, clippy::missing_safety_doc, clippy::too_many_arguments)]

#[cfg(panic = "abort")]
compile_error!("a panic must not end the master's process: build with panic = \"unwind\"");

use container::abi::{self, states, stepping, values};
use fmi2_export::abi::types::{
    Boolean, Byte, Callbacks, Component, FmuState, Integer, Real, Sink, Status, StatusKind, Text, Type,
    ValueReference,
};
use std::ffi::{c_int, c_void};

/// Why derivatives are not offered.
const NO_DERIVATIVES: &str = "its flags in modelDescription.xml say so";

// Where the library begins if the system's loader starts it as a program (`build.rs`); see `container::serve`.
#[cfg(all(target_os = "linux", target_env = "gnu", target_arch = "x86_64"))]
std::arch::global_asm!(
    ".globl acroscope_container_serve",
    "acroscope_container_serve:",
    "xor %ebp, %ebp",
    "and $-16, %rsp",
    "call {serve}",
    "ud2",
    serve = sym serve,
    options(att_syntax)
);

#[cfg(all(target_os = "linux", target_env = "gnu", target_arch = "aarch64"))]
std::arch::global_asm!(
    ".globl acroscope_container_serve",
    "acroscope_container_serve:",
    "mov x29, #0",
    "mov x30, #0",
    "bl {serve}",
    "brk #1",
    serve = sym serve
);

#[cfg(all(target_os = "linux", target_env = "gnu", any(target_arch = "x86_64", target_arch = "aarch64")))]
extern "C" fn serve() -> ! {
    container::serve()
}

macro_rules! functions {
    ($( $name:ident($($argument:ident: $type:ty),* $(,)?) -> $answer:ty = $body:expr; )*) => { $(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name($($argument: $type),*) -> $answer {
            // SAFETY: the caller's contract is handed on.
            #[allow(unused_unsafe)]
            unsafe { $body }
        }
    )* };
}

functions! {
    fmi2GetTypesPlatform() -> Text = abi::types_platform();
    fmi2GetVersion() -> Text = abi::version();
    fmi2Instantiate(
        name: Text, kind: Type, guid: Text, resources: Text, callbacks: *const Callbacks, _visible: Boolean,
        logging_on: Boolean,
    ) -> Component = abi::instantiate(name, kind, guid, resources, callbacks, logging_on);
    fmi2FreeInstance(c: Component) -> () = abi::free_instance(c);
    fmi2SetDebugLogging(c: Component, on: Boolean, n: usize, categories: *const Text) -> Status
        = abi::set_debug_logging(c, on, n, categories);
    fmi2SetupExperiment(
        c: Component, tolerance_defined: Boolean, tolerance: Real, start: Real, stop_defined: Boolean, stop: Real,
    ) -> Status = abi::setup_experiment(c, tolerance_defined, tolerance, start, stop_defined, stop);
    fmi2EnterInitializationMode(c: Component) -> Status = abi::enter_initialization(c);
    fmi2ExitInitializationMode(c: Component) -> Status = abi::exit_initialization(c);
    fmi2Terminate(c: Component) -> Status = abi::terminate(c);
    fmi2Reset(c: Component) -> Status = abi::reset(c);

    fmi2GetReal(c: Component, vr: *const ValueReference, n: usize, value: *mut Real) -> Status
        = values::get_real(c, vr, n, value);
    fmi2GetInteger(c: Component, vr: *const ValueReference, n: usize, value: *mut Integer) -> Status
        = values::get_integer(c, vr, n, value);
    fmi2GetBoolean(c: Component, vr: *const ValueReference, n: usize, value: *mut Boolean) -> Status
        = values::get_boolean(c, vr, n, value);
    fmi2GetString(c: Component, vr: *const ValueReference, n: usize, value: *mut Text) -> Status
        = values::get_string(c, vr, n, value);
    fmi2SetReal(c: Component, vr: *const ValueReference, n: usize, value: *const Real) -> Status
        = values::set_real(c, vr, n, value);
    fmi2SetInteger(c: Component, vr: *const ValueReference, n: usize, value: *const Integer) -> Status
        = values::set_integer(c, vr, n, value);
    fmi2SetBoolean(c: Component, vr: *const ValueReference, n: usize, value: *const Boolean) -> Status
        = values::set_boolean(c, vr, n, value);
    fmi2SetString(c: Component, vr: *const ValueReference, n: usize, value: *const Text) -> Status
        = values::set_string(c, vr, n, value);
    fmi2SetRealInputDerivatives(
        c: Component, _vr: *const ValueReference, n: usize, _order: *const Integer, _value: *const Real,
    ) -> Status = abi::not_provided(c, "fmi2SetRealInputDerivatives", n, NO_DERIVATIVES);
    fmi2GetRealOutputDerivatives(
        c: Component, _vr: *const ValueReference, n: usize, _order: *const Integer, _value: *mut Real,
    ) -> Status = abi::not_provided(c, "fmi2GetRealOutputDerivatives", n, NO_DERIVATIVES);
    fmi2GetDirectionalDerivative(
        c: Component, _unknowns: *const ValueReference, n: usize, _knowns: *const ValueReference, _m: usize,
        _seed: *const Real, _out: *mut Real,
    ) -> Status = abi::not_provided(c, "fmi2GetDirectionalDerivative", n, NO_DERIVATIVES);

    fmi2GetFMUstate(c: Component, state: *mut FmuState) -> Status = states::get_state(c, state);
    fmi2SetFMUstate(c: Component, state: FmuState) -> Status = states::set_state(c, state);
    fmi2FreeFMUstate(c: Component, state: *mut FmuState) -> Status = states::free_state(c, state);
    fmi2SerializedFMUstateSize(c: Component, state: FmuState, size: *mut usize) -> Status
        = states::serialized_size(c, state, size);
    fmi2SerializeFMUstate(c: Component, state: FmuState, bytes: *mut Byte, size: usize) -> Status
        = states::serialize(c, state, bytes, size);
    fmi2DeSerializeFMUstate(c: Component, bytes: *const Byte, size: usize, state: *mut FmuState) -> Status
        = states::deserialize(c, bytes, size, state);

    fmi2DoStep(c: Component, from: Real, size: Real, _no_state_prior: Boolean) -> Status = stepping::do_step(c, from, size);
    fmi2CancelStep(c: Component) -> Status
        = abi::not_provided(c, "fmi2CancelStep", 1, "steps are never asynchronous, so none can be cancelled");
    fmi2GetStatus(c: Component, kind: StatusKind, value: *mut Status) -> Status = stepping::get_status(c, kind, value);
    fmi2GetRealStatus(c: Component, kind: StatusKind, value: *mut Real) -> Status
        = stepping::get_real_status(c, kind, value);
    fmi2GetIntegerStatus(c: Component, kind: StatusKind, value: *mut Integer) -> Status
        = stepping::get_no_status(c, "fmi2GetIntegerStatus", kind, value);
    fmi2GetBooleanStatus(c: Component, kind: StatusKind, value: *mut Boolean) -> Status
        = stepping::get_boolean_status(c, kind, value);
    fmi2GetStringStatus(c: Component, kind: StatusKind, value: *mut Text) -> Status
        = stepping::get_no_status(c, "fmi2GetStringStatus", kind, value);

    fmi2_export_describe(what: c_int, sink: Option<Sink>, context: *mut c_void) -> Status
        = abi::describe(what, sink, context);
}
