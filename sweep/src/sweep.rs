//! The sweep itself: which parts are due, their cases on threads, their rows in order into files, and the page when all parts
//! are there.

use crate::data::{CaseFile, Counts, SignalFile, Stamp};
use crate::error::Error;
use crate::page;
use crate::parts::Parts;
use crate::plan::{self, Plan};
use crate::pool;
use crate::probe;
use crate::worker::{CaseRow, Worker};
use report::Program;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What is asked for beside the study, of all runs alike.
#[derive(Debug, Clone, Default)]
pub struct Limits {
    /// `unit.variable` and value, as typed.
    pub set: Vec<(String, String)>,
    /// Stop time, as typed.
    pub stop: Option<String>,
    /// Every unit in a process of its own: one that crashes costs its case only.
    pub isolate: bool,
    /// Real time that a call into an isolated unit may take.
    pub step: Option<Duration>,
    /// Memory that an isolated unit may have, in bytes.
    pub memory: Option<u64>,
}

/// How a sweep is made, and where to.
#[derive(Debug, Clone)]
pub struct Options {
    /// Folder of the data set.
    pub out: PathBuf,
    /// Threads; `None`: as many as this process may use.
    pub jobs: Option<usize>,
    /// Only part K of N.
    pub partition: Option<(u64, u64)>,
    /// What makes it, for the page.
    pub program: Program,
    /// The command that makes it again, for the page.
    pub command: String,
}

impl Options {
    /// All of it, on all cores.
    pub fn new(out: impl Into<PathBuf>) -> Self {
        Self {
            out: out.into(),
            jobs: None,
            partition: None,
            program: Program::default(),
            command: String::new(),
        }
    }
}

/// Who looks on. Called from any thread.
pub trait Watch: Sync {
    /// So many cases are to be run; so many are there already.
    fn begin(&self, due: u64, there: u64);

    /// So many cases more were run.
    fn ran(&self, cases: u64);

    /// Something that a person should know.
    fn note(&self, text: &str);

    /// Whether the end is asked for.
    fn ends(&self) -> bool;
}

/// Nobody looks on.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Watch for Silent {
    fn begin(&self, _: u64, _: u64) {}
    fn ran(&self, _: u64) {}
    fn note(&self, _: &str) {}
    fn ends(&self) -> bool {
        false
    }
}

/// What was done.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Done {
    /// Cases of the whole study.
    pub cases: u64,
    /// Cases that were run now.
    pub ran: u64,
    /// Cases that failed, of the parts that this call made or found.
    pub failed: u64,
    /// What is to be told of cases whose scalars passed values over that are not finite, if there are any in these parts.
    pub not_finite: Option<String>,
    /// Parts that are there, and of how many.
    pub parts: (u64, u64),
    /// The page, if all parts are there.
    pub page: Option<PathBuf>,
}

/// Makes the parts that are due, and the page when all are there.
///
/// # Errors
/// If the folder holds something else, or a file can't be written; if the end was asked for. A case that fails is a row.
pub fn sweep(plan: &Plan, options: &Options, watch: &dyn Watch) -> Result<Done, Error> {
    let out = &options.out;
    let mut parts =
        Parts::look(out, &plan.fingerprint, plan.cases(), options.partition, !plan.signals.is_empty())?;
    if options.partition.is_none() {
        parts.sweep_up();
    }
    plan.notices.iter().for_each(|notice| watch.note(notice));
    if parts.removed > 0 {
        watch.note(&format!("{} parts of another study, scenario or unit gave way", parts.removed));
    }
    if let Some(lost) = parts.words_of_lost() {
        watch.note(&lost);
    }
    let due: u64 =
        parts.due.iter().map(|part| range(&parts, *part)).map(|cases| cases.end - cases.start).sum();
    let there: u64 =
        parts.finished.iter().map(|(part, _)| range(&parts, *part)).map(|c| c.end - c.start).sum();
    if !parts.finished.is_empty() {
        let (finished, of) = (parts.finished.len(), parts.of);
        watch.note(&format!("{finished} of {of} parts are there and are not made again"));
    }
    if !parts.due.is_empty() {
        let [study, resolved] = plan::files(out);
        write(&study, &plan.text)?;
        write(&resolved, &plan.resolved)?;
        watch.begin(due, there);
        let probed = probe::probe(plan)?;
        if let Some(note) = probed.note {
            watch.note(note);
        }
        run(plan, options, &mut parts, probed.reuse, watch)?;
    }
    let page = match parts.all_there() {
        true => Some(page::write(plan, &parts, options)?),
        false => None,
    };
    let counts = Counts::sum(parts.finished.iter().map(|(_, counts)| *counts));
    Ok(Done {
        cases: plan.cases(),
        ran: due,
        failed: counts.failed,
        not_finite: counts.words(),
        parts: (parts.finished.len() as u64, parts.of),
        page,
    })
}

