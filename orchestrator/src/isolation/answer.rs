//! One call in the process of a unit: its arguments from the request, the function of the library, and what it answered.

use super::message::{Plain, Reader, Writer};
use crate::fmu::library::{Component, Functions, Get, Set, State};
use crate::fmu::{Function, logger};
use std::ffi::{CString, c_char, c_int};
use std::ptr;

/// A call that is to be made. The component is null once it was freed.
pub(super) struct Call<'c, 'r, 'a> {
    pub(super) component: &'c mut Component,
    pub(super) functions: &'c Functions,
    pub(super) request: &'c mut Reader<'r>,
    pub(super) answer: &'c mut Writer<'a>,
}

impl Call<'_, '_, '_> {
    /// Makes the call; its status. `None`, with nothing answered, where the library lacks the function or the request makes
    /// no sense.
    ///
    /// # Safety
    /// The instance is alive, and the request is one of the client's: its arguments have the lengths that are given.
    #[inline]
    pub(super) unsafe fn make(&mut self, function: Function) -> Option<c_int> {
        let (f, c) = (self.functions, *self.component);
        // SAFETY: as promised by the caller.
        unsafe {
            match function {
                Function::DoStep => {
                    let (from, size) = (self.request.real()?, self.request.real()?);
                    let no_return = self.request.number()? as c_int;
                    self.status((f.do_step)(c, from, size, no_return))
                }
                Function::GetReal => self.get(f.get_real),
                Function::GetInteger => self.get(f.get_integer?),
                Function::GetBoolean => self.get(f.get_boolean?),
                Function::GetString => self.get_string(),
                Function::SetReal => self.set(f.set_real),
                Function::SetInteger => self.set(f.set_integer?),
                Function::SetBoolean => self.set(f.set_boolean?),
                Function::SetString => self.set_string(),
                Function::GetRealStatus => self.real_status(),
                Function::GetBooleanStatus => self.boolean_status(),
                Function::GetDirectionalDerivative => self.directional_derivative(),
                Function::SetRealInputDerivatives => self.set_input_derivatives(),
                Function::GetRealOutputDerivatives => self.get_output_derivatives(),
                Function::GetFMUstate
                | Function::SetFMUstate
                | Function::FreeFMUstate
                | Function::SerializedFMUstateSize
                | Function::SerializeFMUstate
                | Function::DeSerializeFMUstate => self.state(function),
                _ => self.control(function),
            }
        }
    }

    /// Answers nothing but the status.
    #[inline]
    fn status(&mut self, status: c_int) -> Option<c_int> {
        self.answer.number(u64::from(status.cast_unsigned()));
        Some(status)
    }

    fn with_number(&mut self, status: c_int, number: u64) -> Option<c_int> {
        self.status(status)?;
        self.answer.number(number);
        Some(status)
    }

    #[inline]
    fn with_values<T: Plain>(&mut self, status: c_int, values: &[T]) -> Option<c_int> {
        self.status(status)?;
        self.answer.slice(values);
        Some(status)
    }

    #[inline]
    unsafe fn get<T: Plain + Default>(&mut self, get: Get<T>) -> Option<c_int> {
        let count = self.request.count()?;
        let references: Vec<u32> = self.request.values(count)?;
        let mut values = vec![T::default(); count];
        // SAFETY: as of `make`; as many values as references.
        let status = unsafe { get(*self.component, references.as_ptr(), count, values.as_mut_ptr()) };
        self.with_values(status, &values)
    }

    #[inline]
    unsafe fn set<T: Plain + Default>(&mut self, set: Set<T>) -> Option<c_int> {
        let count = self.request.count()?;
        let references: Vec<u32> = self.request.values(count)?;
        let values: Vec<T> = self.request.values(count)?;
        // SAFETY: as of `make`; as many values as references.
        let status = unsafe { set(*self.component, references.as_ptr(), count, values.as_ptr()) };
        self.status(status)
    }

    unsafe fn get_string(&mut self) -> Option<c_int> {
        let count = self.request.count()?;
        let references: Vec<u32> = self.request.values(count)?;
        let mut texts: Vec<*const c_char> = vec![ptr::null(); count];
        let get = self.functions.get_string?;
        // SAFETY: as of `make`; as many texts as references.
        let status = unsafe { get(*self.component, references.as_ptr(), count, texts.as_mut_ptr()) };
        self.status(status)?;
        texts.into_iter().for_each(|text| self.answer.bytes(logger::owned(text).as_bytes()));
        Some(status)
    }

    unsafe fn set_string(&mut self) -> Option<c_int> {
        let count = self.request.count()?;
        let references: Vec<u32> = self.request.values(count)?;
        let texts = strings(self.request)?;
        let pointers: Vec<*const c_char> = texts.iter().map(|text| text.as_ptr()).collect();
        let set = self.functions.set_string?;
        // SAFETY: as of `make`; the texts live over the call.
        let status = unsafe { set(*self.component, references.as_ptr(), count, pointers.as_ptr()) };
        self.status(status)
    }

    unsafe fn real_status(&mut self) -> Option<c_int> {
        let mut value = f64::NAN;
        let get = self.functions.get_real_status?;
        // SAFETY: as of `make`.
        let status = unsafe { get(*self.component, self.request.number()? as c_int, &mut value) };
        self.with_number(status, value.to_bits())
    }

    unsafe fn boolean_status(&mut self) -> Option<c_int> {
        let mut value = 0;
        let get = self.functions.get_boolean_status?;
        // SAFETY: as of `make`.
        let status = unsafe { get(*self.component, self.request.number()? as c_int, &mut value) };
        self.with_number(status, u64::from(value != 0))
    }

    /// What begins and ends the instance's life and its runs.
    unsafe fn control(&mut self, function: Function) -> Option<c_int> {
        let (f, c) = (self.functions, *self.component);
        // SAFETY: as of `make`.
        let status = unsafe {
            match function {
                Function::FreeInstance => {
                    (f.free_instance)(c);
                    *self.component = ptr::null_mut();
                    0
                }
                Function::SetDebugLogging => {
                    let (on, names) = (self.request.number()? != 0, strings(self.request)?);
                    let pointers: Vec<*const c_char> = names.iter().map(|name| name.as_ptr()).collect();
                    f.set_debug_logging?(c, c_int::from(on), pointers.len(), pointers.as_ptr())
                }
                Function::SetupExperiment => {
                    let (with_tolerance, tolerance) = (self.request.number()? as c_int, self.request.real()?);
                    let (start, with_stop, stop) =
                        (self.request.real()?, self.request.number()? as c_int, self.request.real()?);
                    (f.setup_experiment)(c, with_tolerance, tolerance, start, with_stop, stop)
                }
                Function::EnterInitializationMode => (f.enter_initialization)(c),
                Function::ExitInitializationMode => (f.exit_initialization)(c),
                Function::Terminate => (f.terminate)(c),
                Function::Reset => f.reset?(c),
                _ => return None,
            }
        };
        self.status(status)
    }

    /// Saved states. One is the unit's own pointer, which the client only hands back.
    unsafe fn state(&mut self, function: Function) -> Option<c_int> {
        let (f, c) = (self.functions, *self.component);
        // SAFETY: as of `make`.
        unsafe {
            match function {
                Function::GetFMUstate => {
                    let mut state = self.request.number()? as State;
                    let status = f.get_state?(c, &mut state);
                    self.with_number(status, state as u64)
                }
                Function::SetFMUstate => {
                    let status = f.set_state?(c, self.request.number()? as State);
                    self.with_number(status, 0)
                }
                Function::FreeFMUstate => {
                    let mut state = self.request.number()? as State;
                    let status = f.free_state?(c, &mut state);
                    self.with_number(status, state as u64)
                }
                Function::SerializedFMUstateSize => {
                    let mut size = 0;
                    let status = f.state_size?(c, self.request.number()? as State, &mut size);
                    self.with_number(status, size as u64)
                }
                Function::SerializeFMUstate => {
                    let (state, size) = (self.request.number()? as State, self.request.count()?);
                    let mut bytes = vec![0u8; size];
                    let status = f.serialize_state?(c, state, bytes.as_mut_ptr().cast(), size);
                    self.with_values(status, &bytes)
                }
                Function::DeSerializeFMUstate => {
                    let bytes = self.request.bytes()?;
                    let mut state: State = ptr::null_mut();
                    let status = f.deserialize_state?(c, bytes.as_ptr().cast(), bytes.len(), &mut state);
                    self.with_number(status, state as u64)
                }
                _ => None,
            }
        }
    }

    unsafe fn directional_derivative(&mut self) -> Option<c_int> {
        let (unknown, known) = (self.request.count()?, self.request.count()?);
        let unknowns: Vec<u32> = self.request.values(unknown)?;
        let knowns: Vec<u32> = self.request.values(known)?;
        let seed: Vec<f64> = self.request.values(known)?;
        let mut result = vec![0.0; unknown];
        let (unknowns, knowns) = (unknowns.as_ptr(), knowns.as_ptr());
        let get = self.functions.directional_derivative?;
        // SAFETY: as of `make`; the lengths are those of the slices.
        let status = unsafe {
            get(*self.component, unknowns, unknown, knowns, known, seed.as_ptr(), result.as_mut_ptr())
        };
        self.with_values(status, &result)
    }

    unsafe fn set_input_derivatives(&mut self) -> Option<c_int> {
        let count = self.request.count()?;
        let references: Vec<u32> = self.request.values(count)?;
        let orders: Vec<i32> = self.request.values(count)?;
        let values: Vec<f64> = self.request.values(count)?;
        let set = self.functions.set_input_derivatives?;
        // SAFETY: as of `make`; as many orders and values as references.
        let status =
            unsafe { set(*self.component, references.as_ptr(), count, orders.as_ptr(), values.as_ptr()) };
        self.status(status)
    }

    unsafe fn get_output_derivatives(&mut self) -> Option<c_int> {
        let count = self.request.count()?;
        let references: Vec<u32> = self.request.values(count)?;
        let orders: Vec<i32> = self.request.values(count)?;
        let mut values = vec![0.0; count];
        let get = self.functions.get_output_derivatives?;
        // SAFETY: as of `make`; as many orders and values as references.
        let status =
            unsafe { get(*self.component, references.as_ptr(), count, orders.as_ptr(), values.as_mut_ptr()) };
        self.with_values(status, &values)
    }
}

fn strings(request: &mut Reader<'_>) -> Option<Vec<CString>> {
    let count = request.count()?;
    let mut all = Vec::new();
    for _ in 0..count {
        let bytes: Vec<u8> = request.bytes()?.iter().copied().filter(|byte| *byte != 0).collect();
        all.push(CString::new(bytes).ok()?);
    }
    Some(all)
}
