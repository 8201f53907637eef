//! Where `.fmu` files are looked for, and those that were opened: each file is unpacked and loaded once.

use crate::error::{Error, Place};
use crate::fmu::Fmu;
use crate::package::{self, Unpacked};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::SystemTime;

/// Folders with units. Clones share the opened units, also between threads.
#[derive(Debug, Clone, Default)]
pub struct UnitPath {
    folders: Vec<PathBuf>,
    opened: Arc<Mutex<HashMap<Key, Fmu>>>,
    unpacked: Arc<Mutex<HashMap<Entry, Weak<Unpacked>>>>,
}

/// A package, and a file in it.
type Entry = (Key, String);

/// A file that was rebuilt is another file.
type Key = (PathBuf, Option<SystemTime>, u64);

impl UnitPath {
    /// No folders: only what lies beside the scenario is found.
    pub fn new() -> Self {
        Self::default()
    }

    /// With one more folder, looked at after those before it.
    #[must_use]
    pub fn with(mut self, folder: impl Into<PathBuf>) -> Self {
        self.folders.push(folder.into());
        self
    }

    /// The folders.
    pub fn folders(&self) -> &[PathBuf] {
        &self.folders
    }

    /// Opens a unit, or gives the one that is open.
    ///
    /// # Errors
    /// As [`Fmu::open`].
    pub fn open(&self, path: &Path) -> Result<Fmu, Error> {
        let key = key(path);
        let mut opened = self.opened.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(fmu) = opened.get(&key) {
            return Ok(fmu.clone());
        }
        let fmu = Fmu::open(path)?;
        opened.insert(key, fmu.clone());
        Ok(fmu)
    }

    /// The file of a unit: beside the scenario, then in the folders. One inside a package is unpacked, which lasts as long
    /// as what comes with it; clones of this path share it.
    pub(crate) fn find(
        &self,
        name: &str,
        beside: &Path,
        place: &Place,
    ) -> Result<(PathBuf, Option<Arc<Unpacked>>), Error> {
        let Some((package, inside)) = package::split(name) else {
            return self.file(name, beside, place).map(|file| (file, None));
        };
        let package = self.file(package, beside, place)?;
        let key = (key(&package), inside.to_owned());
        let mut unpacked = self.unpacked.lock().unwrap_or_else(PoisonError::into_inner);
        let known = unpacked.get(&key).and_then(Weak::upgrade);
        let found = match known {
            Some(found) => found,
            None => Arc::new(package::unpack(&package, inside)?),
        };
        unpacked.insert(key, Arc::downgrade(&found));
        Ok((found.path.clone(), Some(found)))
    }

    fn file(&self, name: &str, beside: &Path, place: &Place) -> Result<PathBuf, Error> {
        let folders = std::iter::once(beside).chain(self.folders.iter().map(PathBuf::as_path));
        for folder in folders.clone() {
            let path = folder.join(name);
            if path.is_file() {
                return Ok(path);
            }
        }
        let shown = |folder: &Path| match folder.as_os_str().is_empty() {
            true => ".".to_owned(),
            false => folder.display().to_string(),
        };
        let looked: Vec<String> = folders.map(shown).collect();
        Err(Error::Scenario {
            place: place.clone(),
            what: format!("fmu = {name:?} was not found"),
            expected: format!("looked in {}", looked.join(", ")),
        })
    }
}

fn key(path: &Path) -> Key {
    let path = path.canonicalize().unwrap_or_else(|_| path.into());
    match path.metadata() {
        Ok(data) => (path, data.modified().ok(), data.len()),
        Err(_) => (path, None, 0),
    }
}