fn range(parts: &Parts, part: u64) -> Range<u64> {
    parts.range(part)
}

/// A stretch of cases of one part.
struct Piece {
    part: u64,
    cases: Range<u64>,
    /// The part begins, or ends, with it.
    first: bool,
    last: bool,
}

/// Cases in pieces: long enough that handing them over costs nothing, short enough that no thread ends long before another.
fn pieces(parts: &Parts, threads: usize, signals: bool) -> Vec<Piece> {
    let total: u64 =
        parts.due.iter().map(|part| parts.range(*part)).map(|cases| cases.end - cases.start).sum();
    let length = if signals { 1 } else { (total / (32 * threads as u64)).clamp(1, 64) };
    let mut pieces = Vec::new();
    for &part in &parts.due {
        let all = parts.range(part);
        let mut from = all.start;
        loop {
            let to = all.end.min(from + length);
            pieces.push(Piece { part, cases: from..to, first: from == all.start, last: to == all.end });
            from = to;
            if from == all.end {
                break;
            }
        }
    }
    pieces
}

fn run(
    plan: &Plan,
    options: &Options,
    parts: &mut Parts,
    reuse: bool,
    watch: &dyn Watch,
) -> Result<(), Error> {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let threads = options.jobs.unwrap_or_else(cores).max(1);
    let pieces = pieces(parts, threads, !plan.signals.is_empty());
    let mut ran = 0;
    let mut files: Option<(CaseFile, Option<SignalFile>)> = None;
    let work = |worker: &mut Worker<'_>, at: usize| {
        let run = |case: u64| if watch.ends() { None } else { worker.run(case) };
        let rows: Option<Vec<CaseRow>> = pieces[at].cases.clone().map(run).collect();
        rows.ok_or(Error::Interrupted { cases: 0, parts: 0 })
    };
    let take = |at: usize, rows: Vec<CaseRow>| {
        let Piece { part, first, last, .. } = pieces[at];
        if first {
            files = Some(begin(plan, parts, part)?);
        }
        let Some((cases, signals)) = &mut files else { return Ok(()) };
        for mut row in rows {
            cases.add(&row)?;
            if let Some(signals) = signals {
                signals.add(row.case, &mut row.signals)?;
            }
            ran += 1;
            watch.ran(1);
        }
        if last && let Some((cases, signals)) = files.take() {
            let counts = cases.counts();
            // The cases last: where they are, the part is whole.
            signals.map_or(Ok(()), |signals| signals.finish(&counts))?;
            cases.finish()?;
            parts.finish(part, counts);
        }
        Ok(())
    };
    let ended = pool::in_order(threads, pieces.len(), || Worker::new(plan, reuse, watch), work, take);
    ended.map_err(|error| match error {
        Error::Interrupted { .. } => Error::Interrupted { cases: ran, parts: parts.finished.len() as u64 },
        other => other,
    })
}

fn begin(plan: &Plan, parts: &Parts, part: u64) -> Result<(CaseFile, Option<SignalFile>), Error> {
    let stamp = Stamp { fingerprint: &plan.fingerprint, part, of: parts.of };
    let cases = CaseFile::begin(&parts.file("cases", part), &stamp, plan)?;
    let signals = match plan.signals.is_empty() {
        true => None,
        false => Some(SignalFile::begin(&parts.file("signals", part), &stamp, plan)?),
    };
    Ok((cases, signals))
}

/// Writes a file whole or not at all: others may write the same.
pub(crate) fn write(path: &Path, text: &str) -> Result<(), Error> {
    let new = crate::data::temporary(path)?;
    std::fs::write(new.path(), text).map_err(Error::file(path))?;
    new.persist(path).map_err(|why| Error::file(path)(why.error))?;
    Ok(())
}
