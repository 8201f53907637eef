//! [`export!`](crate::export): the C names.

/// Makes a library that exports `$Model` (a [`Model`](crate::Model)) with all functions of FMI 2.0 for
/// co-simulation. The shell crate is a `cdylib` with this one line:
///
/// ```text
/// fmi2_export::export!(plant::Plant);
/// ```
///
/// Functions for model exchange are left out: a unit that is for co-simulation only needs none (FMI 2.0
/// section 2.3), and a master that looks for one sees at once that there is none.
#[macro_export]
macro_rules! export {
    ($Model:ty) => {
        #[cfg(panic = "abort")]
        compile_error!("a panic must not end the master's process: build with panic = \"unwind\"");

        /// The C functions of FMI 2.0.
        ///
        /// # Safety
        /// As the standard says: pointers are null or valid, components come from `fmi2Instantiate`.
        #[allow(missing_docs, non_snake_case, clippy::missing_safety_doc, clippy::too_many_arguments)]
        pub mod fmi2 {
            #[allow(unused_imports)]
            use super::*;
            use $crate::abi::types::*;
            use $crate::abi::{lifecycle, states, stepping, values};
            use ::std::ffi::{c_int, c_void};

            $crate::functions! { $Model;
                fmi2Instantiate(
                    name: Text, kind: Type, guid: Text, _resources: Text, callbacks: *const Callbacks,
                    _visible: Boolean, logging_on: Boolean
                ) -> Component = lifecycle::instantiate(name, kind, guid, callbacks, logging_on);
                fmi2FreeInstance(c: Component) -> () = lifecycle::free_instance(c);
                fmi2SetDebugLogging(c: Component, on: Boolean, n: usize, categories: *const Text) -> Status
                    = lifecycle::set_debug_logging(c, on, n, categories);
                fmi2SetupExperiment(
                    c: Component, tolerance_defined: Boolean, tolerance: Real, start: Real, stop_defined: Boolean,
                    stop: Real
                ) -> Status
                    = lifecycle::setup_experiment(c, tolerance_defined, tolerance, start, stop_defined, stop);
                fmi2EnterInitializationMode(c: Component) -> Status = lifecycle::enter_initialization(c);
                fmi2ExitInitializationMode(c: Component) -> Status = lifecycle::exit_initialization(c);
                fmi2Terminate(c: Component) -> Status = lifecycle::terminate(c);
                fmi2Reset(c: Component) -> Status = lifecycle::reset(c);

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
                    c: Component, vr: *const ValueReference, n: usize, order: *const Integer, value: *const Real
                ) -> Status = values::set_real_input_derivatives(c, vr, n, order, value);
                fmi2GetRealOutputDerivatives(
                    c: Component, vr: *const ValueReference, n: usize, order: *const Integer, value: *mut Real
                ) -> Status = values::get_real_output_derivatives(c, vr, n, order, value);
                fmi2GetDirectionalDerivative(
                    c: Component, unknowns: *const ValueReference, n_unknowns: usize,
                    knowns: *const ValueReference, n_knowns: usize, seed: *const Real, out: *mut Real
                ) -> Status
                    = values::get_directional_derivative(c, (unknowns, n_unknowns), (knowns, n_knowns), seed, out);

                fmi2GetFMUstate(c: Component, state: *mut FmuState) -> Status = states::get(c, state);
                fmi2SetFMUstate(c: Component, state: FmuState) -> Status = states::set(c, state);
                fmi2FreeFMUstate(c: Component, state: *mut FmuState) -> Status = states::free(c, state);
                fmi2SerializedFMUstateSize(c: Component, state: FmuState, size: *mut usize) -> Status
                    = states::serialized_size(c, state, size);
                fmi2SerializeFMUstate(c: Component, state: FmuState, bytes: *mut Byte, size: usize) -> Status
                    = states::serialize(c, state, bytes, size);
                fmi2DeSerializeFMUstate(
                    c: Component, bytes: *const Byte, size: usize, state: *mut FmuState
                ) -> Status = states::deserialize(c, bytes, size, state);

                fmi2DoStep(c: Component, from: Real, size: Real, no_state_prior: Boolean) -> Status
                    = stepping::do_step(c, from, size, no_state_prior);
                fmi2CancelStep(c: Component) -> Status = stepping::cancel_step(c);
                fmi2GetStatus(c: Component, kind: StatusKind, value: *mut Status) -> Status
                    = stepping::get_status(c, kind, value);
                fmi2GetRealStatus(c: Component, kind: StatusKind, value: *mut Real) -> Status
                    = stepping::get_real_status(c, kind, value);
                fmi2GetBooleanStatus(c: Component, kind: StatusKind, value: *mut Boolean) -> Status
                    = stepping::get_boolean_status(c, kind, value);

                fmi2_export_describe(what: c_int, sink: Option<Sink>, context: *mut c_void) -> Status
                    = lifecycle::describe(what, sink, context);
            }

            #[unsafe(no_mangle)]
            pub extern "C" fn fmi2GetTypesPlatform() -> Text {
                lifecycle::types_platform()
            }

            #[unsafe(no_mangle)]
            pub extern "C" fn fmi2GetVersion() -> Text {
                lifecycle::version()
            }

            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn fmi2GetIntegerStatus(
                c: Component,
                kind: StatusKind,
                value: *mut Integer,
            ) -> Status {
                // SAFETY: the caller's contract is handed on.
                unsafe { stepping::get_no_status::<$Model, _>(c, "fmi2GetIntegerStatus", kind, value) }
            }

            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn fmi2GetStringStatus(
                c: Component,
                kind: StatusKind,
                value: *mut Text,
            ) -> Status {
                // SAFETY: the caller's contract is handed on.
                unsafe { stepping::get_no_status::<$Model, _>(c, "fmi2GetStringStatus", kind, value) }
            }
        }
    };
}

/// Gives generic functions their C names.
#[doc(hidden)]
#[macro_export]
macro_rules! functions {
    ($Model:ty; $(
        $name:ident($($argument:ident: $type:ty),* $(,)?) -> $answer:ty
            = $module:ident::$generic:ident($($pass:expr),*);
    )*) => { $(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name($($argument: $type),*) -> $answer {
            // SAFETY: the caller's contract is handed on.
            unsafe { $module::$generic::<$Model>($($pass),*) }
        }
    )* };
}
