//! Failures of files that are the machine's, whatever the user gave: no room is left, or the disk is broken.

use std::io;

/// What the system calls a disk that is full, a share of it that is used up, one that is not to be written, and one that can't be read or
/// written.
#[cfg(unix)]
const FULL: [i32; 2] = [libc::ENOSPC, libc::EDQUOT];
#[cfg(unix)]
const PROTECTED: i32 = libc::EROFS;
#[cfg(unix)]
const BROKEN: i32 = libc::EIO;
/// Likewise: `ERROR_DISK_FULL`, `ERROR_HANDLE_DISK_FULL`, `ERROR_WRITE_PROTECT`, `ERROR_IO_DEVICE`.
#[cfg(not(unix))]
const FULL: [i32; 2] = [112, 39];
#[cfg(not(unix))]
const PROTECTED: i32 = 19;
#[cfg(not(unix))]
const BROKEN: i32 = 1117;

/// Whether an error's text has the system's own words for a disk that is full or broken. Units in C have them of `strerror`,
/// libraries hand them on, so that the number of the system is often lost on the way.
pub fn failed(text: &str) -> bool {
    FULL.into_iter().chain([BROKEN]).any(|number| {
        let words = io::Error::from_raw_os_error(number).to_string();
        text.contains(words.split(" (os error").next().unwrap_or(&words))
    })
}

/// Whether nothing could be written since the disk is full, or not to be written: no fault of what was to be unpacked.
pub(crate) fn is_no_room(error: &io::Error) -> bool {
    error.raw_os_error().is_some_and(|code| FULL.contains(&code) || code == PROTECTED)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_of_a_full_or_broken_disk_is_known() {
        for number in FULL.into_iter().chain([BROKEN]) {
            assert!(failed(&format!("out/results.csv: {}", io::Error::from_raw_os_error(number))));
        }
        for kind in [io::ErrorKind::NotFound, io::ErrorKind::PermissionDenied, io::ErrorKind::NotADirectory] {
            assert!(!failed(&io::Error::from(kind).to_string()), "{kind:?} is for the user to mend");
        }
    }
}
