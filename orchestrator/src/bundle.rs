//! A built scenario with all that belongs to it, to be packed: units and tables get short names beside each other.

use crate::scenario::write::{ResolvedUnit, files_as_named};
use crate::scenario::{Scenario, SignalEntry};
use crate::simulation::Simulation;
use crate::value::Value;
use std::path::{Path, PathBuf};

/// A scenario whose files are named by what they are called in the bundle.
pub struct Bundle {
    /// The scenario, in which `fmu = "…"` and `file = "…"` are names of [`Bundle::files`].
    pub scenario: Scenario,
    /// Name in the bundle and where the file lies now; each once.
    pub files: Vec<(String, PathBuf)>,
}

impl Bundle {
    /// The name of a file, which is added if it is new.
    fn add(&mut self, path: &Path) -> String {
        if let Some((name, _)) = self.files.iter().find(|(_, known)| known == path) {
            return name.clone();
        }
        let part = |part: Option<&std::ffi::OsStr>| part.unwrap_or_default().to_string_lossy().into_owned();
        let (stem, ending) = (part(path.file_stem()), part(path.extension()));
        let numbered = (2..).map(|number| format!("{stem}-{number}.{ending}"));
        let mut names = std::iter::once(format!("{stem}.{ending}")).chain(numbered);
        let free = names.find(|name| !self.files.iter().any(|(known, _)| known == name));
        let name = free.unwrap_or_default(); // there is always a number left
        self.files.push((name.clone(), path.to_owned()));
        name
    }
}

impl Simulation {
    /// The scenario and its files.
    pub fn bundle(&self) -> Bundle {
        let mut bundle = Bundle { scenario: self.scenario.clone(), files: Vec::new() };
        for (at, path) in self.wiring.files.iter().enumerate() {
            bundle.scenario.units[at].fmu.value = bundle.add(path);
        }
        for at in 0..bundle.scenario.sources.len() {
            let SignalEntry::Csv { file, .. } = &self.scenario.sources[at].signal else { continue };
            let name = bundle.add(&self.scenario.folder().join(file));
            if let SignalEntry::Csv { file, .. } = &mut bundle.scenario.sources[at].signal {
                *file = name;
            }
        }
        bundle
    }

    /// The text of a bundle's scenario, with every value that a run from here on uses: with the bundle's files beside it,
    /// it gives the same run.
    pub fn bundled(&self, bundle: &Bundle) -> String {
        let units = (bundle.scenario.units.iter().enumerate())
            .map(|(at, entry)| ResolvedUnit { fmu: entry.fmu.value.clone(), values: self.used_values(at) });
        files_as_named(&bundle.scenario, &units.collect::<Vec<_>>())
    }

    /// All parameters of each unit with the values that a run from here on uses, and whatever else was set.
    pub fn used(&self) -> Vec<Vec<(String, Value)>> {
        (0..self.scenario.units.len()).map(|unit| self.used_values(unit)).collect()
    }

    /// What each unit was given beside its own start values: by the scenario, or since with [`Simulation::set`].
    pub fn given(&self) -> Vec<Vec<(&str, &Value)>> {
        let name = |unit: usize, place: usize| self.wiring.names.variable((unit, place)).name.as_str();
        (self.wiring.sets.iter().enumerate())
            .map(|(unit, sets)| sets.iter().map(|(place, value)| (name(unit, *place), value)).collect())
            .collect()
    }
}
