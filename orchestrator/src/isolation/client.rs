//! The master's side of a unit in another process: starts it, sends requests and waits for answers, and says how the
//! process ended, if it did. `calls.rs` makes the requests.

use super::death::{Death, Recorded};
use super::memory::{BODY, Part, Shared, Side};
use super::message::Reader;
use super::place::{self, Mask, Running, Wanted};
use super::{Host, Isolation, server, table};
use crate::error::Error;
use crate::fmu::library::{Component, Functions};
use crate::fmu::logger::{LogLine, Sink};
use crate::fmu::{Fmu, Function, Status};
use std::collections::VecDeque;
use std::ffi::{CString, c_int};
use std::os::unix::process::CommandExt as _;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What a call on a unit that has gone answers.
pub(super) const FATAL: c_int = 4;
/// What a step answers whose inputs were discarded: a smaller one would not help.
pub(super) const ERROR: c_int = 3;
pub(super) const DISCARD: c_int = 2;
/// A sleeping master looks this often whether the process is still there.
const LOOK: Duration = Duration::from_millis(20);
/// A process that is told to end has this long for it.
const FAREWELL: Duration = Duration::from_secs(2);
/// How many calls are remembered for those who ask how it ended.
const REMEMBERED: usize = 12;

/// A read that followed the last step.
pub(super) struct Ask {
    pub(super) function: Function,
    pub(super) references: Vec<u32>,
}

/// A unit in another process.
pub(crate) struct Remote {
    pub(super) shared: Shared,
    pub(super) child: Child,
    pub(super) isolation: Isolation,
    pub(super) fmu: Fmu,
    pub(super) sink: Arc<Sink>,
    /// Where the request under construction ends, and the calls in it.
    pub(super) at: usize,
    pub(super) sent: Vec<Function>,
    /// Initialised: inputs may wait for the step.
    pub(super) stepping: bool,
    pub(super) asks: Vec<Ask>,
    /// The next read in `asks`, how many of them were answered with the last step, and where the next answer lies.
    pub(super) next: usize,
    pub(super) answered: usize,
    pub(super) answer_at: usize,
    /// Reads are those after a step.
    pub(super) following: bool,
    pub(super) texts: Vec<CString>,
    pub(super) calls: VecDeque<Recorded>,
    pub(super) death: Option<Death>,
    /// A call that was sent ahead and failed, and what it answered.
    pub(super) failed: Option<(Function, c_int)>,
    /// Calls that were sent ahead and answered with a warning.
    pub(super) warned: u64,
    /// Where the process runs, and where it may: `None` where that is not known.
    placed: Wanted,
    usual: Option<Mask>,
    _running: Running,
}

impl Remote {
    /// Starts the process and has it make the instance; the component and its functions.
    pub(crate) fn start(
        fmu: &Fmu,
        name: &str,
        isolation: &Isolation,
        sink: Arc<Sink>,
    ) -> Result<(Component, Functions), Error> {
        let failed = |reason: String| Error::Library { path: fmu.path().into(), reason };
        let host = super::host(isolation).map_err(failed)?;
        let library = fmu.library_file()?;
        let shared = Shared::new().map_err(|error| failed(format!("no shared memory: {error}")))?;
        let child = process(&host, isolation, shared.descriptor()).map_err(failed)?;
        let mut remote = Box::new(Self::new(shared, child, isolation.clone(), fmu.clone(), sink));
        let guid = fmu.guid().to_owned();
        let resources = fmu.resource_uri();
        remote.begin(Function::Instantiate, |message| {
            message.bytes(library.to_string_lossy().as_bytes());
            message.bytes(name.as_bytes());
            message.bytes(guid.as_bytes());
            message.bytes(resources.as_bytes());
        });
        let answered = remote.exchange();
        if let Some(death) = remote.death.take() {
            return Err(death.error(name, Function::Instantiate.name(), None, remote.sink.lines()));
        }
        let nonsense = || failed("its process answered what makes no sense".into());
        let mut answer = remote.answer();
        match (answered, answer.number().ok_or_else(nonsense)?) {
            (true, 1) if answer.number().ok_or_else(nonsense)? == 1 => {
                let bits = answer.number().ok_or_else(nonsense)?;
                Ok((Box::into_raw(remote).cast(), table::of(bits)))
            }
            (true, 1) => Err(Error::Instantiate {
                unit: name.into(),
                path: fmu.path().into(),
                log: remote.sink.lines(),
            }),
            _ => {
                let why = String::from_utf8_lossy(answer.bytes().ok_or_else(nonsense)?).into_owned();
                let limit = match remote.short_of_memory().is_some() || why.contains("memory") {
                    true => super::death::want_of_memory(isolation),
                    false => String::new(),
                };
                Err(failed(format!("{why}{limit}")))
            }
        }
    }

