//! The shipped scenarios, which travel inside the program, and where the packed units lie.

use orchestrator::{Scenario, UnitPath};
use std::path::{Path, PathBuf};

/// Name, and text of the file. A new scenario is a file here and a line in this list.
pub const SHIPPED: &[(&str, &str)] =
    &[("visual-servo", include_str!("visual-servo.toml")), ("full-state", include_str!("full-state.toml"))];

/// Why there is no scenario.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Neither a file nor a shipped one.
    #[error("no scenario `{name}`: neither a file nor one of the shipped ones ({})", names())]
    Unknown {
        /// As typed.
        name: String,
    },
    /// It can't be read.
    #[error(transparent)]
    Unreadable(#[from] orchestrator::Error),
}

/// Names of the shipped scenarios.
pub fn names() -> String {
    SHIPPED.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
}

/// Loads a shipped scenario by its name, or any other by its path.
pub fn load(name: &str) -> Result<Scenario, Error> {
    if let Some((stem, text)) = SHIPPED.iter().find(|(stem, _)| *stem == name) {
        return Ok(Scenario::parse(text, format!("scenarios/{stem}.toml"))?);
    }
    if Path::new(name).exists() {
        return Ok(Scenario::load(name)?);
    }
    Err(Error::Unknown { name: name.to_owned() })
}

/// Where units are looked for when they don't lie beside the scenario: the folders of the environment variable
/// `ACROSCOPE_FMUS`, then `fmus` beside the folder of this program or above it, where `cargo xtask pack` puts them
/// (`target/fmus` for `target/release/acroscope` as well as for a test in `target/release/deps`).
pub fn unit_path() -> UnitPath {
    let mut folders: Vec<PathBuf> = std::env::var_os("ACROSCOPE_FMUS")
        .map(|list| std::env::split_paths(&list).collect())
        .unwrap_or_default();
    if let Ok(program) = std::env::current_exe() {
        folders.extend(program.ancestors().skip(1).take(3).map(|folder| folder.join("fmus")));
    }
    folders.into_iter().fold(UnitPath::new(), UnitPath::with)
}
