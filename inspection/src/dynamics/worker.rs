//! The process in which a rule runs a unit: this very program, started again. It says each call before it makes it, so that
//! the last ones are known when it does not come back.

#![allow(unsafe_code)] // descriptors and limits of the process, by the C library

use super::{Limits, bench, look};
use crate::error::Error;
use crate::finding::{Finding, Found};
use orchestrator::Fmu;
use orchestrator::fmu::Bench;
use std::collections::VecDeque;
use std::ffi::OsString;
use std::fs::File;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// In the environment of the process: rule, unit, bytes of memory.
const RULE: &str = "ACROSCOPE_CHECK_RULE";
const UNIT: &str = "ACROSCOPE_CHECK_UNIT";
const MEMORY: &str = "ACROSCOPE_CHECK_MEMORY";
/// What glibc is told: what its caches of freed memory hold counts as used, tens of kB that come and go, and would look
/// like a leak.
const TUNABLES: (&str, &str) = ("GLIBC_TUNABLES", "glibc.malloc.tcache_count=0");

/// Begins each line that is ours: a unit may print what it likes to the same place.
const MARK: &str = "\u{1}acroscope-check ";
/// How many calls are remembered.
const REMEMBERED: usize = 8;

/// Where the process says its lines: a copy of the standard output, which a unit may close or take for itself.
static OUT: OnceLock<Mutex<File>> = OnceLock::new();

static HOST: OnceLock<(PathBuf, Vec<OsString>)> = OnceLock::new();

/// Looks at a rule and never returns, if this process was started for that. Else this program, started again with
/// `arguments` that lead it here, will look at the rules that run a unit. To be called first in `main`.
pub fn host_rules(arguments: impl IntoIterator<Item = impl Into<OsString>>) {
    serve_if_asked();
    if let Ok(program) = std::env::current_exe() {
        remember(program, arguments);
    }
}

/// As [`host_rules`], for a library in a program of another language: `program`, started with `arguments`, comes here.
pub fn host_rules_by(program: impl Into<PathBuf>, arguments: impl IntoIterator<Item = impl Into<OsString>>) {
    serve_if_asked();
    remember(program.into(), arguments);
}

fn remember(program: PathBuf, arguments: impl IntoIterator<Item = impl Into<OsString>>) {
    let arguments = arguments.into_iter().map(Into::into).collect();
    HOST.get_or_init(|| (program, arguments));
}

fn serve_if_asked() {
    if let (Ok(rule), Some(unit)) = (std::env::var(RULE), std::env::var_os(UNIT)) {
        serve(&rule, Path::new(&unit));
    }
}

/// Whether there is a program that can look at rules.
pub(super) fn is_hosted() -> bool {
    HOST.get().is_some()
}

/// What the process says.
enum Line {
    Call(String),
    Trace(String),
    Findings(Vec<Finding>),
}

/// How the process ended.
pub(super) struct Ended {
    pub(super) findings: Vec<Finding>,
    /// What a rule compares from process to process.
    pub(super) trace: Option<String>,
}

/// Says one line. There is nobody to tell that it can't be said.
fn say(kind: char, text: &str) {
    // In one piece, at the begin of a line whatever the unit printed before.
    let line = format!("\n{MARK}{kind}{}\n", text.replace('\n', " "));
    let _ = match OUT.get() {
        Some(out) => out.lock().unwrap_or_else(PoisonError::into_inner).write_all(line.as_bytes()),
        None => {
            let mut out = std::io::stdout().lock();
            out.write_all(line.as_bytes()).and_then(|()| out.flush())
        }
    };
}

/// Says which call comes next.
pub(super) fn say_call(text: &str) {
    say('c', text);
}

/// Hands out what is compared from process to process.
pub(super) fn say_trace(text: &str) {
    say('t', text);
}

