//! Log messages on their way to the master: categories, the escaping that the standard asks for, the callback.

use crate::abi::types::{LoggerCallback, OK, Status};
use crate::error::Error;
use crate::model::{Log, LogCategory};
use std::ffi::{CStr, CString, c_void};

/// Everything, whatever its category.
pub const ALL: LogCategory = LogCategory { name: "logAll", description: "All messages." };
/// Why a call answered `fmi2Error`.
pub const STATUS_ERROR: LogCategory =
    LogCategory { name: "logStatusError", description: "Why a call answered fmi2Error." };
/// What is not quite right although the call answered `fmi2OK`.
pub const STATUS_WARNING: LogCategory =
    LogCategory { name: "logStatusWarning", description: "What is not quite right, though the run goes on." };
/// Why a status could not be given.
pub const STATUS_DISCARD: LogCategory =
    LogCategory { name: "logStatusDiscard", description: "Why a call answered fmi2Discard." };
/// What happened inside the unit.
pub const EVENTS: LogCategory =
    LogCategory { name: "logEvents", description: "What happens inside the unit." };

/// The categories of a unit: the standard's, then its own.
pub fn categories(own: &[LogCategory]) -> Vec<LogCategory> {
    let mut all = vec![ALL, STATUS_ERROR, STATUS_DISCARD, STATUS_WARNING, EVENTS];
    for category in own {
        if !all.iter().any(|known| known.name == category.name) {
            all.push(*category);
        }
    }
    all
}

/// The log of one instance. Nothing goes out unless the master asked for it: some masters hand over a callback
/// that can't be called while logging is off.
pub struct Logger {
    callback: Option<LoggerCallback>,
    environment: *mut c_void,
    instance: CString,
    categories: Vec<(LogCategory, bool)>,
}

impl Logger {
    /// `instance` is the name that the master gave.
    pub fn new(
        callback: Option<LoggerCallback>,
        environment: *mut c_void,
        instance: &CStr,
        own: &[LogCategory],
        logging_on: bool,
    ) -> Self {
        let categories = categories(own).into_iter().map(|category| (category, logging_on)).collect();
        Self { callback, environment, instance: instance.to_owned(), categories }
    }

    /// `fmi2SetDebugLogging`. An empty list means every category. Switching some on switches the others off,
    /// switching some off leaves the others alone.
    pub fn select(&mut self, on: bool, names: &[&str]) -> Result<(), Error> {
        for name in names {
            if !self.categories.iter().any(|(category, _)| category.name == *name) {
                return Err(Error::Category((*name).to_owned()));
            }
        }
        for (category, enabled) in &mut self.categories {
            let named = names.is_empty() || names.contains(&category.name);
            *enabled = if on { named } else { *enabled && !named };
        }
        Ok(())
    }

    fn wants(&self, category: &str) -> bool {
        self.callback.is_some()
            && self.categories.iter().any(|(one, on)| *on && (one.name == ALL.name || one.name == category))
    }

    /// Sends a message if its category is wanted.
    pub fn send(&self, status: Status, category: &str, message: &dyn Fn() -> String) {
        let Some(callback) = self.callback else { return };
        if !self.wants(category) {
            return;
        }
        let (Some(category), Some(message)) = (c_string(category), c_string(&escape(&message()))) else {
            return;
        };
        // SAFETY: the master promises a callback of this type for the life of the instance; all strings are
        // terminated and live until it returns.
        unsafe {
            callback(self.environment, self.instance.as_ptr(), status, category.as_ptr(), message.as_ptr());
        }
    }
}

impl Log for Logger {
    fn log(&mut self, category: &'static str, message: &dyn Fn() -> String) {
        self.send(OK, category, message);
    }
}

/// The callback reads the text as a `printf` format, in which `%` is special, and `#` marks references to
/// variables (FMI 2.0 section 2.1.5). Zero bytes would end it.
fn escape(message: &str) -> String {
    message.replace('%', "%%").replace('#', "##").replace('\0', "")
}

fn c_string(text: &str) -> Option<CString> {
    CString::new(text).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_special_character_is_escaped() {
        assert_eq!(escape("50 % of #1\0"), "50 %% of ##1");
    }

    #[test]
    fn every_category_filter_does_what_it_says() {
        let own = [LogCategory { name: "logVision", description: "" }];
        unsafe extern "C" fn nowhere(
            _: *mut c_void,
            _: *const std::ffi::c_char,
            _: Status,
            _: *const std::ffi::c_char,
            _: *const std::ffi::c_char,
        ) {
        }
        // SAFETY: never called; only its presence counts here.
        let callback: LoggerCallback = unsafe { std::mem::transmute(nowhere as *const ()) };
        let mut log = Logger::new(Some(callback), std::ptr::null_mut(), c"i", &own, false);
        assert!(!log.wants("logVision"));
        log.select(true, &["logVision"]).unwrap();
        assert!(log.wants("logVision") && !log.wants("logStatusError"));
        assert_eq!(log.select(true, &["logNone"]), Err(Error::Category("logNone".to_owned())));
        assert!(log.wants("logVision"), "a refused call changes nothing");
        log.select(true, &[]).unwrap();
        log.select(false, &["logVision", "logAll"]).unwrap();
        assert!(!log.wants("logVision") && log.wants("logStatusError"));
        log.select(false, &[]).unwrap();
        assert!(!log.wants("logStatusError"));
    }
}
