//! Binaries for other platforms, and for old machines of this one: built with zig as the linker, checked, and put beside
//! or in place of the one that was built here. They stay in the `.fmu` until its source changes.

use crate::archive::{self, Entries};
use crate::platform::Platform;
use crate::{Result, at, cargo, merge, shells};
use sha2::{Digest as _, Sha256};
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

/// Builds the units for each platform, checks exports and imports, and packs them into `fmus`.
pub fn add(root: &Path, fmus: &[PathBuf], platforms: &[Platform]) -> Result<()> {
    add_built_in(root, fmus, platforms, &root.join("target").join("fmu-platforms"))
}

/// As [`add`], building in a folder.
pub fn add_built_in(root: &Path, fmus: &[PathBuf], platforms: &[Platform], build: &Path) -> Result<()> {
    if platforms.is_empty() {
        return Ok(());
    }
    let calls = shells::calls(root, &shells::folders(root)?)?;
    let inspect = cargo::build_program(root, "inspect")?;
    for &platform in platforms {
        let mut libraries = Vec::new();
        for packages in &calls {
            libraries.extend(cargo::build_units_for(platform, root, packages, build)?);
        }
        let name = OsStr::new(platform.folder());
        let files = libraries.iter().map(|library| library.as_os_str());
        cargo::run_program(&inspect, &std::iter::once(name).chain(files).collect::<Vec<_>>())?;
        for (fmu, library) in fmus.iter().zip(&libraries) {
            merge::merge(fmu, platform, library)?;
        }
    }
    Ok(())
}

/// From which library of this machine each `.fmu` was made: `NAME CHECKSUM` in each line.
fn record(fmus: &Path) -> PathBuf {
    fmus.join(".natives")
}

fn line(library: &Path) -> Result<String> {
    let sum = Sha256::digest(at(library, fs::read(library))?);
    let sum: String = sum.iter().map(|byte| format!("{byte:02x}")).collect();
    Ok(format!("{} {sum}", library.file_name().unwrap_or_default().display()))
}

/// Keeps in mind from which libraries the `.fmu` files in a folder were made; what is known of others stays.
pub fn remember(fmus: &Path, libraries: &[PathBuf]) -> Result<()> {
    let known = fs::read_to_string(record(fmus)).unwrap_or_default();
    let other = |line: &&str| {
        let name = line.split(' ').next().map(OsStr::new);
        libraries.iter().all(|library| library.file_name() != name)
    };
    let mut lines = libraries.iter().map(|library| line(library)).collect::<Result<Vec<_>>>()?;
    lines.extend(known.lines().filter(other).map(str::to_owned));
    archive::write_if_changed(&record(fmus), (lines.join("\n") + "\n").as_bytes())
}

/// The binaries that an `.fmu` holds stay in it as long as they belong to the same source: what is built from that here,
/// with its description inside, is unchanged.
pub fn keep(fmu: &Path, library: &Path, entries: &mut Entries) -> Result<()> {
    let Ok(old) = archive::read(fmu) else { return Ok(()) };
    let known = fs::read_to_string(record(fmu.parent().unwrap_or(Path::new("")))).unwrap_or_default();
    let same = known.lines().any(|known| line(library).is_ok_and(|line| line == known));
    let own = Platform::own().folder();
    let is_other =
        |name: &String| name.starts_with("binaries/") && !name.starts_with(&format!("binaries/{own}/"));
    if same {
        entries.extend(old.into_iter().filter(|(name, _)| name.starts_with("binaries/")));
    } else if old.keys().any(is_other) {
        eprintln!("{}: the source has changed, so binaries of other platforms were left out", fmu.display());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_binaries_of_other_platforms_stay_until_the_source_changes() {
        let folder = tempfile::tempdir().unwrap();
        let (fmu, library) = (folder.path().join("one.fmu"), folder.path().join("libone.so"));
        fs::write(&library, "built from the first source").unwrap();
        let packed = Entries::from([
            (Platform::own().entry("one"), b"for old machines".to_vec()),
            ("binaries/elsewhere/one.x".to_owned(), b"for others".to_vec()),
            ("modelDescription.xml".to_owned(), b"old".to_vec()),
        ]);
        fs::write(&fmu, archive::to_bytes(&packed).unwrap()).unwrap();
        remember(folder.path(), std::slice::from_ref(&library)).unwrap();

        let fresh = || Entries::from([(Platform::own().entry("one"), b"for this machine".to_vec())]);
        let mut again = fresh();
        keep(&fmu, &library, &mut again).unwrap();
        assert_eq!(again[&Platform::own().entry("one")], b"for old machines");
        assert_eq!(again["binaries/elsewhere/one.x"], b"for others");
        assert!(!again.contains_key("modelDescription.xml"), "only binaries are kept");

        fs::write(&library, "built from another source").unwrap();
        let mut changed = fresh();
        keep(&fmu, &library, &mut changed).unwrap();
        assert_eq!(changed, fresh());
    }
}
