//! The shipped scenarios, which travel inside the program, and where the packed units lie.

#![forbid(unsafe_code)]

mod embedded;

use orchestrator::{Scenario, UnitPath, suggest};
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Name, and text of the file. A new scenario is a file here and a line in this list.
pub const SHIPPED: &[(&str, &str)] = &[
    ("visual-servo", include_str!("visual-servo.toml")),
    ("full-state", include_str!("full-state.toml")),
    ("dual-loop", include_str!("dual-loop.toml")),
];

/// Why there is no scenario.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Neither a file nor a shipped one.
    #[error("no scenario `{name}`: neither a file nor one of the shipped ones ({}); {suggestion}", names())]
    Unknown {
        /// As typed.
        name: String,
        /// What may have been meant.
        suggestion: String,
    },
    /// A folder.
    #[error("{}: a folder, and a scenario is a file: {suggestion}", path.display())]
    Folder {
        /// As typed.
        path: PathBuf,
        /// What may have been meant.
        suggestion: String,
    },
    /// It is a unit.
    #[error("{}: it is a unit and no scenario; `acroscope new {}` makes a scenario of it", path.display(), path.display())]
    Unit {
        /// The unit.
        path: PathBuf,
    },
    /// It can't be read.
    #[error(transparent)]
    Unreadable(#[from] orchestrator::Error),
    /// A packed unit of ours is not there.
    #[error("{name} was not found: looked in {folders}; `cargo xtask pack` makes it")]
    Missing {
        /// The file's name.
        name: String,
        /// Where it could be.
        folders: String,
    },
    /// It is a package that can't be read.
    #[error(transparent)]
    Package(#[from] ssp::Error),
}

/// Names of the shipped scenarios.
pub fn names() -> String {
    SHIPPED.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
}

/// Loads a shipped scenario by its name, or any other by its path: a TOML file, or a package (`.ssp`).
pub fn load(name: &str) -> Result<Scenario, Error> {
    read(name).map(|(scenario, _)| scenario)
}

/// As [`load`], with the bytes that it was read from.
pub fn read(name: &str) -> Result<(Scenario, Cow<'static, [u8]>), Error> {
    let path = Path::new(name);
    if path.extension().is_some_and(|ending| ending == "ssp") && path.is_file() {
        let unreadable = |source| orchestrator::Error::File { path: path.into(), source };
        let bytes = orchestrator::plain::read(path).map_err(unreadable)?;
        return Ok((ssp::read(path)?, Cow::Owned(bytes)));
    }
    let (text, origin) = text(name)?;
    let scenario = Scenario::parse(&text, origin)?;
    let bytes = match text {
        Cow::Borrowed(text) => Cow::Borrowed(text.as_bytes()),
        Cow::Owned(text) => Cow::Owned(text.into_bytes()),
    };
    Ok((scenario, bytes))
}

/// The text of a scenario as [`load`] reads it, and where it comes from.
pub fn text(name: &str) -> Result<(Cow<'static, str>, PathBuf), Error> {
    if let Some((stem, text)) = SHIPPED.iter().find(|(stem, _)| *stem == name) {
        return Ok((Cow::Borrowed(text), format!("scenarios/{stem}.toml").into()));
    }
    let path = Path::new(name);
    if path.is_dir() {
        return Err(Error::Folder { path: path.into(), suggestion: inside(path) });
    }
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("fmu")) && path.is_file() {
        return Err(Error::Unit { path: path.into() });
    }
    if path.exists() {
        let unreadable = |source| orchestrator::Error::File { path: path.into(), source };
        return Ok((Cow::Owned(orchestrator::plain::read_text(path).map_err(unreadable)?), path.into()));
    }
    Err(Error::Unknown { name: name.to_owned(), suggestion: suggestion(path) })
}

/// What a folder holds that a person may have meant.
fn inside(folder: &Path) -> String {
    let path = |file: &str| folder.join(file).display().to_string();
    if folder.join("dataset.toml").is_file() {
        return format!("it holds a data set, `acroscope diagnose {}` reads it", folder.display());
    }
    if folder.join("resolved.toml").is_file() {
        return format!("it holds results, `acroscope run {}` makes them again", path("resolved.toml"));
    }
    if folder.join("amended.toml").is_file() {
        return format!("it holds a diagnosis, `acroscope run {}` runs its model", path("amended.toml"));
    }
    match tomls(folder).as_slice() {
        [] => "it holds no .toml and no .ssp file".to_owned(),
        names => format!("it holds {}", names.iter().map(|name| path(name)).collect::<Vec<_>>().join(", ")),
    }
}

