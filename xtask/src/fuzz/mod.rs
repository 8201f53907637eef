//! Random calls of packed units: legal and illegal order, wrong references and types, NaN, null pointers where
//! the standard allows them, damaged states.
//!
//! A crash ends the program; `--first N --sequences 1` with the number in the file that is named at the start
//! repeats it. Everything else that must not be is found by the program: an unknown status, a panic in the log,
//! a value that is no number, a state that does not restore to the bit.

#![allow(unsafe_code)] // calls units in every order

mod api;
mod calls;
mod random;
mod saved;
mod values;

use crate::platform::Platform;
use crate::{Result, archive, at};
use api::Api;
use calls::Sequence;
use random::Random;
use std::fs;
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

/// What to try.
#[derive(Debug, clap::Args)]
pub struct Options {
    /// Sequences for each unit
    #[arg(long, default_value_t = 10_000)]
    sequences: u64,
    /// Number of the first sequence
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Another seed gives other sequences
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Calls in a sequence, at most
    #[arg(long, default_value_t = 40)]
    calls: u64,
    /// Seconds after which a sequence counts as hanging
    #[arg(long, default_value_t = 60)]
    limit: u64,
    /// Tells each call
    #[arg(long)]
    trace: bool,
    /// The packed units
    #[arg(required = true)]
    fmus: Vec<PathBuf>,
}

/// How many sequences were begun, over all units; the watch compares.
static BEGUN: AtomicU64 = AtomicU64::new(0);

/// Runs all sequences on all units.
pub fn fuzz(options: &Options) -> Result<()> {
    let (done, is_done) = mpsc::channel();
    let limit = options.limit;
    let watch = std::thread::spawn(move || watch(limit, &is_done));
    // All paths first: each unit runs in a folder of its own, where a relative path leads nowhere.
    let fmus = options.fmus.iter().map(|fmu| at(fmu, fs::canonicalize(fmu))).collect::<Result<Vec<_>>>();
    let outcome = fmus.and_then(|fmus| fmus.iter().try_for_each(|fmu| fuzz_one(options, fmu)));
    drop(done);
    watch.join().map_err(|_| "the watch failed")?; // joined, so that a leak checker sees nothing of it
    outcome
}

/// Ends the program if one sequence takes longer than `limit` s: a call that does not come back can't be stopped
/// in another way.
fn watch(limit: u64, is_done: &mpsc::Receiver<()>) {
    let (mut last, mut since) = (0, Instant::now());
    while is_done.recv_timeout(Duration::from_millis(500)) == Err(RecvTimeoutError::Timeout) {
        let now = BEGUN.load(Ordering::Relaxed);
        if now != last {
            (last, since) = (now, Instant::now());
        } else if since.elapsed().as_secs() > limit {
            eprintln!("error: a sequence has taken more than {limit} s");
            std::process::exit(1);
        }
    }
}

fn fuzz_one(options: &Options, fmu: &Path) -> Result<()> {
    let entries = archive::read(fmu)?;
    let missing = |what: &str| format!("{}: {what} is missing", fmu.display());
    let description = entries.get("modelDescription.xml").ok_or_else(|| missing("modelDescription.xml"))?;
    let description = String::from_utf8_lossy(description).into_owned();
    let unit = calls::Unit::read(&description).ok_or_else(|| missing("the list of variables"))?;
    let entry = Platform::own().entry(&unit.identifier);
    let binary = entries.get(&entry).ok_or_else(|| missing(&entry))?;

    // Units may write files where a string tells them to, so they run in a folder of their own.
    let folder = std::env::temp_dir().join(format!("fuzz-{}-{}", unit.identifier, std::process::id()));
    at(&folder, fs::create_dir_all(&folder))?;
    let library = folder.join(entry.rsplit('/').next().unwrap_or_default());
    at(&library, fs::write(&library, binary))?;
    at(&folder, std::env::set_current_dir(&folder))?;
    let api = Api::load(&library)?;
    let current = folder.join("sequence");
    eprintln!(
        "{}: should this end suddenly, {} holds the number of the sequence",
        fmu.display(),
        current.display()
    );
    let Tried { calls, refused, slowest } = sequences(options, fmu, &api, &unit, &current)?;
    at(&folder, fs::remove_dir_all(&folder))?;
    println!(
        "{}: {} sequences, {calls} calls, {refused} refused, no failure; the slowest took {:.2} s (number {})",
        unit.identifier,
        options.sequences,
        slowest.0.as_secs_f64(),
        slowest.1
    );
    Ok(())
}

/// What was tried on a unit.
#[derive(Default)]
struct Tried {
    calls: u64,
    refused: u64,
    /// How long the slowest sequence took, and its number.
    slowest: (Duration, u64),
}

/// Makes all sequences of calls; the file `current` holds the number of the one under way.
fn sequences(options: &Options, fmu: &Path, api: &Api, unit: &calls::Unit, current: &Path) -> Result<Tried> {
    let mut file = at(current, fs::File::create(current))?;
    let started = Instant::now();
    let mut tried = Tried::default();
    for number in options.first..options.first + options.sequences {
        at(current, file.seek(SeekFrom::Start(0)).and_then(|_| writeln!(file, "{number:>20}")))?;
        BEGUN.fetch_add(1, Ordering::Relaxed);
        let begun = Instant::now();
        let random = Random::new(options.seed, number);
        let outcome = Sequence::new(api, unit, random, options.trace).run(options.calls);
        let (made, not_ok) = outcome.map_err(|why| format!("{}, sequence {number}: {why}", fmu.display()))?;
        tried.calls += made;
        tried.refused += not_ok;
        tried.slowest = tried.slowest.max((begun.elapsed(), number));
        if (number + 1) % 1000 == 0 {
            let (done, seconds) = (number + 1, started.elapsed().as_secs_f64());
            eprintln!("{}: {done} sequences, {seconds:.0} s", unit.identifier);
        }
    }
    Ok(tried)
}
