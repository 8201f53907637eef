//! Packages: archives that hold units and what belongs to them, such as `.ssp` files. A file inside is named
//! `package.ssp#resources/unit.fmu`, and a package inside a package by one more `#`. Nothing outside is ever opened:
//! a name is looked up in the archive, never on the disk.

use crate::error::Error;
use crate::fmu::Description;
use crate::fmu::limits::{self, Limits};
use crate::fmu::workshop::Bench;
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek, Write};
use std::path::{Path, PathBuf};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

trait Source: Read + Seek {}
impl<T: Read + Seek> Source for T {}

/// An open package. All that is read of it, packages inside included, counts against one limit.
pub struct Package {
    shown: PathBuf,
    zip: ZipArchive<Box<dyn Source>>,
    /// Bytes that may still be unpacked.
    left: u64,
    limits: Limits,
}

impl Package {
    /// Opens a package; `name` may lead into it: `outer.ssp#resources/inner.ssp`.
    ///
    /// # Errors
    /// If it can't be read, is no archive, or exceeds a limit.
    pub fn open(name: &Path) -> Result<Self, Error> {
        let text = name.to_string_lossy();
        let (file, inside) = match split(&text) {
            Some((file, inside)) => (Path::new(file), inside),
            None => (name, ""),
        };
        let source = crate::plain::open(file).map_err(|source| Error::File { path: file.into(), source })?;
        let limits = Limits::from_environment()?;
        let reader = Box::new(BufReader::new(source));
        let mut package = Self::of(reader, file.into(), limits.unpacked, limits)?;
        for entry in inside.split('#').filter(|entry| !entry.is_empty()) {
            package = package.inner(entry)?;
        }
        Ok(package)
    }

    fn of(reader: Box<dyn Source>, shown: PathBuf, left: u64, limits: Limits) -> Result<Self, Error> {
        let wrong = |reason: String| Error::Package { path: shown.clone(), reason };
        let zip = ZipArchive::new(reader).map_err(|error| wrong(error.to_string()))?;
        if zip.len() as u64 > limits.entries {
            let what = format!("the number of its entries, {},", zip.len());
            return Err(wrong(limits::exceeded(&what, limits.entries, limits::ENTRIES)));
        }
        Ok(Self { shown, zip, left, limits })
    }

    /// The package that is one of this one's files.
    ///
    /// # Errors
    /// As [`Package::open`]; if there is no such file.
    pub fn inner(mut self, entry: &str) -> Result<Self, Error> {
        let file = self.spool(entry)?;
        let shown = PathBuf::from(format!("{}#{entry}", self.shown.display()));
        Self::of(Box::new(BufReader::new(file)), shown, self.left, self.limits)
    }

    /// A file, unpacked into one without a name: however large it is, it takes no memory.
    fn spool(&mut self, entry: &str) -> Result<File, Error> {
        let shown = self.shown.clone();
        let wrong = |error: std::io::Error| Error::Package {
            path: shown.clone(),
            reason: format!("no temporary file for {entry}: {error}"),
        };
        let mut file = tempfile::tempfile().map_err(wrong)?;
        self.copy(entry, self.left, limits::UNPACKED, &mut file)?;
        file.seek(std::io::SeekFrom::Start(0)).map_err(wrong)?;
        Ok(file)
    }

    /// As it is named in messages.
    pub fn path(&self) -> &Path {
        &self.shown
    }

    /// The names of its files.
    pub fn names(&self) -> Vec<String> {
        let names = self.zip.file_names().filter_map(Result::ok).map(|name| name.into_owned());
        names.filter(|name| !name.ends_with('/')).collect()
    }

    /// The bytes of a file.
    ///
    /// # Errors
    /// If there is none of that name, it is damaged, or it exceeds a limit.
    pub fn read(&mut self, entry: &str) -> Result<Vec<u8>, Error> {
        let mut bytes = Vec::new();
        self.copy(entry, self.left, limits::UNPACKED, &mut bytes)?;
        Ok(bytes)
    }

