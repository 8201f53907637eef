//! Parts of sentences that errors have in common.

use crate::fmu::LogLine;

pub(crate) fn at(time: Option<f64>) -> String {
    time.map_or_else(String::new, |time| format!(" at t = {time} s"))
}

/// The names of the first of several, and how many more there are: each is looked for, and they may be a hundred thousand.
pub(crate) fn few<T>(all: &[T], name: impl Fn(&T) -> String) -> String {
    const FEW: usize = 3;
    let first = all.iter().take(FEW).map(name).collect::<Vec<_>>().join(", ");
    match all.len().saturating_sub(FEW) {
        0 => first,
        more => format!("{first} and {more} more"),
    }
}

pub(crate) fn reached(last: Option<f64>) -> String {
    last.map_or_else(String::new, |last| format!(" by the unit, which reached t = {last} s"))
}

pub(crate) fn listed(what: &str, items: &[String]) -> String {
    if items.is_empty() { String::new() } else { format!("\n  {what}: {}", items.join(", ")) }
}

/// Lines of a log that are told with an error.
const SHOWN: usize = 5;

/// What a unit said that gave no instance, or what most often is the reason if it said nothing.
pub(crate) fn reasons(log: &[LogLine]) -> String {
    match log {
        [] => ", and no reason: most often the guid in its description is not that of its library, or it doesn't find its resources".into(),
        log => tail(log),
    }
}

/// The last lines of a log, each on its own line.
pub(crate) fn tail(log: &[LogLine]) -> String {
    let newest = &log[log.len().saturating_sub(SHOWN)..];
    newest.iter().map(|line| format!("\n  {line}")).collect()
}
