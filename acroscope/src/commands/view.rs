//! `acroscope view`: finished runs to look at.

use crate::cli::View;
use crate::error::Error;
use crate::serve::serve;
use report::head::shell_word;
use runner::folder::keep;
use runner::signals::{self, Looking};
use std::path::PathBuf;

/// Writes the page, or serves it until a signal comes.
pub fn view(arguments: &View, quiet: bool) -> Result<(), Error> {
    if let [first, second, third, ..] = arguments.results.as_slice() {
        let shown = |path: &PathBuf| path.display().to_string();
        return Err(Error::words(format!(
            "view: {} results are given, and {} is the third; expected one, or two for a look side by side: acroscope view {} {}",
            arguments.results.len(),
            shown(third),
            shell_word(&shown(first)),
            shell_word(&shown(second))
        )));
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_input_three_results_are_refused_with_how_many_a_look_takes() {
        let results = ["out/a", "out/b", "out/c"].map(PathBuf::from).to_vec();
        let refused = view(&View { results, output: None }, true).expect_err("two are the most");
        let text = refused.to_string();
        assert!(text.contains("out/c is the third") && text.contains("one, or two"), "{text}");
        assert_eq!(refused.exit_status(), 2);
    }
}
