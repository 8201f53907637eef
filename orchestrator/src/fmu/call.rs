//! Reading and writing variables of an instance, many at a time. Lengths are checked before anything is called.

use crate::error::Error;
use crate::fmu::library::Functions;
use crate::fmu::{Function, Instance};
use crate::guard;
use crate::text::Text;
use crate::value::{Kind, Value};
use std::ffi::c_char;
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
    ($get:ident, $set:ident, $type:ty, $need:ident, $get_name:literal, $set_name:literal, $get_function:ident,
     $set_function:ident, $read:ident, $write:ident, $kind:ident) => {
        #[doc = concat!("`", $get_name, "`; as many values as references.")]
        ///
        /// # Errors
        /// Lengths differ, or the unit failed.
        pub fn $get(&mut self, references: &[u32], values: &mut [$type]) -> Result<(), Error> {
            self.entered(|instance| instance.$read(references, values))
        }

        #[doc = concat!("`", $set_name, "`; as many values as references.")]
        ///
        /// # Errors
        /// Lengths differ, or the unit failed.
        pub fn $set(&mut self, references: &[u32], values: &[$type]) -> Result<(), Error> {
            self.entered(|instance| instance.$write(references, values))
        }

        #[doc = concat!("As [`Instance::", stringify!($get), "`] of a unit that was entered.")]
        #[inline]
        pub(crate) fn $read(&mut self, references: &[u32], values: &mut [$type]) -> Result<(), Error> {
            guard::calls(Function::$get_function);
            let functions: &Functions = &self.functions;
            let function = function!(functions, $need, $get, self, $get_name);
            if references.len() != values.len() {
                return Err(self.lengths($get_name, references.len(), values.len()));
            }
            // SAFETY: both slices have the length that is given.
            let status = unsafe {
                function(self.component(), references.as_ptr(), references.len(), values.as_mut_ptr())
            };
            self.checked_of($get_name, status, Kind::$kind, references)
        }

        #[doc = concat!("As [`Instance::", stringify!($set), "`] of a unit that was entered.")]
        #[inline]
        pub(crate) fn $write(&mut self, references: &[u32], values: &[$type]) -> Result<(), Error> {
            guard::calls(Function::$set_function);
            let functions: &Functions = &self.functions;
            let function = function!(functions, $need, $set, self, $set_name);
            if references.len() != values.len() {
                return Err(self.lengths($set_name, references.len(), values.len()));
            }
            // SAFETY: both slices have the length that is given.
            let status =
                unsafe { function(self.component(), references.as_ptr(), references.len(), values.as_ptr()) };
            self.checked_of($set_name, status, Kind::$kind, references)
        }
    };
}

/// Pointers of fewer texts than this need no memory of their own for a call.
const FEW: usize = 8;

impl Instance {
    access!(
        get_real,
        set_real,
        f64,
        needed,
        "fmi2GetReal",
        "fmi2SetReal",
        GetReal,
        SetReal,
        read_real,
        write_real,
        Real
    );
    access!(
        get_integer,
        set_integer,
        i32,
        optional,
        "fmi2GetInteger",
        "fmi2SetInteger",
        GetInteger,
        SetInteger,
        read_integer,
        write_integer,
        Integer
    );
    access!(
        get_boolean,
        set_boolean,
        i32,
        optional,
        "fmi2GetBoolean",
        "fmi2SetBoolean",
        GetBoolean,
        SetBoolean,
        read_boolean,
        write_boolean,
        Boolean
    );

    /// `fmi2GetString`; as many values as references. The texts are copied, since the unit owns its own only until
    /// the next call.
    ///
    /// # Errors
    /// Lengths differ, or the unit failed.
    pub fn get_string(&mut self, references: &[u32], values: &mut [String]) -> Result<(), Error> {
        let mut texts = vec![Text::default(); values.len()];
        self.entered(|instance| instance.get_texts(references, &mut texts))?;
        values.iter_mut().zip(&texts).for_each(|(value, text)| text.as_str().clone_into(value));
        Ok(())
    }

    /// `fmi2SetString`; as many values as references. A zero byte inside a text is left out.
    ///
    /// # Errors
    /// Lengths differ, or the unit failed.
    pub fn set_string(&mut self, references: &[u32], values: &[String]) -> Result<(), Error> {
        let texts: Vec<Text> = values.iter().map(|text| Text::from(text.as_str())).collect();
        self.entered(|instance| instance.set_texts(references, &texts))
    }

    /// As [`Instance::get_string`], without making anything new where a text is as it was.
    #[inline(always)]
    pub(crate) fn get_texts(&mut self, references: &[u32], values: &mut [Text]) -> Result<(), Error> {
        match references.len() {
            1 => self.get_by(references, values, &mut [ptr::null()]),
            _ => self.get_several(references, values),
        }
    }

    #[inline(never)]
    fn get_several(&mut self, references: &[u32], values: &mut [Text]) -> Result<(), Error> {
        match references.len() {
            few @ ..FEW => self.get_by(references, values, &mut [ptr::null(); FEW][..few]),
            many => self.get_by(references, values, &mut vec![ptr::null(); many]),
        }
    }

