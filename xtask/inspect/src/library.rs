//! What a shared library says of itself: processor, exports, the libraries it needs and their versions. ELF, PE and
//! Mach-O, one or universal, read by the crate `object`.

use object::read::elf::ElfFile64;
use object::read::macho::{FatArch as _, MachOFatFile32, MachOFile64};
use object::{Architecture, Endianness, File, FileKind, Object as _, ObjectSymbol as _};
use std::fmt::Display;

/// A library for one processor.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Library {
    /// Processor, by Rust's name.
    pub machine: String,
    /// Names of the exported functions, without the underscore that Mach-O puts before them.
    pub exports: Vec<String>,
    /// Libraries that the loader must find, sorted.
    pub libraries: Vec<String>,
    /// The newest version of the GNU C library that is asked for; 0.0 if none.
    pub glibc: (u32, u32),
    /// Functions of ELF that must be there, but of no library's version: what it was linked against lacks them.
    pub unknown: Vec<String>,
    /// The macOS that is asked for.
    pub macos: Option<(u32, u32)>,
}

impl Library {
    /// What it needs, in words.
    pub fn needs(&self) -> String {
        let mut words = self.libraries.join(", ");
        if self.glibc > (0, 0) {
            words.push_str(&format!(" (GLIBC_{}.{})", self.glibc.0, self.glibc.1));
        }
        if let Some((major, minor)) = self.macos {
            words.push_str(&format!(" (macOS {major}.{minor})"));
        }
        words
    }
}

fn text(error: impl Display) -> String {
    error.to_string()
}

/// Reads a library: one part, or one for each processor of a universal one.
pub fn read(bytes: &[u8]) -> Result<Vec<Library>, String> {
    match FileKind::parse(bytes).map_err(text)? {
        FileKind::MachOFat32 => {
            let fat = MachOFatFile32::parse(bytes).map_err(text)?;
            let parts = fat.arches().iter().map(|arch| part(arch.data(bytes).map_err(text)?));
            parts.collect()
        }
        FileKind::Elf64 | FileKind::Pe64 | FileKind::MachO64 => Ok(vec![part(bytes)?]),
        other => Err(format!("is of kind {other:?}, which no unit has")),
    }
}

fn part(bytes: &[u8]) -> Result<Library, String> {
    let file = File::parse(bytes).map_err(text)?;
    let machine = match file.architecture() {
        Architecture::X86_64 => "x86_64".to_owned(),
        Architecture::Aarch64 => "aarch64".to_owned(),
        other => format!("{other:?}"),
    };
    let names = file.exports().map_err(text)?;
    let exports = names.iter().map(|export| {
        let name = String::from_utf8_lossy(export.name());
        name.strip_prefix('_').filter(|_| matches!(file, File::MachO64(_))).unwrap_or(&name).to_owned()
    });
    let mut library = Library { machine, exports: exports.collect(), ..Library::default() };
    match &file {
        File::Elf64(elf) => needs_of_elf(elf, &mut library)?,
        File::MachO64(macho) => needs_of_macho(macho, &mut library)?,
        other => {
            let imports = other.imports().map_err(text)?;
            library.libraries = imports.iter().map(|import| lossy(import.library())).collect();
        }
    }
    library.libraries.sort();
    library.libraries.dedup();
    Ok(library)
}

fn lossy(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The libraries of the dynamic section, and the newest `GLIBC_x.y` among the wanted versions.
fn needs_of_elf(elf: &ElfFile64<'_, Endianness>, library: &mut Library) -> Result<(), String> {
    let (endian, data, sections) = (elf.endian(), elf.data(), elf.elf_section_table());
    let table = sections.dynamic_table(endian, data).map_err(text)?;
    for entry in table.iter().filter(|entry| entry.tag == object::elf::DT_NEEDED) {
        library.libraries.push(lossy(table.string(entry).map_err(text)?));
    }
    library.unknown = unknown_of_elf(elf)?;
    let Some((mut needs, link)) = sections.gnu_verneed(endian, data).map_err(text)? else { return Ok(()) };
    let strings = sections.strings(endian, data, link).map_err(text)?;
    while let Some((_, mut versions)) = needs.next().map_err(text)? {
        while let Some(version) = versions.next().map_err(text)? {
            let name = lossy(version.name(endian, strings).map_err(text)?);
            if let Some(number) = name.strip_prefix("GLIBC_").and_then(major_minor) {
                library.glibc = library.glibc.max(number);
            }
        }
    }
    Ok(())
}

/// What is neither here nor of any version of a library, and not weak: a linker lets it pass in a shared library, and a loader doesn't.
fn unknown_of_elf(elf: &ElfFile64<'_, Endianness>) -> Result<Vec<String>, String> {
    let (endian, data, sections) = (elf.endian(), elf.data(), elf.elf_section_table());
    let versions = sections.versions(endian, data).map_err(text)?;
    let mut unknown = Vec::new();
    for symbol in elf.dynamic_symbols().filter(|symbol| symbol.is_undefined() && !symbol.is_weak()) {
        let version = match &versions {
            Some(versions) => {
                versions.version(versions.version_index(endian, symbol.index())).map_err(text)?
            }
            None => None,
        };
        let name = lossy(symbol.name_bytes().map_err(text)?);
        if version.is_none() && !name.is_empty() {
            unknown.push(name);
        }
    }
    Ok(unknown)
}

/// The first two numbers of `2.3.4`.
fn major_minor(text: &str) -> Option<(u32, u32)> {
    let mut numbers = text.split('.').map(str::parse);
    Some((numbers.next()?.ok()?, numbers.next()?.ok()?))
}

/// The load commands: libraries, and the oldest system.
fn needs_of_macho(macho: &MachOFile64<'_, Endianness>, library: &mut Library) -> Result<(), String> {
    let endian = macho.endian();
    let mut commands = macho.macho_load_commands().map_err(text)?;
    while let Some(command) = commands.next().map_err(text)? {
        if let Some(dylib) = command.dylib().map_err(text)? {
            library.libraries.push(lossy(command.string(endian, dylib.dylib.name).map_err(text)?));
        }
        if let Some(version) = command.build_version().map_err(text)? {
            // xxxx.yy.zz in nibbles
            let oldest = version.minos.get(endian);
            library.macos = Some((oldest >> 16, oldest >> 8 & 0xff));
        }
    }
    Ok(())
}
