//! The end of the process that a unit brings about: a word, the rows, nothing left behind. All of it may run in a signal handler.

use super::{GUARDED, Ordering, RESCUE, RUNNING, Running, called, under_way};
use std::ffi::{CString, c_char, c_int};
use std::path::Path;
use std::ptr;
use std::sync::atomic::{AtomicI32, AtomicPtr, AtomicUsize};

/// The folder in which units are unpacked, as a C string of whoever takes it out; null if there is none.
static UNPACKED: AtomicPtr<c_char> = AtomicPtr::new(ptr::null_mut());
/// Exit status of a program that has done its work, and one more; 0 before that.
static DONE: AtomicI32 = AtomicI32::new(0);
/// The thread that ends the process; 0 before one does.
static ENDING: AtomicUsize = AtomicUsize::new(0);

/// Where units are unpacked from now on: to be removed at an end of the process that nobody expects.
pub(crate) fn unpacked_in(folder: Option<&Path>) {
    use std::os::unix::ffi::OsStrExt as _;
    let path = folder.and_then(|folder| CString::new(folder.as_os_str().as_bytes()).ok());
    let before = UNPACKED.swap(path.map_or(ptr::null_mut(), CString::into_raw), Ordering::Relaxed);
    if !before.is_null() {
        // SAFETY: it was made below here by `into_raw`, and has been taken out, so that nobody else has it.
        drop(unsafe { CString::from_raw(before) });
    }
}

#[cfg(test)]
pub(super) fn has_unpacked() -> bool {
    !UNPACKED.load(Ordering::Relaxed).is_null()
}

/// The program has done its work: what libraries do when they go changes its exit status no more.
pub(super) fn done(status: u8) {
    DONE.store(i32::from(status) + 1, Ordering::Relaxed);
}

pub(super) fn is_guarded() -> bool {
    // SAFETY: takes and changes nothing.
    GUARDED.load(Ordering::Relaxed) == unsafe { libc::getpid() }
}

/// Where another thread ends the process already, this one waits for that: several that call the same unit crash at once, or exit, and the
/// second one would cut short what the first one says, and its exit status with it.
fn wait_if_another_ends() {
    let ending = ENDING.load(Ordering::Relaxed);
    // SAFETY: a question, and a sleep.
    unsafe {
        while ending != 0 && ending != libc::pthread_self() as usize {
            libc::pause();
        }
    }
}

/// A signal that stands for a crash has come to this thread. Returns if it is nobody's unit that it met.
pub(super) fn crashed(what: &str) {
    wait_if_another_ends();
    if is_guarded() && under_way().is_some() {
        end(what);
    }
    let done = DONE.load(Ordering::Relaxed);
    if done > 0 {
        say(&["\nnote: all is done, but a library of a unit ", what, " when it was unloaded\n"]);
        remove_unpacked();
        leave(done - 1);
    }
    if !is_guarded() {
        return;
    }
    say(&[
        "\nerror: the program ",
        what,
        " outside of any call into a unit, perhaps in a thread that a unit has started",
    ]);
    // The runs whose units are being called are at rest, most likely.
    if let Ok(running) = RUNNING.try_lock() {
        for Running { unit, function, rescue, .. } in running.iter() {
            // SAFETY: a run on the list has not ended.
            unsafe {
                if let (Some((unit, function)), Some(rows)) = (called(&**unit, &**function), rescue.rows) {
                    (rows.write)(rows.recorder);
                    say(&["; unit ", unit, " was in ", function, ", the rows up to there are kept"]);
                }
            }
        }
    }
    say(&["; in a process of its own (isolate = true, --isolate) a unit harms nobody else\n"]);
    remove_unpacked();
}

/// The process itself has sent a signal that asks it to end. Returns if no unit was being called in this thread.
#[cfg(target_os = "linux")]
pub(super) fn asked_by_a_unit(what: &str) {
    wait_if_another_ends();
    if is_guarded() && under_way().is_some() {
        end(what);
    }
}