    #[inline(always)]
    fn get_by(
        &mut self,
        references: &[u32],
        values: &mut [Text],
        pointers: &mut [*const c_char],
    ) -> Result<(), Error> {
        let Some(function) = self.functions.get_string else { return Err(self.missing("fmi2GetString")) };
        if references.len() != values.len() {
            return Err(self.lengths("fmi2GetString", references.len(), values.len()));
        }
        guard::calls(Function::GetString);
        // SAFETY: both slices have the length that is given.
        let status = unsafe {
            function(self.component(), references.as_ptr(), references.len(), pointers.as_mut_ptr())
        };
        self.checked_of("fmi2GetString", status, Kind::String, references)?;
        for (value, pointer) in values.iter_mut().zip(pointers) {
            // SAFETY: the unit's texts end in zero and are valid until it is called again.
            unsafe { value.read(*pointer) };
        }
        Ok(())
    }

    /// As [`Instance::set_string`], without making anything new.
    #[inline(always)]
    pub(crate) fn set_texts(&mut self, references: &[u32], values: &[Text]) -> Result<(), Error> {
        match references.len() {
            1 => self.set_by(references, values, &mut [ptr::null()]),
            _ => self.set_several(references, values),
        }
    }

    #[inline(never)]
    fn set_several(&mut self, references: &[u32], values: &[Text]) -> Result<(), Error> {
        match references.len() {
            few @ ..FEW => self.set_by(references, values, &mut [ptr::null(); FEW][..few]),
            many => self.set_by(references, values, &mut vec![ptr::null(); many]),
        }
    }

    #[inline(always)]
    fn set_by(
        &mut self,
        references: &[u32],
        values: &[Text],
        pointers: &mut [*const c_char],
    ) -> Result<(), Error> {
        let Some(function) = self.functions.set_string else { return Err(self.missing("fmi2SetString")) };
        if references.len() != values.len() {
            return Err(self.lengths("fmi2SetString", references.len(), values.len()));
        }
        for (pointer, value) in pointers.iter_mut().zip(values) {
            *pointer = value.as_ptr();
        }
        guard::calls(Function::SetString);
        // SAFETY: both slices have the length that is given; the texts end in zero and live over the call.
        let status =
            unsafe { function(self.component(), references.as_ptr(), references.len(), pointers.as_ptr()) };
        self.checked_of("fmi2SetString", status, Kind::String, references)
    }

    /// `fmi2SetRealInputDerivatives`: derivatives of the given orders, for inputs that the unit interpolates.
    /// `orders` and `values` are as long as `references`.
    ///
    /// # Errors
    /// The unit hasn't got the function, lengths differ, or it failed.
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
        let status = guard::around(self.label(), Function::SetRealInputDerivatives, || unsafe {
            function(
                self.component(),
                references.as_ptr(),
                references.len(),
                orders.as_ptr(),
                values.as_ptr(),
            )
        });
        self.checked(NAME, status)
    }

    /// `fmi2GetRealOutputDerivatives`: derivatives of the given orders at the current communication point.
    /// `orders` and `values` are as long as `references`.
    ///
    /// # Errors
    /// The unit hasn't got the function, lengths differ, or it failed.
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
        let status = guard::around(self.label(), Function::GetRealOutputDerivatives, || unsafe {
            function(
                self.component(),
                references.as_ptr(),
                references.len(),
                orders.as_ptr(),
                values.as_mut_ptr(),
            )
        });
        self.checked(NAME, status)
    }

    /// `fmi2GetDirectionalDerivative`: the change of `unknowns` for a change `seed` of `knowns`.
    /// `seed` is as long as `knowns`, `result` as `unknowns`.
    ///
    /// # Errors
    /// The unit hasn't got the function, lengths differ, or it failed.
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
        let status = guard::around(self.label(), Function::GetDirectionalDerivative, || unsafe {
            function(
                self.component(),
                unknowns.as_ptr(),
                unknowns.len(),
                knowns.as_ptr(),
                knowns.len(),
                seed.as_ptr(),
                result.as_mut_ptr(),
            )
        });
        self.checked(NAME, status)
    }

    /// Reads one variable.
    ///
    /// # Errors
    /// The unit failed.
    pub fn get(&mut self, kind: Kind, reference: u32) -> Result<Value, Error> {
        Ok(match kind {
            Kind::Real => {
                let mut value = [0.0];
                self.get_real(&[reference], &mut value)?;
                Value::Real(value[0])
            }
            Kind::Integer => {
                let mut value = [0];
                self.get_integer(&[reference], &mut value)?;
                Value::Integer(value[0])
            }
            Kind::Boolean => {
                let mut value = [0];
                self.get_boolean(&[reference], &mut value)?;
                Value::Boolean(value[0] != 0)
            }
            Kind::String => {
                let mut value = [String::new()];
                self.get_string(&[reference], &mut value)?;
                let [text] = value;
                Value::String(text)
            }
        })
    }

    /// Writes one variable.
    ///
    /// # Errors
    /// The unit failed.
    pub fn set(&mut self, reference: u32, value: &Value) -> Result<(), Error> {
        match value {
            Value::Real(value) => self.set_real(&[reference], &[*value]),
            Value::Integer(value) => self.set_integer(&[reference], &[*value]),
            Value::Boolean(value) => self.set_boolean(&[reference], &[i32::from(*value)]),
            Value::String(value) => self.set_string(&[reference], std::slice::from_ref(value)),
        }
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
