//! Collects what a unit logs. The C half (`logger.c`) formats; this half keeps the newest lines.

use crate::fmu::Status;
use std::borrow::Cow;
use std::collections::{BTreeMap, VecDeque};
use std::ffi::{CStr, c_char, c_int, c_void};
use std::fmt;
use std::ptr;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};

/// How many lines are kept per instance; older ones are dropped so that a chatty unit doesn't fill the memory.
const KEPT: usize = 256;

/// One message of a unit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LogLine {
    /// Severity that the unit gave.
    pub status: Status,
    /// Category that the unit gave; empty if none.
    pub category: String,
    /// The message, formatted.
    pub text: String,
}

impl fmt::Display for LogLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (category, text) = (shown(&self.category), shown(&self.text));
        match self.category.is_empty() {
            true => write!(f, "[{}] {text}", self.status),
            false => write!(f, "[{}, {category}] {text}", self.status),
        }
    }
}

/// A text without what a terminal would obey: control characters other than new lines and tabs are written out.
fn shown(text: &str) -> Cow<'_, str> {
    let is_plain = |letter: char| !letter.is_control() || matches!(letter, '\n' | '\t');
    if text.chars().all(is_plain) {
        return text.into();
    }
    let one =
        |letter: char| if is_plain(letter) { letter.into() } else { letter.escape_default().to_string() };
    text.chars().map(one).collect::<String>().into()
}

/// The log of one instance. Its address is the `componentEnvironment` that the unit gets, and is only ever compared:
/// some units log with a pointer of their own.
pub(crate) struct Sink {
    /// Where the unit's library lies in memory; 0 if that is not known.
    home: usize,
    lines: Mutex<VecDeque<LogLine>>,
}

/// The logs of all live instances by their addresses.
static SINKS: Mutex<BTreeMap<usize, Weak<Sink>>> = Mutex::new(BTreeMap::new());

/// Where all lines go in a process that only serves a unit.
static FORWARD: OnceLock<fn(&LogLine)> = OnceLock::new();

/// Has all lines of this process handed on.
#[cfg(isolation)]
pub(crate) fn forward_to(forward: fn(&LogLine)) {
    FORWARD.get_or_init(|| forward);
}

impl Sink {
    /// A log for an instance of the library that holds a function.
    pub(crate) fn new(function: *const c_void) -> Arc<Self> {
        // SAFETY: the C half keeps the pointer to a function that lives as long as the program.
        unsafe { orchestrator_logger_receiver(receive) };
        let sink = Arc::new(Self { home: home_of(function), lines: Mutex::new(VecDeque::new()) });
        locked(&SINKS).insert(sink.environment(), Arc::downgrade(&sink));
        sink
    }

    /// The `componentEnvironment`.
    pub(crate) fn environment(self: &Arc<Self>) -> usize {
        Arc::as_ptr(self) as usize
    }

    /// The lines that are kept, oldest first.
    pub(crate) fn lines(&self) -> Vec<LogLine> {
        locked(&self.lines).iter().cloned().collect()
    }

    /// Takes the lines away.
    pub(crate) fn take(&self) -> Vec<LogLine> {
        locked(&self.lines).drain(..).collect()
    }

    /// Keeps a line, or hands it on.
    pub(crate) fn push(&self, line: LogLine) {
        if let Some(forward) = FORWARD.get() {
            return forward(&line);
        }
        let mut lines = locked(&self.lines);
        if lines.len() == KEPT {
            lines.pop_front();
        }
        lines.push_back(line);
    }
}

