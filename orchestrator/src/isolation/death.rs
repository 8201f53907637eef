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
}

impl Death {
    /// The error; `function` is the call that brought it to light.
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
        let (how, inputs, calls) = (self.how.clone(), inputs.collect(), calls.collect());
        let post_mortem = Box::new(PostMortem { how, inputs, calls, log });
        Error::Died { unit: unit.into(), function, time, post_mortem }
    }
}

/// How a process ended, in words that complete "its process".
pub(super) fn how(status: ExitStatus, isolation: &Isolation) -> String {
    let limit = isolation.memory_limit.map_or_else(String::new, |limit| {
        let mebibytes = limit as f64 / f64::from(1 << 20);
        format!(", perhaps for want of memory: it may have {mebibytes} MiB (memory_limit)")
    });
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
