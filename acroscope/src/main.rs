//! The program: [`acroscope::command_line`] on what was typed.

use std::process::ExitCode;

/// Units that call the C library's `_exit` find this one first (`build.rs` exports it), so that an end of theirs is told.
#[cfg(target_os = "linux")]
#[allow(unsafe_code)] // a name of the C library
#[unsafe(no_mangle)]
extern "C" fn _exit(status: i32) -> ! {
    orchestrator::exit_at_once(status)
}

/// The same by its name in the C standard.
#[cfg(target_os = "linux")]
#[allow(unsafe_code)] // a name of the C library
#[unsafe(no_mangle)]
extern "C" fn _Exit(status: i32) -> ! {
    orchestrator::exit_at_once(status)
}

fn main() -> ExitCode {
    // First, since this process may be that of a unit.
    orchestrator::host_units(["(the process of a unit)"]);
    inspection::host_rules(["(the process of a check)"]);
    let guard = orchestrator::Guard::begin();
    ExitCode::from(guard.done(acroscope::command_line(std::env::args_os())))
}
