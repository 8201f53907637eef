//! Which permissions new files don't get (`umask`): of the whole process, so that a unit that changes it changes it for the results, too.

/// The mask as it was; it is put back at the latest when this is dropped.
#[derive(Debug)]
pub struct FileMask(Option<u32>);

impl FileMask {
    /// As it is. Read where the system shows it, on Linux: asking for it would change it for a moment.
    pub fn now() -> Self {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("Umask:"));
        Self(mask.and_then(|mask| u32::from_str_radix(mask.trim(), 8).ok()))
    }

    /// Puts it back; whether it was another one.
    pub fn put_back(&self) -> bool {
        let (Some(before), Some(now)) = (self.0, Self::now().0) else { return false };
        #[cfg(unix)]
        if now != before {
            // SAFETY: takes and gives plain numbers.
            unsafe { libc::umask(before as libc::mode_t) };
        }
        now != before
    }
}

impl Drop for FileMask {
    fn drop(&mut self) {
        self.put_back();
    }
}