fn serve(rule: &str, unit: &Path) -> ! {
    if let Some(out) = copy_of(1) {
        OUT.get_or_init(|| Mutex::new(out));
    }
    let master = copy_of(0);
    limit_memory();
    std::thread::spawn(|| end_with_the_master(master));
    let findings = match Fmu::open(unit) {
        Ok(fmu) => look(rule, &bench::Bench::new(fmu)),
        Err(error) => {
            let mut found = Found::new("runs");
            found.error(format!("it can't be opened: {error}"));
            found.findings
        }
    };
    // Texts only: nothing can fail.
    say('f', &serde_json::to_string(&findings).unwrap_or_default());
    leave(0)
}

/// A copy of a descriptor at a place where no unit looks for it: among the low numbers are its own files.
#[cfg(unix)]
fn copy_of(descriptor: libc::c_int) -> Option<File> {
    use std::os::fd::FromRawFd as _;
    /// Below what a process may have open by default, above what it has open.
    const HIGH: libc::c_int = 700;
    // SAFETY: plain numbers; the answer is a new descriptor or -1.
    let copy = unsafe { libc::fcntl(descriptor, libc::F_DUPFD_CLOEXEC, HIGH) };
    // SAFETY: nobody else has it.
    (copy >= 0).then(|| unsafe { File::from_raw_fd(copy) })
}

#[cfg(not(unix))]
fn copy_of(_: i32) -> Option<File> {
    None
}

/// Ends the process without what a unit has registered for its end.
fn leave(status: i32) -> ! {
    orchestrator::fmu::discard_unpacked();
    // SAFETY: never returns, and nothing is used afterwards.
    unsafe { libc::_exit(status) }
}

/// The master holds the other end of the standard input: when it has gone, nobody waits for this process.
fn end_with_the_master(master: Option<File>) {
    let read = match master {
        Some(mut master) => master.read(&mut [0]),
        None => std::io::stdin().read(&mut [0]),
    };
    // An error is no end: a unit has closed it.
    if read.is_ok() {
        leave(1);
    }
}

fn limit_memory() {
    #[cfg(unix)]
    if let Some(limit) = std::env::var(MEMORY).ok().and_then(|text| text.parse().ok()) {
        let limit = libc::rlimit { rlim_cur: limit, rlim_max: limit };
        // SAFETY: plain data.
        unsafe { libc::setrlimit(libc::RLIMIT_DATA, &limit) };
    }
}

/// Looks at a rule in a process of its own.
pub(super) fn run(rule: &'static str, unit: &Path, limits: &Limits) -> Result<Ended, Error> {
    // What the unit prints of itself is shown once, with the first rule.
    let first = rule == super::RULES[0].id;
    // What a process leaves that a unit ends goes with this folder.
    let room = Bench::new().map_err(|error| Error::Host(error.to_string()))?;
    let mut child = process(rule, unit, limits, first, room.path())?;
    let Some(out) = child.stdout.take() else { return Err(Error::Host("it has no output".into())) };
    let lines = listen(out, first);
    let mut calls: VecDeque<String> = VecDeque::new();
    let mut ended = Ended { findings: Vec::new(), trace: None };
    let hung = loop {
        match lines.recv_timeout(limits.call) {
            Ok(Line::Call(call)) => {
                if calls.len() == REMEMBERED {
                    calls.pop_front();
                }
                calls.push_back(call);
            }
            Ok(Line::Trace(trace)) => ended.trace = Some(trace),
            Ok(Line::Findings(findings)) => {
                ended.findings = findings;
                let _ = child.kill();
                let _ = child.wait();
                return Ok(ended);
            }
            Err(RecvTimeoutError::Timeout) => break true,
            Err(RecvTimeoutError::Disconnected) => break false,
        }
    };
    // Whoever can't be heard any more need not have ended.
    let status = if hung { None } else { ended_within(&mut child, limits.call)? };
    let (end, how) = match status {
        Some(status) => how(status),
        None => {
            let _ = child.kill();
            let _ = child.wait();
            let seconds = limits.call.as_secs_f64();
            let gone = if hung { "" } else { "closed the files of its process and " };
            ("endless-loop", format!("{gone}did not come back within {seconds} s"))
        }
    };
    let mut found = Found::new(end);
    found.error(format!("the unit {how} in {}", last_calls(calls.make_contiguous(), rule)));
    ended.findings.append(&mut found.findings);
    Ok(ended)
}

