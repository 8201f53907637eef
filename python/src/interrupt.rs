//! Ctrl-C while a unit is called. Python only notes that it came: somebody has to look, and be in a place from which it can be told.
//!
//! A run has a thread of its own, and the one that Python called from waits and looks: so a unit that hangs in this process keeps that thread,
//! and not Python. A simulation step by step is called too often for that; there whoever waits for a unit in another process looks.

use crate::errors::told;
use orchestrator::Progress;
use pyo3::prelude::*;
use std::cell::RefCell;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// How often the waiting thread looks.
const LOOK: Duration = Duration::from_millis(20);
/// What ends by itself after Ctrl-C has this long, as on the command line.
const PATIENCE: Duration = Duration::from_secs(10);
/// The stack of a run's thread: as much as the main thread most often has, which units are made for.
const STACK: usize = 8 << 20;

/// Where a thread that waits for a unit looks for Ctrl-C.
enum Looks {
    Nowhere,
    /// Somebody else does, and sets this.
    At(Arc<AtomicBool>),
    /// By itself.
    Here,
}

thread_local! {
    static LOOKS: RefCell<Looks> = const { RefCell::new(Looks::Nowhere) };
    /// What it found.
    static RAISED: RefCell<Option<PyErr>> = const { RefCell::new(None) };
}

/// Whether the unit that this thread waits for is to be ended.
pub fn came() -> bool {
    LOOKS.with_borrow(|looks| match looks {
        Looks::Nowhere => false,
        Looks::At(flag) => flag.load(Ordering::Relaxed),
        Looks::Here => match Python::attach(|py| py.check_signals()) {
            Ok(()) => false,
            Err(raised) => {
                RAISED.set(Some(raised));
                true
            }
        },
    })
}

/// A call of a simulation: a unit in another process is ended by Ctrl-C, which is then all that is raised.
pub fn here<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<T, orchestrator::Error> + Send,
) -> PyResult<T> {
    LOOKS.set(Looks::Here);
    let made = py.detach(work);
    LOOKS.set(Looks::Nowhere);
    match RAISED.take() {
        Some(raised) => Err(raised),
        None => made.map_err(told),
    }
}

/// Ends a run at its next communication point once Ctrl-C came.
pub struct Watch(Arc<AtomicBool>);

impl Progress for Watch {
    fn at(&mut self, _: f64, _: f64) -> ControlFlow<()> {
        if self.0.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Long work in a thread of its own, while this one looks for Ctrl-C: the work ends at its next point then, and a unit in another process
/// at once. One in this process that does not come back is left behind with its thread, after a while or when Ctrl-C comes again.
pub fn apart<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&mut Watch) -> T + Send + 'static,
) -> PyResult<T> {
    let flag = Arc::new(AtomicBool::new(false));
    let (send, mut done) = channel();
    let mut watch = Watch(Arc::clone(&flag));
    let thread = std::thread::Builder::new().stack_size(STACK).spawn(move || {
        LOOKS.set(Looks::At(Arc::clone(&watch.0)));
        // Nobody waits for it any more: then it is lost.
        let _ = send.send(work(&mut watch));
    })?;
    let mut interrupted: Option<(PyErr, Instant)> = None;
    loop {
        let waits = &mut done;
        match py.detach(move || waits.recv_timeout(LOOK)) {
            Ok(made) => return interrupted.map_or(Ok(made), |(raised, _)| Err(raised)),
            Err(RecvTimeoutError::Disconnected) => match thread.join() {
                Err(panicked) => std::panic::resume_unwind(panicked),
                Ok(()) => return Err(crate::errors::other("the run's thread ended without an answer")),
            },
            Err(RecvTimeoutError::Timeout) => {}
        }
        let again = py.check_signals();
        if let Err(raised) = again {
            if interrupted.is_some() {
                return Err(left_behind(py, raised, &thread));
            }
            flag.store(true, Ordering::Relaxed);
            interrupted = Some((raised, Instant::now()));
        } else if let Some((raised, _)) = interrupted.take_if(|(_, at)| at.elapsed() >= PATIENCE) {
            return Err(left_behind(py, raised, &thread));
        }
    }
}

/// The exception, with a note of what goes on.
fn left_behind(py: Python<'_>, raised: PyErr, thread: &std::thread::JoinHandle<()>) -> PyErr {
    let unit = orchestrator::not_back(thread.thread().id());
    let note = format!(
        "{}. Its thread is left behind in this process until Python ends, and rows that were not yet written are lost; with isolate=True \
         the unit would have ended",
        unit.unwrap_or_else(|| "a unit does not come back".into())
    );
    // Without it the exception says what matters most.
    let _ = raised.value(py).call_method1("add_note", (note,));
    raised
}
