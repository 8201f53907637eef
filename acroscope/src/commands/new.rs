//! `acroscope new`: a scenario that runs, from the descriptions of units.

use crate::cli::New;
use crate::error::Error;
use std::io::{ErrorKind, Write as _};
use std::path::Path;

/// Writes the scenario, or prints it.
pub fn new(arguments: &New, quiet: bool) -> Result<(), Error> {
    let Some(path) = &arguments.output else {
        let text = inspection::draft::draft(&arguments.files, Path::new("scenario.toml"))?;
        tell!("{}", text.trim_end());
        return Ok(());
    };
    // Said before the work; the file itself is made so that none is lost.
    if path.exists() && !arguments.force {
        return Err(Error::There { path: path.clone() });
    }
    let text = inspection::draft::draft(&arguments.files, path)?;
    let mut options = std::fs::OpenOptions::new();
    match arguments.force {
        true => options.write(true).create(true).truncate(true),
        false => options.write(true).create_new(true),
    };
    let mut file = options.open(path).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => Error::There { path: path.clone() },
        _ => Error::file(path)(error),
    })?;
    file.write_all(text.as_bytes()).map_err(Error::file(path))?;
    if !quiet {
        let guesses = match text.matches("guess: ").count() {
            0 => "nothing in it is guessed".to_owned(),
            1 => "one guess, with a comment".to_owned(),
            more => format!("{more} guesses, each with a comment"),
        };
        tell!("{}: {guesses}; run it with `acroscope run {}`", path.display(), path.display());
    }
    Ok(())
}
