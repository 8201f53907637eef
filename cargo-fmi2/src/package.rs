//! What goes into an `.fmu`.

use crate::archive::Entries;
use crate::library::Unit;
use crate::platform::Platform;
use crate::{Result, at, icon};
use std::fs;
use std::path::Path;

/// The entries of a unit: description, page, picture, the library under this platform's folder, and licences by name.
///
/// # Errors
/// The library can't be read.
pub fn content(library: &Path, unit: &Unit, licences: &[(String, Vec<u8>)]) -> Result<Entries> {
    let count = |causality| unit.xml.matches(&format!("causality=\"{causality}\"")).count();
    let mut entries = Entries::from([
        ("modelDescription.xml".to_owned(), unit.xml.clone().into_bytes()),
        ("documentation/index.html".to_owned(), unit.html.clone().into_bytes()),
        ("model.png".to_owned(), icon::icon(&unit.identifier, count("input"), count("output"))?),
        (Platform::own().entry(&unit.identifier), at(library, fs::read(library))?),
    ]);
    for (name, text) in licences {
        entries.insert(format!("documentation/licenses/{name}.txt"), text.clone());
    }
    Ok(entries)
}
