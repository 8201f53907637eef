//! Signals that ask the program to end: SIGINT (Ctrl-C), SIGTERM, SIGHUP, and SIGXCPU, by which a batch system says that the time is up.
//!
//! A run ends at its next communication point, with its rows and its report. Whatever does not come to an end by itself,
//! since it is no run, or its unit hangs, or the person asks a second time, ends at once; units that were unpacked and
//! folders that are empty are taken away first. The exit status is 128 + the signal's number, as a shell has it.

use crate::complain;
use std::sync::atomic::{AtomicBool, AtomicI32, AtomicUsize, Ordering};

/// Within this long after the first one a signal is the same request: `timeout` and shells send it to the program and then to its whole
/// group. A person who asks again takes longer.
#[cfg(unix)]
const SAME: std::time::Duration = std::time::Duration::from_millis(200);

/// How long a signal may lie until it is seen. Looked for by the clock: a pipe, as others have it, is gone when a unit closes all
/// descriptors.
#[cfg(unix)]
const LOOK_EVERY: std::time::Duration = std::time::Duration::from_millis(20);

/// The signal that came; 0: none.
static CAUGHT: AtomicI32 = AtomicI32::new(0);
/// How many parts of the program look at [`caught`] by themselves.
static LOOKING: AtomicUsize = AtomicUsize::new(0);

/// Whether the program is being ended at once: files vanish under what still works.
static ENDING: AtomicBool = AtomicBool::new(false);

/// Before an error is told: one that comes since the program is being ended at once is none, and its end comes first.
pub fn let_end_come() {
    if ENDING.load(Ordering::Acquire) {
        std::thread::sleep(std::time::Duration::from_secs(10));
    }
}

/// The signal that asks for the end.
pub fn caught() -> Option<i32> {
    match CAUGHT.load(Ordering::Relaxed) {
        0 => None,
        signal => Some(signal),
    }
}

/// Says, while it lives, that its owner looks at [`caught`] and ends by itself.
pub struct Looking;

impl Looking {
    /// From now on.
    pub fn now() -> Self {
        LOOKING.fetch_add(1, Ordering::Relaxed);
        Self
    }
}

impl Drop for Looking {
    fn drop(&mut self) {
        LOOKING.fetch_sub(1, Ordering::Relaxed);
    }
}

/// The exit status after a signal.
pub fn exit_status(signal: i32) -> u8 {
    u8::try_from(128 + signal).unwrap_or(1)
}

/// The signal's name.
#[cfg(unix)]
pub fn name(signal: i32) -> &'static str {
    signal_hook::low_level::signal_name(signal).unwrap_or("a signal")
}

/// The signal's name.
#[cfg(not(unix))]
pub fn name(_: i32) -> &'static str {
    "a signal"
}

/// Begins to listen, once a process. Where that can't be done, signals do what they always do.
#[cfg(unix)]
pub fn listen() {
    static LISTENING: std::sync::Once = std::sync::Once::new();
    LISTENING.call_once(begin);
}

#[cfg(unix)]
fn begin() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXCPU};
    use std::sync::Arc;
    let came = Arc::new(AtomicUsize::new(0));
    for signal in [SIGINT, SIGTERM, SIGHUP, SIGXCPU] {
        let registered =
            signal_hook::flag::register_usize(signal, Arc::clone(&came), signal.unsigned_abs() as usize);
        if registered.is_err() {
            return;
        }
    }
    std::thread::spawn(move || {
        let mut began: Option<std::time::Instant> = None;
        loop {
            std::thread::sleep(LOOK_EVERY);
            let signal = match came.swap(0, Ordering::Relaxed) {
                0 => continue,
                number => i32::try_from(number).unwrap_or(SIGTERM),
            };
            if began.is_some_and(|began| began.elapsed() < SAME) {
                continue;
            }
            began = began.or_else(|| Some(std::time::Instant::now()));
            let first = CAUGHT.compare_exchange(0, signal, Ordering::Relaxed, Ordering::Relaxed).is_ok();
            if first && LOOKING.load(Ordering::Relaxed) > 0 {
                // What ends by itself has this long; a unit that hangs would keep it for ever.
                std::thread::spawn(move || {
                    std::thread::sleep(std::time::Duration::from_secs(10));
                    end_at_once(signal);
                });
                continue;
            }
            end_at_once(signal);
        }
    });
}

/// Nothing to listen to.
#[cfg(not(unix))]
pub fn listen() {}

#[cfg(unix)]
fn end_at_once(signal: i32) {
    ENDING.store(true, Ordering::Release);
    for word in orchestrator::give_up() {
        complain!("error: {word}");
    }
    end_with(exit_status(signal));
}

/// Ends the program with an error, whatever its threads are at: one of them is in a unit that does not come back.
pub fn end_with_error(why: &str) {
    ENDING.store(true, Ordering::Release);
    complain!("error: {why}");
    end_with(1);
}

fn end_with(status: u8) {
    orchestrator::fmu::discard_unpacked();
    crate::folder::remove_empty();
    #[cfg(unix)]
    signal_hook::low_level::exit(i32::from(status));
    #[cfg(not(unix))]
    std::process::exit(i32::from(status));
}
