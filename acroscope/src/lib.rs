//! The command line: parses, calls, prints. No physics, no algorithm.
//!
//! A library, so that Python's console script is the same program as `acroscope`.
//!
//! Exit status: 0 done; 2 the user's input is wrong; 130, 143, 129, 152 after SIGINT, SIGTERM, SIGHUP, SIGXCPU; 1 anything else.

#![forbid(unsafe_code)]

#[macro_use]
extern crate runner;

mod cli;
mod commands;
mod data_set;
mod error;
mod formats;
mod serve;

pub use error::Error;
/// For hosts of the command line: where the rules of `acroscope check` run units.
pub use inspection::host_rules_by;

use clap::Parser as _;
use orchestrator::{Progress, Recorder};
use std::ffi::OsString;
use std::path::PathBuf;

/// Does what was typed and answers the exit status. The first argument is the program's name.
pub fn command_line(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments = match cli::Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(told) => {
            // Help and versions go to standard output, mistakes to standard error; nobody is there if that fails.
            let _ = told.print();
            return u8::try_from(told.exit_code()).unwrap_or(2);
        }
    };
    runner::signals::listen();
    runner::tell::apart();
    match commands::dispatch(&arguments) {
        Ok(()) => runner::tell::status(),
        Err(error) => {
            runner::signals::let_end_come();
            complain!("error: {error}");
            error.exit_status()
        }
    }
}

/// Does `acroscope --quiet run …` for a host with a recorder and a way to interrupt of its own: `words` are what would be typed
/// after `run`. Answers the folder of the results, in which `summary.json` says how the run ended.
///
/// # Errors
/// As the command, also if the run ended with an error; what it left until then lies in its folder.
pub fn run(
    words: impl IntoIterator<Item = OsString>,
    recorder: &mut dyn Recorder,
    progress: &mut dyn Progress,
) -> Result<PathBuf, Error> {
    let words = ["acroscope".into(), "--quiet".into(), "run".into()].into_iter().chain(words);
    let arguments = cli::Arguments::try_parse_from(words).map_err(|told| Error::words(told.to_string()))?;
    match &arguments.command {
        cli::Command::Run(run) => {
            let carried_out = runner::carry_out(run, true, &formats::write, recorder, progress)?;
            Ok(carried_out.ended.map(|_| carried_out.folder)?)
        }
        _ => Err(Error::words("not the command `run`")),
    }
}
