//! `acroscope-run`: the program `acroscope` without its other commands.

use clap::{Parser, Subcommand};
use runner::{Error, cli::Run, complain, signals};
use std::process::ExitCode;

/// Co-simulation bench for visual servoing, as far as a fresh machine builds it for its first run.
#[derive(Debug, Parser)]
#[command(name = "acroscope", version, propagate_version = true)]
struct Arguments {
    /// Print errors only.
    #[arg(long, short, global = true)]
    quiet: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a scenario: writes results.csv, resolved.toml and report.html.
    Run(Run),
}

orchestrator::own_exit!();

fn main() -> ExitCode {
    // First, since this process may be that of a unit.
    orchestrator::host_units(["(the process of a unit)"]);
    let guard = orchestrator::Guard::begin();
    ExitCode::from(guard.done(command_line()))
}

/// Does what was typed and answers the exit status.
fn command_line() -> u8 {
    let Arguments { quiet, command: Command::Run(run) } = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(told) => {
            let _ = told.print(); // nobody is there if that fails
            return u8::try_from(told.exit_code()).unwrap_or(2);
        }
    };
    signals::listen();
    runner::tell::apart();
    match asked(&run).and_then(|()| runner::run(&run, quiet, &|_| Ok(()))) {
        Ok(()) => runner::tell::status(),
        Err(error) => {
            signals::let_end_come();
            complain!("error: {error}");
            error.exit_status()
        }
    }
}

/// Refuses, before the run, what only the whole program writes after it.
fn asked(run: &Run) -> Result<(), Error> {
    let option = [("--mcap", run.mcap), ("--parquet", run.parquet)].into_iter().find(|(_, asked)| *asked);
    option.map_or(Ok(()), |(option, _)| {
        Err(Error::Words(format!("{option}: acroscope-run writes no such file; acroscope does")))
    })
}
