//! Signals by which somebody asks a program to end, where it is a unit that sends them: no request, then, but an end that it brings about.
//!
//! Whoever listens to them as requests (the command line) has a handler of its own, which comes after this one and calls it first.

use super::ending;
use std::ffi::{c_int, c_void};
use std::ptr;

const REQUESTS: [(c_int, &str); 3] = [
    (libc::SIGTERM, "sent this program SIGTERM"),
    (libc::SIGINT, "sent this program SIGINT"),
    (libc::SIGHUP, "sent this program SIGHUP"),
];

/// Where nobody handles them yet.
pub(super) fn install() {
    for (signal, _) in REQUESTS {
        // SAFETY: plain data; the handler calls only what a signal handler may.
        unsafe {
            if now(signal) != libc::SIG_DFL {
                continue;
            }
            let mut action: libc::sigaction = std::mem::zeroed();
            action.sa_sigaction = on_request as *const () as usize;
            action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK;
            libc::sigaction(signal, &action, ptr::null_mut());
        }
    }
}

/// What handles a signal now.
unsafe fn now(signal: c_int) -> usize {
    // SAFETY: plain data, which the system fills.
    unsafe {
        let mut now: libc::sigaction = std::mem::zeroed();
        libc::sigaction(signal, ptr::null(), &mut now);
        now.sa_sigaction
    }
}

extern "C" fn on_request(signal: c_int, told: *mut libc::siginfo_t, _: *mut c_void) {
    // SAFETY: what the system tells of the signal, which has a sender if a process sent it; and plain data.
    unsafe {
        let sent = matches!((*told).si_code, libc::SI_USER | libc::SI_TKILL);
        if sent && (*told).si_pid() == libc::getpid() {
            let place = REQUESTS.iter().position(|(known, _)| *known == signal).unwrap_or(0);
            ending::asked_by_a_unit(REQUESTS[place].1);
        }
        // Somebody else's: who has come after this handler goes on by itself; else what would have happened without it happens.
        if now(signal) == on_request as *const () as usize {
            libc::sigaction(signal, &std::mem::zeroed(), ptr::null_mut());
            libc::raise(signal);
        }
    }
}