/// The nearest names: of the shipped scenarios, or of the files beside where this one was looked for.
fn suggestion(path: &Path) -> String {
    let typed = path.file_name().unwrap_or_default().to_string_lossy();
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let beside = tomls(folder.unwrap_or(Path::new(".")));
    let shipped = SHIPPED.iter().map(|(name, _)| *name).filter(|_| folder.is_none());
    let known: Vec<&str> = shipped.chain(beside.iter().map(String::as_str)).collect();
    if let (Some(folder), []) = (folder, known.as_slice()) {
        let folder_shown = folder.display();
        return match folder.is_dir() {
            true => format!("{folder_shown} holds no .toml and no .ssp file"),
            false => format!("there is no folder {folder_shown}"),
        };
    }
    suggest::nearest(&typed, known.into_iter())
}

fn tomls(folder: &Path) -> Vec<String> {
    let names = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = names
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|name| name.ends_with(".toml") || name.ends_with(".ssp"))
        .collect();
    names.sort();
    names
}

static ADDED: OnceLock<PathBuf> = OnceLock::new();

/// Names a folder with units for [`unit_path`], for a host that is not our program: Python's package has the units
/// beside it. The first one counts.
pub fn add_units(folder: PathBuf) {
    ADDED.get_or_init(|| folder);
}

/// A packed unit of ours by its file's name, where [`unit_path`] looks.
pub fn packed(name: &str) -> Result<PathBuf, Error> {
    let path = unit_path();
    let found = path.folders().iter().map(|folder| folder.join(name)).find(|file| file.is_file());
    found.ok_or_else(|| Error::Missing {
        name: name.to_owned(),
        folders: path
            .folders()
            .iter()
            .map(|folder| folder.display().to_string())
            .collect::<Vec<_>>()
            .join(", "),
    })
}

/// Where units are looked for when they don't lie beside the scenario, in this order: the folders of the environment
/// variable `ACROSCOPE_FMUS`; the one of [`add_units`]; `fmus` beside the folder of this program or above it, where `cargo
/// xtask pack` puts them (`target/fmus` for `target/release/acroscope` as well as for a test in `target/release/deps`);
/// `share/acroscope/fmus` beside the folder of this program (`bin/acroscope`); the units inside the program, if it was
/// built with any.
pub fn unit_path() -> UnitPath {
    let mut folders: Vec<PathBuf> = std::env::var_os("ACROSCOPE_FMUS")
        .map(|list| std::env::split_paths(&list).collect())
        .unwrap_or_default();
    folders.extend(ADDED.get().cloned());
    if let Ok(program) = std::env::current_exe() {
        folders.extend(program.ancestors().skip(1).take(3).map(|folder| folder.join("fmus")));
        let installed =
            program.ancestors().nth(2).map(|above| above.join("share").join("acroscope").join("fmus"));
        folders.extend(installed);
    }
    folders.extend(embedded::folder());
    folders.into_iter().fold(UnitPath::new(), UnitPath::with)
}

#[cfg(test)]
mod tests {
    use super::{load, names};

    fn refused(name: &str) -> String {
        load(name).err().map(|error| error.to_string()).unwrap_or_default()
    }

    #[test]
    fn law_a_misspelt_name_gets_the_nearest_one() {
        let text = refused("visual-sevro");
        assert!(text.contains("did you mean visual-servo?") && text.contains(&names()), "{text}");
        assert!(refused("fullstate").contains("did you mean full-state"), "{}", refused("fullstate"));
    }

    #[test]
    fn law_a_misspelt_file_gets_those_beside_it() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join("heater.toml"), "").expect("writable");
        let text = refused(&folder.path().join("haeter.toml").to_string_lossy());
        assert!(text.contains("did you mean heater.toml?"), "{text}");
    }

    #[test]
    fn law_a_file_in_a_folder_without_any_says_so() {
        assert!(
            refused("nodir/x.toml").ends_with("; there is no folder nodir"),
            "{}",
            refused("nodir/x.toml")
        );
        let folder = tempfile::tempdir().expect("a temporary folder");
        let text = refused(&folder.path().join("x.toml").to_string_lossy());
        assert!(text.ends_with("holds no .toml and no .ssp file"), "{text}");
    }

    #[test]
    fn law_a_folder_says_what_it_holds() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let name = folder.path().to_string_lossy().into_owned();
        assert!(refused(&name).contains("a folder") && refused(&name).contains("no .toml and no .ssp file"));
        for (file, said) in [
            ("mine.toml", "mine.toml"),
            ("resolved.toml", "acroscope run "),
            ("dataset.toml", "acroscope diagnose "),
        ] {
            std::fs::write(folder.path().join(file), "").expect("writable");
            assert!(refused(&name).contains(said), "{}", refused(&name));
        }
    }
}
