//! What a unit leaves behind in the process: threads that still run its code, handlers of signals that lie in it. Its library must
//! then stay where it is.

use std::collections::BTreeSet;
use std::ffi::c_void;

/// The threads of this process before a library was loaded.
pub(super) struct Before {
    threads: BTreeSet<u64>,
}

impl Before {
    pub(super) fn now() -> Self {
        Self { threads: threads() }
    }

    /// Whether threads have come since that still live, or a handler lies in the library that holds `function`. A thread may
    /// also be this program's own: then a library stays for no reason, which costs some memory.
    pub(super) fn left_something(&self, function: *const c_void) -> bool {
        threads().difference(&self.threads).next().is_some() || handles_signals(function)
    }
}

/// The threads of this process by number; none where the system does not tell.
fn threads() -> BTreeSet<u64> {
    let tasks = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    tasks.filter_map(|task| task.file_name().to_str()?.parse().ok()).collect()
}

#[cfg(unix)]
fn handles_signals(function: *const c_void) -> bool {
    use crate::fmu::logger::home_of;
    /// The signals that have had a number and a name for long; those after them are for real-time programs.
    const SIGNALS: std::ops::Range<i32> = 1..32;
    let home = home_of(function);
    home != 0
        && SIGNALS.into_iter().any(|signal| {
            // SAFETY: plain data that the call fills; nothing is changed.
            let handler = unsafe {
                let mut action: libc::sigaction = std::mem::zeroed();
                libc::sigaction(signal, std::ptr::null(), &mut action);
                action.sa_sigaction
            };
            handler > libc::SIG_IGN && home_of(handler as *const c_void) == home
        })
}

#[cfg(not(unix))]
fn handles_signals(_: *const c_void) -> bool {
    false
}
