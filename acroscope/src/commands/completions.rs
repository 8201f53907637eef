//! `acroscope completions`: a script that completes commands and options in a shell.

use crate::cli::{Arguments, Completions};
use crate::error::Error;
use clap::CommandFactory as _;

/// Prints the script.
pub fn completions(arguments: &Completions) -> Result<(), Error> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "acroscope", &mut script);
    tell!("{}", String::from_utf8_lossy(&script).trim_end());
    Ok(())
}
