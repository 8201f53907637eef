//! `acroscope ssp`: a scenario with its units as a package for other tools.

use crate::cli::Packing;
use crate::error::Error;
use orchestrator::Simulation;
use runner::folder::keep;
use runner::request::sets;
use std::path::{Path, PathBuf};

/// Writes the package.
pub fn ssp(arguments: &Packing, quiet: bool) -> Result<(), Error> {
    let output = &arguments.output;
    named(output, "ssp")?;
    let mut scenario = scenarios::load(&arguments.scenario)?;
    for (name, value) in sets(&arguments.set)? {
        scenario.set(&name, &value)?;
    }
    // Built, so that what is packed is known to run.
    let mut simulation = Simulation::new(&scenario, &scenarios::unit_path())?;
    keep_inputs(output, &arguments.scenario, &simulation)?;
    if arguments.delay_units {
        let (with_units, notes) = ssp::with_delay_units(&simulation);
        notes.iter().filter(|_| !quiet).for_each(|note| complain!("note: {note}"));
        simulation = Simulation::new(&with_units, &scenarios::unit_path())?;
        scenario = with_units;
    }
    write(output, &ssp::write(&simulation)?)?;
    if !quiet {
        simulation.notices().iter().for_each(|notice| complain!("note: {notice}"));
        tell!(
            "{}: {} units, {} connections",
            output.display(),
            scenario.units.len(),
            scenario.connections.len()
        );
    }
    Ok(())
}

/// Refuses a file that what is packed is made of.
pub fn keep_inputs(output: &Path, scenario: &str, simulation: &Simulation) -> Result<(), Error> {
    let mut read: Vec<PathBuf> = simulation.bundle().files.into_iter().map(|(_, path)| path).collect();
    read.push(scenario.into());
    Ok(keep(&[output.to_owned()], &read)?)
}

/// Refuses a file's name without the ending that others know such files by.
pub fn named(path: &Path, ending: &str) -> Result<(), Error> {
    match path.extension().is_some_and(|given| given == ending) {
        true => Ok(()),
        false => {
            let why = format!("wanted is a name that ends in .{ending}, by which such files are known");
            Err(runner::Error::File { path: path.to_owned(), why }.into())
        }
    }
}

/// Writes a file whole or not at all.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.new", std::process::id()));
    let new = path.with_file_name(name);
    let written = std::fs::write(&new, bytes).and_then(|()| std::fs::rename(&new, path));
    if written.is_err() {
        let _ = std::fs::remove_file(&new); // half of it, or nothing
    }
    written.map_err(Error::file(path))
}
