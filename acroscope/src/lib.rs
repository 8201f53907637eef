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

/// Does what was typed and answers the exit status. The first argument is the program's name.
pub fn command_line(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments = match cli::Arguments::try_parse_from(help_of_help(arguments.into_iter().collect())) {
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

/// What was typed, with `help --help` as `help`: clap takes anything after `help` for the name of a command.
fn help_of_help(mut words: Vec<OsString>) -> Vec<OsString> {
    if words.get(1).is_some_and(|word| word == "help") {
        words.retain(|word| word != "--help" && word != "-h");
    }
    words
}

/// Does `acroscope --quiet run …` for a host with a recorder and a way to interrupt of its own: `words` are what would be typed
/// after `run`. Answers the graphs of the page as JSON; in the folder of the results `summary.json` says how the run ended.
///
/// # Errors
/// As the command, also if the run ended with an error; what it left until then lies in its folder.
pub fn run(
    words: impl IntoIterator<Item = OsString>,
    recorder: &mut dyn Recorder,
    progress: &mut dyn Progress,
) -> Result<String, Error> {
    let words = ["acroscope".into(), "--quiet".into(), "run".into()].into_iter().chain(words);
    let arguments = cli::Arguments::try_parse_from(words).map_err(|told| Error::words(told.to_string()))?;
    match &arguments.command {
        cli::Command::Run(run) => {
            let carried_out = runner::carry_out(run, true, &formats::write, recorder, progress)?;
            Ok(carried_out.ended.map(|_| carried_out.layout.graphs_as_json())?)
        }
        _ => Err(Error::words("not the command `run`")),
    }
}
