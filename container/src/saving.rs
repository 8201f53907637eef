//! The states of an instance: kept under handles, set again, and as bytes.

use crate::error::Error;
use crate::instance::{Instance, Mode};
use crate::state::State;

impl Instance {
    fn state(&mut self) -> Result<State, Error> {
        if !self.interface.saves {
            let expected = "a unit inside can't save its state (canGetAndSetFMUstate, canSerializeFMUstate)";
            return Err(Error::NotProvided { what: "the state", expected });
        }
        if matches!(self.mode, Mode::Error | Mode::Ended | Mode::Terminated) {
            return Err(Error::Illegal { mode: self.mode.name() });
        }
        let runs = self.mode == Mode::Step || self.mode == Mode::Initialization && !self.stale;
        let inside = if runs { Some(self.simulation.save()?) } else { None };
        let Self { mode, time, experiment, .. } = *self;
        Ok(State { mode, time, experiment, starts: self.starts.clone(), inside })
    }

    fn restore(&mut self, state: State) -> Result<(), Error> {
        let anew = self.experiment != state.experiment || self.starts != state.starts;
        (self.experiment, self.starts) = (state.experiment, state.starts);
        if anew || state.inside.is_none() {
            self.rebuild()?;
        }
        self.stale = state.inside.is_none();
        if let Some(inside) = &state.inside {
            self.simulation.go_back(inside)?;
        }
        (self.mode, self.time) = (state.mode, state.time);
        Ok(())
    }

    /// `fmi2GetFMUstate`: under a new handle, or in place of a known one.
    pub fn get_state(&mut self, handle: usize) -> Result<usize, Error> {
        if handle != 0 && !self.saved.contains_key(&handle) {
            return Err(Error::UnknownState(handle));
        }
        let state = self.state()?;
        let handle = if handle == 0 { self.new_handle() } else { handle };
        self.saved.insert(handle, state);
        Ok(handle)
    }

    /// Grows by so much that it looks like an aligned address to a master that prints it.
    fn new_handle(&mut self) -> usize {
        let handle = self.next_handle * 16;
        self.next_handle += 1;
        handle
    }

    fn known(&self, handle: usize) -> Result<&State, Error> {
        self.saved.get(&handle).ok_or(Error::UnknownState(handle))
    }

    /// `fmi2SetFMUstate`.
    pub fn set_state(&mut self, handle: usize) -> Result<(), Error> {
        let state = self.known(handle)?.clone();
        self.restore(state).inspect_err(|_| self.mode = Mode::Error)
    }

    /// `fmi2FreeFMUstate`.
    pub fn free_state(&mut self, handle: usize) -> Result<(), Error> {
        self.saved.remove(&handle).map(drop).ok_or(Error::UnknownState(handle))
    }

    /// `fmi2SerializeFMUstate`.
    pub fn serialize(&self, handle: usize) -> Result<Vec<u8>, Error> {
        self.known(handle)?.to_bytes(&self.guid)
    }

    /// `fmi2DeSerializeFMUstate`.
    pub fn deserialize(&mut self, bytes: &[u8]) -> Result<usize, Error> {
        let state = State::from_bytes(bytes, &self.guid)?;
        let handle = self.new_handle();
        self.saved.insert(handle, state);
        Ok(handle)
    }
}
