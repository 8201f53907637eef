//! The `.fmu` file as it lies on the disk: the names in it, the text of the description, what its libraries export.
//! Nothing is unpacked.

use crate::error::Error;
use crate::xml::Fault;
use object::Architecture;
use std::io::{BufReader, Read as _, Seek, SeekFrom};
use std::path::Path;

/// A file of the archive.
#[derive(Debug)]
pub(crate) struct Entry {
    /// As it is written there.
    pub(crate) name: String,
    pub(crate) is_folder: bool,
    pub(crate) is_link: bool,
    /// Its content can't be read: why.
    pub(crate) unreadable: Option<String>,
}

/// A shared library under `binaries/`.
#[derive(Debug)]
pub(crate) struct Binary {
    /// Where it lies.
    pub(crate) name: String,
    /// Folder under `binaries/`.
    pub(crate) platform: String,
    /// Without folder and ending.
    pub(crate) stem: String,
    /// What it exports; an error is why that can't be read.
    pub(crate) exports: Result<Vec<String>, String>,
    /// The processor that it is for, if that can be read.
    pub(crate) processor: Option<Architecture>,
}

/// What is known of the file.
#[derive(Debug)]
pub(crate) struct Archive {
    pub(crate) entries: Vec<Entry>,
    /// How many entries have the very name of another one: readers see one of them only.
    pub(crate) twins: usize,
    pub(crate) binaries: Vec<Binary>,
    /// Some libraries are encrypted: they are there, and not among `binaries`.
    pub(crate) encrypted_libraries: bool,
    /// The description; an error is why there is none, the inner one where it is no text.
    pub(crate) description: Result<Result<String, Fault>, String>,
}

/// Longer descriptions and libraries are not read: a small archive may unpack to any size.
const LONGEST: u64 = 1 << 28;

const DESCRIPTION: &str = "modelDescription.xml";

impl Archive {
    /// Reads a file. The inner error is why it is no archive.
    pub(crate) fn read(path: &Path) -> Result<Result<Self, String>, Error> {
        let file =
            orchestrator::plain::open(path).map_err(|source| Error::File { path: path.into(), source })?;
        let mut file = BufReader::new(file);
        let listed = listed(&mut file).map_err(|source| Error::File { path: path.into(), source })?;
        let mut zip = match zip::ZipArchive::new(file) {
            Ok(zip) => zip,
            Err(error) => return Ok(Err(error.to_string())),
        };
        let mut archive = Self {
            entries: Vec::new(),
            twins: listed.map_or(0, |listed| listed.saturating_sub(zip.len())),
            binaries: Vec::new(),
            encrypted_libraries: false,
            description: Err(format!("it holds no {DESCRIPTION} at its root")),
        };
        for index in 0..zip.len() {
            let (hidden, name) = match zip.by_index_raw(index) {
                Ok(entry) => (entry.encrypted(), String::from_utf8_lossy(entry.name_raw()).into_owned()),
                Err(_) => (false, String::new()),
            };
            match hidden {
                true => archive.add_encrypted(name),
                false => archive.add(name, zip.by_index(index)),
            }
        }
        Ok(Ok(archive))
    }

    /// Its name can be read, what it holds can't.
    fn add_encrypted(&mut self, name: String) {
        if name == DESCRIPTION {
            self.description = Err(format!("{DESCRIPTION} can't be read"));
        }
        self.encrypted_libraries |= library(&name).is_some();
        let is_folder = name.ends_with('/');
        let unreadable =
            Some("it is encrypted, which no master reads: pack it without a password".to_owned());
        self.entries.push(Entry { name, is_folder, is_link: false, unreadable });
    }

