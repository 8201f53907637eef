//! The workspace's own commands: `cargo xtask …` and `cargo acroscope …`.
//!
//! Knows the layout of the repository, no unit by name: a unit is a folder under `fmus/` with an `fmu/` shell.

mod cargo;
mod fuzz;
mod merge;
mod pack;
mod portable;
mod program;
mod shells;

use cargo_fmi2::{Result, archive, at, library, package, platform};
use clap::{Parser, Subcommand};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::LazyLock;

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
        /// Also packs binaries for these platforms: linux64, win64, darwin64, aarch64-linux with commas between, or
        /// all. Linux gets binaries for old machines, too (GLIBC 2.17). Needs python/requirements.txt; takes minutes
        #[arg(long, default_value = "", hide_default_value = true, conflicts_with = "check")]
        platforms: platform::Platforms,
    },
    /// Builds every unit twice, in two folders, and fails if the packed bytes differ (takes minutes)
    SameBytes {
        /// With binaries for these platforms, as for `pack`
        #[arg(long, default_value = "", hide_default_value = true)]
        platforms: platform::Platforms,
    },
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
        Command::Pack { check: true, .. } => pack::check(root()),
        Command::Pack { check: false, platforms } => packed(&platforms.0).map(|packed| {
            for fmu in packed {
                println!("{}", fmu.display());
            }
        }),
        Command::SameBytes { platforms } => pack::same_bytes(root(), &platforms.0),
        Command::Merge { fmu, platform, library } => merge::merge(&fmu, platform, &library),
        Command::Fuzz(options) => fuzz::fuzz(&options),
        Command::Acroscope { arguments } => return acroscope(&arguments),
    };
    exit_code(outcome.map(|()| ExitCode::SUCCESS))
}

fn packed(platforms: &[platform::Platform]) -> Result<Vec<PathBuf>> {
    let fmus = pack::pack(root())?;
    if !platforms.is_empty() {
        portable::add(root(), &fmus, platforms)?;
    }
    Ok(fmus)
}

fn acroscope(arguments: &[OsString]) -> ExitCode {
    let run = || {
        // the master as a unit, built for that, costs a fresh machine a minute: only for who asks for it
        let mut shells = shells::folders(root())?;
        shells.retain(|shell| {
            *shell != shells::blank(root()) || arguments.iter().any(|word| word == "container")
        });
        // Side by side: each unit is optimised whole, by one core.
        let (units, program) = std::thread::scope(|scope| {
            let units = scope.spawn(|| pack::pack_stale(root(), &shells).map_err(|why| why.to_string()));
            let program = program::build(root(), arguments);
            (units.join().unwrap_or_else(|_| Err("packing the units failed".to_owned())), program)
        });
        units?;
        cargo::become_program(&program?, arguments)
    };
    exit_code(run())
}

fn exit_code(outcome: Result<ExitCode>) -> ExitCode {
    outcome.unwrap_or_else(|error| {
        eprintln!("error: {error}");
        ExitCode::FAILURE
    })
}

/// The repository: this crate lies one level below it. `cargo run` says where, so that a program which came along with a
/// copied `target/` works on its own clone, not on the one that it was built in.
fn root() -> &'static Path {
    static ROOT: LazyLock<PathBuf> = LazyLock::new(|| {
        let here =
            std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| env!("CARGO_MANIFEST_DIR").into());
        Path::new(&here).parent().map_or_else(|| PathBuf::from(&here), Path::to_path_buf)
    });
    &ROOT
}
