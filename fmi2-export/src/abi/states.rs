//! Saving and restoring the whole state of an instance.
//!
//! # Safety
//! As in [`super::lifecycle`]. Handles of states are numbers that are looked up, so any value is safe.
#![allow(clippy::missing_safety_doc)] // said once above

use super::types::{Byte, Component, FmuState, Status};
use super::{call, slice, slice_out};
use crate::error::Error;
use crate::model::Model;
use crate::saved;
use crate::state_machine::Call;
use std::ptr;

/// `fmi2GetFMUstate`: a new state if `*state` is null, else that one is overwritten.
pub unsafe fn get<M: Model>(c: Component, state: *mut FmuState) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        call::<M>(c, "fmi2GetFMUstate", Call::Always, |instance| {
            if state.is_null() {
                return Err(Error::Null { argument: "FMUstate" });
            }
            let handle = saved::keep(c as usize, *state as usize, instance.state.clone())?;
            *state = ptr::without_provenance_mut(handle);
            Ok(())
        })
    }
}

/// `fmi2SetFMUstate`
pub unsafe fn set<M: Model>(c: Component, state: FmuState) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        call::<M>(c, "fmi2SetFMUstate", Call::Always, |instance| {
            instance.restore(saved::with::<M, _>(state as usize, Clone::clone)?)
        })
    }
}

/// `fmi2FreeFMUstate`: nothing happens if there is no state.
pub unsafe fn free<M: Model>(c: Component, state: *mut FmuState) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        call::<M>(c, "fmi2FreeFMUstate", Call::Always, |_| {
            if state.is_null() || (*state).is_null() {
                return Ok(());
            }
            saved::free(*state as usize)?;
            *state = ptr::null_mut();
            Ok(())
        })
    }
}

/// `fmi2SerializedFMUstateSize`
pub unsafe fn serialized_size<M: Model>(c: Component, state: FmuState, size: *mut usize) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        call::<M>(c, "fmi2SerializedFMUstateSize", Call::Always, |instance| {
            if size.is_null() {
                return Err(Error::Null { argument: "size" });
            }
            let bytes = saved::with::<M, _>(state as usize, |state| saved::to_bytes(state, &instance.guid))??;
            *size = bytes.len();
            Ok(())
        })
    }
}

/// `fmi2SerializeFMUstate`
pub unsafe fn serialize<M: Model>(c: Component, state: FmuState, bytes: *mut Byte, size: usize) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        call::<M>(c, "fmi2SerializeFMUstate", Call::Always, |instance| {
            let content =
                saved::with::<M, _>(state as usize, |state| saved::to_bytes(state, &instance.guid))??;
            let out = slice_out(bytes.cast::<u8>(), size, "serializedState")?;
            if out.len() < content.len() {
                return Err(Error::Buffer { given: size, needed: content.len() });
            }
            for (out, byte) in out.iter_mut().zip(content) {
                out.write(byte);
            }
            Ok(())
        })
    }
}

/// `fmi2DeSerializeFMUstate`
pub unsafe fn deserialize<M: Model>(
    c: Component,
    bytes: *const Byte,
    size: usize,
    state: *mut FmuState,
) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        call::<M>(c, "fmi2DeSerializeFMUstate", Call::Always, |instance| {
            if state.is_null() {
                return Err(Error::Null { argument: "FMUstate" });
            }
            let content = slice(bytes.cast::<u8>(), size, "serializedState")?;
            let restored = saved::from_bytes::<M>(content, &instance.guid)?;
            let handle = saved::keep(c as usize, *state as usize, restored)?;
            *state = ptr::without_provenance_mut(handle);
            Ok(())
        })
    }
}
