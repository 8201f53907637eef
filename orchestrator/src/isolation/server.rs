//! The process of a unit: loads its library, has the calls made that come through shared memory (`answer.rs`), and ends.

use super::answer::Call;
use super::memory::{Part, Shared, Side, UnderWay};
use super::message::{Reader, Writer};
use crate::fmu::library::{Callbacks, Component, Functions, Library};
use crate::fmu::logger::{self, LogLine, Sink, calloc, free, orchestrator_logger};
use crate::fmu::{Function, Status, control_word};
use crate::guard;
use std::ffi::{CString, c_int, c_void};
use std::io::Read as _;
use std::os::fd::{FromRawFd, OwnedFd, RawFd};
use std::path::Path;
use std::ptr;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;

/// Names the descriptor of the shared memory, in the environment of the process.
pub(super) const MEMORY: &str = "ACROSCOPE_UNIT_MEMORY";
/// Bytes that the process may have, if they are limited.
pub(super) const LIMIT: &str = "ACROSCOPE_UNIT_MEMORY_LIMIT";

/// Threads of the process, without those of its unit: the one that calls it, and the one that waits for the master's end.
pub(super) const THREADS: usize = 2;

/// The memory, for log lines: they must be there when the process ends in the middle of a call.
static MEMORY_OF_LOG: OnceLock<Mutex<Shared>> = OnceLock::new();

/// Serves the master until it has gone or frees the instance. Never returns.
pub(super) fn serve(descriptor: i32) -> ! {
    // SAFETY: a question.
    let (master, input) = (unsafe { libc::getppid() }, file_of(libc::STDIN_FILENO));
    // Before its memory is limited: a thread needs some.
    if std::thread::Builder::new().spawn(move || end_with_the_master(master, input)).is_err() {
        std::process::exit(1);
    }
    if let Some(limit) = std::env::var(LIMIT).ok().and_then(|text| text.parse().ok()) {
        let limit = libc::rlimit { rlim_cur: limit, rlim_max: limit };
        // SAFETY: plain data. Shared memory does not count as data.
        unsafe { libc::setrlimit(libc::RLIMIT_DATA, &limit) };
    }
    // SAFETY: the master opened the descriptor for this process.
    let file = unsafe { OwnedFd::from_raw_fd(descriptor) };
    let again = file.try_clone();
    let (Ok(mut shared), Ok(Ok(log))) = (Shared::map(file), again.map(Shared::map)) else {
        std::process::exit(1)
    };
    MEMORY_OF_LOG.get_or_init(|| Mutex::new(log));
    logger::forward_to(tell);
    let process = std::process::id();
    // SAFETY: the memory stays mapped as long as this process lives, and the word is atomic.
    let under_way = unsafe { &*ptr::from_ref(shared.under_way()) };
    let mut unit = None;
    loop {
        while !shared.wait_for(Side::Server, Duration::from_secs(3600)) {}
        let length = shared.length(Part::Request);
        // Copied neither way: the request stays as it is while the answer is written beside it.
        let request = ptr::slice_from_raw_parts(shared.part(Part::Request).as_ptr(), length);
        let mut answer = Writer::at(shared.part(Part::Answer), 0);
        // SAFETY: the parts don't overlap, and the client writes only in its own turn.
        let mut reader = Reader::at(unsafe { &*request }, 0);
        while !reader.is_empty() {
            if answered(&mut unit, &mut reader, &mut answer, under_way).is_none_or(|status| status > 1) {
                break;
            }
        }
        if std::process::id() != process {
            // A copy that the unit split off, and that came back from the call as well: the master waits for one answer.
            // SAFETY: ends the copy without what a unit has registered for its end.
            unsafe { libc::_exit(0) };
        }
        under_way.set(None);
        let end = answer.end().unwrap_or(0);
        shared.set_length(Part::Answer, end);
        shared.hand_to(Side::Client);
        if matches!(unit, Some(Unit { component, .. }) if component.is_null()) {
            std::process::exit(0);
        }
    }
}

/// The master holds the other end of the standard input: when it has gone, nobody waits for this process. A unit may close that descriptor, or take
/// it for a file of its own, before it is read here: what it gives then says nothing, and the parent is looked at instead.
fn end_with_the_master(master: libc::pid_t, input: Option<Inode>) {
    let _ = std::io::stdin().read(&mut [0]);
    if file_of(libc::STDIN_FILENO) != input {
        // SAFETY: a question; who has lost its parent has another one.
        while unsafe { libc::getppid() } == master {
            std::thread::sleep(Duration::from_millis(100));
        }
    }
    // SAFETY: ends the process without what a unit has registered for its end.
    unsafe { libc::_exit(1) };
}

/// Device and number of what a descriptor stands for.
type Inode = (libc::dev_t, libc::ino_t);

