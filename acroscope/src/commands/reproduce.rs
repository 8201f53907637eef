//! `acroscope reproduce`: the paper's tables, figures and claims, chosen ones or all.

use crate::cli::Reproduce;
use crate::error::Error;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use orchestrator::Simulation;
use report::Provenance;
use runner::folder::Folder;
use runner::provenance;
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};

/// Runs the studies side by side and writes `claims.json` and `index.html`.
pub fn reproduce(arguments: &Reproduce, quiet: bool) -> Result<(), Error> {
    let out = arguments.out.clone().unwrap_or_else(|| PathBuf::from("out/reproduce"));
    let bar = bar(quiet, studies::choose(&arguments.ids)?.len());
    // Before the work, so that a folder that can't be made costs no minutes; it vanishes if nothing comes of the work.
    let _folder = Folder::make(&out)?;
    let bench = studies::Bench::new(scenarios::unit_path());
    let provenance = provenance()?;
    let done = |study: &studies::Study| {
        bar.set_message(study.id);
        bar.inc(1);
    };
    let reproduction = match arguments.partition {
        Some(part) => studies::reproduce_part(&arguments.ids, part, (&out, &provenance), &bench, &done)?,
        None => studies::reproduce(&arguments.ids, &bench, &done)?,
    };
    bar.finish_and_clear();
    reproduction.write(&out, &provenance)?;
    if !quiet {
        summary(&reproduction, &out);
    }
    Ok(())
}

/// Where studies come from: the shipped scenarios and their units. What makes them again is told by what the folder holds.
fn provenance() -> Result<Provenance, Error> {
    let mut found = Provenance { program: provenance::program(), ..Provenance::default() };
    for (name, text) in scenarios::SHIPPED {
        found.inputs.push(provenance::shipped("scenario", name, text));
        let simulation = Simulation::new(&scenarios::load(name)?, &scenarios::unit_path())?;
        for unit in provenance::units(&simulation)? {
            if !found.units.contains(&unit) {
                found.units.push(unit);
            }
        }
    }
    Ok(found)
}

/// A bar that counts studies; hidden if `quiet` or if nobody looks at a terminal.
fn bar(quiet: bool, studies: usize) -> ProgressBar {
    let hidden = quiet || !std::io::stderr().is_terminal();
    let target = if hidden { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(Some(studies as u64), target);
    // The template is a constant; were it wrong, indicatif's own style would do.
    if let Ok(style) = ProgressStyle::with_template("{bar:32} {pos} of {len} studies, {elapsed}: {msg}") {
        bar.set_style(style);
    }
    bar.tick();
    bar
}

/// How many statements hold, and which don't.
fn summary(reproduction: &studies::Reproduction, out: &Path) {
    tell!("{}", reproduction.tally());
    for claim in reproduction.claims().filter(|claim| !claim.holds) {
        tell!("  {} does not: {}; {}", claim.id, claim.quantity, claim.ours);
    }
    tell!("the report is {}", out.join("index.html").display());
}
