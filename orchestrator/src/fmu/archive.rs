//! The `.fmu` file: a zip archive, unpacked into a folder that lives as long as anything loaded from it.
//!
//! Only what a run needs is unpacked: the description, the resources and this platform's binaries.

use crate::error::{self, Error};
use crate::fmu::Description;
use crate::fmu::limits::{self, Limits};
use crate::fmu::workshop::{self, Bench};
use crate::machine;
use crate::plain;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Folders under `binaries/` for this platform, the best first. FMI 2.0.5 section 2.3 names those of x86 and asks for
/// FMI 3.0's tuples elsewhere; tools older than that put 64-bit ARM into `linux64` and `darwin64`, too.
pub(crate) const PLATFORMS: &[&str] = if cfg!(all(target_os = "windows", target_arch = "aarch64")) {
    &["aarch64-windows"]
} else if cfg!(target_os = "windows") {
    if cfg!(target_pointer_width = "64") { &["win64", "x86_64-windows"] } else { &["win32"] }
} else if cfg!(all(target_os = "macos", target_arch = "aarch64")) {
    &["aarch64-darwin", "darwin64"]
} else if cfg!(target_os = "macos") {
    &["darwin64", "x86_64-darwin"]
} else if cfg!(target_arch = "aarch64") {
    &["aarch64-linux", "linux64"]
} else if cfg!(target_pointer_width = "64") {
    &["linux64", "x86_64-linux"]
} else {
    &["linux32"]
};

/// File extension of a shared library.
pub(crate) const EXTENSION: &str = std::env::consts::DLL_EXTENSION;

/// Folders in each other that are unpacked. Python installations have a dozen; to take away many times more, a file is open for
/// each, and a process may have 1024.
const DEEPEST: usize = 100;

/// An unpacked unit. Dropping it deletes the folder.
#[derive(Debug)]
pub(crate) struct Archive {
    folder: Bench,
    /// Platforms for which the archive holds binaries.
    pub(crate) platforms: Vec<String>,
}

impl Archive {
    pub(crate) fn unpack(path: &Path) -> Result<(Self, Description), Error> {
        Self::unpack_within(path, Limits::from_environment()?)
    }

    fn unpack_within(path: &Path, limits: Limits) -> Result<(Self, Description), Error> {
        let file = plain::open(path).map_err(|source| Error::File { path: path.into(), source })?;
        let broken = |reason: String| Error::Archive { path: path.into(), reason };
        let mut zip = zip::ZipArchive::new(io::BufReader::new(file)).map_err(|e| broken(e.to_string()))?;
        if zip.len() as u64 > limits.entries {
            let what = format!("the number of its entries, {},", zip.len());
            return Err(broken(limits::exceeded(&what, limits.entries, limits::ENTRIES)));
        }
        not_too_much(&mut zip, limits).map_err(broken)?;
        let _unpacking = workshop::unpacking();
        let folder = Bench::new().map_err(|error| error::unpack(path, &error))?;
        let mut left = limits.unpacked;
        let mut description = None;
        let (mut platforms, mut links) = (Vec::new(), Vec::new());
        for index in 0..zip.len() {
            let mut entry = entry(&mut zip, index).map_err(broken)?;
            if entry.is_dir() {
                continue;
            }
            // A name that leads out of the folder is nobody's resource.
            let Some(name) = entry.enclosed_name() else { continue };
            if name == Path::new("modelDescription.xml") {
                description = Some(described(path, entry.by_ref(), limits.description)?);
                continue;
            }
            if is_wanted(&name, &mut platforms) {
                if entry.is_symlink() {
                    links.push(name.clone());
                }
                not_too_deep(&name).map_err(broken)?;
                // One byte more than allowed tells what is too much.
                let mut file = entry.by_ref().take(left.saturating_add(1));
                let written =
                    write(&folder.path().join(&name), &mut file).map_err(
                        |error| match machine::is_no_room(&error) {
                            true => error::unpack(path, &error),
                            false => broken(format!("{}: {error}", name.display())),
                        },
                    )?;
                left = left.checked_sub(written).ok_or_else(|| broken(too_much(&name, limits)))?;
            }
        }
        // The standard hands out the folder whether the unit has resources or not.
        fs::create_dir_all(folder.path().join("resources")).map_err(|e| broken(e.to_string()))?;
        let description = description.ok_or_else(|| broken("it holds no modelDescription.xml".into()))?;
        no_link(&links, &description).map_err(broken)?;
        Ok((Self { folder, platforms }, description))
    }

