//! Units in processes of their own: whatever such a unit does, the run goes on to a clear end. The price is one exchange
//! through shared memory a step.
//!
//! The process is this very program, started again: its `main` begins with [`host_units`], which serves if the program was
//! started for that, and says that it can be.

#[cfg(isolation)]
mod answer;
#[cfg(isolation)]
mod calls;
#[cfg(isolation)]
mod client;
#[cfg(isolation)]
mod death;
#[cfg(isolation)]
mod memory;
#[cfg(isolation)]
mod message;
#[cfg(isolation)]
mod place;
#[cfg(isolation)]
mod server;
#[cfg(isolation)]
mod table;

#[cfg(isolation)]
pub(crate) use client::Remote;
#[cfg(isolation)]
pub(crate) use place::Stepping;

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::OnceLock;
use std::time::Duration;

/// How a unit in a process of its own is kept within limits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Isolation {
    /// Real time that a call may take; then the process is ended.
    pub step_limit: Duration,
    /// Bytes of memory that the process may have; `None`: as many as there are.
    pub memory_limit: Option<u64>,
    /// What serves the unit; `None`: what was registered with [`host_units`].
    pub host: Option<Host>,
}

/// Seconds of a limit are fewer: a clock that counts them on from now must hold the sum.
const LONGEST_LIMIT: f64 = 1e9;

/// So many seconds as a limit; nothing where they are none: above 0 and below 1e9.
pub fn limit_of(seconds: f64) -> Option<Duration> {
    let seconds = Some(seconds).filter(|seconds| *seconds > 0.0 && *seconds < LONGEST_LIMIT)?;
    Duration::try_from_secs_f64(seconds).ok().filter(|limit| !limit.is_zero())
}

/// A program that serves units: started with these arguments, it comes by [`host_units`] or [`serve_units`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Host {
    /// Its file.
    pub program: PathBuf,
    /// What it is started with.
    pub arguments: Vec<OsString>,
}

/// Half a minute a call: a step that takes longer is hardly one that comes back.
impl Default for Isolation {
    fn default() -> Self {
        Self { step_limit: Duration::from_secs(30), memory_limit: None, host: None }
    }
}

/// The program that serves units.
static HOST: OnceLock<Host> = OnceLock::new();

/// Serves a unit and never returns, if this process was started for that. Else this program, started again with
/// `arguments` that lead it here, will serve the units that are to be isolated. To be called first in `main`.
pub fn host_units(arguments: impl IntoIterator<Item = impl Into<OsString>>) {
    serve_if_asked();
    if let Ok(program) = std::env::current_exe() {
        register(program, arguments);
    }
}

/// As [`host_units`], for a library that is loaded into a program which can't be told by its file: Python's, in a virtual
/// environment. `program`, started with `arguments`, must come by here, too. The first call counts.
pub fn host_units_by(program: PathBuf, arguments: impl IntoIterator<Item = impl Into<OsString>>) {
    serve_if_asked();
    register(program, arguments);
}

/// Serves a unit and never returns, if this process was started for that; nothing else. For a program that has functions of FMI
/// of its own: units find theirs first.
pub fn serve_units() {
    crate::fmu::library::prefer_own_symbols();
    serve_if_asked();
}

/// What a thread asks while it waits for a unit in a process of its own.
static TO_END: OnceLock<fn() -> bool> = OnceLock::new();

/// For a host that learns of Ctrl-C in ways of its own: a thread that waits for a unit in a process of its own asks this some fifty
/// times a second, and once it answers true the process is ended, and the call with it. The first call counts.
pub fn end_units_when(asked: fn() -> bool) {
    TO_END.get_or_init(|| asked);
}

/// Whether the unit that this thread waits for is to be ended.
#[cfg(isolation)]
fn is_to_end() -> bool {
    TO_END.get().is_some_and(|asked| asked())
}

fn serve_if_asked() {
    #[cfg(isolation)]
    if let Some(descriptor) = std::env::var(server::MEMORY).ok().and_then(|text| text.parse().ok()) {
        server::serve(descriptor);
    }
}

fn register(program: PathBuf, arguments: impl IntoIterator<Item = impl Into<OsString>>) {
    let arguments = arguments.into_iter().map(Into::into).collect();
    HOST.get_or_init(|| Host { program, arguments });
}

/// The program that serves a unit; an error is why there is none.
#[cfg(isolation)]
fn host(isolation: &Isolation) -> Result<Host, String> {
    isolation.host.as_ref().or_else(|| HOST.get()).cloned().ok_or_else(|| {
        "it is to run in a process of its own, but this program does not call orchestrator::host_units".into()
    })
}
