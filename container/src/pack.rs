//! A scenario and the blank unit become a unit of their own.

use crate::error::Error;
use crate::instance::{Instance, SCENARIO};
use crate::xml;
use orchestrator::Simulation;
use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::Path;

/// The model identifier of the blank unit.
pub(crate) const IDENTIFIER: &str = "acroscope_container";
/// The file of the blank unit, which lies with the packed units.
pub const BLANK: &str = "acroscope_container.fmu";

/// The bytes of a unit that holds a scenario; `output` is the file that they will be written to, from which the unit has
/// its name.
///
/// # Errors
/// If a file can't be read, or the scenario can't be built from its bundle.
pub fn pack(simulation: &Simulation, blank: &Path, output: &Path) -> Result<Vec<u8>, Error> {
    let identifier = identifier(output)?;
    let bundle = simulation.bundle();
    let text = simulation.bundled(&bundle);
    let at = |path: &Path| {
        let path = path.to_owned();
        move |error: std::io::Error| Error::File { path, why: error.to_string() }
    };
    // As the library will find it: what it says of itself is asked of an instance.
    let stage = tempfile::tempdir().map_err(at(Path::new("a temporary folder")))?;
    let mut files = BTreeMap::from([(format!("resources/{SCENARIO}"), text.clone().into_bytes())]);
    std::fs::write(stage.path().join(SCENARIO), &text).map_err(at(stage.path()))?;
    for (name, path) in &bundle.files {
        let bytes = std::fs::read(path).map_err(at(path))?;
        let staged = stage.path().join(name);
        std::fs::write(&staged, &bytes).map_err(at(&staged))?;
        files.insert(format!("resources/{name}"), bytes);
    }
    let instance = Instance::new(stage.path())?;
    let description = xml::description(instance.interface(), &identifier, instance.guid(), &bundle.scenario);
    files.insert("modelDescription.xml".to_owned(), description.into_bytes());
    libraries(blank, &identifier, &mut files)?;
    orchestrator::package::pack(&files).map_err(at(output))
}

/// The blank unit's libraries and licences.
fn libraries(blank: &Path, identifier: &str, files: &mut BTreeMap<String, Vec<u8>>) -> Result<(), Error> {
    let wrong = |why: String| Error::File { path: blank.to_owned(), why };
    let file = std::fs::File::open(blank).map_err(|error| wrong(error.to_string()))?;
    let mut archive = zip::ZipArchive::new(file).map_err(|error| wrong(error.to_string()))?;
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index).map_err(|error| wrong(error.to_string()))?;
        let name = entry.name().map_err(|error| wrong(error.to_string()))?.into_owned();
        let renamed = match name.rsplit_once('/') {
            Some((folder, library)) if folder.starts_with("binaries/") => {
                format!("{folder}/{}", library.replacen(IDENTIFIER, identifier, 1))
            }
            _ if name.starts_with("documentation/licenses/") => name.clone(),
            _ => continue,
        };
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).map_err(|error| wrong(format!("{name}: {error}")))?;
        files.insert(renamed, bytes);
    }
    Ok(())
}

/// The stem of a file as a C identifier.
fn identifier(output: &Path) -> Result<String, Error> {
    let stem = output.file_stem().unwrap_or_default().to_string_lossy();
    let plain: String = stem.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if !plain.contains(|c: char| c.is_ascii_alphanumeric()) {
        let expected = "a name with letters or digits, such as servo.fmu".to_owned();
        return Err(Error::Name { path: output.to_owned(), expected });
    }
    let starts = plain.starts_with(|c: char| c.is_ascii_digit());
    Ok(if starts { format!("_{plain}") } else { plain })
}

#[cfg(test)]
mod tests {
    use super::identifier;

    #[test]
    fn value_identifiers_are_those_of_c() {
        for (file, expected) in
            [("out/visual-servo.fmu", "visual_servo"), ("2dof.fmu", "_2dof"), ("a.fmu", "a")]
        {
            assert_eq!(identifier(file.as_ref()).ok().as_deref(), Some(expected));
        }
        assert!(identifier("-.fmu".as_ref()).is_err() && identifier("".as_ref()).is_err());
    }
}
