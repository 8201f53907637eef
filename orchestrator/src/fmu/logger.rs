//! Collects what a unit logs. The C half (`logger.c`) formats; this half keeps the newest lines.

use crate::fmu::Status;
use std::collections::VecDeque;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::fmt;
use std::sync::Mutex;

/// How many lines are kept per instance; older ones are dropped so that a chatty unit doesn't fill the memory.
const KEPT: usize = 256;

/// One message of a unit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LogLine {
    /// Severity that the unit gave.
    pub status: Status,
    /// Category that the unit gave; empty if none.
    pub category: String,
    /// The message, formatted.
    pub text: String,
}

impl fmt::Display for LogLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.category.is_empty() {
            true => write!(f, "[{}] {}", self.status, self.text),
            false => write!(f, "[{}, {}] {}", self.status, self.category, self.text),
        }
    }
}

/// What `componentEnvironment` points to. The C half knows only the first field.
#[repr(C)]
pub(crate) struct Sink {
    line: extern "C" fn(*const Sink, c_int, *const c_char, *const c_char),
    lines: Mutex<VecDeque<LogLine>>,
}

impl Sink {
    pub(crate) fn new() -> Box<Self> {
        Box::new(Self { line: receive, lines: Mutex::new(VecDeque::new()) })
    }

    /// The lines that are kept, oldest first.
    pub(crate) fn lines(&self) -> Vec<LogLine> {
        self.lock().iter().cloned().collect()
    }

    /// Takes the lines away.
    pub(crate) fn take(&self) -> Vec<LogLine> {
        self.lock().drain(..).collect()
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, VecDeque<LogLine>> {
        self.lines.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

extern "C" fn receive(sink: *const Sink, status: c_int, category: *const c_char, text: *const c_char) {
    if sink.is_null() {
        return;
    }
    // SAFETY: the environment given to fmi2Instantiate is a boxed `Sink` that outlives the instance.
    let sink = unsafe { &*sink };
    let line = LogLine { status: Status::from(status), category: owned(category), text: owned(text) };
    let mut lines = sink.lock();
    if lines.len() == KEPT {
        lines.pop_front();
    }
    lines.push_back(line);
}

/// A C string as text; null gives an empty one, bytes that are no UTF-8 are replaced.
pub(crate) fn owned(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: not null, and the standard promises a terminated string.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

unsafe extern "C" {
    /// `fmi2CallbackLogger`, defined in `logger.c`.
    pub(crate) fn orchestrator_logger(
        environment: *mut c_void,
        instance: *const c_char,
        status: c_int,
        category: *const c_char,
        message: *const c_char,
        ...
    );
    /// `fmi2CallbackAllocateMemory`: the C library's.
    pub(crate) fn calloc(count: usize, size: usize) -> *mut c_void;
    /// `fmi2CallbackFreeMemory`: the C library's.
    pub(crate) fn free(memory: *mut c_void);
}
