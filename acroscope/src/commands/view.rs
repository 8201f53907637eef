//! `acroscope view`: finished runs to look at.

use crate::cli::View;
use crate::error::Error;
use crate::serve::serve;
use runner::folder::keep;
use runner::signals::{self, Looking};
use std::path::PathBuf;

/// Writes the page, or serves it until a signal comes.
pub fn view(arguments: &View, quiet: bool) -> Result<(), Error> {
    let viewer::Shown { html, notes } = viewer::page(&arguments.results)?;
    if !quiet {
        notes.iter().for_each(|note| complain!("note: {note}"));
    }
    if let Some(file) = &arguments.output {
        let read = |folder: &PathBuf| ["results.csv", "resolved.toml"].map(|name| folder.join(name));
        keep(std::slice::from_ref(file), &arguments.results.iter().flat_map(read).collect::<Vec<_>>())?;
        std::fs::write(file, html).map_err(Error::file(file))?;
        if !quiet {
            tell!("the page is {}", file.display());
        }
        return Ok(());
    }
    let _looking = Looking::now();
    // The address is what was asked for, so that it is told in any case.
    let told = |address: &str| tell!("the page is at {address} until Ctrl-C");
    serve(&html, told, || signals::caught().is_some())
}
