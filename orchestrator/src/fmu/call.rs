//! Reading and writing variables of an instance, many at a time. Lengths are checked before anything is called.

use crate::error::Error;
use crate::fmu::Instance;
use crate::fmu::library::Functions;
use crate::fmu::logger::owned;
use std::ffi::{CString, c_char};
use std::ptr;

/// A unit without variables of a type may leave the functions for it out.
macro_rules! function {
    ($functions:expr, needed, $field:ident, $instance:expr, $name:literal) => {
        $functions.$field
    };
    ($functions:expr, optional, $field:ident, $instance:expr, $name:literal) => {
        match $functions.$field {
            Some(function) => function,
            None => return Err($instance.missing($name)),
        }
    };
}

macro_rules! access {
    ($get:ident, $set:ident, $type:ty, $need:ident, $get_name:literal, $set_name:literal) => {
        #[doc = concat!("`", $get_name, "`; as many values as references.")]
        #[inline]
        pub fn $get(&mut self, references: &[u32], values: &mut [$type]) -> Result<(), Error> {
            let functions: &Functions = &self.functions;
            let function = function!(functions, $need, $get, self, $get_name);
            if references.len() != values.len() {
                return Err(self.lengths($get_name, references.len(), values.len()));
            }
            // SAFETY: both slices have the length that is given.
            let status = unsafe {
                function(self.component(), references.as_ptr(), references.len(), values.as_mut_ptr())
            };
            self.checked($get_name, status)
        }

        #[doc = concat!("`", $set_name, "`; as many values as references.")]
        #[inline]
        pub fn $set(&mut self, references: &[u32], values: &[$type]) -> Result<(), Error> {
            let functions: &Functions = &self.functions;
            let function = function!(functions, $need, $set, self, $set_name);
            if references.len() != values.len() {
                return Err(self.lengths($set_name, references.len(), values.len()));
            }
            // SAFETY: both slices have the length that is given.
            let status =
                unsafe { function(self.component(), references.as_ptr(), references.len(), values.as_ptr()) };
            self.checked($set_name, status)
        }
    };
}

impl Instance {
    access!(get_real, set_real, f64, needed, "fmi2GetReal", "fmi2SetReal");
    access!(get_integer, set_integer, i32, optional, "fmi2GetInteger", "fmi2SetInteger");
    access!(get_boolean, set_boolean, i32, optional, "fmi2GetBoolean", "fmi2SetBoolean");

    /// `fmi2GetString`; as many values as references. The texts are copied, since the unit owns its own only until
    /// the next call.
    pub fn get_string(&mut self, references: &[u32], values: &mut [String]) -> Result<(), Error> {
        let Some(function) = self.functions.get_string else { return Err(self.missing("fmi2GetString")) };
        if references.len() != values.len() {
            return Err(self.lengths("fmi2GetString", references.len(), values.len()));
        }
        let mut pointers: Vec<*const c_char> = vec![ptr::null(); references.len()];
        // SAFETY: both slices have the length that is given.
        let status = unsafe {
            function(self.component(), references.as_ptr(), references.len(), pointers.as_mut_ptr())
        };
        self.checked("fmi2GetString", status)?;
        for (value, pointer) in values.iter_mut().zip(pointers) {
            *value = owned(pointer);
        }
        Ok(())
    }

    /// `fmi2SetString`; as many values as references. A zero byte inside a text is left out.
    pub fn set_string(&mut self, references: &[u32], values: &[String]) -> Result<(), Error> {
        let Some(function) = self.functions.set_string else { return Err(self.missing("fmi2SetString")) };
        if references.len() != values.len() {
            return Err(self.lengths("fmi2SetString", references.len(), values.len()));
        }
        let texts: Vec<CString> =
            values.iter().map(|text| CString::new(text.replace('\0', "")).unwrap_or_default()).collect();
        let pointers: Vec<*const c_char> = texts.iter().map(|text| text.as_ptr()).collect();
        // SAFETY: both slices have the length that is given; the texts live over the call.
        let status =
            unsafe { function(self.component(), references.as_ptr(), references.len(), pointers.as_ptr()) };
        self.checked("fmi2SetString", status)
    }

    /// `fmi2SetRealInputDerivatives`: derivatives of the given orders, for inputs that the unit interpolates.
    pub fn set_input_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &[f64],
    ) -> Result<(), Error> {
        const NAME: &str = "fmi2SetRealInputDerivatives";
        let Some(function) = self.functions.set_input_derivatives else { return Err(self.missing(NAME)) };
        for length in [orders.len(), values.len()] {
            if references.len() != length {
                return Err(self.lengths(NAME, references.len(), length));
            }
        }
        // SAFETY: all slices have the length that is given.
        let status = unsafe {
            function(
                self.component(),
                references.as_ptr(),
                references.len(),
                orders.as_ptr(),
                values.as_ptr(),
            )
        };
        self.checked(NAME, status)
    }

    /// `fmi2GetRealOutputDerivatives`: derivatives of the given orders at the current communication point.
    pub fn get_output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &mut [f64],
    ) -> Result<(), Error> {
        const NAME: &str = "fmi2GetRealOutputDerivatives";
        let Some(function) = self.functions.get_output_derivatives else { return Err(self.missing(NAME)) };
        for length in [orders.len(), values.len()] {
            if references.len() != length {
                return Err(self.lengths(NAME, references.len(), length));
            }
        }
        // SAFETY: all slices have the length that is given.
        let status = unsafe {
            function(
                self.component(),
                references.as_ptr(),
                references.len(),
                orders.as_ptr(),
                values.as_mut_ptr(),
            )
        };
        self.checked(NAME, status)
    }

    /// `fmi2GetDirectionalDerivative`: the change of `unknowns` for a change `seed` of `knowns`.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        result: &mut [f64],
    ) -> Result<(), Error> {
        const NAME: &str = "fmi2GetDirectionalDerivative";
        let Some(function) = self.functions.directional_derivative else { return Err(self.missing(NAME)) };
        if knowns.len() != seed.len() {
            return Err(self.lengths(NAME, knowns.len(), seed.len()));
        }
        if unknowns.len() != result.len() {
            return Err(self.lengths(NAME, unknowns.len(), result.len()));
        }
        // SAFETY: all slices have the lengths that are given.
        let status = unsafe {
            function(
                self.component(),
                unknowns.as_ptr(),
                unknowns.len(),
                knowns.as_ptr(),
                knowns.len(),
                seed.as_ptr(),
                result.as_mut_ptr(),
            )
        };
        self.checked(NAME, status)
    }

    #[cold]
    pub(super) fn missing(&self, function: &'static str) -> Error {
        Error::Missing { unit: self.name().into(), function }
    }

    #[cold]
    fn lengths(&self, function: &'static str, references: usize, values: usize) -> Error {
        Error::Lengths { unit: self.name().into(), function, references, values }
    }
}
