//! The errors of calls that failed: what the unit said, and which variables a call was about.

use crate::error::Error;
#[cfg(isolation)]
use crate::fmu::LogLine;
use crate::fmu::{Instance, Status};
use crate::value::Kind;
use crate::words::few;
use std::ffi::c_int;

impl Instance {
    /// The error for a call that failed.
    #[cold]
    pub(crate) fn failure(&mut self, function: &'static str, status: Status, time: Option<f64>) -> Error {
        #[cfg(isolation)]
        let (function, status) = match self.remote() {
            Some(remote) => {
                let ahead =
                    remote.take_failed().map(|(function, status)| (function.name(), Status::from(status)));
                let (function, status) = ahead.unwrap_or((function, status));
                if let Some(death) = remote.death().cloned() {
                    return death.error(self.name(), function, time, self.sink.lines());
                }
                if let Some(text) = remote.short_of_memory() {
                    let (status, category) = (Status::Warning, "memory_limit".into());
                    self.sink.push(LogLine { status, category, text });
                }
                (function, status)
            }
            None => (function, status),
        };
        Error::Call { unit: self.name().into(), function, status, time, log: self.sink.lines() }
    }

    /// As [`Instance::checked`] of a call that was about variables.
    #[inline]
    pub(super) fn checked_of(
        &mut self,
        function: &'static str,
        status: c_int,
        kind: Kind,
        references: &[u32],
    ) -> Result<(), Error> {
        if status == 0 { Ok(()) } else { self.not_ok_of(function, status, kind, references) }
    }

    #[cold]
    fn not_ok_of(
        &mut self,
        function: &'static str,
        status: c_int,
        kind: Kind,
        references: &[u32],
    ) -> Result<(), Error> {
        match self.checked(function, status) {
            // Another call may have failed before it, which this one brought to light.
            Err(error @ Error::Call { function: failed, .. }) if failed == function => {
                Err(self.about(error, kind, references))
            }
            other => other,
        }
    }

    /// The error of a call, with the names of the variables that it was about.
    #[cold]
    pub(crate) fn about(&self, error: Error, kind: Kind, references: &[u32]) -> Error {
        let variables = &self.fmu().description().variables;
        let name = |reference: &u32| {
            let named = variables.iter().find(|v| v.kind == kind && v.reference == *reference);
            named.map_or_else(|| format!("reference {reference}"), |v| v.name.clone())
        };
        match error {
            Error::Call { unit, function, status, time, log } if !references.is_empty() => {
                let variables = few(references, name);
                Error::Access { unit, function, variables, status, time, log }
            }
            other => other,
        }
    }
}
