//! Whether units come back: for a program that calls them in its own process, many times over and in several threads.
//!
//! Each thread says between calls that its work goes on. One that is in a call, and has not said so for as long as a call may take, waits for a
//! unit that loops or sleeps for ever; nothing ends such a call but the end of the process.

use super::{AtomicPtr, AtomicU8, FUNCTION, Label, Mutex, Ordering, PoisonError, UNIT, called};
use std::ptr;
use std::sync::atomic::AtomicU64;
use std::time::Duration;

/// Looks within the time that a call may take. Looks are counted rather than the clock: of a process that was stopped nothing counts.
const LOOKS: u32 = 20;

thread_local! {
    static BEATS: AtomicU64 = const { AtomicU64::new(0) };
    static LISTED: Listed = Listed::new();
}

/// A thread that calls units.
struct Thread {
    unit: *const AtomicPtr<Label>,
    function: *const AtomicU8,
    beats: *const AtomicU64,
    /// Its beats when it was looked at, and how often they have been the same within a call.
    seen: (u64, u32),
}

// SAFETY: what it points to belongs to a thread that takes it off the list, under the lock, before it ends.
unsafe impl Send for Thread {}

static THREADS: Mutex<Vec<Thread>> = Mutex::new(Vec::new());

/// This thread is on the list while it lives.
struct Listed;

impl Listed {
    fn new() -> Self {
        let thread = Thread {
            unit: UNIT.with(ptr::from_ref),
            function: FUNCTION.with(ptr::from_ref),
            beats: BEATS.with(ptr::from_ref),
            seen: (0, 0),
        };
        THREADS.lock().unwrap_or_else(PoisonError::into_inner).push(thread);
        Self
    }
}

impl Drop for Listed {
    fn drop(&mut self) {
        let mine = BEATS.with(ptr::from_ref);
        THREADS.lock().unwrap_or_else(PoisonError::into_inner).retain(|thread| thread.beats != mine);
    }
}

/// The work of this thread goes on. To be said between calls into units; who waits for one in another process says so, too.
pub fn beat() {
    LISTED.with(|_| ());
    BEATS.with(|beats| beats.store(beats.load(Ordering::Relaxed).wrapping_add(1), Ordering::Relaxed));
}

/// How often this thread has said so.
pub fn beats() -> u64 {
    BEATS.with(|beats| beats.load(Ordering::Relaxed))
}

/// From now on looks whether threads that [`beat`] come back from their calls within a time. The first that doesn't is told: the unit
/// and the function.
pub fn look_out(limit: Duration, told: impl FnOnce(&str, &str) + Send + 'static) {
    std::thread::spawn(move || {
        let (unit, function) = loop {
            std::thread::sleep(limit / LOOKS);
            if let Some(found) = stuck() {
                break found;
            }
        };
        told(unit, function);
    });
}

/// The unit and the function that some thread does not come back from.
fn stuck() -> Option<(&'static str, &'static str)> {
    let mut threads = THREADS.lock().unwrap_or_else(PoisonError::into_inner);
    threads.iter_mut().find_map(|thread| {
        // SAFETY: a thread on the list has not ended.
        let (at, beats) =
            unsafe { (called(&*thread.unit, &*thread.function), (*thread.beats).load(Ordering::Relaxed)) };
        let same = at.is_some() && thread.seen.0 == beats;
        thread.seen = (beats, if same { thread.seen.1 + 1 } else { 0 });
        at.filter(|_| thread.seen.1 >= LOOKS)
    })
}

#[cfg(test)]
mod tests {
    use super::super::{calls, label, within};
    use super::*;
    use crate::fmu::Function;

    /// Looks often enough for all of a time.
    fn look() -> Vec<(&'static str, &'static str)> {
        (0..=LOOKS).filter_map(|_| stuck()).filter(|(unit, _)| *unit == "looper").collect()
    }

    #[test]
    fn law_a_thread_that_stays_in_a_call_is_found_and_one_that_goes_on_is_not() {
        let before = beats();
        beat();
        assert_eq!(beats(), before + 1);
        assert!(look().is_empty(), "no unit is called");
        within(label("looper"), || {
            calls(Function::DoStep);
            beat();
            assert_eq!(look(), [("looper", "fmi2DoStep")], "at the last look of the time");
            beat();
            assert!((0..2 * LOOKS).all(|_| {
                beat();
                stuck().is_none_or(|(unit, _)| unit != "looper")
            }));
        });
        assert!(look().is_empty(), "it came back");
    }
}
