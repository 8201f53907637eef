//! `acroscope record`: finished runs become a measured data set, to rehearse a diagnosis.

use crate::cli::Record;
use crate::data_set::data_set;
use crate::error::Error;
use diagnosis::{Recording, recorded};

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
    recorded(&arguments.runs, &recording)?.write(&arguments.out, &earlier)?;
    if !quiet {
        tell!(
            "{}: {} runs; diagnose it with `acroscope diagnose`",
            arguments.out.display(),
            arguments.runs.len()
        );
    }
    Ok(())
}
