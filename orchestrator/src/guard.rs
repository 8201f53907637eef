//! A unit runs in this process and may take it down: by a signal, by `exit`, by `_exit`. What can be done then is done:
//! the rows that wait are written, a line says which unit did what, and the exit status is 1.
//!
//! A step pays for it with four stores: which unit is called, and which of its functions. To survive such a unit it must
//! run in a process of its own ([`crate::Isolation`]).

use crate::fmu::Function;
use crate::recorder::Waiting;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::ptr;
use std::sync::atomic::{AtomicI32, AtomicPtr, AtomicU8, Ordering};
use std::sync::{Mutex, PoisonError};

thread_local! {
    /// Atomic, so that another thread may look; that costs a step nothing.
    static UNIT: AtomicPtr<Label> = const { AtomicPtr::new(ptr::null_mut()) };
    static FUNCTION: AtomicU8 = const { AtomicU8::new(0) };
    static RESCUE: Cell<Option<Rescue>> = const { Cell::new(None) };
}

/// A unit's name, kept for as long as the program runs: a signal may ask for it at any time.
#[derive(Debug)]
pub(crate) struct Label(Box<str>);

/// The label of a name; one of each.
pub(crate) fn label(name: &str) -> &'static Label {
    static LABELS: Mutex<BTreeMap<String, &'static Label>> = Mutex::new(BTreeMap::new());
    let mut labels = LABELS.lock().unwrap_or_else(PoisonError::into_inner);
    labels.entry(name.to_owned()).or_insert_with(|| Box::leak(Box::new(Label(name.into()))))
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
        let before = place.load(Ordering::Relaxed);
        place.store(ptr::from_ref(unit).cast_mut(), Ordering::Relaxed);
        let answer = work();
        place.store(before, Ordering::Relaxed);
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
            unix::install();
            GUARDED.store(std::process::id().cast_signed(), Ordering::Relaxed);
        }
        Self(())
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        GUARDED.store(0, Ordering::Relaxed);
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
    let function = Function::of(function.load(Ordering::Relaxed));
    Some((&unit.0, function.map_or("a call", Function::name)))
}

/// A thread of a run, for [`give_up`].
struct Running {
    unit: *const AtomicPtr<Label>,
    function: *const AtomicU8,
    rescue: Rescue,
}

// SAFETY: what it points to belongs to a run that takes it off the list, under the lock, before it ends.
unsafe impl Send for Running {}

impl Running {
    /// This thread is on the list from now on.
    fn enter(rescue: Rescue) {
        let running = UNIT.with(|unit| FUNCTION.with(|function| Running { unit, function, rescue }));
        RUNNING.lock().unwrap_or_else(PoisonError::into_inner).push(running);
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
        // SAFETY: a run on the list has not ended, so that its thread is there. While its unit is called nobody uses its
        // recorder, and its time stays as it is.
        unsafe {
            let (unit, function) = called(&*run.unit, &*run.function)?;
            let time = ptr::read_volatile(run.rescue.time);
            let kept = match run.rescue.rows {
                Some(rows) => {
                    (rows.write)(rows.recorder);
                    "; the rows up to there are kept"
                }
                None => "",
            };
            Some(format!("unit {unit}: it does not come back from {function} after t = {time} s{kept}"))
        }
    };
    running.iter().filter_map(word).collect()
}

/// For a program that exports it as `_exit`, so that units which call that are found out.
#[cfg(unix)]
pub fn exit_at_once(status: i32) -> ! {
    unix::exit_at_once(status)
}

#[cfg(unix)]
mod unix {
    use super::{GUARDED, Ordering, RESCUE, under_way};
    use std::ffi::{c_int, c_void};
    use std::ptr;
    use std::sync::OnceLock;

    const SIGNALS: [(c_int, &str); 5] = [
        (libc::SIGSEGV, "crashed with a segmentation fault (SIGSEGV)"),
        (libc::SIGBUS, "crashed with a bus error (SIGBUS)"),
        (libc::SIGILL, "crashed with an illegal instruction (SIGILL)"),
        (libc::SIGFPE, "crashed with an arithmetic fault (SIGFPE)"),
        (libc::SIGABRT, "gave up (SIGABRT)"),
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
            unsafe { libc::atexit(on_exit) };
            before
        });
        for (signal, _) in SIGNALS {
            // SAFETY: as above.
            unsafe {
                let mut action: libc::sigaction = std::mem::zeroed();
                action.sa_sigaction = on_signal as *const () as usize;
                action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK;
                libc::sigaction(signal, &action, ptr::null_mut());
            }
        }
    }

    fn is_guarded() -> bool {
        // SAFETY: takes and changes nothing.
        GUARDED.load(Ordering::Relaxed) == unsafe { libc::getpid() }
    }

    extern "C" fn on_signal(signal: c_int, _: *mut libc::siginfo_t, _: *mut c_void) {
        let place = SIGNALS.iter().position(|(known, _)| *known == signal).unwrap_or(0);
        if is_guarded() && under_way().is_some() {
            end(SIGNALS[place].1);
        }
        // Nobody's unit: what would have happened without this handler happens as soon as it returns.
        // SAFETY: plain data that was written before this handler was installed.
        unsafe {
            match BEFORE.get() {
                Some(before) => libc::sigaction(signal, &before[place], ptr::null_mut()),
                None => libc::sigaction(signal, &std::mem::zeroed(), ptr::null_mut()),
            };
            if signal == libc::SIGABRT {
                libc::raise(signal);
            }
        }
    }

    extern "C" fn on_exit() {
        if is_guarded() {
            end("ended the program by calling exit");
        }
    }

    /// Ends the process as the C library's `_exit` does; of a unit, the word comes first.
    pub(super) fn exit_at_once(status: c_int) -> ! {
        if is_guarded() && under_way().is_some() {
            end("ended the program by calling _exit");
        }
        leave(status)
    }

    /// Says what happened, has the rows written, and ends the process. Calls only what a signal handler may.
    fn end(what: &str) -> ! {
        // Only once, whatever happens below.
        GUARDED.store(0, Ordering::Relaxed);
        let rescue = RESCUE.get();
        match under_way() {
            Some((unit, function)) => say(&["\nerror: unit ", unit, ": it ", what, " in ", function]),
            None => say(&["\nerror: a unit, or a library that it brought, ", what]),
        }
        if let Some(rescue) = rescue {
            // SAFETY: the run that registered this has not ended, so its time and its recorder are where they were.
            unsafe {
                let mut buffer = zmij::Buffer::new();
                say(&[" after t = ", buffer.format(ptr::read_volatile(rescue.time)), " s"]);
                if let Some(rows) = rescue.rows {
                    (rows.write)(rows.recorder);
                    say(&["; the rows up to there are kept"]);
                }
            }
        }
        say(&["; in a process of its own (isolate = true, --isolate) it would tell more\n"]);
        leave(1)
    }

    /// To the standard error.
    fn say(parts: &[&str]) {
        for part in parts {
            // SAFETY: the bytes are there; if nobody reads them, there is nothing to be done.
            unsafe { libc::write(2, part.as_ptr().cast(), part.len()) };
        }
    }

    fn leave(status: c_int) -> ! {
        loop {
            // SAFETY: ends the process, without the exported `_exit` above.
            unsafe {
                #[cfg(any(target_os = "linux", target_os = "android"))]
                libc::syscall(libc::SYS_exit_group, status);
                #[cfg(not(any(target_os = "linux", target_os = "android")))]
                libc::_Exit(status);
            }
        }
    }
}