    /// Where the library of a model lies; if it is not there and another one is the only one, that one, and a word
    /// about it.
    pub(crate) fn library(&self, model_identifier: &str) -> (PathBuf, Option<String>) {
        let binaries = self.folder.path().join("binaries");
        let held = PLATFORMS.iter().find(|platform| binaries.join(platform).is_dir());
        let folder = binaries.join(held.unwrap_or(&PLATFORMS[0]));
        let named = folder.join(format!("{model_identifier}.{EXTENSION}"));
        if named.exists() {
            return (named, None);
        }
        let files = fs::read_dir(&folder).into_iter().flatten().flatten().map(|entry| entry.path());
        let libraries: Vec<PathBuf> =
            files.filter(|file| file.extension().is_some_and(|known| known == EXTENSION)).collect();
        match libraries.as_slice() {
            [only] => {
                let name = only.file_name().unwrap_or_default().to_string_lossy();
                let note = format!(
                    "its library is called {name}, not {model_identifier}.{EXTENSION}; it is the only one"
                );
                (only.clone(), Some(note))
            }
            _ => (named, None),
        }
    }

    /// The `fmuResourceLocation` of `fmi2Instantiate`.
    pub(crate) fn resource_uri(&self) -> String {
        let mut uri = String::from("file://");
        let path = self.folder.path().join("resources");
        let text = path.to_string_lossy().replace('\\', "/");
        if !text.starts_with('/') {
            uri.push('/');
        }
        for byte in text.bytes() {
            match byte {
                b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'-' | b'_' | b'.' | b'~' | b':' => {
                    uri.push(byte as char)
                }
                other => uri.push_str(&format!("%{other:02X}")),
            }
        }
        uri
    }
}

type Zip = zip::ZipArchive<io::BufReader<File>>;

/// An entry, or its name and why it can't be read: it is encrypted, say.
fn entry(zip: &mut Zip, index: usize) -> Result<zip::read::ZipFile<'_, io::BufReader<File>>, String> {
    let name = zip.name_for_index(index).and_then(Result::ok).map(|name| name.into_owned());
    zip.by_index(index).map_err(|error| format!("{}: {error}", name.unwrap_or_default()))
}

/// Whether what a run needs of an archive is more than is taken, by its own directory: then nothing is unpacked. One that says less than
/// there is meets the limit later.
fn not_too_much(zip: &mut Zip, limits: Limits) -> Result<(), String> {
    if zip.decompressed_size().is_some_and(|all| all <= u128::from(limits.unpacked)) {
        return Ok(());
    }
    let mut left = limits.unpacked;
    for index in 0..zip.len() {
        let entry = zip.by_index_raw(index).map_err(|error| error.to_string())?;
        let Some(name) = entry.enclosed_name().filter(|name| is_wanted(name, &mut Vec::new())) else {
            continue;
        };
        left = left.checked_sub(entry.size()).ok_or_else(|| too_much(&name, limits))?;
    }
    Ok(())
}

fn too_much(name: &Path, limits: Limits) -> String {
    let what = format!("what it unpacks to, as far as {},", name.display());
    limits::exceeded(&what, limits.unpacked, limits::UNPACKED)
}

/// Whether the very library that is loaded is a link. Links beside it, as from one version's name to another's, may be nobody's.
fn no_link(links: &[PathBuf], description: &Description) -> Result<(), String> {
    let library = format!("{}.{EXTENSION}", description.co_simulation.model_identifier);
    let is_it = |name: &&PathBuf| {
        name.starts_with("binaries") && name.file_name().is_some_and(|file| file.to_string_lossy() == library)
    };
    let told = |link: &PathBuf| {
        let link = link.display();
        format!(
            "{link} is a symbolic link, and links in an archive are not followed: pack the file that it leads to"
        )
    };
    links.iter().find(is_it).map_or(Ok(()), |link| Err(told(link)))
}

/// Whether a run needs the file of this name; adds the platform that it is for, if that is a new one.
fn is_wanted(name: &Path, platforms: &mut Vec<String>) -> bool {
    let mut parts = name.components().filter_map(|part| part.as_os_str().to_str());
    match (parts.next(), parts.next()) {
        (Some("resources"), _) => true,
        (Some("binaries"), Some(platform)) => {
            if !platforms.iter().any(|known| known == platform) {
                platforms.push(platform.to_owned());
            }
            PLATFORMS.contains(&platform)
        }
        _ => false,
    }
}

fn not_too_deep(name: &Path) -> Result<(), String> {
    let folders = name.components().count() - 1;
    if folders <= DEEPEST {
        return Ok(());
    }
    let told: String = name.to_string_lossy().chars().take(60).collect();
    Err(format!("{told}… lies in {folders} folders; expected at most {DEEPEST}, one in the other"))
}

