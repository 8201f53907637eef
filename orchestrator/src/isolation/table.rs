//! The functions of a unit in another process, as if they were those of a library in this one.

use super::client::Remote;
use super::memory::BODY;
use crate::fmu::Function;
use crate::fmu::library::{Callbacks, Component, Functions, State};
use std::ffi::{c_char, c_int, c_uint};
use std::ptr;

/// Which of the functions that a unit may leave out there are, a bit each.
pub(super) fn optional(f: &Functions) -> u64 {
    let bit = |function: Function, is: bool| u64::from(is) << (function as u8);
    bit(Function::SetDebugLogging, f.set_debug_logging.is_some())
        | bit(Function::Reset, f.reset.is_some())
        | bit(Function::GetInteger, f.get_integer.is_some())
        | bit(Function::SetInteger, f.set_integer.is_some())
        | bit(Function::GetBoolean, f.get_boolean.is_some())
        | bit(Function::SetBoolean, f.set_boolean.is_some())
        | bit(Function::GetString, f.get_string.is_some())
        | bit(Function::SetString, f.set_string.is_some())
        | bit(Function::GetFMUstate, f.get_state.is_some())
        | bit(Function::SetFMUstate, f.set_state.is_some())
        | bit(Function::FreeFMUstate, f.free_state.is_some())
        | bit(Function::SerializedFMUstateSize, f.state_size.is_some())
        | bit(Function::SerializeFMUstate, f.serialize_state.is_some())
        | bit(Function::DeSerializeFMUstate, f.deserialize_state.is_some())
        | bit(Function::GetDirectionalDerivative, f.directional_derivative.is_some())
        | bit(Function::SetRealInputDerivatives, f.set_input_derivatives.is_some())
        | bit(Function::GetRealOutputDerivatives, f.get_output_derivatives.is_some())
        | bit(Function::GetRealStatus, f.get_real_status.is_some())
        | bit(Function::GetBooleanStatus, f.get_boolean_status.is_some())
}

/// The table of a unit that has these; its component is a [`Remote`].
pub(super) fn of(bits: u64) -> Functions {
    /// A function that the unit has.
    fn known<T>(bits: u64, function: Function, proxy: T) -> Option<T> {
        (bits >> (function as u8) & 1 == 1).then_some(proxy)
    }
    Functions {
        instantiate,
        free_instance,
        setup_experiment,
        enter_initialization,
        exit_initialization,
        terminate,
        get_real,
        set_real,
        do_step,
        get_version: None,
        set_debug_logging: known(bits, Function::SetDebugLogging, set_debug_logging),
        reset: known(bits, Function::Reset, reset),
        get_integer: known(bits, Function::GetInteger, get_integer),
        set_integer: known(bits, Function::SetInteger, set_integer),
        get_boolean: known(bits, Function::GetBoolean, get_boolean),
        set_boolean: known(bits, Function::SetBoolean, set_boolean),
        get_string: known(bits, Function::GetString, get_string),
        set_string: known(bits, Function::SetString, set_string),
        get_state: known(bits, Function::GetFMUstate, get_state),
        set_state: known(bits, Function::SetFMUstate, set_state),
        free_state: known(bits, Function::FreeFMUstate, free_state),
        state_size: known(bits, Function::SerializedFMUstateSize, state_size),
        serialize_state: known(bits, Function::SerializeFMUstate, serialize_state),
        deserialize_state: known(bits, Function::DeSerializeFMUstate, deserialize_state),
        directional_derivative: known(bits, Function::GetDirectionalDerivative, directional_derivative),
        set_input_derivatives: known(bits, Function::SetRealInputDerivatives, set_input_derivatives),
        get_output_derivatives: known(bits, Function::GetRealOutputDerivatives, get_output_derivatives),
        get_real_status: known(bits, Function::GetRealStatus, get_real_status),
        get_boolean_status: known(bits, Function::GetBooleanStatus, get_boolean_status),
    }
}

/// # Safety
/// The component came from [`Remote::start`] and was not freed.
unsafe fn remote<'a>(component: Component) -> &'a mut Remote {
    // SAFETY: as promised; calls on one instance don't overlap.
    unsafe { &mut *component.cast::<Remote>() }
}

/// # Safety
/// The pointer is to so many values, or there are none.
unsafe fn slice<'a, T>(pointer: *const T, count: usize) -> &'a [T] {
    // SAFETY: as promised.
    if count == 0 { &[] } else { unsafe { std::slice::from_raw_parts(pointer, count) } }
}

/// # Safety
/// As of [`slice`].
unsafe fn slice_mut<'a, T>(pointer: *mut T, count: usize) -> &'a mut [T] {
    // SAFETY: as promised.
    if count == 0 { &mut [] } else { unsafe { std::slice::from_raw_parts_mut(pointer, count) } }
}

