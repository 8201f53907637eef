//! Saving and restoring the whole state of an instance.
//!
//! # Safety
//! As in [`super`]. Handles of states are numbers that are looked up, so any value is safe.
#![allow(clippy::missing_safety_doc)] // said once above

use super::{array, array_out, call};
use crate::error::Error;
use fmi2_export::abi::types::{Byte, Component, FmuState, OK, Status};
use std::ptr;

/// `fmi2GetFMUstate`
pub unsafe fn get_state(c: Component, state: *mut FmuState) -> Status {
    // SAFETY: by the module's contract, here and inside. Handles are numbers that are looked up.
    unsafe {
        call(c, "fmi2GetFMUstate", |inside| {
            if state.is_null() {
                return Err(Error::Null { argument: "FMUstate" });
            }
            *state = ptr::without_provenance_mut(inside.instance.get_state(*state as usize)?);
            Ok(OK)
        })
    }
}

/// `fmi2SetFMUstate`
pub unsafe fn set_state(c: Component, state: FmuState) -> Status {
    // SAFETY: by the module's contract.
    unsafe { call(c, "fmi2SetFMUstate", |inside| inside.instance.set_state(state as usize).map(|()| OK)) }
}

/// `fmi2FreeFMUstate`: nothing happens if there is no state.
pub unsafe fn free_state(c: Component, state: *mut FmuState) -> Status {
    // SAFETY: by the module's contract, here and inside.
    unsafe {
        call(c, "fmi2FreeFMUstate", |inside| {
            if !state.is_null() && !(*state).is_null() {
                inside.instance.free_state(*state as usize)?;
                *state = ptr::null_mut();
            }
            Ok(OK)
        })
    }
}

/// `fmi2SerializedFMUstateSize`
pub unsafe fn serialized_size(c: Component, state: FmuState, size: *mut usize) -> Status {
    // SAFETY: by the module's contract, here and inside.
    unsafe {
        call(c, "fmi2SerializedFMUstateSize", |inside| {
            if size.is_null() {
                return Err(Error::Null { argument: "size" });
            }
            *size = inside.instance.serialize(state as usize)?.len();
            Ok(OK)
        })
    }
}

/// `fmi2SerializeFMUstate`
pub unsafe fn serialize(c: Component, state: FmuState, out: *mut Byte, size: usize) -> Status {
    // SAFETY: by the module's contract, here and inside.
    unsafe {
        call(c, "fmi2SerializeFMUstate", |inside| {
            let state = inside.instance.serialize(state as usize)?;
            if size < state.len() {
                return Err(Error::Buffer { given: size, needed: state.len() });
            }
            for (byte, out) in state.iter().zip(array_out(out, size, "serializedState")?) {
                out.write(*byte as Byte);
            }
            Ok(OK)
        })
    }
}

/// `fmi2DeSerializeFMUstate`
pub unsafe fn deserialize(c: Component, from: *const Byte, size: usize, state: *mut FmuState) -> Status {
    // SAFETY: by the module's contract, here and inside.
    unsafe {
        call(c, "fmi2DeSerializeFMUstate", |inside| {
            if state.is_null() {
                return Err(Error::Null { argument: "FMUstate" });
            }
            let bytes: Vec<u8> =
                array(from, size, "serializedState")?.iter().map(|byte| *byte as u8).collect();
            let handle = inside.instance.deserialize(&bytes)?;
            *state = ptr::without_provenance_mut(handle);
            Ok(OK)
        })
    }
}
