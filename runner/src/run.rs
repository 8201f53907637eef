//! `acroscope run`: one scenario, from start to stop.

use crate::bar::Bar;
use crate::cli::Run;
use crate::error::Error;
use crate::folder::{self, Folder};
use crate::request::Request;
use crate::results::Results;
use crate::run_report::{Finished, How, Layout, Summary};
use crate::signals::{self, Looking};
use crate::{complain, provenance, run_report, tell};
use orchestrator::{
    Checkpoint, Checkpoints, Ended, FileMask, Isolation, Lateness, NoRecorder, Progress, Recorder, Scenario,
    Simulation, Twice,
};
use report::{Figure, Provenance};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What a run writes, beside `frames`.
const FILES: [&str; 7] = [
    "results.csv",
    "resolved.toml",
    "report.html",
    "summary.json",
    "results.mcap",
    "results.parquet",
    PACING,
];
/// How well a run kept to the real clock: apart from what is the same each time.
const PACING: &str = "pacing.json";
/// The newest checkpoint, beside the results.
const CHECKPOINT: &str = "checkpoint.bin";
/// One that was not written to its end.
const CUT_OFF: &str = "checkpoint.bin.new";

/// A run that came to its end, for what else is written of it.
pub struct Ran<'a> {
    /// What was asked.
    pub arguments: &'a Run,
    /// Its folder, with `results.csv`.
    pub folder: &'a Folder,
    /// What was run.
    pub simulation: &'a Simulation,
    /// What its page shows.
    pub layout: &'a Layout,
    /// Where it comes from.
    pub provenance: &'a Provenance,
}

