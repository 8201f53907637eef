//! A scenario that runs, from descriptions alone: what fits by name, type and unit is connected, what is free gets its start
//! value as a source, and each guess has its comment.

mod experiment;
mod matching;
mod text;

use crate::error::Error;
use orchestrator::fmu::{Causality, Variable};
use orchestrator::{Fmu, Isolation, Scenario, Simulation, UnitPath};
use std::path::{Path, PathBuf};

/// A unit of the scenario.
pub(crate) struct Unit {
    /// Its name there.
    pub(crate) name: String,
    /// Its file, as the scenario names it.
    pub(crate) file: String,
    pub(crate) fmu: Fmu,
}

impl Unit {
    fn variables(&self, causality: Causality) -> impl Iterator<Item = &Variable> {
        let description = self.fmu.description();
        let all = description.variables.iter().filter(move |variable| variable.causality == causality);
        // A name that several variables have means nobody.
        all.filter(|variable| !description.is_ambiguous(&variable.name))
    }
}

/// The text of a scenario of these units for a file that is to lie at `scenario`. It was built and initialised once, so that
/// it can be run.
///
/// # Errors
/// If a unit can't be opened, or the scenario can't be started.
pub fn draft(files: &[PathBuf], scenario: &Path) -> Result<String, Error> {
    draft_with(files, scenario, None)
}

/// The same, with units that are tried in processes of their own if limits are given.
///
/// # Errors
/// As of [`draft`]; if a unit ends its process, or doesn't come back in time.
pub fn draft_with(
    files: &[PathBuf],
    scenario: &Path,
    isolation: Option<&Isolation>,
) -> Result<String, Error> {
    let folder = scenario.parent().unwrap_or(Path::new(""));
    let mut units: Vec<Unit> = Vec::new();
    for file in files {
        let fmu = Fmu::open(file)?;
        let name = name_of(file, &units);
        units.push(Unit { name, file: seen_from(folder, file)?, fmu });
    }
    let text = text::scenario(&units, false);
    match try_out(&text, scenario, isolation) {
        // Units that depend on each other at once, without a solution: one of them waits.
        Err(orchestrator::Error::Loop { .. }) => {
            let text = text::scenario(&units, true);
            try_out(&text, scenario, isolation)?;
            Ok(text)
        }
        other => {
            other?;
            Ok(text)
        }
    }
}

fn try_out(text: &str, scenario: &Path, isolation: Option<&Isolation>) -> Result<(), orchestrator::Error> {
    let mut scenario = Scenario::parse(text, scenario)?;
    for unit in &mut scenario.units {
        unit.isolation = isolation.cloned();
    }
    Simulation::new(&scenario, &UnitPath::new())?.initialize()
}

/// The stem of the file, as far as scenarios allow it, with a number where it is taken.
fn name_of(file: &Path, units: &[Unit]) -> String {
    let stem = orchestrator::scenario::name_of_file(file);
    let taken = |name: &str| units.iter().any(|unit| unit.name == name);
    let numbered = (2..).map(|number| format!("{stem}_{number}"));
    [stem.clone()].into_iter().chain(numbered).find(|name| !taken(name)).unwrap_or(stem)
}

/// A file as it is named from a folder: relative, with `/` between folders.
fn seen_from(folder: &Path, file: &Path) -> Result<String, Error> {
    let whole = |path: &Path| {
        let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
        path.canonicalize().map_err(|source| Error::File { path: path.into(), source })
    };
    let (folder, file) = (whole(folder)?, whole(file)?);
    let alike = folder.components().zip(file.components()).take_while(|(a, b)| a == b).count();
    // On another drive there is no way from the one to the other.
    if alike == 0 {
        return Ok(file.to_string_lossy().into_owned());
    }
    let up = folder.components().skip(alike).map(|_| "..".to_owned());
    let down = file.components().skip(alike).map(|part| part.as_os_str().to_string_lossy().into_owned());
    Ok(up.chain(down).collect::<Vec<_>>().join("/"))
}