/// Reads a description, of which so many bytes are taken.
fn described(path: &Path, entry: &mut impl Read, most: u64) -> Result<Description, Error> {
    // One byte more than allowed tells a file that is longer.
    let mut text = entry.take(most.saturating_add(1));
    let description = Description::read(&mut text);
    // As far as its end, where the archive's checksum is looked at.
    let rest = io::copy(&mut text, &mut io::sink());
    if text.limit() == 0 {
        let reason = limits::exceeded("modelDescription.xml", most, limits::DESCRIPTION);
        return Err(Error::Archive { path: path.into(), reason });
    }
    let description =
        description.map_err(|(line, what)| Error::Description { path: path.into(), line, what });
    let broken =
        |error| Error::Archive { path: path.into(), reason: format!("modelDescription.xml: {error}") };
    description.and_then(|description| rest.map(|_| description).map_err(broken))
}

fn write(path: &Path, from: &mut impl Read) -> io::Result<u64> {
    if let Some(parent) = path.parent() {
        fs::create_dir_all(parent)?;
    }
    io::copy(from, &mut File::create(path)?)
}

#[cfg(test)]
mod tests {
    use super::{Archive, Limits};
    use crate::package::pack;

    const DESCRIPTION: &str = "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"m\" guid=\"g\">\
        <CoSimulation modelIdentifier=\"m\"/><ModelVariables/><ModelStructure/></fmiModelDescription>";

    #[test]
    fn bad_input_a_library_that_is_a_link_is_told() {
        let path = tempfile::NamedTempFile::new().expect("a temporary file").into_temp_path();
        let packed = |link: &str| {
            let options = zip::write::SimpleFileOptions::default();
            let file = std::fs::File::create(&path).expect("writable");
            let mut zip = zip::ZipWriter::new(file);
            zip.start_file("modelDescription.xml", options).expect("packed");
            std::io::Write::write_all(&mut zip, DESCRIPTION.as_bytes()).expect("packed");
            zip.add_symlink(link, "other.so", options).expect("packed");
            zip.finish().expect("packed");
            Archive::unpack(&path).map(drop).map_err(|error| error.to_string())
        };
        let library = format!("binaries/{}/m.{}", super::PLATFORMS[0], super::EXTENSION);
        let told = packed(&library).expect_err("a link");
        assert!(told.contains(&library) && told.contains("is a symbolic link, and links"), "{told}");
        // What lies beside it may be of use to nobody.
        assert_eq!(packed(&library.replace("/m.", "/libother.")), Ok(()));
    }

    #[test]
    fn law_a_unit_unpacks_just_as_much_as_it_may() {
        let path = tempfile::NamedTempFile::new().expect("a temporary file").into_temp_path();
        let files = [
            ("modelDescription.xml", DESCRIPTION.as_bytes()),
            ("resources/a.txt", b"12345"),
            ("resources/b.txt", b"678"),
            ("documentation/c.txt", b"not unpacked"),
        ];
        let files = files.map(|(name, bytes)| (name.to_owned(), bytes.to_vec()));
        std::fs::write(&path, pack(&files.into()).expect("packed")).expect("writable");
        let just = Limits { unpacked: 8, entries: 4, description: DESCRIPTION.len() as u64 };
        let (archive, description) = Archive::unpack_within(&path, just).expect("just");
        assert_eq!(description.guid, "g");
        assert_eq!(std::fs::read(archive.folder.path().join("resources/b.txt")).expect("there"), b"678");
        assert!(!archive.folder.path().join("documentation").exists());
        // Refused by its directory, before anything is unpacked; what is not unpacked doesn't count.
        let not_too_much = |unpacked: u64| {
            let file = std::io::BufReader::new(std::fs::File::open(&path).expect("there"));
            let mut zip = zip::ZipArchive::new(file).expect("a zip");
            super::not_too_much(&mut zip, Limits { unpacked, ..just })
        };
        assert_eq!(not_too_much(8), Ok(()));
        assert!(not_too_much(7).is_err_and(|told| told.contains("as far as resources/b.txt, exceeds")));
        for (less, told) in [
            (Limits { unpacked: 7, ..just }, "as far as resources/b.txt, exceeds the limit of 7;"),
            (Limits { entries: 3, ..just }, "the number of its entries, 4, exceeds the limit of 3;"),
            (
                Limits { description: just.description - 1, ..just },
                "modelDescription.xml exceeds the limit of",
            ),
        ] {
            let error = Archive::unpack_within(&path, less).map(drop).expect_err(told).to_string();
            assert!(error.contains(told), "{error}");
        }
    }
}