/// Writes the formats of other tools that were asked for. [`run`] by itself has none.
pub type Formats<'a> = &'a dyn Fn(&Ran<'_>) -> Result<(), Error>;

/// What a run left.
pub struct CarriedOut {
    /// Where.
    pub folder: PathBuf,
    /// What is told of it, if there is a row to tell of.
    summary: Option<Summary>,
    /// How it ended.
    pub ended: Result<Ended, Error>,
    /// Inputs whose start value gave way.
    replaced_starts: Vec<String>,
    /// How late its loops are.
    timing: Vec<String>,
    /// How well it kept to the real clock, if it had to.
    lateness: Option<Lateness>,
    /// What its page shows.
    pub layout: Layout,
    /// Its units, which are freed last: what they do then changes nothing of the above.
    _simulation: Simulation,
}

/// Runs the scenario and writes `results.csv`, `resolved.toml`, `report.html` and `summary.json`.
///
/// # Errors
/// As [`carry_out`], and what ended the run itself.
pub fn run(arguments: &Run, quiet: bool, formats: Formats<'_>) -> Result<(), Error> {
    let mut bar = Bar::new(quiet);
    let done = carry_out(arguments, quiet, formats, &mut NoRecorder, &mut bar)?;
    if !quiet {
        for start in done.replaced_starts.iter().filter(|_| arguments.verbose) {
            complain!("note: start value gave way to a connected output: {start}");
        }
        if let Some(summary) = &done.summary {
            tell_all(summary, &done.timing, &bar, &done.folder);
        }
        if let Some(lateness) = &done.lateness {
            tell!("{lateness}");
        }
    }
    match done.ended? {
        Ended::Interrupted { time } => {
            Err(Error::Interrupted { signal: signals::caught().unwrap_or_default(), time })
        }
        _ => {
            orchestrator::all_done(0);
            Ok(())
        }
    }
}

/// What is known before the first step.
struct Prepared {
    /// The folder as it was named, and from the root on.
    shown: PathBuf,
    out: PathBuf,
    simulation: Simulation,
    layout: Layout,
    provenance: Provenance,
}

/// The run, for a second recorder beside the file of results.
///
/// # Errors
/// What happens before the first step, or in the report of a run that ended well; how the run itself ended is in the answer.
pub fn carry_out(
    arguments: &Run,
    quiet: bool,
    formats: Formats<'_>,
    also: &mut dyn Recorder,
    progress: &mut dyn Progress,
) -> Result<CarriedOut, Error> {
    let mask = FileMask::now();
    let mut prepared = Prepared::new(arguments)?;
    let folder = Folder::make(&prepared.out)?;
    let from = checkpoint(arguments, &folder, quiet)?;
    let goes_on = |from: &Checkpoint| format!("note: the run goes on from t = {} s", from.time());
    let frames =
        prepared.layout.picture.as_ref().map(|_| Folder::make(&prepared.out.join("frames"))).transpose()?;
    let checkpoints = arguments.checkpoint.map(|every| Checkpoints { file: folder.file(CHECKPOINT), every });
    let resolved = prepared.simulation.resolved();
    let mut results = match &from {
        Some(checkpoint) => Results::resumed(&folder, &FILES, &resolved, checkpoint)?
            .told((!quiet).then(|| goes_on(checkpoint))),
        None => Results::new(&folder, &[&FILES[..], &[CHECKPOINT, CUT_OFF]].concat(), &resolved)?,
    };
    let mut recorder = Twice(&mut results, also);
    let simulation = &mut prepared.simulation;
    let ended = go(simulation, from.as_ref(), checkpoints.as_ref(), &mut recorder, progress);
    if mask.put_back() {
        simulation
            .notice("a unit changes which permissions new files have (umask): put back after the run".into());
    }
    if !results.begun() {
        // A unit refused to begin, or the checkpoint is another run's: what lies in the folder is of an earlier run, and stays.
        let ended = ended.map_err(|error| results.failed().unwrap_or(error));
        return Ok(prepared.carried_out(None, ended, Vec::new(), None));
    }
    let Prepared { simulation, layout, provenance, .. } = &prepared;
    let exported = formats(&Ran { arguments, folder: &folder, simulation, layout, provenance });
    let lateness = simulation.lateness().cloned();
    if let Some(lateness) = &lateness {
        folder.write(PACING, &lateness.to_json())?;
    }
    let summary = prepared.summary(&ended, &folder)?;
    exported?;
    drop(frames);
    let timing = run_report::timing::lines(simulation);
    Ok(prepared.carried_out(summary, ended, timing, lateness))
}

/// Refuses a folder in which the run would write over what it is made of: its scenario, its tables, its units. A resolved scenario
/// that says the same again may be written over.
fn keep_inputs(arguments: &Run, simulation: &Simulation, out: &Path) -> Result<(), Error> {
    let written: Vec<PathBuf> = FILES.iter().chain([&CHECKPOINT]).map(|name| out.join(name)).collect();
    let mut read: Vec<PathBuf> = simulation.bundle().files.into_iter().map(|(_, path)| path).collect();
    let scenario = PathBuf::from(&arguments.scenario);
    if !std::fs::read(&scenario).is_ok_and(|text| text == simulation.resolved().as_bytes()) {
        read.push(scenario);
    }
    folder::keep(&written, &read)
}

impl Prepared {
    /// Reads the scenario, gives it what was asked for, and builds it.
    fn new(arguments: &Run) -> Result<Self, Error> {
        let request = Request::of(arguments)?;
        let shown = arguments.out.clone().unwrap_or_else(|| request.folder());
        // Units may change the working folder.
        let out = std::path::absolute(&shown).map_err(Error::file(&shown))?;
        let (mut scenario, bytes) = scenarios::read(&arguments.scenario)?;
        let mut layout = Layout::of(&scenario)?;
        if let Some(picture) = &layout.picture {
            scenario.set(&picture.directory_parameter(), &out.join("frames").to_string_lossy())?;
        }
        request.apply(&mut scenario)?;
        isolate(&mut scenario, arguments)?;
        let mut simulation = Simulation::new(&scenario, &scenarios::unit_path())?;
        layout.complete(&simulation)?;
        keep_inputs(arguments, &simulation, &shown)?;
        simulation.pace(arguments.real_time);
        let provenance = provenance::of_run(&request, &bytes, &simulation)?;
        Ok(Self { shown, out, simulation, layout, provenance })
    }

    /// Writes page and summary. None are left of a run that ended before its first row.
    fn summary(&self, ended: &Result<Ended, Error>, folder: &Folder) -> Result<Option<Summary>, Error> {
        let finished = Finished {
            simulation: &self.simulation,
            layout: &self.layout,
            folder: &self.out,
            how: how(ended),
            by: match ended {
                Ok(Ended::ByUnit { unit, .. }) => Some(unit.clone()),
                _ => None,
            },
            error: ended.as_ref().err().map(ToString::to_string),
            provenance: self.provenance.clone(),
        };
        match told(finished, folder) {
            Ok(Some(summary)) => Ok(Some(summary)),
            // It ended before its first row: nothing of it is worth keeping.
            Ok(None) => folder.clear(&FILES).map(|()| None),
            // The run's own error counts more than that of its report.
            Err(error) if ended.is_ok() => Err(error),
            Err(_) => Ok(None),
        }
    }

    fn carried_out(
        self,
        summary: Option<Summary>,
        ended: Result<Ended, Error>,
        timing: Vec<String>,
        lateness: Option<Lateness>,
    ) -> CarriedOut {
        let replaced_starts = self.simulation.replaced_starts().to_vec();
        let (folder, layout, _simulation) = (self.shown, self.layout, self.simulation);
        CarriedOut { folder, summary, ended, replaced_starts, timing, lateness, layout, _simulation }
    }
}

/// Where the run goes on, if it is to.
fn checkpoint(arguments: &Run, folder: &Folder, quiet: bool) -> Result<Option<Checkpoint>, Error> {
    let file = folder.file(CHECKPOINT);
    if !arguments.resume {
        return Ok(None);
    }
    let from = Checkpoint::load(&file)?;
    if from.is_none() && !quiet {
        complain!("note: there is no {}, so the run begins at its start", file.display());
    }
    Ok(from)
}

/// Units in processes of their own, and their limits.
fn isolate(scenario: &mut Scenario, arguments: &Run) -> Result<(), Error> {
    for unit in &mut scenario.units {
        if arguments.isolate && unit.isolation.is_none() {
            unit.isolation = Some(Isolation::default());
        }
        let Some(isolation) = &mut unit.isolation else { continue };
        if let Some(limit) = arguments.step_limit {
            isolation.step_limit = Duration::from_secs_f64(limit);
        }
        isolation.memory_limit = arguments.memory_limit.map(|limit| limit << 20).or(isolation.memory_limit);
    }
    let given = [
        ("--step-limit", arguments.step_limit.is_some()),
        ("--memory-limit", arguments.memory_limit.is_some()),
    ];
    match given.into_iter().find(|(_, given)| *given) {
        Some((option, _)) if scenario.units.iter().all(|unit| unit.isolation.is_none()) => Err(Error::Words(
            format!("{option} is for units in processes of their own, and no unit is in one: add --isolate"),
        )),
        _ => Ok(()),
    }
}

/// The run itself. A signal ends it at the next communication point.
fn go(
    simulation: &mut Simulation,
    from: Option<&Checkpoint>,
    checkpoints: Option<&Checkpoints>,
    recorder: &mut dyn Recorder,
    progress: &mut dyn Progress,
) -> Result<Ended, Error> {
    let _looking = Looking::now();
    let ended = simulation.run_on(from, checkpoints, recorder, progress);
    if ended.is_ok() {
        simulation.look_over();
    }
    simulation.terminate();
    Ok(ended?)
}

fn how(ended: &Result<Ended, Error>) -> How {
    match ended {
        Ok(Ended::Interrupted { .. }) => How::Interrupted,
        Ok(Ended::ByUnit { .. }) => How::Unit,
        Ok(_) => How::Stop,
        Err(_) => How::Error,
    }
}

/// Writes page and summary, if there is a row to tell of.
fn told(finished: Finished<'_>, folder: &Folder) -> Result<Option<Summary>, Error> {
    let Some((summary, page)) = finished.tell()? else { return Ok(None) };
    folder.write("summary.json", &summary.to_json())?;
    folder.write("report.html", &page)?;
    Ok(Some(summary))
}

/// The verdict, then where it comes from.
fn tell_all(summary: &Summary, timing: &[String], bar: &Bar, out: &Path) {
    let verdict = &summary.verdict;
    tell!("{}", verdict.words);
    if !verdict.figures.is_empty() {
        let figures: Vec<String> = verdict.figures.iter().map(Figure::line).collect();
        tell!("  {}", figures.join(", "));
    }
    for note in &verdict.notes {
        tell!("  note: {note}");
    }
    for line in timing {
        tell!("  {line}");
    }
    tell!("{}", summary.title);
    for (label, text) in summary.provenance.rows() {
        tell!("  {label}: {text}");
    }
    tell!("  again: {}", summary.provenance.command);
    let speed = bar.real_time_factor.map_or_else(String::new, |factor| format!(" ({factor:.0} x real time)"));
    tell!("the report is {}{speed}", out.join("report.html").display());
}
