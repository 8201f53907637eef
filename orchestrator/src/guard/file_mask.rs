//! Which permissions new files don't get (`umask`): of the whole process, so that a unit that changes it changes it for the results, too.

/// The mask as it was; it is put back at the latest when this is dropped.
#[derive(Debug)]
pub struct FileMask(Option<u32>);

impl FileMask {
    /// As it is.
    pub fn now() -> Self {
        Self(read())
    }

    /// Puts it back; whether it was another one.
    pub fn put_back(&self) -> bool {
        let (Some(before), Some(now)) = (self.0, read()) else { return false };
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

/// The mask now. Read where the system shows it, on Linux: asking for it would change it for a moment.
fn read() -> Option<u32> {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("Umask:"))?;
    u32::from_str_radix(mask.trim(), 8).ok()
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::{FileMask, read};

    #[test]
    fn law_the_mask_is_put_back_when_asked_and_when_dropped() {
        // a process of its own: files that other tests make meanwhile would get other permissions
        if !crate::alone::is_alone() {
            return;
        }
        let before = read();
        let set = |mask: u32| {
            // SAFETY: takes and gives plain numbers.
            unsafe { libc::umask(mask as libc::mode_t) };
        };
        let mask = FileMask::now();
        assert!(!mask.put_back(), "nobody changed it");
        set(0o777);
        assert!(mask.put_back() && read() == before);
        set(0o777);
        drop(mask);
        assert_eq!(read(), before);
    }
}
