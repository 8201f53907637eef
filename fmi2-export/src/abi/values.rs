//! Values of variables and their derivatives.
//!
//! # Safety
//! As in [`super::lifecycle`]; arrays are as long as the argument beside them says.
#![allow(clippy::missing_safety_doc)] // said once above

use super::types::{Boolean, Component, Integer, Real, Status, Text, ValueReference};
use super::{bytes, call, slice, slice_out};
use crate::model::Model;
use crate::state_machine::Call;

macro_rules! getter {
    ($name:ident, $function:literal, $type:ty) => {
        #[doc = concat!("`", $function, "`")]
        pub unsafe fn $name<M: Model>(
            c: Component,
            vr: *const ValueReference,
            n: usize,
            value: *mut $type,
        ) -> Status {
            // SAFETY: by the module's contract.
            unsafe {
                call::<M>(c, $function, Call::Get, |instance| {
                    instance.$name(slice(vr, n, "vr")?, slice_out(value, n, "value")?)
                })
            }
        }
    };
}
getter!(get_real, "fmi2GetReal", Real);
getter!(get_integer, "fmi2GetInteger", Integer);
getter!(get_boolean, "fmi2GetBoolean", Boolean);
getter!(get_string, "fmi2GetString", Text);

macro_rules! setter {
    ($name:ident, $function:literal, $type:ty) => {
        #[doc = concat!("`", $function, "`")]
        pub unsafe fn $name<M: Model>(
            c: Component,
            vr: *const ValueReference,
            n: usize,
            value: *const $type,
        ) -> Status {
            // SAFETY: by the module's contract.
            unsafe {
                call::<M>(c, $function, Call::Set, |instance| {
                    instance.$name(slice(vr, n, "vr")?, slice(value, n, "value")?)
                })
            }
        }
    };
}
setter!(set_real, "fmi2SetReal", Real);
setter!(set_integer, "fmi2SetInteger", Integer);
setter!(set_boolean, "fmi2SetBoolean", Boolean);

/// `fmi2SetString`
pub unsafe fn set_string<M: Model>(
    c: Component,
    vr: *const ValueReference,
    n: usize,
    value: *const Text,
) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        call::<M>(c, "fmi2SetString", Call::Set, |instance| {
            let texts: Vec<_> = slice(value, n, "value")?.iter().map(|&text| bytes(text)).collect();
            instance.set_string(slice(vr, n, "vr")?, &texts)
        })
    }
}

/// `fmi2SetRealInputDerivatives`
pub unsafe fn set_real_input_derivatives<M: Model>(
    c: Component,
    vr: *const ValueReference,
    n: usize,
    order: *const Integer,
    value: *const Real,
) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        call::<M>(c, "fmi2SetRealInputDerivatives", Call::SetInputDerivatives, |instance| {
            instance.set_input_rates(
                slice(vr, n, "vr")?,
                slice(order, n, "order")?,
                slice(value, n, "value")?,
            )
        })
    }
}

/// `fmi2GetRealOutputDerivatives`
pub unsafe fn get_real_output_derivatives<M: Model>(
    c: Component,
    vr: *const ValueReference,
    n: usize,
    order: *const Integer,
    value: *mut Real,
) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        call::<M>(c, "fmi2GetRealOutputDerivatives", Call::GetOutputDerivatives, |instance| {
            instance.output_derivatives(
                slice(vr, n, "vr")?,
                slice(order, n, "order")?,
                slice_out(value, n, "value")?,
            )
        })
    }
}

/// `fmi2GetDirectionalDerivative`
pub unsafe fn get_directional_derivative<M: Model>(
    c: Component,
    (unknowns, n_unknowns): (*const ValueReference, usize),
    (knowns, n_knowns): (*const ValueReference, usize),
    seed: *const Real,
    out: *mut Real,
) -> Status {
    // SAFETY: by the module's contract.
    unsafe {
        call::<M>(c, "fmi2GetDirectionalDerivative", Call::Get, |instance| {
            instance.directional_derivative(
                slice(unknowns, n_unknowns, "vUnknown_ref")?,
                slice(knowns, n_knowns, "vKnown_ref")?,
                slice(seed, n_knowns, "dvKnown")?,
                slice_out(out, n_unknowns, "dvUnknown")?,
            )
        })
    }
}
