//! A unit runs in this process and may take it down: by a signal, by `exit`, by `_exit`. What can be done then is done:
//! the rows that wait are written, a line says which unit did what, and the exit status is 1.
//!
//! A step pays for it with four stores: which unit is called, and which of its functions; 9 instructions, counted, 3 % of what a nearly free
//! unit costs. Without a [`Guard`] they are made as well: a test whether there is one would cost as many. To survive such a unit it must
//! run in a process of its own ([`crate::Isolation`]).

#[cfg(unix)]
mod ending;
mod file_mask;
mod lookout;
#[cfg(unix)]
mod prints;
#[cfg(target_os = "linux")]
mod requests;
#[cfg(unix)]
mod signals;
#[cfg(test)]
mod tests;

use crate::fmu::{Function, control_word};
use crate::recorder::Waiting;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicI32, AtomicPtr, AtomicU8, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread::ThreadId;

#[cfg(unix)]
pub(crate) use ending::{end_copy_of, unpacked_in};
pub use file_mask::FileMask;
pub use lookout::{beat, beats, look_out};
#[cfg(unix)]
pub use prints::own_output;

/// Whether there is a folder to be removed.
#[cfg(all(unix, test))]
pub(crate) fn has_unpacked() -> bool {
    ending::has_unpacked()
}

thread_local! {
    /// Atomic, so that another thread may look; that costs a step nothing.
    static UNIT: AtomicPtr<Label> = const { AtomicPtr::new(ptr::null_mut()) };
    static FUNCTION: AtomicU8 = const { AtomicU8::new(0) };
    static RESCUE: Cell<Option<Rescue>> = const { Cell::new(None) };
}

/// A unit's name, kept for as long as the program runs: a signal may ask for it at any time.
#[derive(Debug)]
pub(crate) struct Label {
    name: Box<str>,
    /// It changed how reals are rounded, since the last instance of the name was made.
    rounds: AtomicBool,
}

impl Label {
    /// It changed how reals are rounded.
    #[cold]
    pub(crate) fn note_rounding(&self) {
        self.rounds.store(true, Ordering::Relaxed);
    }

    /// Whether it did.
    pub(crate) fn rounds(&self) -> bool {
        self.rounds.load(Ordering::Relaxed)
    }
}

/// The label of a name; one of each.
pub(crate) fn label(name: &str) -> &'static Label {
    static LABELS: Mutex<BTreeMap<String, &'static Label>> = Mutex::new(BTreeMap::new());
    let mut labels = LABELS.lock().unwrap_or_else(PoisonError::into_inner);
    let new = || &*Box::leak(Box::new(Label { name: name.into(), rounds: AtomicBool::new(false) }));
    let label = *labels.entry(name.to_owned()).or_insert_with(new);
    label.rounds.store(false, Ordering::Relaxed);
    label
}

/// Calls into a unit begin.
#[inline(always)]
pub(crate) fn enter(unit: &'static Label) {
    UNIT.with(|place| place.store(ptr::from_ref(unit).cast_mut(), Ordering::Relaxed));
}

/// The function of the unit that is called next.
#[inline(always)]
pub(crate) fn calls(function: Function) {
    FUNCTION.with(|place| place.store(function as u8, Ordering::Relaxed));
}

/// No unit is called.
#[inline(always)]
pub(crate) fn leave() {
    UNIT.with(|place| place.store(ptr::null_mut(), Ordering::Relaxed));
}

/// Something done with a unit.
#[inline(always)]
pub(crate) fn within<T>(unit: &'static Label, work: impl FnOnce() -> T) -> T {
    UNIT.with(|place| {
        let (before, word) = (place.load(Ordering::Relaxed), control_word::read());
        place.store(ptr::from_ref(unit).cast_mut(), Ordering::Relaxed);
        let answer = work();
        place.store(before, Ordering::Relaxed);
        if control_word::put_back(word) {
            unit.note_rounding();
        }
        answer
    })
}

/// One call.
#[inline(always)]
pub(crate) fn around<T>(unit: &'static Label, function: Function, call: impl FnOnce() -> T) -> T {
    within(unit, || {
        calls(function);
        call()
    })
}

