//! Archives of which the same content always has the same bytes: sorted names, no time stamps.

use crate::{Result, at};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{Cursor, Read, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

/// Names and contents.
pub type Entries = BTreeMap<String, Vec<u8>>;

/// The bytes of an archive. Libraries may be executed, since some masters unpack with the modes given.
pub fn to_bytes(entries: &Entries) -> Result<Vec<u8>> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in entries {
        let mode = if name.starts_with("binaries/") { 0o755 } else { 0o644 };
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default()) // 1980-01-01, the earliest there is
            .unix_permissions(mode);
        writer.start_file(name.as_str(), options)?;
        writer.write_all(content)?;
    }
    Ok(writer.finish()?.into_inner())
}

/// Reads an archive whole.
pub fn read(path: &Path) -> Result<Entries> {
    let named = |error| format!("{}: {error}", path.display());
    let mut archive =
        ZipArchive::new(at(path, File::open(path))?).map_err(|error| named(error.to_string()))?;
    let mut entries = Entries::new();
    for index in 0..archive.len() {
        let mut file = archive.by_index(index).map_err(|error| named(error.to_string()))?;
        if file.is_file() {
            let mut content = Vec::new();
            at(path, file.read_to_end(&mut content))?;
            let name = file.name().map_err(|error| named(error.to_string()))?.into_owned();
            entries.insert(name, content);
        }
    }
    Ok(entries)
}

/// Writes a file unless it already has this content, and never leaves half of one.
pub fn write_if_changed(path: &Path, content: &[u8]) -> Result<()> {
    if fs::read(path).is_ok_and(|old| old == content) {
        return Ok(());
    }
    let folder = path.parent().unwrap_or(Path::new("."));
    at(folder, fs::create_dir_all(folder))?;
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.new", std::process::id()));
    let new = path.with_file_name(name);
    at(&new, fs::write(&new, content))?;
    at(path, fs::rename(&new, path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_an_archive_reads_back_and_has_the_same_bytes_each_time() {
        let entries = Entries::from([("b/x".to_owned(), vec![1, 2, 3]), ("a".to_owned(), b"text".to_vec())]);
        let bytes = to_bytes(&entries).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sub").join("one.fmu");
        write_if_changed(&path, &bytes).unwrap();
        assert_eq!(read(&path).unwrap(), entries);
        let written = fs::metadata(&path).unwrap().modified().unwrap();
        write_if_changed(&path, &to_bytes(&read(&path).unwrap()).unwrap()).unwrap();
        assert_eq!(fs::metadata(&path).unwrap().modified().unwrap(), written, "nothing was rewritten");
        assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1, "no temporary file is left");
    }
}
