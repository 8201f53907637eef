//! The command line: parses, calls, prints. No physics, no algorithm.
//!
//! Exit status: 0 done; 2 the user's input is wrong; 1 anything else.

#[macro_use]
mod tell;

mod bar;
mod cli;
mod commands;
mod error;
mod run_report;

use clap::Parser as _;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = cli::Arguments::parse();
    match commands::dispatch(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_status())
        }
    }
}