    /// A process to which nothing was sent.
    fn new(shared: Shared, child: Child, isolation: Isolation, fmu: Fmu, sink: Arc<Sink>) -> Self {
        Self {
            shared,
            child,
            isolation,
            fmu,
            sink,
            at: 0,
            sent: Vec::new(),
            stepping: false,
            asks: Vec::new(),
            next: 0,
            answered: 0,
            answer_at: 0,
            following: false,
            texts: Vec::new(),
            calls: VecDeque::with_capacity(REMEMBERED),
            death: None,
            failed: None,
            warned: 0,
            placed: Wanted { processor: None, looks: true },
            usual: place::mask(0),
            _running: Running::new(),
        }
    }

    /// How the process ended, if it did; the function that was under way takes the place of the one that was called.
    pub(crate) fn death(&self) -> Option<&Death> {
        self.death.as_ref()
    }

    /// A call that was sent ahead and failed, and what it answered, in place of the one that brought it to light.
    pub(crate) fn take_failed(&mut self) -> Option<(Function, c_int)> {
        self.failed.take()
    }

    /// How many more calls than the one that says so answered with a warning.
    pub(crate) fn take_warned(&mut self) -> u64 {
        std::mem::take(&mut self.warned)
    }

    /// The last call. The process ends, if need be by force.
    pub(super) fn free(mut self: Box<Self>) {
        if self.death.is_none() {
            self.isolation.step_limit = FAREWELL;
            self.call(Function::FreeInstance, |_| ());
            let limit = Instant::now() + FAREWELL;
            while self.death.is_none() && Instant::now() < limit {
                match self.child.try_wait() {
                    Ok(None) => std::thread::sleep(Duration::from_millis(1)),
                    _ => return,
                }
            }
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }

    /// Sends the request and waits for the answer; whether there is one.
    pub(super) fn exchange(&mut self) -> bool {
        if self.at == usize::MAX {
            self.die("was to get more than can be sent to another process".into(), true);
            return false;
        }
        let wanted = place::next();
        if wanted != self.placed {
            self.place(wanted);
        }
        self.shared.set_length(Part::Request, self.at);
        self.shared.hand_to(Side::Server);
        let mut limit = None;
        while !self.shared.wait_for(Side::Client, LOOK) {
            // It has a limit here.
            crate::guard::beat();
            if let Some(how) = self.ended() {
                // It may have answered before it went.
                if self.shared.wait_for(Side::Client, Duration::ZERO) {
                    break;
                }
                self.die(how, false);
                return false;
            }
            if super::is_to_end() {
                self.die("was ended, since the run was interrupted".into(), true);
                return false;
            }
            let limit = *limit.get_or_insert_with(|| Instant::now() + self.isolation.step_limit);
            if Instant::now() >= limit {
                let seconds = self.isolation.step_limit.as_secs_f64();
                self.die(
                    format!("was ended, since it did not come back within {seconds} s (step_limit)"),
                    true,
                );
                return false;
            }
        }
        self.collect_log();
        (self.at, self.answer_at) = (0, 0);
        true
    }

    /// That the process, which still lives, has most of the memory that it may have.
    pub(crate) fn short_of_memory(&self) -> Option<String> {
        let limit = self.isolation.memory_limit?;
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).ok()?;
        let data = status.lines().find_map(|line| line.strip_prefix("VmData:"))?;
        let bytes = data.trim().trim_end_matches(" kB").parse::<u64>().ok()? << 10;
        let mebibytes = |bytes: u64| (bytes as f64 / f64::from(1 << 20)).round();
        super::death::is_near(bytes, limit).then(|| {
            format!(
                "(of the master) its process has {} of the {} MiB that it may have: perhaps it wants memory",
                mebibytes(bytes),
                mebibytes(limit)
            )
        })
    }

    /// How the process ended, if it has.
    fn ended(&mut self) -> Option<String> {
        // Asked before it is taken off the system's list.
        let most = self.isolation.memory_limit.and_then(|_| most_memory(self.child.id().cast_signed()));
        match self.child.try_wait() {
            Ok(None) => None,
            Ok(Some(status)) => Some(super::death::how(status, &self.isolation, most)),
            // Somebody else in this process asked first, or has the system ask nobody.
            Err(_) => Some(
                "ended; how is not known, since another part of this program waits for its children".into(),
            ),
        }
    }

