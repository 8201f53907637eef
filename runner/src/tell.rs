//! Lines for the person at the terminal. Whoever closed the other end of the pipe (`| head`) has read enough, and a log on a full disk
//! ends nothing.

use std::io::Write as _;

/// Writes a line; there is nobody to tell that it can't be written.
pub fn line(text: std::fmt::Arguments<'_>) {
    let _ = writeln!(std::io::stdout().lock(), "{text}");
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
