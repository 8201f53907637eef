//! Puts a library that was built elsewhere into a packed unit.

use crate::platform::Platform;
use crate::{Result, archive, at};
use std::fs;
use std::path::Path;

/// Adds `library` to `fmu`, or replaces the one of that platform.
pub fn merge(fmu: &Path, platform: Platform, library: &Path) -> Result<()> {
    let mut entries = archive::read(fmu)?;
    let description = entries.get("modelDescription.xml").ok_or("modelDescription.xml is missing")?;
    let identifier = identifier(&String::from_utf8_lossy(description))
        .ok_or_else(|| format!("{}: modelDescription.xml has no modelIdentifier", fmu.display()))?;
    let content = at(library, fs::read(library))?;
    if !platform.matches(&content) {
        return Err(format!("{}: not a library for {}", library.display(), platform.folder()).into());
    }
    entries.insert(platform.entry(&identifier), content);
    archive::write_if_changed(fmu, &archive::to_bytes(&entries)?)
}

/// The value of the first attribute `modelIdentifier`.
fn identifier(description: &str) -> Option<String> {
    let (_, rest) = description.split_once("modelIdentifier=\"")?;
    rest.split_once('"').map(|(value, _)| value.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::archive::Entries;

    #[test]
    fn alone_a_library_of_another_platform_is_added_and_a_wrong_one_refused() {
        let folder = tempfile::tempdir().unwrap();
        let (fmu, dll) = (folder.path().join("one.fmu"), folder.path().join("any.dll"));
        let xml = br#"<fmiModelDescription><CoSimulation modelIdentifier="one"/></fmiModelDescription>"#;
        let entries = Entries::from([("modelDescription.xml".to_owned(), xml.to_vec())]);
        fs::write(&fmu, archive::to_bytes(&entries).unwrap()).unwrap();
        fs::write(&dll, b"MZ and so on").unwrap();
        merge(&fmu, Platform::Win64, &dll).unwrap();
        assert_eq!(archive::read(&fmu).unwrap()["binaries/win64/one.dll"], b"MZ and so on");
        let refused = merge(&fmu, Platform::Darwin64, &dll).unwrap_err().to_string();
        assert!(refused.contains("not a library for darwin64"), "{refused}");
    }
}
