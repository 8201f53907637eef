//! Units that travel inside the program: those of a crate that was installed without a clone. They are unpacked once into
//! the user's cache, in a folder named by their checksum.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

include!(concat!(env!("OUT_DIR"), "/units.rs"));

/// The folder with the units inside, or `None` if there are none inside or the cache can't be written.
pub fn folder() -> Option<PathBuf> {
    if UNITS.is_empty() {
        return None;
    }
    let folder = cache()?.join("acroscope").join(format!("units-{SUM}"));
    unpack(UNITS, &folder).ok().map(|()| folder)
}

/// Where programs of this user keep what they can make again.
fn cache() -> Option<PathBuf> {
    let given = |name: &str| env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    if cfg!(windows) {
        return given("LOCALAPPDATA");
    }
    let home = || {
        given("HOME")
            .map(|home| home.join(if cfg!(target_os = "macos") { "Library/Caches" } else { ".cache" }))
    };
    given("XDG_CACHE_HOME").or_else(home)
}

/// Writes each unit that is not there yet, whole or not at all: several programs may do so at once.
fn unpack(units: &[(&str, &[u8])], folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    for (name, bytes) in units {
        let path = folder.join(name);
        if path.metadata().is_ok_and(|data| data.len() == bytes.len() as u64) {
            continue;
        }
        let new = folder.join(format!("{name}.{}.new", std::process::id()));
        fs::write(&new, bytes)?;
        fs::rename(&new, &path)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::unpack;
    use std::fs;

    #[test]
    fn law_units_inside_are_written_once_and_mended() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let units: &[(&str, &[u8])] = &[("one.fmu", b"first"), ("two.fmu", b"second")];
        let inner = folder.path().join("made");
        unpack(units, &inner).expect("writable");
        let time = || fs::metadata(inner.join("one.fmu")).and_then(|data| data.modified()).expect("there");
        let before = time();
        fs::write(inner.join("two.fmu"), "cut").expect("writable");
        unpack(units, &inner).expect("writable");
        assert_eq!(time(), before, "what is there is not written again");
        assert_eq!(fs::read(inner.join("two.fmu")).expect("there"), b"second", "what was cut short is");
        assert_eq!(fs::read_dir(&inner).expect("there").count(), 2, "nothing else is left");
    }
}
