//! Saved states of an instance: `fmi2GetFMUstate` and its family.

use crate::error::Error;
use crate::fmu::library::State;
use crate::fmu::{Function, Instance};
use crate::guard;
use std::ptr;

/// A state of one instance, kept inside the unit. Give it back with [`Instance::free_state`]; a state that is only
/// dropped stays allocated until the process ends, since freeing needs the instance.
#[derive(Debug)]
#[must_use = "a state is freed only by Instance::free_state"]
pub struct SavedState {
    state: State,
}

// SAFETY: a state is data of the unit without thread affinity, as the instance is.
unsafe impl Send for SavedState {}

impl Instance {
    /// `fmi2GetFMUstate`.
    ///
    /// # Errors
    /// The unit hasn't got the function, or it failed.
    pub fn save_state(&mut self) -> Result<SavedState, Error> {
        const NAME: &str = "fmi2GetFMUstate";
        let Some(function) = self.functions.get_state else { return Err(self.missing(NAME)) };
        let mut state: State = ptr::null_mut();
        // SAFETY: a null state asks for a new one.
        let status = guard::around(self.label(), Function::GetFMUstate, || unsafe {
            function(self.component(), &mut state)
        });
        self.checked(NAME, status)?;
        Ok(SavedState { state })
    }

    /// `fmi2GetFMUstate` into a state that there is.
    pub(crate) fn save_state_again(&mut self, saved: &mut SavedState) -> Result<(), Error> {
        const NAME: &str = "fmi2GetFMUstate";
        let Some(function) = self.functions.get_state else { return Err(self.missing(NAME)) };
        // SAFETY: the state came from this unit, which writes it anew.
        let status = guard::around(self.label(), Function::GetFMUstate, || unsafe {
            function(self.component(), &mut saved.state)
        });
        self.checked(NAME, status)
    }

    /// `fmi2SetFMUstate`: back to a state of this instance.
    ///
    /// # Errors
    /// The unit hasn't got the function, or it failed.
    pub fn restore_state(&mut self, saved: &SavedState) -> Result<(), Error> {
        const NAME: &str = "fmi2SetFMUstate";
        let Some(function) = self.functions.set_state else { return Err(self.missing(NAME)) };
        // SAFETY: the state came from this unit.
        let status = guard::around(self.label(), Function::SetFMUstate, || unsafe {
            function(self.component(), saved.state)
        });
        self.checked(NAME, status)
    }

    /// `fmi2FreeFMUstate`.
    ///
    /// # Errors
    /// The unit hasn't got the function, or it failed.
    pub fn free_state(&mut self, saved: SavedState) -> Result<(), Error> {
        self.free_state_seen(saved).map(drop)
    }

    /// `fmi2FreeFMUstate`, and whether the unit set the pointer to null, as FMI 2.0 section 2.1.8 asks.
    ///
    /// # Errors
    /// The unit hasn't got the function, or it failed.
    pub fn free_state_seen(&mut self, mut saved: SavedState) -> Result<bool, Error> {
        const NAME: &str = "fmi2FreeFMUstate";
        let Some(function) = self.functions.free_state else { return Err(self.missing(NAME)) };
        // SAFETY: the state came from this unit and is used no more.
        let status = guard::around(self.label(), Function::FreeFMUstate, || unsafe {
            function(self.component(), &mut saved.state)
        });
        self.checked(NAME, status)?;
        Ok(saved.state.is_null())
    }

    /// `fmi2SerializeFMUstate`: the state as bytes.
    ///
    /// # Errors
    /// The unit hasn't got the function, or it failed.
    pub fn serialize_state(&mut self, saved: &SavedState) -> Result<Vec<u8>, Error> {
        const NAME: &str = "fmi2SerializeFMUstate";
        let (Some(size_of), Some(function)) = (self.functions.state_size, self.functions.serialize_state)
        else {
            return Err(self.missing(NAME));
        };
        let mut size = 0;
        // SAFETY: the state came from this unit.
        let status = guard::around(self.label(), Function::SerializedFMUstateSize, || unsafe {
            size_of(self.component(), saved.state, &mut size)
        });
        self.checked("fmi2SerializedFMUstateSize", status)?;
        let mut bytes: Vec<u8> = Vec::new();
        // a unit may say any size
        if bytes.try_reserve_exact(size).is_err() {
            return Err(Error::StateSize { unit: self.name().to_owned(), bytes: size });
        }
        bytes.resize(size, 0);
        // SAFETY: the buffer has the size that the unit asked for.
        let status = guard::around(self.label(), Function::SerializeFMUstate, || unsafe {
            function(self.component(), saved.state, bytes.as_mut_ptr().cast(), size)
        });
        self.checked(NAME, status)?;
        Ok(bytes)
    }

    /// `fmi2DeSerializeFMUstate`: a state from bytes, also those of another instance of the same unit.
    ///
    /// # Errors
    /// The unit hasn't got the function, or it failed.
    pub fn deserialize_state(&mut self, bytes: &[u8]) -> Result<SavedState, Error> {
        const NAME: &str = "fmi2DeSerializeFMUstate";
        let Some(function) = self.functions.deserialize_state else { return Err(self.missing(NAME)) };
        let mut state: State = ptr::null_mut();
        // SAFETY: the buffer has the length that is given.
        let status = guard::around(self.label(), Function::DeSerializeFMUstate, || unsafe {
            function(self.component(), bytes.as_ptr().cast(), bytes.len(), &mut state)
        });
        self.checked(NAME, status)?;
        Ok(SavedState { state })
    }
}
