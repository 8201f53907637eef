//! `acroscope run`: one scenario, from start to stop.

use crate::bar::Bar;
use crate::cli::Run;
use crate::error::Error;
use crate::run_report::{self, Layout};
use orchestrator::{CsvRecorder, Scenario, Simulation};
use std::path::{Path, PathBuf};

/// Runs the scenario and writes `results.csv`, `resolved.toml` and `report.html`.
pub fn run(arguments: &Run, quiet: bool) -> Result<(), Error> {
    let out = arguments.out.clone().unwrap_or_else(|| Path::new("out").join(stem(&arguments.scenario)));
    let mut scenario = scenarios::load(&arguments.scenario)?;
    let layout = Layout::of(&scenario)?;
    std::fs::create_dir_all(&out).map_err(Error::file(&out))?;
    if let Some(picture) = &layout.picture {
        let frames = picture.fresh_folder(&out)?;
        scenario.set(&picture.directory_parameter(), &frames.to_string_lossy())?;
    }
    apply(&mut scenario, arguments)?;

    let mut simulation = Simulation::new(&scenario, &scenarios::unit_path())?;
    layout.check(&scenario, simulation.columns().iter().map(|column| column.name.as_str()))?;
    write(&out.join("resolved.toml"), &simulation.resolved())?;
    let mut results = CsvRecorder::create(out.join("results.csv"))?;
    let mut bar = Bar::new(quiet);
    let ended = simulation.run(&mut results, &mut bar);
    if !quiet {
        for notice in simulation.notices() {
            eprintln!("note: {notice}");
        }
        for start in simulation.replaced_starts().iter().filter(|_| arguments.verbose) {
            eprintln!("note: start value gave way to a connected output: {start}");
        }
    }
    ended?;

    let page = run_report::page(&scenario, &layout, &out)?;
    let report = out.join("report.html");
    write(&report, &page)?;
    if !quiet {
        let speed =
            bar.real_time_factor.map_or_else(String::new, |factor| format!(" at {factor:.0} x real time"));
        tell!(
            "{}: ran to t = {} s{speed}; the report is {}",
            arguments.scenario,
            simulation.time(),
            report.display()
        );
    }
    Ok(())
}

/// What was typed beside the scenario's name.
fn apply(scenario: &mut Scenario, arguments: &Run) -> Result<(), Error> {
    for given in &arguments.set {
        let Some((name, value)) = given.split_once('=') else {
            return Err(Error::Override { given: given.clone() });
        };
        scenario.set(name.trim(), value.trim())?;
    }
    if let Some(stop) = &arguments.stop {
        scenario.set_stop(stop)?;
    }
    Ok(())
}

fn write(path: &PathBuf, text: &str) -> Result<(), Error> {
    std::fs::write(path, text).map_err(Error::file(path))
}

/// Name under which the results of a scenario are kept.
fn stem(scenario: &str) -> String {
    let stem = Path::new(scenario).file_stem().map_or_else(|| scenario.into(), |stem| stem.to_string_lossy());
    stem.into_owned()
}
