//! Files that people name: only ordinary ones are read. To open a pipe waits for a writer, who may never come, and a device may
//! have no end. What is written is whole or not there.

use std::fs::{self, File, FileType};
use std::io;
use std::path::{Component, Path, PathBuf};

/// Opens an ordinary file.
///
/// # Errors
/// If there is none, it can't be read, or it is something else: a folder, a pipe, a device.
pub fn open(path: &Path) -> io::Result<File> {
    let is = fs::metadata(path)?.file_type();
    if is.is_file() {
        return File::open(path);
    }
    let text = format!("it is {}, not a file; expected an ordinary file", what(is));
    Err(io::Error::new(io::ErrorKind::InvalidInput, text))
}

/// All of an ordinary file, which is a text.
///
/// # Errors
/// As of [`open`]; if it is no UTF-8, with the line that isn't.
pub fn read_text(path: &Path) -> io::Result<String> {
    String::from_utf8(read(path)?).map_err(|refused| {
        let good = refused.utf8_error().valid_up_to();
        let line = 1 + refused.as_bytes()[..good].iter().filter(|byte| **byte == b'\n').count();
        let byte = refused.as_bytes()[good];
        let text = format!(
            "line {line}: the byte 0x{byte:02x} there is no UTF-8; expected a text file, saved as UTF-8"
        );
        io::Error::new(io::ErrorKind::InvalidData, text)
    })
}

/// All of an ordinary file.
///
/// # Errors
/// As of [`open`].
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    io::Read::read_to_end(&mut open(path)?, &mut bytes)?;
    Ok(bytes)
}

/// Whether a name leads out of the folder that it is looked for in.
pub fn leaves(name: &Path) -> bool {
    let mut depth = Some(0_usize);
    for part in name.components() {
        depth = match part {
            Component::Normal(_) => depth.map(|depth| depth + 1),
            Component::CurDir => depth,
            Component::ParentDir => depth.and_then(|depth| depth.checked_sub(1)),
            Component::RootDir | Component::Prefix(_) => None,
        };
    }
    depth.is_none()
}

/// The name beside a file under which it is written before it gets its own.
pub fn beside(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".new");
    path.with_file_name(name)
}

/// Writes a file that is whole or not there, in the place of the one before, even if this ends in the middle.
///
/// # Errors
/// If it can't be written; the one before then stays, and nothing is left beside it.
pub fn write_whole(path: &Path, write: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
    let new = beside(path);
    // what lies there was cut off, or is a link that somebody put there: it is not written through
    let gone = match fs::remove_file(&new) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    };
    let written = gone.and_then(|()| File::create_new(&new)).and_then(|mut file| {
        write(&mut file)?;
        file.sync_all()
    });
    let named = written.and_then(|()| fs::rename(&new, path));
    if named.is_err() {
        let _ = fs::remove_file(&new);
    }
    named
}

fn what(is: FileType) -> &'static str {
    if is.is_dir() {
        return "a folder";
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt as _;
        if is.is_fifo() {
            return "a pipe";
        }
        if is.is_char_device() || is.is_block_device() {
            return "a device";
        }
        if is.is_socket() {
            return "a socket";
        }
    }
    "something else"
}

#[cfg(all(test, unix))]
mod tests {
    use super::{beside, open, read_text, write_whole};

    #[test]
    fn law_a_file_is_written_whole_or_stays_as_it_was() {
        use std::io::Write as _;
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("log.csv");
        write_whole(&path, |file| file.write_all(b"first")).expect("written");
        let full = || Err(std::io::Error::from(std::io::ErrorKind::StorageFull));
        write_whole(&path, |file| file.write_all(b"sec").and_then(|()| full())).expect_err("full");
        assert_eq!(read_text(&path).expect("there"), "first");
        assert!(!beside(&path).exists());
        let mine = folder.path().join("mine");
        write_whole(&mine, |file| file.write_all(b"mine")).expect("written");
        std::os::unix::fs::symlink(&mine, beside(&path)).expect("a link");
        write_whole(&path, |file| file.write_all(b"second")).expect("written");
        let both = [&path, &mine].map(|path| read_text(path).expect("there"));
        assert_eq!(both, ["second", "mine"], "nothing is written through a link");
    }

    #[test]
    fn every_thing_that_is_no_file_is_called_by_its_name() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let at = |name: &str| folder.path().join(name);
        let told = |path: &std::path::Path| open(path).map(drop).expect_err("no file").to_string();
        assert_eq!(told(folder.path()), "it is a folder, not a file; expected an ordinary file");
        assert_eq!(told("/dev/null".as_ref()), "it is a device, not a file; expected an ordinary file");
        let _socket = std::os::unix::net::UnixListener::bind(at("socket")).expect("bound");
        assert_eq!(told(&at("socket")), "it is a socket, not a file; expected an ordinary file");
        assert!(std::process::Command::new("mkfifo").arg(at("pipe")).status().expect("of POSIX").success());
        assert_eq!(told(&at("pipe")), "it is a pipe, not a file; expected an ordinary file");
        std::fs::write(at("file"), "text").expect("writable");
        assert_eq!(read_text(&at("file")).expect("a file"), "text");
        std::fs::write(at("latin-1"), b"one\ntw\xf6\n").expect("writable");
        let told = read_text(&at("latin-1")).expect_err("no UTF-8").to_string();
        assert_eq!(told, "line 2: the byte 0xf6 there is no UTF-8; expected a text file, saved as UTF-8");
        assert_eq!(open(&at("none")).map(drop).expect_err("none").kind(), std::io::ErrorKind::NotFound);
    }
}