impl Drop for Sink {
    fn drop(&mut self) {
        locked(&SINKS).remove(&(ptr::from_ref(self) as usize));
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Where the library that holds an address lies in memory; 0 if that is not known.
pub(crate) fn home_of(address: *const c_void) -> usize {
    #[cfg(unix)]
    {
        // SAFETY: the structure is plain data that the call fills; any address may be asked for.
        let (found, library) = unsafe {
            let mut library: libc::Dl_info = std::mem::zeroed();
            (libc::dladdr(address, &mut library), library)
        };
        if found != 0 { library.dli_fbase as usize } else { 0 }
    }
    #[cfg(not(unix))]
    {
        let _ = address;
        0
    }
}

/// A line from a unit. One with an environment that is nobody's goes to all instances of the library that sent it, or to
/// every instance if that is not known either: better told twice than lost.
extern "C" fn receive(
    environment: *const c_void,
    caller: *const c_void,
    status: c_int,
    category: *const c_char,
    text: *const c_char,
) {
    let mut line = LogLine { status: Status::from(status), category: owned(category), text: owned(text) };
    // Let go before the lines are kept: the last owner of a log takes it off this list.
    let all: Vec<(usize, Arc<Sink>)> = {
        let sinks = locked(&SINKS);
        match sinks.get(&(environment as usize)).and_then(Weak::upgrade) {
            Some(sink) => vec![(environment as usize, sink)],
            None => sinks.iter().filter_map(|(key, sink)| Some((*key, sink.upgrade()?))).collect(),
        }
    };
    if let [(key, sink)] = all.as_slice()
        && *key == environment as usize
    {
        return sink.push(line);
    }
    line.text.insert_str(0, "unknown instance: ");
    let home = home_of(caller);
    let known = home != 0 && all.iter().any(|(_, sink)| sink.home == home);
    for (_, sink) in all.iter().filter(|(_, sink)| !known || sink.home == home) {
        sink.push(line.clone());
    }
}

/// A C string as text; null gives an empty one, bytes that are no UTF-8 are replaced.
pub(crate) fn owned(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: not null, and the standard promises a terminated string.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

type Receiver = extern "C" fn(*const c_void, *const c_void, c_int, *const c_char, *const c_char);

unsafe extern "C" {
    /// Tells `logger.c` where formatted lines go.
    fn orchestrator_logger_receiver(receive: Receiver);
    /// `fmi2CallbackLogger`, defined in `logger.c`.
    pub(crate) fn orchestrator_logger(
        environment: *mut c_void,
        instance: *const c_char,
        status: c_int,
        category: *const c_char,
        message: *const c_char,
        ...
    );
    /// `fmi2CallbackAllocateMemory`: the C library's.
    pub(crate) fn calloc(count: usize, size: usize) -> *mut c_void;
    /// `fmi2CallbackFreeMemory`: the C library's.
    pub(crate) fn free(memory: *mut c_void);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_a_units_words_don_t_command_the_terminal() {
        let line = |text: &str| {
            LogLine { status: Status::Ok, category: String::new(), text: text.into() }.to_string()
        };
        assert_eq!(line("a\u{1b}[2Jb\r\n\tc \u{e4}"), "[ok] a\\u{1b}[2Jb\\r\n\tc \u{e4}");
    }

    /// One at a time: a line for nobody goes to all logs of the program.
    static ALONE: Mutex<()> = Mutex::new(());

    #[cfg(unix)]
    /// The texts that a log holds after a line of a caller with somebody's environment.
    fn told(sink: &Arc<Sink>, environment: usize, caller: *const c_void) -> Vec<String> {
        receive(environment as *const c_void, caller, 1, c"events".as_ptr(), c"word".as_ptr());
        sink.take().into_iter().map(|line| line.to_string()).collect()
    }

    #[cfg(unix)] // elsewhere it is not known whose library an address is of
    #[test]
    fn law_a_line_for_nobody_goes_to_its_library_or_to_all() {
        let _alone = locked(&ALONE);
        let (here, libc) = (told as *const c_void, libc::getpid as *const c_void);
        assert!(home_of(here) != 0 && home_of(libc) != 0 && home_of(here) != home_of(libc));
        let (ours, theirs) = (Sink::new(here), Sink::new(libc));
        assert_eq!(
            told(&ours, ours.environment(), libc),
            ["[warning, events] word"],
            "by its own environment"
        );
        let unknown = ["[warning, events] unknown instance: word"];
        assert_eq!(told(&ours, 8, here), unknown);
        assert!(theirs.lines().is_empty(), "not its library");
        // Of a library that is nobody's, or of none that is known.
        drop(ours);
        assert_eq!(told(&theirs, 8, here), unknown);
        assert_eq!(told(&theirs, 8, ptr::null()), unknown);
    }

    #[test]
    fn law_a_log_that_has_gone_is_off_the_list_and_one_that_is_long_keeps_its_end() {
        let _alone = locked(&ALONE);
        let sink = Sink::new(ptr::null());
        let environment = sink.environment();
        assert!(locked(&SINKS).contains_key(&environment));
        for number in 0..=KEPT {
            sink.push(LogLine { status: Status::Ok, category: String::new(), text: number.to_string() });
        }
        let lines = sink.lines();
        assert_eq!((lines.len(), lines[0].text.as_str(), lines[KEPT - 1].text.as_str()), (KEPT, "1", "256"));
        drop(sink);
        assert!(locked(&SINKS).get(&environment).is_none_or(|other| other.upgrade().is_some()));
    }
}