    /// Has the process run where it is wanted. One whose unit has threads of its own stays free: they would get in each other's way.
    #[cold]
    fn place(&mut self, wanted: Wanted) {
        self.shared.have_looks(wanted.looks);
        let process = self.child.id().cast_signed();
        if wanted.processor != self.placed.processor
            && let Some(usual) = &self.usual
        {
            let threads = threads(process);
            match wanted.processor {
                Some(processor) if (1..=server::THREADS).contains(&threads.len()) => {
                    place::put(process, &place::only(processor));
                }
                // Threads that were begun meanwhile are where their maker was.
                _ => threads.iter().for_each(|thread| {
                    place::put(*thread, usual);
                }),
            }
        }
        self.placed = wanted;
    }

    pub(super) fn answer(&mut self) -> Reader<'_> {
        self.sent.clear();
        Reader::at(answer_of(&mut self.shared), 0)
    }

    pub(super) fn nonsense(&mut self) -> c_int {
        self.die("answered what makes no sense, so its memory is spoilt".into(), true);
        FATAL
    }

    /// Ends a process whose unit has a state that can't come over.
    #[cold]
    pub(super) fn too_large(&mut self, bytes: u64) -> c_int {
        let how = format!(
            "was ended, since the unit says that its state has {bytes} bytes, of which {BODY} can leave a process of its own"
        );
        self.die(how, true);
        FATAL
    }

    #[cold]
    fn die(&mut self, how: String, by_force: bool) {
        if by_force {
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
        self.collect_log();
        let length = if self.at == usize::MAX { 0 } else { self.at };
        let request = &self.shared.part(Part::Request)[..length];
        let inputs = super::death::inputs(request, self.fmu.description());
        let under_way =
            self.shared.under_way().get().and_then(|number| Function::of(u8::try_from(number).ok()?));
        let calls = super::death::ending_with(under_way, self.calls.iter().copied().collect());
        self.death = Some(Death { how, inputs, calls, under_way });
    }

    pub(super) fn remember(&mut self, function: Function, count: usize, from: f64, size: f64) {
        if self.calls.len() == REMEMBERED {
            self.calls.pop_front();
        }
        self.calls.push_back(Recorded { function, count, from, size });
    }

    #[inline]
    fn collect_log(&mut self) {
        let length = self.shared.length(Part::Log);
        if length > 0 {
            self.take_log(length);
        }
    }

    #[cold]
    fn take_log(&mut self, length: usize) {
        let mut lines = Reader::at(&self.shared.part(Part::Log)[..length], 0);
        let mut all = Vec::new();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        while let (Some(status), Some(category), Some(line)) = (lines.number(), lines.bytes(), lines.bytes())
        {
            let status = Status::from((status as u32).cast_signed());
            all.push(LogLine { status, category: text(category), text: text(line) });
        }
        self.shared.set_length(Part::Log, 0);
        all.into_iter().for_each(|line| self.sink.push(line));
    }
}

/// Starts the process of a unit, which gets the shared memory by its descriptor.
fn process(host: &Host, isolation: &Isolation, descriptor: c_int) -> Result<Child, String> {
    let Host { program, arguments } = host;
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::piped()).env(server::MEMORY, descriptor.to_string());
    if let Some(limit) = isolation.memory_limit {
        command.env(server::LIMIT, limit.to_string());
    }
    // A group of its own: keys and signals that are meant for the master don't reach it.
    command.process_group(0);
    // SAFETY: between fork and exec only a call that is allowed there.
    unsafe {
        command.pre_exec(move || match libc::fcntl(descriptor, libc::F_SETFD, 0) {
            0 => Ok(()),
            _ => Err(std::io::Error::last_os_error()),
        })
    };
    command.spawn().map_err(|error| format!("{} can't be started: {error}", program.display()))
}

/// The most memory that a process had which has ended and was not asked about yet, in bytes. What it was split from counts, too.
fn most_memory(process: i32) -> Option<u64> {
    // SAFETY: plain data, which the system fills; the process stays on its list.
    unsafe {
        let mut found: libc::siginfo_t = std::mem::zeroed();
        let mut usage: libc::rusage = std::mem::zeroed();
        let how = libc::WEXITED | libc::WNOHANG | libc::WNOWAIT;
        let status =
            libc::syscall(libc::SYS_waitid, libc::P_PID, process, &raw mut found, how, &raw mut usage);
        (status == 0 && found.si_pid() == process).then(|| usage.ru_maxrss.cast_unsigned() << 10)
    }
}

/// Those of a process; none where the system does not say.
fn threads(process: i32) -> Vec<i32> {
    let all = std::fs::read_dir(format!("/proc/{process}/task")).into_iter().flatten().flatten();
    all.filter_map(|thread| thread.file_name().to_str()?.parse().ok()).collect()
}

pub(super) fn answer_of(shared: &mut Shared) -> &[u8] {
    let length = shared.length(Part::Answer);
    &shared.part(Part::Answer)[..length]
}
