//! `acroscope man`: manual pages, one a command.

use crate::cli::{Arguments, Man};
use crate::error::Error;
use clap::CommandFactory as _;
use runner::folder::Folder;

/// Writes the pages.
pub fn man(arguments: &Man, quiet: bool) -> Result<(), Error> {
    let folder = Folder::make(&arguments.out)?;
    clap_mangen::generate_to(Arguments::command(), folder.path()).map_err(Error::file(folder.path()))?;
    if !quiet {
        tell!("the pages are in {}; `man -l` shows one", folder.path().display());
    }
    Ok(())
}