    fn add<R: std::io::Read>(
        &mut self,
        name: String,
        entry: zip::result::ZipResult<zip::read::ZipFile<'_, R>>,
    ) {
        let mut entry = match entry {
            Ok(entry) => entry,
            Err(error) => {
                let unreadable = Some(error.to_string());
                return self.entries.push(Entry { name, is_folder: false, is_link: false, unreadable });
            }
        };
        let (name, mut unreadable) = match entry.name() {
            Ok(name) => (name.into_owned(), None),
            Err(error) => (String::from_utf8_lossy(entry.name_raw()).into_owned(), Some(error.to_string())),
        };
        if name == DESCRIPTION {
            self.description = content(&mut entry).map(text);
        } else if let Some((platform, stem)) = library(&name) {
            let bytes = content(&mut entry);
            let processor = bytes.as_ref().ok().and_then(|bytes| processor(bytes));
            let exports = bytes.and_then(|bytes| exports(&bytes));
            let (name, platform, stem) = (name.clone(), platform.to_owned(), stem.to_owned());
            self.binaries.push(Binary { name, platform, stem, exports, processor });
        } else if let Err(error) = entry.read(&mut [0]) {
            unreadable = Some(error.to_string());
        }
        let (is_folder, is_link) = (entry.is_dir(), entry.is_symlink());
        self.entries.push(Entry { name, is_folder, is_link, unreadable });
    }
}

/// The text of a description. Bytes of another encoding have the line at which reading ends.
fn text(bytes: Vec<u8>) -> Result<String, Fault> {
    String::from_utf8(bytes).map_err(|error| {
        let (bytes, good) = (error.as_bytes(), error.utf8_error().valid_up_to());
        let line = 1 + bytes[..good].iter().filter(|&&byte| byte == b'\n').count();
        (
            line,
            format!("the byte 0x{:02X} is no UTF-8: the description must be written in UTF-8", bytes[good]),
        )
    })
}

/// How many entries the archive's own record of its end lists (APPNOTE.TXT 4.3.16): the library keeps one of each name. None where
/// there is no such record, or more than it can count.
fn listed(file: &mut (impl std::io::Read + Seek)) -> std::io::Result<Option<usize>> {
    let length = file.seek(SeekFrom::End(0))?;
    file.seek(SeekFrom::Start(length.saturating_sub(END + LONGEST_COMMENT)))?;
    let mut end = Vec::new();
    file.by_ref().take(END + LONGEST_COMMENT).read_to_end(&mut end)?;
    file.seek(SeekFrom::Start(0))?;
    let record = end.windows(END as usize).rev().find(|bytes| bytes.starts_with(b"PK\x05\x06"));
    let count = record.map(|record| u16::from_le_bytes([record[10], record[11]]));
    Ok(count.filter(|count| *count < u16::MAX).map(usize::from))
}

/// Bytes of the record of the end without its comment, and at most of the comment.
const END: u64 = 22;
const LONGEST_COMMENT: u64 = 0xFFFF;

fn content<R: std::io::Read>(entry: &mut zip::read::ZipFile<'_, R>) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let read = entry.by_ref().take(LONGEST + 1).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    if read as u64 > LONGEST { Err(format!("it is longer than {LONGEST} bytes")) } else { Ok(bytes) }
}

/// Platform and stem of a library: `binaries/PLATFORM/STEM.so`.
fn library(name: &str) -> Option<(&str, &str)> {
    let (platform, file) = name.strip_prefix("binaries/")?.split_once('/')?;
    let (stem, ending) = file.rsplit_once('.')?;
    let is_library = matches!(ending, "so" | "dll" | "dylib") && !file.contains('/');
    is_library.then_some((platform, stem))
}

/// The processor that a library is for; a universal one is for several.
fn processor(bytes: &[u8]) -> Option<Architecture> {
    use object::Object as _;
    Some(object::File::parse(bytes).ok()?.architecture())
}

/// The names that a library exports, without the underscore that Mach-O puts before them.
fn exports(bytes: &[u8]) -> Result<Vec<String>, String> {
    use object::read::macho::{FatArch as _, MachOFatFile32};
    use object::{FileKind, Object as _};
    let text = |error: object::Error| error.to_string();
    let part = match FileKind::parse(bytes).map_err(text)? {
        // All parts of a universal library are built from the same source; the first stands for them.
        FileKind::MachOFat32 => {
            let fat = MachOFatFile32::parse(bytes).map_err(text)?;
            let first = fat.arches().first().ok_or("a universal library without a part")?;
            first.data(bytes).map_err(text)?
        }
        _ => bytes,
    };
    let file = object::File::parse(part).map_err(text)?;
    let bare = |name: &[u8]| {
        let name = String::from_utf8_lossy(name).into_owned();
        match file.format() {
            object::BinaryFormat::MachO => name.strip_prefix('_').map_or(name.clone(), str::to_owned),
            _ => name,
        }
    };
    Ok(file.exports().map_err(text)?.iter().map(|export| bare(export.name())).collect())
}
