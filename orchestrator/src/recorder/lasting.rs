//! A file of results that outlives what units do to the process: one that closes all descriptors, or puts its own in their
//! place, as programs do that go on in the background, costs no row.

#![allow(unsafe_code)] // descriptors, looked at as numbers

use std::ffi::{CString, c_int};
use std::fs::File;
use std::io::{self, Seek as _};
use std::mem::ManuallyDrop;
use std::os::fd::{AsRawFd as _, FromRawFd as _, IntoRawFd as _};
use std::os::unix::ffi::OsStrExt as _;
use std::path::{Path, PathBuf};

/// Which file it is, and where.
#[derive(Debug)]
pub(super) struct Lasting {
    descriptor: c_int,
    /// Absolute: units may change the working folder.
    path: CString,
    /// Device and number on it.
    identity: (u64, u64),
}

impl Lasting {
    /// Of a file that was just opened.
    pub(super) fn new(path: &Path, file: &File) -> io::Result<Self> {
        let path = std::path::absolute(path)?;
        let path = CString::new(path.as_os_str().as_bytes())?;
        let descriptor = file.as_raw_fd();
        let identity = identity(descriptor).ok_or_else(io::Error::last_os_error)?;
        Ok(Self { descriptor, path, identity })
    }

    /// The file, if it had to be opened again; `written` bytes of it count.
    pub(super) fn found(&mut self, written: u64) -> io::Result<Option<File>> {
        if identity(self.descriptor) == Some(self.identity) {
            return Ok(None);
        }
        fill_standard_places();
        let path = PathBuf::from(std::ffi::OsStr::from_bytes(self.path.to_bytes()));
        let mut file = File::options().write(true).open(path)?;
        self.descriptor = file.as_raw_fd();
        if identity(self.descriptor) != Some(self.identity) {
            return Err(io::Error::other("a unit has closed it, and another file has its name now"));
        }
        file.set_len(written)?;
        file.seek(io::SeekFrom::End(0))?;
        Ok(Some(file))
    }

    /// Takes off what lies beyond these bytes; if that can't be done, it stays.
    pub(super) fn cut_at(&self, written: u64) {
        if let (true, Ok(length)) = (identity(self.descriptor) == Some(self.identity), i64::try_from(written))
        {
            // SAFETY: plain values.
            unsafe { libc::ftruncate(self.descriptor, length) };
        }
    }

    /// Waits until it is on the disk.
    pub(super) fn sync(&self) -> io::Result<()> {
        // SAFETY: a number; if a unit has closed it, this is an error. It is not closed here.
        let file = ManuallyDrop::new(unsafe { File::from_raw_fd(self.descriptor) });
        file.sync_data()
    }

    /// Writes at its end, in a process that is about to end: calls only what a signal handler may. What can't be written is lost.
    pub(super) fn append(&self, bytes: &[u8]) {
        // SAFETY: a path that ends in zero, bytes that are there, plain values.
        unsafe {
            let mut descriptor = self.descriptor;
            if identity(descriptor) != Some(self.identity) {
                descriptor =
                    libc::open(self.path.as_ptr(), libc::O_WRONLY | libc::O_APPEND | libc::O_CLOEXEC);
                if identity(descriptor) != Some(self.identity) {
                    return;
                }
            }
            libc::write(descriptor, bytes.as_ptr().cast(), bytes.len());
        }
    }
}

/// Device and number of what a descriptor stands for.
fn identity(descriptor: c_int) -> Option<(u64, u64)> {
    // SAFETY: the structure is plain data, which the call fills.
    unsafe {
        let mut of: libc::stat = std::mem::zeroed();
        #[allow(clippy::unnecessary_cast, clippy::cast_sign_loss)] // other systems have other types
        (libc::fstat(descriptor, &mut of) == 0).then_some((of.st_dev as u64, of.st_ino as u64))
    }
}

/// Where standard input, output and error are closed, nothing else may take their places: notes would be written into it.
fn fill_standard_places() {
    while let Ok(nothing) = File::options().read(true).write(true).open("/dev/null") {
        let place = nothing.into_raw_fd();
        if place > 2 {
            // SAFETY: opened above, by nobody else.
            unsafe { libc::close(place) };
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write as _;

    #[test]
    fn law_half_a_row_is_taken_off_and_another_file_is_left_alone() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("results.csv");
        let mut file = File::create(&path).expect("made");
        let lasting = Lasting::new(&path, &file).expect("a file");
        file.write_all(b"time\n0.5\n0.").expect("written");
        lasting.cut_at(9);
        assert_eq!(std::fs::read(&path).expect("there"), b"time\n0.5\n");
        // Its number is another file's by now.
        let other = folder.path().join("other");
        std::fs::write(&other, b"whole").expect("written");
        let theirs = File::options().write(true).open(&other).expect("there");
        let lasting = Lasting { descriptor: theirs.as_raw_fd(), ..lasting };
        lasting.cut_at(1);
        assert_eq!(std::fs::read(&other).expect("there"), b"whole");
    }

    #[test]
    fn law_a_closed_file_is_found_again_unless_another_one_has_its_name() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("results.csv");
        std::fs::write(&path, b"time\n0.5\n0.").expect("written");
        let file = File::open(&path).expect("there");
        let mut lasting = Lasting::new(&path, &file).expect("a file");
        assert!(lasting.found(9).expect("there").is_none(), "nobody has closed it");
        lasting.descriptor = -1;
        let mut again = lasting.found(9).expect("there").expect("opened again");
        again.write_all(b"1.0\n").expect("at its end");
        assert_eq!(std::fs::read(&path).expect("there"), b"time\n0.5\n1.0\n", "without half a row");
        lasting.append(b"1.5\n");
        lasting.descriptor = -1;
        lasting.append(b"2.0\n");
        assert_eq!(std::fs::read(&path).expect("there"), b"time\n0.5\n1.0\n1.5\n2.0\n");
        std::fs::remove_file(&path).expect("there");
        std::fs::write(&path, b"mine").expect("written");
        let error = lasting.found(9).expect_err("another one").to_string();
        assert!(error.ends_with("another file has its name now"), "{error}");
        lasting.append(b"1.5\n");
        assert_eq!(std::fs::read(&path).expect("there"), b"mine");
    }
}
