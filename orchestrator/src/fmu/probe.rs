//! Calls that no run makes: what a checker asks of a unit. All are legal but [`Fmu::with_guid`].

use super::archive;
use crate::error::Error;
use crate::fmu::{Fmu, Function, Instance};
use crate::guard;
use std::ffi::{CString, c_char};
use std::ptr;
use std::sync::Arc;

/// Folders under `binaries/` whose libraries run here, the best first.
pub fn platforms() -> &'static [&'static str] {
    archive::PLATFORMS
}

impl Fmu {
    /// The same unit, whose library is told another GUID than its own: one that looks refuses to be instantiated.
    #[must_use]
    pub fn with_guid(&self, guid: &str) -> Self {
        Self { guid: Some(Arc::from(guid)), ..self.clone() }
    }

    /// `fmi2FreeInstance` of no instance, which does nothing (FMI 2.0 section 2.1.5).
    ///
    /// # Errors
    /// If the library can't be loaded.
    pub fn free_nothing(&self) -> Result<(), Error> {
        let label = guard::label("none");
        let free = self.library(label)?.functions.free_instance;
        // SAFETY: the standard has a null pointer passed over.
        guard::around(label, Function::FreeInstance, || unsafe { free(ptr::null_mut()) });
        Ok(())
    }
}

impl Instance {
    /// `fmi2FreeFMUstate` of no state, which does nothing (FMI 2.0 section 2.1.8).
    pub fn free_no_state(&mut self) -> Result<(), Error> {
        const NAME: &str = "fmi2FreeFMUstate";
        let Some(function) = self.functions.free_state else { return Err(self.missing(NAME)) };
        let mut none = ptr::null_mut();
        // SAFETY: the standard has a null pointer passed over.
        let status = guard::around(self.label(), Function::FreeFMUstate, || unsafe {
            function(self.component(), &mut none)
        });
        self.checked(NAME, status)
    }

    /// `fmi2GetReal` and `fmi2SetReal` of no variables, with null pointers for the empty lists.
    pub fn access_nothing(&mut self) -> Result<(), Error> {
        let (get, set, component) = (self.functions.get_real, self.functions.set_real, self.component());
        // SAFETY: none of the pointers is read, since there is nothing behind them.
        let status = guard::around(self.label(), Function::GetReal, || unsafe {
            get(component, ptr::null(), 0, ptr::null_mut())
        });
        self.checked("fmi2GetReal", status)?;
        // SAFETY: as above.
        let status = guard::around(self.label(), Function::SetReal, || unsafe {
            set(component, ptr::null(), 0, ptr::null())
        });
        self.checked("fmi2SetReal", status)
    }

    /// `fmi2SetDebugLogging`: what the unit is to log.
    ///
    /// # Errors
    /// The unit hasn't got the function, or it failed.
    pub fn set_debug_logging(&mut self, on: bool, categories: &[String]) -> Result<(), Error> {
        const NAME: &str = "fmi2SetDebugLogging";
        let Some(function) = self.functions.set_debug_logging else { return Err(self.missing(NAME)) };
        let names: Vec<CString> =
            categories.iter().map(|name| CString::new(name.replace('\0', "")).unwrap_or_default()).collect();
        let pointers: Vec<*const c_char> = names.iter().map(|name| name.as_ptr()).collect();
        // SAFETY: the pointers are to terminated strings that live over the call.
        let status = guard::around(self.label(), Function::SetDebugLogging, || unsafe {
            function(self.component(), i32::from(on), pointers.len(), pointers.as_ptr())
        });
        self.checked(NAME, status)
    }
}