/// `None` where the descriptor is closed.
fn file_of(descriptor: RawFd) -> Option<Inode> {
    // SAFETY: plain data, which the system fills.
    let (status, found) = unsafe {
        let mut found: libc::stat = std::mem::zeroed();
        (libc::fstat(descriptor, &raw mut found), found)
    };
    (status == 0).then_some((found.st_dev, found.st_ino))
}

fn tell(line: &LogLine) {
    let Some(shared) = MEMORY_OF_LOG.get() else { return };
    let mut shared = shared.lock().unwrap_or_else(PoisonError::into_inner);
    let at = shared.length(Part::Log);
    let mut writer = Writer::at(shared.part(Part::Log), at);
    writer.number(u64::from(line.status.number().cast_unsigned()));
    writer.bytes(line.category.as_bytes());
    writer.bytes(line.text.as_bytes());
    // The first lines of a call that logs too much are kept.
    if let Some(end) = writer.end() {
        shared.set_length(Part::Log, end);
    }
}

/// The instance; the pointer is null once it was freed.
struct Unit {
    component: Component,
    functions: Functions,
    _library: Library,
    _callbacks: Box<Callbacks>,
    _sink: Arc<Sink>,
}

/// Makes one call; what it answered. `None` where the request makes no sense.
fn answered(
    unit: &mut Option<Unit>,
    request: &mut Reader<'_>,
    answer: &mut Writer<'_>,
    under_way: &UnderWay,
) -> Option<c_int> {
    let function = Function::of(u8::try_from(request.number()?).ok()?)?;
    under_way.set(Some(function as u32));
    if function == Function::Instantiate {
        return instantiate(unit, request, answer);
    }
    let unit = unit.as_mut()?;
    let Unit { component, functions, .. } = unit;
    let mut call = Call { component, functions, request, answer };
    // SAFETY: the instance is alive, and the request is one of the client's.
    let status = control_word::kept(|| unsafe { call.make(function) });
    if status.is_none() {
        // Asked for what the library lacks, or in words that make no sense.
        answer.number(u64::from(3u32));
    }
    status
}

fn instantiate(unit: &mut Option<Unit>, request: &mut Reader<'_>, answer: &mut Writer<'_>) -> Option<c_int> {
    let mut text = || Some(String::from_utf8_lossy(request.bytes()?).into_owned());
    let (library, name, guid, resources) = (text()?, text()?, text()?, text()?);
    let library = match Library::load(Path::new(&library), Path::new(&library), guard::label(&name)) {
        Ok(library) => library,
        Err(error) => {
            answer.number(0);
            answer.bytes(error.to_string().as_bytes());
            return Some(0);
        }
    };
    let functions = library.functions;
    let sink = Sink::new(functions.instantiate as *const c_void);
    let callbacks = Box::new(Callbacks {
        logger: orchestrator_logger,
        allocate: calloc,
        free,
        step_finished: None,
        environment: sink.environment() as *mut c_void,
    });
    let text = |text: String| CString::new(text).unwrap_or_default();
    let (name, guid, resources) = (text(name), text(guid), text(resources));
    // SAFETY: all strings end in zero and live over the call; callbacks and log outlive the instance.
    let component = unsafe {
        (functions.instantiate)(name.as_ptr(), 1, guid.as_ptr(), resources.as_ptr(), &*callbacks, 0, 1)
    };
    answer.number(1);
    answer.number(u64::from(!component.is_null()));
    answer.number(super::table::optional(&functions));
    *unit = Some(Unit { component, functions, _library: library, _callbacks: callbacks, _sink: sink });
    Some(0)
}

/// For [`Status`] to be sent.
impl Status {
    fn number(self) -> c_int {
        match self {
            Self::Ok => 0,
            Self::Warning => 1,
            Self::Discard => 2,
            Self::Error => 3,
            Self::Fatal => 4,
            Self::Pending => 5,
            Self::Unknown(other) => other,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::file_of;
    use std::os::fd::AsRawFd;

    #[test]
    fn value_a_descriptor_that_is_closed_or_taken_for_another_file_is_told() {
        let (mine, _other) = std::io::pipe().expect("a pipe");
        let null = std::fs::File::open("/dev/null").expect("it is there");
        // A number of its own, which no other test opens in between.
        // SAFETY: new descriptors of this test's own files.
        let descriptor = unsafe { libc::fcntl(mine.as_raw_fd(), libc::F_DUPFD_CLOEXEC, 700) };
        let before = file_of(descriptor);
        assert!(before.is_some() && before == file_of(mine.as_raw_fd()));
        // SAFETY: as above.
        unsafe { libc::dup2(null.as_raw_fd(), descriptor) };
        assert!(file_of(descriptor).is_some_and(|now| Some(now) != before));
        // SAFETY: as above.
        unsafe { libc::close(descriptor) };
        assert_eq!(file_of(descriptor), None);
    }
}
