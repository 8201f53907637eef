//! Files that people name: only ordinary ones are read. To open a pipe waits for a writer, who may never come, and a device may
//! have no end.

use std::fs::{self, File, FileType};
use std::io;
use std::path::Path;

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
    use super::{open, read_text};

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
