//! Lines for the person at the terminal. Whoever closed the other end of the pipe (`| head`) has read enough. A log on a full disk
//! ends nothing, but in the end it is told.

use std::fs::File;
use std::io::Write as _;
use std::sync::{Mutex, OnceLock, PoisonError};

/// The standard output, once what units print goes elsewhere.
static OWN: OnceLock<File> = OnceLock::new();

/// From now on the standard output has only what is told here; what units print there goes to the standard error.
#[cfg(unix)]
pub fn apart() {
    if OWN.get().is_none()
        && let Some(own) = orchestrator::own_output()
    {
        let _ = OWN.set(own);
    }
}

/// Here nothing is kept apart.
#[cfg(not(unix))]
pub fn apart() {}

/// What the system says of a descriptor that is closed: `EBADF`, on Windows `ERROR_INVALID_HANDLE`.
const CLOSED: i32 = if cfg!(windows) { 6 } else { 9 };

/// Why a line could not be written, of the first one that could not.
static UNWRITTEN: Mutex<Option<String>> = Mutex::new(None);

/// Writes a line.
pub fn line(text: std::fmt::Arguments<'_>) {
    // In one piece.
    let text = format!("{text}\n");
    let written = match OWN.get() {
        Some(mut own) => own.write_all(text.as_bytes()),
        None => std::io::stdout().lock().write_all(text.as_bytes()),
    };
    // What a unit has closed, nobody reads either.
    if let Err(why) = written
        && why.kind() != std::io::ErrorKind::BrokenPipe
        && why.raw_os_error() != Some(CLOSED)
    {
        UNWRITTEN.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_with(|| why.to_string());
    }
}

/// The exit status of a command that has done its work: 1, and a word about it, where lines for the standard output are lost. The next
/// command of the same process begins anew.
pub fn status() -> u8 {
    let Some(why) = UNWRITTEN.lock().unwrap_or_else(PoisonError::into_inner).take() else { return 0 };
    error_line(format_args!("error: the standard output can't be written: {why}"));
    1
}

/// Writes a line to the standard error, likewise.
pub fn error_line(text: std::fmt::Arguments<'_>) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// As `println!`, without its panic at a closed pipe.
#[macro_export]
macro_rules! tell {
    ($($text:tt)*) => { $crate::tell::line(format_args!($($text)*)) };
}

/// As `eprintln!`, without its panic where the standard error can't be written.
#[macro_export]
macro_rules! complain {
    ($($text:tt)*) => { $crate::tell::error_line(format_args!($($text)*)) };
}
