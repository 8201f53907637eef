//! Random use of saved states, and what must hold for them.

use super::calls::{OK, Sequence};
use fmi2_export::abi::types::FmuState;
use std::ptr;

impl Sequence<'_> {
    /// Saves, restores or frees a state, sometimes none.
    pub(super) fn state(&mut self) -> Result<(), String> {
        let (api, c) = (self.api, self.c);
        let at = self.random.below(self.states.len() + 1);
        let mut state = self.states.get(at).copied().unwrap_or(ptr::null_mut());
        // SAFETY: states of this instance, or null.
        unsafe {
            match self.random.below(4) {
                0 | 1 => {
                    let status = (api.get_state)(c, &mut state);
                    if self.note("fmi2GetFMUstate", status)? && at == self.states.len() {
                        self.states.push(state);
                    }
                }
                2 => {
                    self.sound = false; // the state may be of a failed instance
                    let status = (api.set_state)(c, state);
                    if self.note("fmi2SetFMUstate", status)? {
                        let mut time = self.time;
                        if (api.real_status)(c, 2, &mut time) == OK {
                            self.time = time;
                        }
                    }
                }
                _ => {
                    let status = (api.free_state)(c, &mut state);
                    if self.note("fmi2FreeFMUstate", status)? && at < self.states.len() {
                        self.states.swap_remove(at);
                    }
                }
            }
        }
        Ok(())
    }

    fn serialized(&mut self, state: FmuState) -> Result<Option<Vec<u8>>, String> {
        let mut size = 0;
        // SAFETY: a state of this instance, a buffer of the size given.
        unsafe {
            let status = (self.api.state_size)(self.c, state, &mut size);
            if !self.note("fmi2SerializedFMUstateSize", status)? {
                return Ok(None);
            }
            let mut bytes = vec![0_u8; size];
            let status = (self.api.serialize)(self.c, state, bytes.as_mut_ptr().cast(), size);
            Ok(self.note("fmi2SerializeFMUstate", status)?.then_some(bytes))
        }
    }

    /// Bytes of a state must give the same state; damaged ones must be refused.
    pub(super) fn bytes(&mut self) -> Result<(), String> {
        let (api, c) = (self.api, self.c);
        let mut state = ptr::null_mut();
        // SAFETY: states of this instance, buffers of the size given.
        unsafe {
            let status = (api.get_state)(c, &mut state);
            if !self.note("fmi2GetFMUstate", status)? {
                return Ok(());
            }
            self.states.push(state);
            let Some(mut bytes) = self.serialized(state)? else { return Ok(()) };
            let mut copy = ptr::null_mut();
            let damaged = self.random.per_cent(50);
            if damaged {
                let at = self.random.below(bytes.len());
                bytes[at] ^= 1 << self.random.below(8);
            }
            let length = bytes.len() - if damaged && self.random.per_cent(20) { 1 } else { 0 };
            let status = (api.deserialize)(c, bytes.as_ptr().cast(), length, &mut copy);
            if self.note("fmi2DeSerializeFMUstate", status)? == damaged {
                return Err(format!("fmi2DeSerializeFMUstate answered {status}, bytes damaged: {damaged}"));
            }
            if !damaged {
                self.states.push(copy);
                if self.serialized(copy)?.as_deref() != Some(&bytes) {
                    return Err("a serialised state changed on its way".to_owned());
                }
            }
        }
        Ok(())
    }

    /// A step, undone and repeated, must end in the same state to the bit.
    pub(super) fn replay(&mut self) -> Result<(), String> {
        let (api, c, from) = (self.api, self.c, self.time);
        let size = self.random.pick(&[1.0 / 600.0, 1e-3, 1.0 / 30.0]);
        let mut start = ptr::null_mut();
        let mut ends = Vec::new();
        // SAFETY: states of this instance.
        unsafe {
            let status = (api.get_state)(c, &mut start);
            if !self.note("fmi2GetFMUstate", status)? {
                return Ok(());
            }
            self.states.push(start);
            for _ in 0..2 {
                let status = (api.step)(c, from, size, 0);
                let stepped = self.note("fmi2DoStep", status)?;
                let mut end = ptr::null_mut();
                let status = (api.get_state)(c, &mut end);
                self.note("fmi2GetFMUstate", status)?;
                self.states.push(end);
                ends.push((stepped, self.serialized(end)?));
                let status = (api.set_state)(c, start);
                if !self.note("fmi2SetFMUstate", status)? {
                    return Err("a state of the instance's own is refused".to_owned());
                }
            }
        }
        if ends[0] != ends[1] {
            return Err(format!(
                "a step from {from} of {size} s, repeated from a saved state, ends elsewhere"
            ));
        }
        Ok(())
    }
}