/// Stands for a function while a library is loaded or unloaded.
const LOADING: u8 = u8::MAX;

/// The initialisers of a unit's library, or what it does when it goes.
pub(crate) fn loading<T>(unit: &'static Label, work: impl FnOnce() -> T) -> T {
    within(unit, || {
        FUNCTION.with(|place| place.store(LOADING, Ordering::Relaxed));
        work()
    })
}

/// What a run leaves behind when its process ends.
#[derive(Clone, Copy)]
pub(crate) struct Rescue {
    /// Writes the rows that wait, and calls only what a signal handler may call.
    pub(crate) rows: Option<Waiting>,
    /// Simulated time of the last point in s.
    pub(crate) time: *const f64,
}

/// Until it is dropped, the run of this thread is rescued.
pub(crate) struct Rescued;

impl Rescued {
    pub(crate) fn new(rescue: Rescue) -> Self {
        RESCUE.set(Some(rescue));
        Running::enter(rescue);
        Self
    }
}

impl Drop for Rescued {
    fn drop(&mut self) {
        // A unit that ends its thread comes by here, too, in the middle of a call.
        if let (Some(_), Some(Rescue { rows: Some(rows), .. })) = (under_way(), RESCUE.get()) {
            // SAFETY: the run has not ended, so its recorder is where it was.
            unsafe { (rows.write)(rows.recorder) };
        }
        RESCUE.set(None);
        Running::leave();
    }
}

/// The rescue of a run, for threads that step units of it.
#[derive(Clone, Copy)]
pub(crate) struct Shared(Option<Rescue>);

// SAFETY: the run waits for its threads, so that what the rescue points to is there and at rest while they have it.
unsafe impl Send for Shared {}
// SAFETY: as above; it is only copied.
unsafe impl Sync for Shared {}

/// That of the run of this thread.
pub(crate) fn rescue() -> Shared {
    Shared(RESCUE.get())
}

impl Shared {
    /// Does something with a unit in this thread as if it were the run's own. A unit that does not come back is found there, too.
    pub(crate) fn adopt(self, work: impl FnOnce()) {
        let before = RESCUE.replace(self.0);
        let is_the_runs = before.is_some();
        if let Some(rescue) = self.0.filter(|_| !is_the_runs) {
            Running::enter(rescue);
        }
        work();
        leave();
        if !is_the_runs {
            Running::leave();
        }
        RESCUE.set(before);
    }
}

/// The process that is guarded; a child that it split off is not.
static GUARDED: AtomicI32 = AtomicI32::new(0);

/// As long as it lives, an end of the process that a unit brings about is told. A program has one, from the beginning of
/// `main` to its end; without it, and elsewhere than on Unix, nothing is done.
#[derive(Debug)]
pub struct Guard(());

impl Guard {
    /// Begins.
    #[must_use = "it guards until it is dropped"]
    pub fn begin() -> Self {
        #[cfg(unix)]
        {
            signals::install();
            GUARDED.store(std::process::id().cast_signed(), Ordering::Relaxed);
        }
        Self(())
    }

    /// The program has done its work, and ends with a status: what units' libraries do when they are unloaded, as the last of all,
    /// is told, but changes it no more.
    pub fn done(self, status: u8) -> u8 {
        all_done(status);
        status
    }
}

/// The program's work is done and told, and it will end with this status: what units do when they are freed and unloaded is told,
/// but changes the status no more. To be called before the last simulation is dropped.
pub fn all_done(status: u8) {
    #[cfg(unix)]
    ending::done(status);
    #[cfg(not(unix))]
    let _ = status;
}

impl Drop for Guard {
    fn drop(&mut self) {
        // A unit that ends its thread comes by here, too, in the middle of a call.
        if under_way().is_none() {
            GUARDED.store(0, Ordering::Relaxed);
        }
    }
}

/// What this thread is at, in a sentence for people: the unit, the function, the time of the last point. `None` while no
/// unit is called.
fn under_way() -> Option<(&'static str, &'static str)> {
    UNIT.with(|unit| FUNCTION.with(|function| called(unit, function)))
}

