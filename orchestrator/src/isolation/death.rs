//! How the process of a unit ended, and what it was at.

use super::Isolation;
use super::message::Reader;
use crate::error::{Error, PostMortem};
use crate::fmu::logger::LogLine;
use crate::fmu::{Description, Function};
use crate::value::Kind;
use std::os::unix::process::ExitStatusExt as _;
use std::process::ExitStatus;

/// A call that was made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Recorded {
    pub(super) function: Function,
    /// Variables that it was about.
    pub(super) count: usize,
    /// Begin and size of a step in s.
    pub(super) from: f64,
    pub(super) size: f64,
}

/// The end of a process.
#[derive(Debug, Clone)]
pub(crate) struct Death {
    /// Completes "its process ...".
    pub(super) how: String,
    /// What was sent with the last request: name and value.
    pub(super) inputs: Vec<(String, String)>,
    /// The last calls, the one under way last.
    pub(super) calls: Vec<Recorded>,
    /// The function that the process was in, if in any: calls are sent together, and this one may be another than the one that brought
    /// its end to light.
    pub(super) under_way: Option<Function>,
}

impl Death {
    /// The error; `function` is the call that brought it to light, and is named where the process was in none.
    pub(crate) fn error(
        &self,
        unit: &str,
        function: &'static str,
        time: Option<f64>,
        log: Vec<LogLine>,
    ) -> Error {
        let calls = self.calls.iter().map(|call| {
            let name = call.function.name();
            match (call.function, call.count) {
                (Function::DoStep, _) => format!("{name} from {} s by {} s", call.from, call.size),
                (_, 0) => name.to_owned(),
                (_, count) => format!("{name} of {count}"),
            }
        });
        let inputs = self.inputs.iter().map(|(name, value)| format!("{name} = {value}"));
        let function = self.under_way.map_or(function, Function::name);
        let (how, inputs, calls) = (self.how.clone(), inputs.collect(), calls.collect());
        let post_mortem = Box::new(PostMortem { how, inputs, calls, log });
        Error::Died { unit: unit.into(), function, time, post_mortem }
    }
}

/// Calls up to the one under way. A value that was set waited for the step that is behind it in the list; a read that was made with a step
/// is not in it yet.
pub(super) fn ending_with(under_way: Option<Function>, mut calls: Vec<Recorded>) -> Vec<Recorded> {
    let Some(function) = under_way else { return calls };
    let is_set = matches!(
        function,
        Function::SetReal | Function::SetInteger | Function::SetBoolean | Function::SetString
    );
    match calls.iter().rposition(|call| call.function == function) {
        Some(place) if is_set || place + 1 == calls.len() => calls.truncate(place + 1),
        _ => calls.push(Recorded { function, count: 0, from: 0.0, size: 0.0 }),
    }
    calls
}

/// How a process ended that had so many bytes at most, in words that complete "its process".
pub(super) fn how(status: ExitStatus, isolation: &Isolation, most: Option<u64>) -> String {
    let limit = match (most, isolation.memory_limit) {
        (Some(most), Some(limit)) if is_near(most, limit) => want_of_memory(isolation),
        _ => String::new(),
    };
    match (status.code(), status.signal()) {
        (Some(0), _) => "ended by exit with status 0".into(),
        (Some(code), _) => format!("ended by exit with status {code}{limit}"),
        // What comes of memory that is not there; other signals have other reasons.
        (_, Some(signal @ (libc::SIGSEGV | libc::SIGBUS | libc::SIGABRT | libc::SIGKILL))) => {
            format!("was ended by signal {signal}{}{limit}", name(signal))
        }
        (_, Some(signal)) => format!("was ended by signal {signal}{}", name(signal)),
        _ => format!("ended ({status}){limit}"),
    }
}

/// Whether so many bytes are near a limit. A unit that is refused memory has less than it, by as much as it asked for.
pub(super) fn is_near(bytes: u64, limit: u64) -> bool {
    bytes >= limit / 4 * 3
}

/// That a limit may be the reason, if there is one.
pub(super) fn want_of_memory(isolation: &Isolation) -> String {
    isolation.memory_limit.map_or_else(String::new, |limit| {
        let mebibytes = limit as f64 / f64::from(1 << 20);
        format!(", perhaps for want of memory: it may have {mebibytes} MiB (memory_limit)")
    })
}

fn name(signal: i32) -> &'static str {
    match signal {
        libc::SIGSEGV => " (SIGSEGV, a segmentation fault)",
        libc::SIGBUS => " (SIGBUS, a bus error)",
        libc::SIGILL => " (SIGILL, an illegal instruction)",
        libc::SIGFPE => " (SIGFPE, an arithmetic fault)",
        libc::SIGABRT => " (SIGABRT, it gave up)",
        libc::SIGTERM => " (SIGTERM)",
        libc::SIGKILL => " (SIGKILL)",
        libc::SIGTRAP => " (SIGTRAP, a breakpoint)",
        libc::SIGSYS => " (SIGSYS, a call that the system does not allow)",
        libc::SIGALRM => " (SIGALRM, a timer)",
        libc::SIGXFSZ => " (SIGXFSZ, a file longer than it may be)",
        _ => "",
    }
}

/// The values that a request sets, by name.
pub(super) fn inputs(request: &[u8], description: &Description) -> Vec<(String, String)> {
    let mut all = Vec::new();
    let mut reader = Reader::at(request, 0);
    // Sets come first; whatever follows them has other arguments.
    while let Some((kind, references, values)) = set(&mut reader) {
        for (reference, value) in references.into_iter().zip(values) {
            let of = |v: &&crate::fmu::Variable| v.kind == kind && v.reference == reference;
            let name = description.variables.iter().find(of).map_or("?", |v| v.name.as_str());
            all.push((name.to_owned(), value));
        }
    }
    all
}

fn set(reader: &mut Reader<'_>) -> Option<(Kind, Vec<u32>, Vec<String>)> {
    let function = Function::of(u8::try_from(reader.number()?).ok()?)?;
    let kind = match function {
        Function::SetReal => Kind::Real,
        Function::SetInteger => Kind::Integer,
        Function::SetBoolean => Kind::Boolean,
        _ => return None,
    };
    let count = reader.count()?;
    let references = reader.values(count)?;
    let values = match kind {
        Kind::Real => reader.values::<f64>(count)?.iter().map(ToString::to_string).collect(),
        _ => reader.values::<i32>(count)?.iter().map(ToString::to_string).collect(),
    };
    Some((kind, references, values))
}
