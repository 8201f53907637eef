//! The program: [`acroscope::command_line`] on what was typed.

use std::process::ExitCode;

orchestrator::own_exit!();

fn main() -> ExitCode {
    // First, since this process may be that of a unit.
    orchestrator::host_units(["(the process of a unit)"]);
    inspection::host_rules(["(the process of a check)"]);
    let guard = orchestrator::Guard::begin();
    ExitCode::from(guard.done(acroscope::command_line(std::env::args_os())))
}