    /// Copies a file of so many bytes at most; `variable` moves the limit.
    fn copy(&mut self, entry: &str, most: u64, variable: &str, to: &mut dyn Write) -> Result<(), Error> {
        let shown = self.shown.clone();
        let wrong = |reason: String| Error::Package { path: shown.clone(), reason };
        let Some(index) = self.zip.index_for_name(entry) else {
            let names = self.names();
            let near = crate::suggest::nearest(entry, names.iter().map(String::as_str));
            return Err(wrong(format!("it holds no {entry:?}: {near}")));
        };
        let mut file = self.zip.by_index(index).map_err(|error| wrong(format!("{entry}: {error}")))?;
        // One byte more than allowed tells a file that is longer.
        let copied = std::io::copy(&mut file.by_ref().take(most.saturating_add(1)), to);
        let copied = copied.map_err(|error| match crate::machine::is_no_room(&error) {
            true => crate::error::unpack(&shown, &error),
            false => wrong(format!("{entry}: {error}")),
        })?;
        if copied > most {
            let (what, limit) = match variable {
                limits::UNPACKED => (format!("what it unpacks to, as far as {entry},"), self.limits.unpacked),
                _ => (entry.to_owned(), most),
            };
            return Err(wrong(limits::exceeded(&what, limit, variable)));
        }
        self.left = self.left.saturating_sub(copied);
        Ok(())
    }

    /// What a unit says of itself that is one of the files.
    ///
    /// # Errors
    /// As [`Package::read`]; if it is no unit.
    pub fn describe(&mut self, entry: &str) -> Result<Description, Error> {
        let file = self.spool(entry)?;
        let shown = PathBuf::from(format!("{}#{entry}", self.shown.display()));
        let mut unit = Self::of(Box::new(BufReader::new(file)), shown.clone(), self.left, self.limits)?;
        let text = unit.read_text("modelDescription.xml")?;
        Description::parse(&text).map_err(|(line, what)| Error::Description { path: shown, line, what })
    }

    /// A text file that is a description: it has a limit of its own, since it is read as a whole tree.
    ///
    /// # Errors
    /// As [`Package::read`]; if it is no UTF-8.
    pub fn read_text(&mut self, entry: &str) -> Result<String, Error> {
        let mut bytes = Vec::new();
        match self.left < self.limits.description {
            true => self.copy(entry, self.left, limits::UNPACKED, &mut bytes)?,
            false => self.copy(entry, self.limits.description, limits::DESCRIPTION, &mut bytes)?,
        }
        let wrong = |reason: String| Error::Package { path: self.shown.clone(), reason };
        String::from_utf8(bytes).map_err(|error| wrong(format!("{entry}: {error}")))
    }
}

/// A file of a package, unpacked. It vanishes when this is dropped.
#[derive(Debug)]
pub(crate) struct Unpacked {
    _bench: Bench,
    pub(crate) path: PathBuf,
}

/// Whether a name leads into a package, and to which file.
pub(crate) fn split(name: &str) -> Option<(&str, &str)> {
    let at = name.find(".ssp#")?;
    Some((&name[..at + 4], &name[at + 5..]))
}

/// Unpacks the file of a package under its own last name.
pub(crate) fn unpack(package: &Path, inside: &str) -> Result<Unpacked, Error> {
    let (outer, entry) = match inside.rfind(".ssp#") {
        Some(at) => {
            (PathBuf::from(format!("{}#{}", package.display(), &inside[..at + 4])), &inside[at + 5..])
        }
        None => (package.to_owned(), inside),
    };
    let mut package = Package::open(&outer)?;
    let wrong = |reason: String| Error::Package { path: outer.clone(), reason };
    let bench = Bench::new().map_err(|error| crate::error::unpack(&outer, &error))?;
    let name = Path::new(entry).file_name().unwrap_or_else(|| "unit.fmu".as_ref());
    let path = bench.path().join(name);
    let mut file = File::create(&path).map_err(|error| wrong(format!("{}: {error}", path.display())))?;
    package.copy(entry, package.left, limits::UNPACKED, &mut file)?;
    Ok(Unpacked { _bench: bench, path })
}

/// The bytes of an archive of which the same content always has the same bytes: names sorted, no time stamps. Libraries
/// may be executed, since some masters unpack with the modes given.
///
/// # Errors
/// If a name is none for an archive.
pub fn pack(files: &std::collections::BTreeMap<String, Vec<u8>>) -> std::io::Result<Vec<u8>> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in files {
        let mode = if name.starts_with("binaries/") { 0o755 } else { 0o644 };
        // What is compressed already is stored.
        let packed = [".fmu", ".ssp", ".png"].iter().any(|ending| name.ends_with(ending));
        let method = if packed { CompressionMethod::Stored } else { CompressionMethod::Deflated };
        let options = SimpleFileOptions::default()
            .compression_method(method)
            .last_modified_time(DateTime::default()) // 1980-01-01, the earliest there is
            .unix_permissions(mode);
        writer.start_file(name.as_str(), options).map_err(std::io::Error::other)?;
        writer.write_all(content)?;
    }
    Ok(writer.finish().map_err(std::io::Error::other)?.into_inner())
}