/// Something has called `exit`.
pub(super) extern "C" fn on_exit() {
    if is_guarded() || ENDING.load(Ordering::Relaxed) != 0 {
        // The C library has taken this off its list. A second thread that calls `exit` meanwhile is to come by here as well.
        // SAFETY: the function is `extern "C"` and does not unwind.
        unsafe { libc::atexit(on_exit) };
    }
    wait_if_another_ends();
    if is_guarded() {
        end("ended the program by calling exit");
    }
}

/// Ends the process as the C library's `_exit` does; of a unit, the word comes first.
pub(super) fn exit_at_once(status: c_int) -> ! {
    wait_if_another_ends();
    if is_guarded() && under_way().is_some() {
        end("ended the program by calling _exit");
    }
    leave(match DONE.load(Ordering::Relaxed) {
        0 => status,
        done => done - 1,
    })
}

/// Says what happened, has the rows written, and ends the process. Calls only what a signal handler may.
fn end(what: &str) -> ! {
    // SAFETY: a question.
    let this = unsafe { libc::pthread_self() as usize };
    if ENDING.compare_exchange(0, this, Ordering::Relaxed, Ordering::Relaxed).is_err() {
        wait_if_another_ends();
    }
    // Only once, whatever happens below.
    GUARDED.store(0, Ordering::Relaxed);
    let done = DONE.load(Ordering::Relaxed);
    if done > 0 {
        match under_way() {
            Some((unit, function)) => {
                say(&["\nnote: all is done, but unit ", unit, " ", what, " in ", function, "\n"])
            }
            None => say(&["\nnote: all is done, but a unit, or a library that it brought, ", what, "\n"]),
        }
        remove_unpacked();
        leave(done - 1);
    }
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
    remove_unpacked();
    leave(1)
}

/// Removes the unpacked units by a program of the system: in a signal handler nothing else may walk through folders. Where that is
/// missing, the next run sweeps.
fn remove_unpacked() {
    let folder = UNPACKED.swap(ptr::null_mut(), Ordering::Relaxed);
    if folder.is_null() {
        return;
    }
    let program = c"/bin/rm";
    let arguments = [program.as_ptr(), c"-rf".as_ptr(), c"--".as_ptr(), folder.cast_const(), ptr::null()];
    let (mut process, nothing) = (0, [ptr::null_mut()]);
    // SAFETY: strings that end in zero, lists that end in null; what the call answers is looked at.
    unsafe {
        let arguments = arguments.as_ptr().cast::<*mut c_char>();
        let started = libc::posix_spawn(
            &mut process,
            program.as_ptr(),
            ptr::null(),
            ptr::null(),
            arguments,
            nothing.as_ptr(),
        );
        if started == 0 {
            libc::waitpid(process, ptr::null_mut(), 0);
        }
    }
}

/// To the standard error.
fn say(parts: &[&str]) {
    for part in parts {
        // SAFETY: the bytes are there; if nobody reads them, there is nothing to be done.
        unsafe { libc::write(2, part.as_ptr().cast(), part.len()) };
    }
}

/// Ends a copy of a guarded process, and does nothing else: files and folders are those of the process that it was split from. A program
/// without a [`Guard`](super::Guard) may split itself on purpose, and goes on.
pub(crate) fn end_copy_of(process: u32) {
    if GUARDED.load(Ordering::Relaxed) == process.cast_signed() {
        leave(0);
    }
}

fn leave(status: c_int) -> ! {
    loop {
        // SAFETY: ends the process, without the `_exit` that programs for Linux export.
        unsafe {
            #[cfg(any(target_os = "linux", target_os = "android"))]
            libc::syscall(libc::SYS_exit_group, status);
            #[cfg(not(any(target_os = "linux", target_os = "android")))]
            libc::_exit(status);
        }
    }
}