/// The unit and the function that a thread calls.
fn called(unit: &AtomicPtr<Label>, function: &AtomicU8) -> Option<(&'static str, &'static str)> {
    // SAFETY: null, or a label, which lives for ever.
    let unit = unsafe { unit.load(Ordering::Relaxed).as_ref::<'static>() }?;
    let function = match function.load(Ordering::Relaxed) {
        LOADING => "what its library does when it is loaded or unloaded",
        number => Function::of(number).map_or("a call", Function::name),
    };
    Some((&unit.name, function))
}

/// A thread of a run, for [`give_up`].
struct Running {
    unit: *const AtomicPtr<Label>,
    function: *const AtomicU8,
    rescue: Rescue,
    thread: ThreadId,
}

// SAFETY: what it points to belongs to a run that takes it off the list, under the lock, before it ends.
unsafe impl Send for Running {}

impl Running {
    /// This thread is on the list from now on.
    fn enter(rescue: Rescue) {
        let thread = std::thread::current().id();
        let running = UNIT.with(|unit| FUNCTION.with(|function| Running { unit, function, rescue, thread }));
        RUNNING.lock().unwrap_or_else(PoisonError::into_inner).push(running);
    }

    /// The unit that is being called and does not come back, if any is.
    fn word(&self) -> Option<String> {
        // SAFETY: a run on the list has not ended, so that its thread is there; while a unit is called its time stays as it is.
        unsafe {
            let (unit, function) = called(&*self.unit, &*self.function)?;
            let time = ptr::read_volatile(self.rescue.time);
            Some(format!("unit {unit}: it does not come back from {function} after t = {time} s"))
        }
    }

    /// It is no longer.
    fn leave() {
        let mine = UNIT.with(ptr::from_ref);
        RUNNING.lock().unwrap_or_else(PoisonError::into_inner).retain(|run| run.unit != mine);
    }
}

static RUNNING: Mutex<Vec<Running>> = Mutex::new(Vec::new());

/// For a program that ends while runs go on, since a unit does not come back: has the rows of the runs written whose units are
/// being called, and says which units these are.
pub fn give_up() -> Vec<String> {
    let running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
    let word = |run: &Running| {
        let word = run.word()?;
        let Some(rows) = run.rescue.rows else { return Some(word) };
        // SAFETY: a run on the list has not ended. While its unit is called nobody uses its recorder.
        unsafe { (rows.write)(rows.recorder) };
        Some(format!("{word}; the rows up to there are kept"))
    };
    running.iter().filter_map(word).collect()
}

/// For a program that goes on while a thread of its is left behind in a unit: which unit of that thread's run does not come back, in words.
/// Nothing is done to the run, which may go on after all.
pub fn not_back(thread: ThreadId) -> Option<String> {
    let running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
    let own = running.iter().find(|run| run.thread == thread)?;
    // Its other threads are those with the same clock.
    running.iter().filter(|run| ptr::eq(run.rescue.time, own.rescue.time)).find_map(Running::word)
}

/// In the `main.rs` of a program: functions `_exit` and `_Exit` of its own, which units that call those of the C library find first, so that
/// an end of theirs is told. Linkers export both by themselves, since the C library has them, too.
#[macro_export]
macro_rules! own_exit {
    () => {
        /// In place of the C library's.
        #[cfg(target_os = "linux")]
        #[allow(unsafe_code)] // a name of the C library
        #[unsafe(no_mangle)]
        extern "C" fn _exit(status: i32) -> ! {
            $crate::exit_at_once(status)
        }

        /// The same by its name in the C standard.
        #[cfg(target_os = "linux")]
        #[allow(unsafe_code)] // a name of the C library
        #[unsafe(no_mangle)]
        extern "C" fn _Exit(status: i32) -> ! {
            $crate::exit_at_once(status)
        }
    };
}

/// For a program that exports it as `_exit`, so that units which call that are found out: see [`own_exit!`](crate::own_exit).
#[cfg(unix)]
pub fn exit_at_once(status: i32) -> ! {
    ending::exit_at_once(status)
}
