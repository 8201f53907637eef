//! Steps and what a unit says of them afterwards.
//!
//! # Safety
//! As in [`super::lifecycle`].
#![allow(clippy::missing_safety_doc)] // said once above

use super::call;
use super::types::{Boolean, Component, DISCARD, DO_STEP_STATUS, LAST_SUCCESSFUL_TIME, OK, Real, Status};
use super::types::{StatusKind, TERMINATED};
use crate::error::Error;
use crate::instance::Instance;
use crate::logger::STATUS_DISCARD;
use crate::model::Model;
use crate::state_machine::Call;

/// `fmi2DoStep`
pub unsafe fn do_step<M: Model>(c: Component, from: Real, size: Real, no_state_prior: Boolean) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        call::<M>(c, "fmi2DoStep", Call::Step, |instance| instance.do_step(from, size, no_state_prior != 0))
    }
}

/// `fmi2CancelStep`: never legal, since no step is asynchronous.
pub unsafe fn cancel_step<M: Model>(c: Component) -> Status {
    // SAFETY: by the module's contract.
    unsafe { call::<M>(c, "fmi2CancelStep", Call::CancelStep, |_| Err(Error::NotPending)) }
}

/// Writes a status if there is one of that kind; `fmi2Discard` and a log line otherwise.
unsafe fn answer<M: Model, T>(
    c: Component,
    function: &'static str,
    kind: StatusKind,
    out: *mut T,
    find: impl FnOnce(&Instance<M>) -> Option<T>,
) -> Status {
    let mut found = true;
    // SAFETY: by the module's contract.
    let status = unsafe {
        call::<M>(c, function, Call::GetStatus, |instance| {
            if out.is_null() {
                return Err(Error::Null { argument: "value" });
            }
            match find(instance) {
                Some(value) => out.write(value),
                None => {
                    found = false;
                    let message = || format!("{function}: there is no status of the kind {kind}");
                    instance.log.send(DISCARD, STATUS_DISCARD.name, &message);
                }
            }
            Ok(())
        })
    };
    if status == OK && !found { DISCARD } else { status }
}

/// `fmi2GetStatus`
pub unsafe fn get_status<M: Model>(c: Component, kind: StatusKind, out: *mut Status) -> Status {
    let find = |instance: &Instance<M>| (kind == DO_STEP_STATUS).then_some(instance.last_step);
    // SAFETY: by the module's contract.
    unsafe { answer(c, "fmi2GetStatus", kind, out, find) }
}

/// `fmi2GetRealStatus`
pub unsafe fn get_real_status<M: Model>(c: Component, kind: StatusKind, out: *mut Real) -> Status {
    let find = |instance: &Instance<M>| (kind == LAST_SUCCESSFUL_TIME).then_some(instance.state.time);
    // SAFETY: by the module's contract.
    unsafe { answer(c, "fmi2GetRealStatus", kind, out, find) }
}

/// `fmi2GetBooleanStatus`: a unit never asks to end the simulation.
pub unsafe fn get_boolean_status<M: Model>(c: Component, kind: StatusKind, out: *mut Boolean) -> Status {
    // SAFETY: by the module's contract.
    unsafe { answer::<M, _>(c, "fmi2GetBooleanStatus", kind, out, |_| (kind == TERMINATED).then_some(0)) }
}

/// `fmi2GetIntegerStatus` and `fmi2GetStringStatus`: there is no status of these types.
pub unsafe fn get_no_status<M: Model, T>(
    c: Component,
    function: &'static str,
    kind: StatusKind,
    out: *mut T,
) -> Status {
    // SAFETY: by the module's contract.
    unsafe { answer::<M, T>(c, function, kind, out, |_| None) }
}
