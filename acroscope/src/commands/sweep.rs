//! `acroscope sweep`: one scenario many times, as a study says.

use crate::cli::Sweep;
use crate::error::Error;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use report::head::shell_word;
use runner::folder::{Folder, keep};
use runner::request::{folder_name, isolation_words};
use runner::signals::{self, Looking};
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};
use std::time::Duration;
use sweep::{Done, Limits, Options, Plan, Study, Watch, Words};

/// Makes the parts that are due, and `report.html` when all are there.
pub fn sweep(arguments: &Sweep, quiet: bool) -> Result<(), Error> {
    let study = study(arguments)?;
    let out = arguments.out.clone().unwrap_or_else(|| default_folder(arguments, &study));
    let plan = Plan::new(&study, &scenarios::unit_path(), &limits(arguments)?)?;
    // the study itself is written as it is
    let written = ["resolved.toml", "report.html"].map(|name| out.join(name));
    keep(&written, &[(&study.scenario).into(), (&arguments.study).into()])?;
    let _folder = Folder::make(&out)?;
    let options = Options {
        out: out.clone(),
        jobs: arguments.jobs.map(usize::from),
        partition: arguments.partition,
        program: runner::provenance::program(),
        command: command(arguments),
    };
    let looker = Looker { bar: bar(quiet), quiet, _looking: Looking::now() };
    let done = sweep::sweep(&plan, &options, &looker);
    looker.bar.finish_and_clear();
    let done = done.map_err(|error| match (error, signals::caught()) {
        (why @ sweep::Error::Interrupted { .. }, Some(signal)) => {
            Error::SweepInterrupted { signal, why: why.to_string() }
        }
        (error, _) => error.into(),
    })?;
    if !quiet {
        summary(&done, &out);
    }
    Ok(())
}

fn study(arguments: &Sweep) -> Result<Study, Error> {
    if arguments.grid.is_empty() {
        return Ok(Study::load(&arguments.study)?);
    }
    Ok(Study::of_words(&Words {
        scenario: arguments.study.clone(),
        grid: arguments.grid.clone(),
        until: arguments.until.clone(),
        scalars: arguments.scalars.clone(),
    })?)
}

fn limits(arguments: &Sweep) -> Result<Limits, Error> {
    let set = |given: &String| match given.split_once('=') {
        Some((name, value)) => Ok((name.trim().to_owned(), value.trim().to_owned())),
        None => Err(Error::from(runner::Error::Override { given: given.clone() })),
    };
    Ok(Limits {
        set: arguments.set.iter().map(set).collect::<Result<_, _>>()?,
        stop: arguments.stop.clone(),
        isolate: arguments.isolate,
        step: arguments.step_limit.map(Duration::from_secs_f64),
        memory: arguments.memory_limit.map(|limit| limit << 20),
    })
}

/// A folder for each thing that can be asked.
fn default_folder(arguments: &Sweep, study: &Study) -> PathBuf {
    let until = arguments.until.iter().map(|until| format!("until={until}"));
    let stop = arguments.stop.iter().map(|stop| format!("stop={stop}"));
    let changes = arguments.grid.iter().chain(&arguments.scalars).chain(&arguments.set).cloned();
    Path::new("out").join(folder_name(&format!("sweep-{}", study.name), changes.chain(until).chain(stop)))
}

/// The command that makes all of it again, on any machine: threads and parts change nothing. A unit that needs a process of its own does.
fn command(arguments: &Sweep) -> String {
    let mut words = vec!["acroscope sweep".to_owned(), shell_word(&arguments.study)];
    let stop: Vec<String> = arguments.stop.iter().cloned().collect();
    let until: Vec<String> = arguments.until.iter().cloned().collect();
    let all = [
        ("--grid", &arguments.grid),
        ("--until", &until),
        ("--scalar", &arguments.scalars),
        ("--set", &arguments.set),
        ("--stop", &stop),
    ];
    for (option, given) in all {
        words.extend(given.iter().flat_map(|given| [option.to_owned(), shell_word(given)]));
    }
    words.extend(isolation_words(arguments.isolate, arguments.step_limit, arguments.memory_limit));
    words.join(" ")
}

/// Shows how far it is, on a terminal, and listens to signals.
struct Looker {
    bar: ProgressBar,
    quiet: bool,
    _looking: Looking,
}

fn bar(quiet: bool) -> ProgressBar {
    let hidden = quiet || !std::io::stderr().is_terminal();
    let target = if hidden { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(Some(0), target);
    // The template is a constant; were it wrong, indicatif's own style would do.
    if let Ok(style) = ProgressStyle::with_template("{bar:32} {pos} of {len} cases, {per_sec}, {eta} left") {
        bar.set_style(style);
    }
    bar
}

impl Watch for Looker {
    fn begin(&self, due: u64, _: u64) {
        self.bar.set_length(due);
        self.bar.reset_eta();
    }

    fn ran(&self, cases: u64) {
        self.bar.inc(cases);
    }

    fn note(&self, text: &str) {
        if !self.quiet {
            self.bar.suspend(|| complain!("note: {text}"));
        }
    }

    fn ends(&self) -> bool {
        signals::caught().is_some()
    }
}

fn summary(done: &Done, out: &Path) {
    let Done { cases, ran, failed, not_finite, parts: (there, of), page } = done;
    let failures = match failed {
        0 => "none failed".to_owned(),
        _ => format!("{failed} failed, and say why in their rows"),
    };
    tell!("{ran} of {cases} cases were run; {failures}");
    if let Some(words) = not_finite {
        tell!("{words}");
    }
    tell!("{}: {there} of {of} parts", out.join("cases").display());
    if let Some(page) = page {
        tell!("the report is {}", page.display());
    }
}
