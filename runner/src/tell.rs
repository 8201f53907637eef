//! Lines for the person at the terminal. Whoever closed the other end of the pipe (`| head`) has read enough, and a log on a full disk
//! ends nothing.

use std::fs::File;
use std::io::Write as _;
use std::sync::OnceLock;

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

/// Writes a line; there is nobody to tell that it can't be written.
pub fn line(text: std::fmt::Arguments<'_>) {
    // In one piece.
    let text = format!("{text}\n");
    let _ = match OWN.get() {
        Some(mut own) => own.write_all(text.as_bytes()),
        None => std::io::stdout().lock().write_all(text.as_bytes()),
    };
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
