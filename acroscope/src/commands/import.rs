//! `acroscope import`: a data set of a unit and measured logs.

use crate::cli::Import;
use crate::error::Error;

/// Writes the data set and says what was guessed.
pub fn import(arguments: &Import, quiet: bool) -> Result<(), Error> {
    let units = scenarios::unit_path();
    let imported = diagnosis::import(&arguments.logs, &arguments.fmu, &arguments.out, &units)?;
    if quiet {
        return Ok(());
    }
    for notice in &imported.notices {
        eprintln!("note: {notice}");
    }
    tell!("guesses, also in {}:", arguments.out.join("dataset.toml").display());
    for guess in &imported.guesses {
        tell!("  {guess}");
    }
    tell!("then: acroscope diagnose {}", arguments.out.display());
    Ok(())
}