unsafe extern "C" fn instantiate(
    _: *const c_char,
    _: c_int,
    _: *const c_char,
    _: *const c_char,
    _: *const Callbacks,
    _: c_int,
    _: c_int,
) -> Component {
    ptr::null_mut() // made by `Remote::start`
}

unsafe extern "C" fn free_instance(component: Component) {
    // SAFETY: the component was made from a box, and this is its last use.
    unsafe { Box::from_raw(component.cast::<Remote>()) }.free();
}

macro_rules! plain {
    ($( $name:ident = $function:ident; )*) => {
        $( unsafe extern "C" fn $name(component: Component) -> c_int {
            // SAFETY: the component is alive.
            unsafe { remote(component) }.plain(Function::$function)
        } )*
    };
}

plain! {
    enter_initialization = EnterInitializationMode;
    exit_initialization = ExitInitializationMode;
    terminate = Terminate;
    reset = Reset;
}

macro_rules! access {
    ($( $get:ident, $set:ident, $type:ty, $get_function:ident, $set_function:ident; )*) => {
        $(
            unsafe extern "C" fn $get(
                component: Component, references: *const c_uint, count: usize, values: *mut $type,
            ) -> c_int {
                // SAFETY: the component is alive, and both have the length that is given.
                let (remote, references, values) =
                    unsafe { (remote(component), slice(references, count), slice_mut(values, count)) };
                remote.get(Function::$get_function, references, values)
            }
            unsafe extern "C" fn $set(
                component: Component, references: *const c_uint, count: usize, values: *const $type,
            ) -> c_int {
                // SAFETY: as above.
                let (remote, references, values) =
                    unsafe { (remote(component), slice(references, count), slice(values, count)) };
                remote.set(Function::$set_function, references, values)
            }
        )*
    };
}

access! {
    get_real, set_real, f64, GetReal, SetReal;
    get_integer, set_integer, c_int, GetInteger, SetInteger;
    get_boolean, set_boolean, c_int, GetBoolean, SetBoolean;
}

unsafe extern "C" fn setup_experiment(
    component: Component,
    with_tolerance: c_int,
    tolerance: f64,
    start: f64,
    with_stop: c_int,
    stop: f64,
) -> c_int {
    // SAFETY: the component is alive.
    let remote = unsafe { remote(component) };
    remote.call(Function::SetupExperiment, |message| {
        message.number(u64::from(with_tolerance != 0));
        message.real(tolerance);
        message.real(start);
        message.number(u64::from(with_stop != 0));
        message.real(stop);
    })
}

unsafe extern "C" fn do_step(component: Component, from: f64, size: f64, no_return: c_int) -> c_int {
    // SAFETY: the component is alive.
    unsafe { remote(component) }.do_step(from, size, no_return != 0)
}

unsafe extern "C" fn set_debug_logging(
    component: Component,
    on: c_int,
    count: usize,
    names: *const *const c_char,
) -> c_int {
    // SAFETY: the component is alive, and there are so many names.
    let (remote, names) = unsafe { (remote(component), slice(names, count)) };
    remote.call(Function::SetDebugLogging, |message| {
        message.number(u64::from(on != 0));
        message.number(count as u64);
        names.iter().for_each(|name| message.bytes(crate::fmu::logger::owned(*name).as_bytes()));
    })
}

unsafe extern "C" fn get_string(
    component: Component,
    references: *const c_uint,
    count: usize,
    values: *mut *const c_char,
) -> c_int {
    // SAFETY: the component is alive, and both have the length that is given.
    let (remote, references, values) =
        unsafe { (remote(component), slice(references, count), slice_mut(values, count)) };
    remote.get_strings(references, values)
}

unsafe extern "C" fn set_string(
    component: Component,
    references: *const c_uint,
    count: usize,
    values: *const *const c_char,
) -> c_int {
    // SAFETY: as above.
    let (remote, references, values) =
        unsafe { (remote(component), slice(references, count), slice(values, count)) };
    remote.call(Function::SetString, |message| {
        message.number(count as u64);
        message.slice(references);
        message.number(count as u64);
        values.iter().for_each(|text| message.bytes(crate::fmu::logger::owned(*text).as_bytes()));
    })
}

unsafe extern "C" fn get_real_status(component: Component, kind: c_int, value: *mut f64) -> c_int {
    // SAFETY: the component is alive, and the value is somebody's.
    let (remote, value) = unsafe { (remote(component), &mut *value) };
    remote.ask(
        Function::GetRealStatus,
        |message| message.number(u64::from(kind.cast_unsigned())),
        |answer| {
            *value = answer.real()?;
            Some(())
        },
    )
}

unsafe extern "C" fn get_boolean_status(component: Component, kind: c_int, value: *mut c_int) -> c_int {
    // SAFETY: as above.
    let (remote, value) = unsafe { (remote(component), &mut *value) };
    remote.ask(
        Function::GetBooleanStatus,
        |message| message.number(u64::from(kind.cast_unsigned())),
        |answer| {
            *value = c_int::from(answer.number()? != 0);
            Some(())
        },
    )
}

