//! The workspace's own commands: `cargo xtask …` and `cargo acroscope …`.
//!
//! Knows the layout of the repository, no unit by name: a unit is a folder under `fmus/` with an `fmu/` shell.

mod archive;
mod cargo;
mod fuzz;
mod icon;
mod library;
mod merge;
mod pack;
mod platform;
mod shells;

use clap::{Parser, Subcommand};
use std::error::Error;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// What goes wrong here is told to a person and ends the command.
type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Commands of the workspace.
#[derive(Parser)]
#[command(name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Builds every unit and writes target/fmus/*.fmu, modelDescriptions/*.xml and NOTATION.md
    Pack {
        /// Writes nothing; fails if modelDescriptions/*.xml or NOTATION.md are stale
        #[arg(long)]
        check: bool,
    },
    /// Builds every unit twice, in two folders, and fails if the packed bytes differ (takes minutes)
    SameBytes,
    /// Puts a library that was built for another platform into a packed unit
    Merge {
        /// The packed unit
        fmu: PathBuf,
        /// FMI's name of the platform
        #[arg(long)]
        platform: platform::Platform,
        /// The library
        library: PathBuf,
    },
    /// Calls packed units in random order, legal and not; a crash, a panic or a NaN is a failure
    Fuzz(fuzz::Options),
    /// Packs what is stale, builds the command line and runs it
    #[command(disable_help_flag = true)]
    Acroscope {
        /// Handed on
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<OsString>,
    },
}

fn main() -> ExitCode {
    let outcome = match Arguments::parse().command {
        Command::Pack { check: true } => pack::check(root()),
        Command::Pack { check: false } => pack::pack(root(), pack::Extent::All).map(|packed| {
            for fmu in packed {
                println!("{}", fmu.display());
            }
        }),
        Command::SameBytes => pack::same_bytes(root()),
        Command::Merge { fmu, platform, library } => merge::merge(&fmu, platform, &library),
        Command::Fuzz(options) => fuzz::fuzz(&options),
        Command::Acroscope { arguments } => return acroscope(&arguments),
    };
    exit_code(outcome.map(|()| ExitCode::SUCCESS))
}

fn acroscope(arguments: &[OsString]) -> ExitCode {
    let run = || {
        pack::pack(root(), pack::Extent::Stale)?;
        let program = cargo::build_program(root(), "acroscope")?;
        cargo::become_program(&program, arguments)
    };
    exit_code(run())
}

fn exit_code(outcome: Result<ExitCode>) -> ExitCode {
    outcome.unwrap_or_else(|error| {
        eprintln!("error: {error}");
        ExitCode::FAILURE
    })
}

/// The repository: this crate lies one level below it, wherever it was built.
fn root() -> &'static Path {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here)
}

/// Says which file an input or output error concerns.
fn at<T>(path: &Path, outcome: std::io::Result<T>) -> Result<T> {
    outcome.map_err(|error| format!("{}: {error}", path.display()).into())
}
