//! `cargo fmi2`: builds a crate that exports a unit, and packs it or prints what it says of itself.

use cargo_fmi2::project::Project;
use cargo_fmi2::{Result, archive, library, package};
use clap::{Parser, Subcommand};
use std::path::PathBuf;
use std::process::ExitCode;

/// FMI 2.0 co-simulation units from Rust
#[derive(Parser)]
#[command(name = "cargo fmi2", bin_name = "cargo fmi2", version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Builds the crate and writes MODELIDENTIFIER.fmu
    Pack {
        #[command(flatten)]
        project: Project,
        /// Folder for the .fmu (default: fmus in cargo's target folder)
        #[arg(long, short, value_name = "FOLDER")]
        out: Option<PathBuf>,
    },
    /// Builds the crate and prints its modelDescription.xml, or another text of it
    Describe {
        #[command(flatten)]
        project: Project,
        /// Which text
        #[arg(long, value_enum, default_value_t = Text::Xml)]
        text: Text,
    },
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Text {
    /// modelDescription.xml
    Xml,
    /// The page in documentation/
    Html,
    /// All variables in a table, in Markdown
    Notation,
}

fn main() -> ExitCode {
    // Cargo hands its subcommand on: `cargo fmi2 pack` is `cargo-fmi2 fmi2 pack`.
    let by_cargo = std::env::args_os().nth(1).is_some_and(|first| first == "fmi2");
    let given = std::env::args_os().enumerate().filter(|(at, _)| !(by_cargo && *at == 1)).map(|(_, one)| one);
    match run(Arguments::parse_from(given).command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(command: Command) -> Result<()> {
    match command {
        Command::Pack { project, out } => {
            let library = project.build()?;
            let unit = library::describe(&library)?;
            let folder = out.map_or_else(|| project.target().map(|target| target.join("fmus")), Ok)?;
            let path = folder.join(format!("{}.fmu", unit.identifier));
            let entries = package::content(&library, &unit, &project.licences()?, &project.folder())?;
            archive::write_if_changed(&path, &archive::to_bytes(&entries)?)?;
            println!("{}", path.display());
        }
        Command::Describe { project, text } => {
            let unit = library::describe(&project.build()?)?;
            print!(
                "{}",
                match text {
                    Text::Xml => unit.xml,
                    Text::Html => unit.html,
                    Text::Notation => unit.notation,
                }
            );
        }
    }
    Ok(())
}
