//! The C functions of FMI 2.0: the only place where pointers are followed.
//!
//! Each function here is generic over the model; [`export!`](crate::export) gives it its C name. All follow one
//! pattern: `call` finds the instance, checks the calling sequence, turns arguments into slices, and turns
//! errors and panics into a status and a log line.

pub mod export;
pub mod lifecycle;
pub mod states;
pub mod stepping;
pub mod types;
pub mod values;

use crate::error::Error;
use crate::instance::Instance;
use crate::model::Model;
use crate::state_machine::{Call, Mode};
use std::any::Any;
use std::cell::UnsafeCell;
use std::ffi::{CStr, c_char};
use std::mem::MaybeUninit;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use types::{Component, DISCARD, ERROR, OK, Status};

/// What an `fmi2Component` points to.
pub struct Handle<M: Model> {
    /// A call is under way. A second one, from another thread or from within a log callback, is refused.
    busy: AtomicBool,
    instance: UnsafeCell<Instance<M>>,
}

impl<M: Model> Handle<M> {
    fn new(instance: Instance<M>) -> Self {
        Self { busy: AtomicBool::new(false), instance: UnsafeCell::new(instance) }
    }
}

/// Runs `body` on the instance if the calling sequence allows it.
///
/// # Safety
/// `component` is null or came from `fmi2Instantiate` of the same model and was not freed.
unsafe fn call<M: Model>(
    component: Component,
    function: &'static str,
    kind: Call,
    body: impl FnOnce(&mut Instance<M>) -> Result<(), Error>,
) -> Status {
    if component.is_null() {
        return ERROR;
    }
    // SAFETY: by the contract above.
    let handle = unsafe { &*component.cast::<Handle<M>>() };
    if handle.busy.swap(true, Ordering::Acquire) {
        return ERROR;
    }
    // SAFETY: `busy` was free and is ours now, so there is no other reference.
    let instance = unsafe { &mut *handle.instance.get() };
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        instance.check(kind)?;
        body(instance)
    }));
    let error = match outcome {
        Ok(Ok(())) => None,
        Ok(Err(error)) => Some(error),
        Err(payload) => {
            instance.state.mode = Mode::Error;
            Some(Error::Panic(panic_message(payload)))
        }
    };
    let status = match &error {
        None => OK,
        // Nothing is wrong with the unit: a master that asks on speculation may go on.
        Some(Error::NoOutputDerivative { .. }) => DISCARD,
        Some(_) => ERROR,
    };
    if let Some(error) = error {
        instance.report(function, status, &error);
    }
    handle.busy.store(false, Ordering::Release);
    status
}

/// What a panic said.
pub fn panic_message(payload: Box<dyn Any + Send>) -> String {
    let message = match payload.downcast::<String>() {
        Ok(message) => return *message,
        Err(payload) => payload.downcast::<&'static str>(),
    };
    match message {
        Ok(message) => (*message).to_owned(),
        Err(unknown) => {
            std::mem::forget(unknown); // its destructor is unknown and might panic again
            "without a message".to_owned()
        }
    }
}

/// The longest array that a pointer can lead to.
fn check_array<T>(pointer: *const T, length: usize, argument: &'static str) -> Result<(), Error> {
    if pointer.is_null() {
        return Err(Error::Null { argument });
    }
    if length > isize::MAX as usize / size_of::<T>().max(1) {
        return Err(Error::Length { argument, length });
    }
    Ok(())
}

/// An array that the master passed. A null pointer is legal if it has no elements.
///
/// # Safety
/// If `length` is not 0 and `pointer` not null, `length` elements can be read there for `'a`.
pub unsafe fn slice<'a, T>(
    pointer: *const T,
    length: usize,
    argument: &'static str,
) -> Result<&'a [T], Error> {
    if length == 0 {
        return Ok(&[]);
    }
    check_array(pointer, length, argument)?;
    // SAFETY: not null, not too long, the rest by the contract above.
    Ok(unsafe { std::slice::from_raw_parts(pointer, length) })
}

/// An array that the master wants filled.
///
/// # Safety
/// As for [`slice()`], and nobody else uses the elements during `'a`.
pub unsafe fn slice_out<'a, T>(
    pointer: *mut T,
    length: usize,
    argument: &'static str,
) -> Result<&'a mut [MaybeUninit<T>], Error> {
    if length == 0 {
        return Ok(&mut []);
    }
    check_array(pointer, length, argument)?;
    // SAFETY: as above; uninitialised elements are fine as `MaybeUninit`.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer.cast(), length) })
}

/// The bytes of a C string, or `None` for a null pointer.
///
/// # Safety
/// `pointer` is null or leads to a terminated string that lives for `'a`.
pub unsafe fn bytes<'a>(pointer: *const c_char) -> Option<&'a [u8]> {
    // SAFETY: by the contract above.
    (!pointer.is_null()).then(|| unsafe { CStr::from_ptr(pointer) }.to_bytes())
}