/// How a process ended, if it does so in time. Its standard input stays open meanwhile: closed, it would end the process.
fn ended_within(child: &mut Child, limit: Duration) -> Result<Option<ExitStatus>, Error> {
    let begin = Instant::now();
    loop {
        let status = child.try_wait().map_err(|error| Error::Host(error.to_string()))?;
        if status.is_some() || begin.elapsed() >= limit {
            return Ok(status);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Starts this program again to look at a rule; temporary files go into a folder.
fn process(
    rule: &str,
    unit: &Path,
    limits: &Limits,
    is_heard: bool,
    temporary: &Path,
) -> Result<Child, Error> {
    let (program, arguments) =
        HOST.get().cloned().ok_or_else(|| Error::Host("this program does not call host_rules".into()))?;
    let mut command = Command::new(&program);
    command.args(arguments).env(RULE, rule).env(UNIT, unit).env(MEMORY, limits.memory.to_string());
    command.env(TUNABLES.0, TUNABLES.1);
    // The first is Unix's name, the others are those of Windows.
    command.env("TMPDIR", temporary).env("TMP", temporary).env("TEMP", temporary);
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt as _;
        // A group of its own: keys and signals that are meant for the master don't reach it.
        command.process_group(0);
    }
    let errors = if is_heard { Stdio::inherit() } else { Stdio::null() };
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(errors);
    command.spawn().map_err(|error| Error::Host(format!("{}: {error}", program.display())))
}

/// The call that did not come back, the rule, and the calls before, in words.
fn last_calls(calls: &[String], rule: &str) -> String {
    let last = calls.last().map_or("loading the library", String::as_str);
    let before = if calls.len() > 1 {
        format!("; calls before: {}", calls[..calls.len() - 1].join(", "))
    } else {
        String::new()
    };
    format!("{last}, while the rule {rule} was looked at{before}")
}

/// The kind of an end and words for it.
fn how(status: ExitStatus) -> (&'static str, String) {
    #[cfg(unix)]
    {
        use std::os::unix::process::ExitStatusExt as _;
        if let Some(signal) = status.signal() {
            let name = match signal {
                libc::SIGSEGV => " (SIGSEGV, a segmentation fault)",
                libc::SIGBUS => " (SIGBUS, a bus error)",
                libc::SIGILL => " (SIGILL, an illegal instruction)",
                libc::SIGFPE => " (SIGFPE, an arithmetic fault)",
                libc::SIGABRT => " (SIGABRT, it gave up)",
                _ => "",
            };
            return ("crash", format!("ended its process by signal {signal}{name}"));
        }
    }
    ("exit", format!("ended its process by exit with status {}", status.code().unwrap_or_default()))
}

/// A line that is longer is read in pieces of so many bytes: hundred times the findings about a unit of a thousand variables.
const LONGEST_LINE: u64 = 1 << 24;

/// Reads what the process says, for as long as it lives.
fn listen(out: ChildStdout, show: bool) -> Receiver<Line> {
    let (tell, heard) = channel();
    std::thread::spawn(move || {
        let mut lines = BufReader::new(out);
        let mut bytes = Vec::new();
        // a unit that prints without end ends no line
        while lines.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut bytes).is_ok_and(|read| read > 0) {
            let text = String::from_utf8_lossy(&bytes);
            let text = text.trim_end_matches(['\n', '\r']);
            let said = text.strip_prefix(MARK).and_then(|rest| Some((rest.chars().next()?, rest.get(1..)?)));
            let line = match said {
                Some(('c', call)) => Some(Line::Call(call.to_owned())),
                Some(('t', trace)) => Some(Line::Trace(trace.to_owned())),
                Some(('f', findings)) => serde_json::from_str(findings).ok().map(Line::Findings),
                _ => {
                    if show && !text.is_empty() {
                        eprintln!("{text}");
                    }
                    None
                }
            };
            if line.is_some_and(|line| tell.send(line).is_err()) {
                return;
            }
            bytes.clear();
        }
    });
    heard
}
