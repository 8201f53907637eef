//! What goes into an `.fmu`.

use crate::archive::Entries;
use crate::library::Unit;
use crate::platform::Platform;
use crate::{Result, at, icon};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The entries of a unit: description, page, picture, the library under this platform's folder, licences by name, and what
/// lies in the folder `extra` of its crate.
///
/// # Errors
/// A file can't be read.
pub fn content(
    library: &Path,
    unit: &Unit,
    licences: &[(String, Vec<u8>)],
    crate_folder: &Path,
) -> Result<Entries> {
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
    for (name, path) in extra(crate_folder)? {
        entries.insert(name, at(&path, fs::read(&path))?);
    }
    Ok(entries)
}

/// The files below `extra` beside a crate's Cargo.toml, with the names that they have in the archive. FMI keeps that folder
/// for layered standards, each in a folder of its own name, such as `org.fmi-standard.fmi-ls-ref`.
///
/// # Errors
/// A folder can't be read, or something there is a symbolic link: what it leads to was not meant to be handed on with the unit, and FMI's
/// archives hold none.
pub fn extra(crate_folder: &Path) -> Result<BTreeMap<String, PathBuf>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![("extra".to_owned(), crate_folder.join("extra"))];
    while let Some((name, folder)) = folders.pop() {
        if folder.is_symlink() {
            return Err(link(&folder));
        }
        if !folder.is_dir() {
            continue;
        }
        for entry in at(&folder, fs::read_dir(&folder))? {
            let entry = at(&folder, entry)?;
            let name = format!("{name}/{}", entry.file_name().to_string_lossy());
            if at(&entry.path(), entry.file_type())?.is_symlink() {
                return Err(link(&entry.path()));
            }
            if entry.path().is_dir() {
                folders.push((name, entry.path()));
            } else {
                found.insert(name, entry.path());
            }
        }
    }
    Ok(found)
}

/// What to say of a symbolic link.
fn link(path: &Path) -> Box<dyn std::error::Error> {
    let to = fs::read_link(path).unwrap_or_default();
    format!("{}: a symbolic link to {}: put the file itself there", path.display(), to.display()).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn error_a_link_in_extra_is_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let (own, secret) = (folder.path().join("extra/org.example"), folder.path().join("secret"));
        fs::create_dir_all(&own).unwrap();
        fs::create_dir(&secret).unwrap();
        fs::write(secret.join("key"), "mine").unwrap();
        for target in [secret.join("key"), secret.clone(), secret.join("gone")] {
            std::os::unix::fs::symlink(&target, own.join("link")).unwrap();
            let told = extra(folder.path()).unwrap_err().to_string();
            assert!(told.contains("extra/org.example/link: a symbolic link to"), "{told}");
            fs::remove_file(own.join("link")).unwrap();
        }
        fs::remove_dir_all(folder.path().join("extra")).unwrap();
        std::os::unix::fs::symlink(&secret, folder.path().join("extra")).unwrap();
        let told = extra(folder.path()).unwrap_err().to_string();
        assert!(told.contains("extra: a symbolic link to"), "{told}");
    }

    #[test]
    fn law_what_lies_in_extra_is_packed_under_its_own_name() {
        let folder = tempfile::tempdir().unwrap();
        assert!(extra(folder.path()).unwrap().is_empty(), "there need not be one");
        let standard = folder.path().join("extra/org.example.standard");
        fs::create_dir_all(standard.join("deeper")).unwrap();
        fs::write(standard.join("manifest.xml"), "<a/>").unwrap();
        fs::write(standard.join("deeper/in.csv"), "time").unwrap();
        fs::write(folder.path().join("Cargo.toml"), "").unwrap();
        let library = folder.path().join("libone.so");
        fs::write(&library, "library").unwrap();
        let unit = Unit {
            identifier: "one".into(),
            xml: String::new(),
            html: String::new(),
            notation: String::new(),
        };
        let entries = content(&library, &unit, &[], folder.path()).unwrap();
        let extra: Vec<_> = entries.iter().filter(|(name, _)| name.starts_with("extra/")).collect();
        let names = ["extra/org.example.standard/deeper/in.csv", "extra/org.example.standard/manifest.xml"];
        assert_eq!(
            extra,
            [(&names[0].to_owned(), &b"time".to_vec()), (&names[1].to_owned(), &b"<a/>".to_vec())]
        );
    }
}