#[cfg(test)]
mod tests {
    use super::{Package, pack, split, unpack};
    use crate::error::Error;
    use crate::fmu::limits::Limits;
    use std::collections::BTreeMap;
    use std::io::Cursor;

    fn files(list: &[(&str, &[u8])]) -> BTreeMap<String, Vec<u8>> {
        list.iter().map(|(name, bytes)| ((*name).to_owned(), bytes.to_vec())).collect()
    }

    #[test]
    fn value_names_lead_into_packages() {
        assert_eq!(split("a/b.ssp#resources/c.fmu"), Some(("a/b.ssp", "resources/c.fmu")));
        assert_eq!(split("b.ssp#c.ssp#d.fmu"), Some(("b.ssp", "c.ssp#d.fmu")));
        assert_eq!(split("a#b.fmu"), None);
    }

    #[test]
    fn law_files_are_found_in_packages_within_packages_and_nowhere_else() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let secret = folder.path().join("secret.fmu");
        std::fs::write(&secret, b"outside").expect("writable");
        let inner = pack(&files(&[("x/u.fmu", b"inner")])).expect("packed");
        let list: &[(&str, &[u8])] = &[("in.ssp", &inner), ("r/u.fmu", b"outer")];
        let path = folder.path().join("out.ssp");
        std::fs::write(&path, pack(&files(list)).expect("packed")).expect("writable");
        assert_eq!(pack(&files(list)).expect("packed"), std::fs::read(&path).expect("readable"));
        for (inside, bytes) in [("r/u.fmu", &b"outer"[..]), ("in.ssp#x/u.fmu", b"inner")] {
            let unpacked = unpack(&path, inside).expect(inside);
            assert_eq!(std::fs::read(&unpacked.path).expect("unpacked"), bytes);
            assert!(unpacked.path.ends_with("u.fmu"));
        }
        for wrong in ["../secret.fmu", "secret.fmu", secret.to_str().expect("UTF-8"), "r/../r/u.fmu"] {
            let told = unpack(&path, wrong).expect_err(wrong).to_string();
            assert!(told.contains("out.ssp: it holds no"), "{told}");
        }
        let mut package = Package::open(&path).expect("opens");
        assert_eq!(package.names(), ["in.ssp", "r/u.fmu"]);
        assert!(package.read("r/v.fmu").expect_err("not there").to_string().contains("r/u.fmu"));
    }

    #[test]
    fn law_a_package_unpacks_just_as_much_as_it_may() {
        let bytes =
            pack(&files(&[("a.txt", b"12345"), ("b.txt", b"678"), ("c.txt", b"\xff")])).expect("packed");
        let open = |unpacked: u64, entries: u64, description: u64| {
            let limits = Limits { unpacked, entries, description };
            Package::of(Box::new(Cursor::new(bytes.clone())), "x.ssp".into(), unpacked, limits)
        };
        let told = |error: Option<Error>| error.expect("refused").to_string();
        // All files together, each read as often as it is.
        let mut package = open(8, 3, 100).expect("opens");
        assert_eq!(package.read("a.txt").expect("five"), b"12345");
        assert_eq!(package.read("b.txt").expect("eight"), b"678");
        let error = told(package.read("b.txt").err());
        assert!(error.contains("what it unpacks to, as far as b.txt, exceeds the limit of 8;"), "{error}");
        let error = told(open(8, 2, 100).err());
        assert!(error.contains("the number of its entries, 3, exceeds the limit of 2;"), "{error}");
        // A text has a limit of its own, unless less than that is left.
        assert_eq!(open(100, 3, 5).expect("opens").read_text("a.txt").expect("just"), "12345");
        let error = told(open(100, 3, 4).expect("opens").read_text("a.txt").err());
        assert!(
            error.contains("a.txt exceeds the limit of 4;") && error.contains("_DESCRIPTION="),
            "{error}"
        );
        let error = told(open(4, 3, 5).expect("opens").read_text("a.txt").err());
        assert!(error.contains("as far as a.txt, exceeds the limit of 4;"), "{error}");
        assert!(
            told(open(9, 3, 9).expect("opens").read_text("c.txt").err()).contains("c.txt: invalid utf-8")
        );
    }
}
