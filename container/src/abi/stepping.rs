//! Steps and what is said of them afterwards.
//!
//! # Safety
//! As in [`super`].
#![allow(clippy::missing_safety_doc)] // said once above

use super::{Inside, call};
use crate::error::Error;
use crate::instance::{Mode, Stepped};
use fmi2_export::abi::types::{
    Boolean, Component, DISCARD, DO_STEP_STATUS, ERROR, LAST_SUCCESSFUL_TIME, OK, Real, Status, StatusKind,
    TERMINATED,
};
use fmi2_export::logger::STATUS_DISCARD;

/// `fmi2DoStep`
pub unsafe fn do_step(c: Component, from: Real, size: Real) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        call(c, "fmi2DoStep", |inside| {
            inside.last_step = ERROR;
            let stepped = inside.instance.do_step(from, size)?;
            inside.last_step = match stepped {
                Stepped::Whole => OK,
                Stepped::Ended(time) => {
                    inside.log.send(DISCARD, STATUS_DISCARD.name, &|| {
                        format!("fmi2DoStep: a unit inside wants the run to end at t = {time} s")
                    });
                    DISCARD
                }
            };
            Ok(inside.last_step)
        })
    }
}

/// Writes a status if there is one of that kind; `fmi2Discard` otherwise.
unsafe fn answer<T>(
    c: Component,
    function: &'static str,
    kind: StatusKind,
    out: *mut T,
    find: impl FnOnce(&Inside) -> Option<T>,
) -> Status {
    // SAFETY: by the module's contract, here and inside.
    unsafe {
        call(c, function, |inside| {
            if out.is_null() {
                return Err(Error::Null { argument: "value" });
            }
            match find(inside) {
                Some(value) => {
                    out.write(value);
                    Ok(OK)
                }
                None => {
                    let message = || format!("{function}: there is no status of the kind {kind}");
                    inside.log.send(DISCARD, STATUS_DISCARD.name, &message);
                    Ok(DISCARD)
                }
            }
        })
    }
}

/// `fmi2GetStatus`
pub unsafe fn get_status(c: Component, kind: StatusKind, out: *mut Status) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        answer(c, "fmi2GetStatus", kind, out, |inside| (kind == DO_STEP_STATUS).then_some(inside.last_step))
    }
}

/// `fmi2GetRealStatus`
pub unsafe fn get_real_status(c: Component, kind: StatusKind, out: *mut Real) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        answer(c, "fmi2GetRealStatus", kind, out, |inside| {
            (kind == LAST_SUCCESSFUL_TIME).then(|| inside.instance.time())
        })
    }
}

/// `fmi2GetBooleanStatus`
pub unsafe fn get_boolean_status(c: Component, kind: StatusKind, out: *mut Boolean) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        answer(c, "fmi2GetBooleanStatus", kind, out, |inside| {
            (kind == TERMINATED).then(|| Boolean::from(inside.instance.mode() == Mode::Ended))
        })
    }
}

/// `fmi2GetIntegerStatus` and `fmi2GetStringStatus`, of which there are none.
pub unsafe fn get_no_status<T>(
    c: Component,
    function: &'static str,
    kind: StatusKind,
    out: *mut T,
) -> Status {
    // SAFETY: by the module's contract.
    unsafe { answer(c, function, kind, out, |_| None) }
}
