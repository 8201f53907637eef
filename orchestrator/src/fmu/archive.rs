//! The `.fmu` file: a zip archive, unpacked into a folder that lives as long as anything loaded from it.
//!
//! Only what a run needs is unpacked: the description, the resources and this platform's binaries.

use crate::error::Error;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Folder under `binaries/` for this platform (FMI 2.0 section 2.3).
pub(crate) const PLATFORM: &str = if cfg!(target_os = "windows") {
    if cfg!(target_pointer_width = "64") { "win64" } else { "win32" }
} else if cfg!(target_os = "macos") {
    "darwin64"
} else if cfg!(target_pointer_width = "64") {
    "linux64"
} else {
    "linux32"
};

/// File extension of a shared library.
pub(crate) const EXTENSION: &str = std::env::consts::DLL_EXTENSION;

/// An unpacked unit. Dropping it deletes the folder.
#[derive(Debug)]
pub(crate) struct Archive {
    folder: TempDir,
    /// Text of `modelDescription.xml`.
    pub(crate) description: String,
    /// Platforms for which the archive holds binaries.
    pub(crate) platforms: Vec<String>,
}

impl Archive {
    pub(crate) fn unpack(path: &Path) -> Result<Self, Error> {
        let file = File::open(path).map_err(|source| Error::File { path: path.into(), source })?;
        let broken = |reason: String| Error::Archive { path: path.into(), reason };
        let mut zip = zip::ZipArchive::new(io::BufReader::new(file)).map_err(|e| broken(e.to_string()))?;
        let folder = TempDir::with_prefix("fmu-").map_err(|e| broken(format!("no temporary folder: {e}")))?;
        let mut description = None;
        let mut platforms = Vec::new();
        for index in 0..zip.len() {
            let mut entry = zip.by_index(index).map_err(|e| broken(e.to_string()))?;
            if entry.is_dir() {
                continue;
            }
            // A name that leads out of the folder is nobody's resource.
            let Some(name) = entry.enclosed_name() else { continue };
            if name == Path::new("modelDescription.xml") {
                let mut bytes = Vec::new();
                entry.read_to_end(&mut bytes).map_err(|e| broken(format!("modelDescription.xml: {e}")))?;
                description =
                    Some(String::from_utf8(bytes).map_err(|e| broken(format!("modelDescription.xml: {e}")))?);
                continue;
            }
            let mut parts = name.components().filter_map(|part| part.as_os_str().to_str());
            let wanted = match (parts.next(), parts.next()) {
                (Some("resources"), _) => true,
                (Some("binaries"), Some(platform)) => {
                    if !platforms.iter().any(|known| known == platform) {
                        platforms.push(platform.to_owned());
                    }
                    platform == PLATFORM
                }
                _ => false,
            };
            if wanted {
                write(&folder.path().join(&name), &mut entry)
                    .map_err(|e| broken(format!("{}: {e}", name.display())))?;
            }
        }
        // The standard hands out the folder whether the unit has resources or not.
        fs::create_dir_all(folder.path().join("resources")).map_err(|e| broken(e.to_string()))?;
        let description = description.ok_or_else(|| broken("it holds no modelDescription.xml".into()))?;
        Ok(Self { folder, description, platforms })
    }

    /// Where the library of a model lies.
    pub(crate) fn library(&self, model_identifier: &str) -> PathBuf {
        self.folder.path().join("binaries").join(PLATFORM).join(format!("{model_identifier}.{EXTENSION}"))
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

fn write(path: &Path, from: &mut impl Read) -> io::Result<()> {
    if let Some(parent) = path.parent() {
        fs::create_dir_all(parent)?;
    }
    io::copy(from, &mut File::create(path)?)?;
    Ok(())
}
