//! `acroscope record`: finished runs become a measured data set, to rehearse a diagnosis.

use crate::cli::Record;
use crate::error::Error;
use crate::folder::data_set;
use diagnosis::{Recording, record as write};

/// Writes the data set.
pub fn record(arguments: &Record, quiet: bool) -> Result<(), Error> {
    let recording = Recording {
        scenario: arguments.scenario.clone(),
        encoder_noise: arguments.encoder_noise,
        encoder_rate: arguments.encoder_rate,
        torque_noise: arguments.torque_noise,
        seed: arguments.seed,
    };
    let earlier = data_set(&arguments.out, arguments.force)?;
    // what a run lacks now must not be left of an earlier one
    earlier.iter().try_for_each(|path| std::fs::remove_file(path).map_err(Error::file(path)))?;
    std::fs::create_dir_all(&arguments.out).map_err(Error::file(&arguments.out))?;
    write(&arguments.runs, &arguments.out, &recording)?;
    if !quiet {
        tell!(
            "{}: {} runs; diagnose it with `acroscope diagnose`",
            arguments.out.display(),
            arguments.runs.len()
        );
    }
    Ok(())
}