/// A call that takes a state and answers a number.
fn with_state(component: Component, function: Function, state: State) -> (c_int, u64) {
    let mut number = 0;
    // SAFETY: the component is alive.
    let remote = unsafe { remote(component) };
    let status = remote.ask(
        function,
        |message| message.number(state as u64),
        |answer| {
            number = answer.number()?;
            Some(())
        },
    );
    (status, number)
}

unsafe extern "C" fn get_state(component: Component, state: *mut State) -> c_int {
    // SAFETY: the state is somebody's.
    let state = unsafe { &mut *state };
    let (status, number) = with_state(component, Function::GetFMUstate, *state);
    if status <= 1 {
        *state = number as State;
    }
    status
}

unsafe extern "C" fn set_state(component: Component, state: State) -> c_int {
    with_state(component, Function::SetFMUstate, state).0
}

unsafe extern "C" fn free_state(component: Component, state: *mut State) -> c_int {
    // SAFETY: the state is somebody's.
    let state = unsafe { &mut *state };
    let (status, number) = with_state(component, Function::FreeFMUstate, *state);
    *state = number as State;
    status
}

unsafe extern "C" fn state_size(component: Component, state: State, size: *mut usize) -> c_int {
    let (status, number) = with_state(component, Function::SerializedFMUstateSize, state);
    if number > BODY as u64 {
        // SAFETY: the component is alive.
        return unsafe { remote(component) }.too_large(number);
    }
    // SAFETY: the size is somebody's.
    unsafe { *size = number as usize };
    status
}

unsafe extern "C" fn serialize_state(
    component: Component,
    state: State,
    bytes: *mut c_char,
    size: usize,
) -> c_int {
    // SAFETY: the component is alive, and there are so many bytes.
    let (remote, bytes) = unsafe { (remote(component), slice_mut(bytes.cast::<u8>(), size)) };
    let question = |message: &mut super::message::Writer<'_>| {
        message.number(state as u64);
        message.number(size as u64);
    };
    remote.ask(Function::SerializeFMUstate, question, |answer| answer.slice(bytes))
}

unsafe extern "C" fn deserialize_state(
    component: Component,
    bytes: *const c_char,
    size: usize,
    state: *mut State,
) -> c_int {
    // SAFETY: the component is alive, there are so many bytes, and the state is somebody's.
    let (remote, bytes, state) = unsafe { (remote(component), slice(bytes.cast::<u8>(), size), &mut *state) };
    remote.ask(
        Function::DeSerializeFMUstate,
        |message| message.bytes(bytes),
        |answer| {
            *state = answer.number()? as State;
            Some(())
        },
    )
}

unsafe extern "C" fn directional_derivative(
    component: Component,
    unknowns: *const c_uint,
    unknown: usize,
    knowns: *const c_uint,
    known: usize,
    seed: *const f64,
    result: *mut f64,
) -> c_int {
    // SAFETY: the component is alive, and all have the lengths that are given.
    let (remote, unknowns, knowns, seed, result) = unsafe {
        let (unknowns, knowns) = (slice(unknowns, unknown), slice(knowns, known));
        (remote(component), unknowns, knowns, slice(seed, known), slice_mut(result, unknown))
    };
    let question = |message: &mut super::message::Writer<'_>| {
        message.number(unknown as u64);
        message.number(known as u64);
        message.slice(unknowns);
        message.slice(knowns);
        message.slice(seed);
    };
    remote.ask(Function::GetDirectionalDerivative, question, |answer| answer.slice(result))
}

unsafe extern "C" fn set_input_derivatives(
    component: Component,
    references: *const c_uint,
    count: usize,
    orders: *const c_int,
    values: *const f64,
) -> c_int {
    // SAFETY: the component is alive, and all have the length that is given.
    let (remote, references, orders, values) =
        unsafe { (remote(component), slice(references, count), slice(orders, count), slice(values, count)) };
    remote.call(Function::SetRealInputDerivatives, |message| {
        message.number(count as u64);
        message.slice(references);
        message.slice(orders);
        message.slice(values);
    })
}

unsafe extern "C" fn get_output_derivatives(
    component: Component,
    references: *const c_uint,
    count: usize,
    orders: *const c_int,
    values: *mut f64,
) -> c_int {
    // SAFETY: as above.
    let (remote, references, orders, values) = unsafe {
        (remote(component), slice(references, count), slice(orders, count), slice_mut(values, count))
    };
    let question = |message: &mut super::message::Writer<'_>| {
        message.number(count as u64);
        message.slice(references);
        message.slice(orders);
    };
    remote.ask(Function::GetRealOutputDerivatives, question, |answer| answer.slice(values))
}

#[cfg(test)]
mod tests;
