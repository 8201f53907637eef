//! The signals that end a program and that nobody but a unit brings about, and the functions that end a program.

use super::ending;
#[cfg(target_os = "linux")]
use super::requests;
use std::ffi::{c_int, c_void};
use std::ptr;
use std::sync::OnceLock;

const SIGNALS: [(c_int, &str); 13] = [
    (libc::SIGSEGV, "crashed with a segmentation fault (SIGSEGV)"),
    (libc::SIGBUS, "crashed with a bus error (SIGBUS)"),
    (libc::SIGILL, "crashed with an illegal instruction (SIGILL)"),
    (libc::SIGFPE, "crashed with an arithmetic fault (SIGFPE)"),
    (libc::SIGABRT, "gave up (SIGABRT)"),
    (libc::SIGTRAP, "met a breakpoint (SIGTRAP)"),
    (libc::SIGSYS, "made a call that the system does not allow (SIGSYS)"),
    // Timers and messages that a unit's author meant for a program of his own: unhandled, they end this one.
    (libc::SIGALRM, "was ended by a timer (SIGALRM)"),
    (libc::SIGVTALRM, "was ended by a timer of its processor time (SIGVTALRM)"),
    (libc::SIGPROF, "was ended by a profiling timer (SIGPROF)"),
    (libc::SIGUSR1, "was ended by SIGUSR1"),
    (libc::SIGUSR2, "was ended by SIGUSR2"),
    (libc::SIGIO, "was ended by a message of a device (SIGIO)"),
];

/// What was done about each signal before: Rust's own handler tells overflows of a stack.
static BEFORE: OnceLock<Vec<libc::sigaction>> = OnceLock::new();

pub(super) fn install() {
    BEFORE.get_or_init(|| {
        let set = |&(signal, _): &(c_int, &str)| {
            // SAFETY: the structures are plain data; the handler calls only what a signal handler may.
            unsafe {
                let mut before: libc::sigaction = std::mem::zeroed();
                libc::sigaction(signal, ptr::null(), &mut before);
                before
            }
        };
        let before = SIGNALS.iter().map(set).collect();
        // SAFETY: the function is `extern "C"` and does not unwind.
        unsafe {
            libc::atexit(ending::on_exit);
            // A file that grows beyond what it may is an error of its writing, told as such.
            libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
            #[cfg(target_os = "linux")]
            at_quick_exit(ending::on_exit);
        }
        before
    });
    #[cfg(target_os = "linux")]
    requests::install();
    for (signal, _) in SIGNALS {
        // SAFETY: as above.
        unsafe {
            if !is_fault(signal) && signal != libc::SIGABRT {
                // Somebody's own timer or message is left to him.
                let mut now: libc::sigaction = std::mem::zeroed();
                libc::sigaction(signal, ptr::null(), &mut now);
                if now.sa_sigaction != libc::SIG_DFL {
                    continue;
                }
            }
            let mut action: libc::sigaction = std::mem::zeroed();
            action.sa_sigaction = on_signal as *const () as usize;
            action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK;
            libc::sigaction(signal, &action, ptr::null_mut());
        }
    }
}

/// What a processor answers to an instruction, which comes again once the handler returns.
fn is_fault(signal: c_int) -> bool {
    matches!(signal, libc::SIGSEGV | libc::SIGBUS | libc::SIGILL | libc::SIGFPE)
}

#[cfg(target_os = "linux")]
unsafe extern "C" {
    /// As `atexit`, for `quick_exit`.
    fn at_quick_exit(function: extern "C" fn()) -> c_int;
}

extern "C" fn on_signal(signal: c_int, _: *mut libc::siginfo_t, _: *mut c_void) {
    let place = SIGNALS.iter().position(|(known, _)| *known == signal).unwrap_or(0);
    ending::crashed(SIGNALS[place].1);
    // Nobody's unit: what would have happened without this handler happens as soon as it returns.
    // SAFETY: plain data that was written before this handler was installed.
    unsafe {
        match BEFORE.get() {
            Some(before) => libc::sigaction(signal, &before[place], ptr::null_mut()),
            None => libc::sigaction(signal, &std::mem::zeroed(), ptr::null_mut()),
        };
        if !is_fault(signal) {
            libc::raise(signal);
        }
    }
}
