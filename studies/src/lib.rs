//! The paper's tables, figures and claims, reproduced from the units: one file a study, one line of registration.
//!
//! A study reaches the units only through FMI. It returns what the paper states, what we get, and whether it holds;
//! [`reproduce`] runs the chosen studies side by side and [`Reproduction::write`] writes `claims.json` and the pages.

#![forbid(unsafe_code)]

pub mod bench;
mod blur;
pub mod claim;
pub mod closed_loop;
mod compensated_loop;
mod compensation;
mod composite;
mod defocus_mask;
mod delay;
mod diagrams;
mod drawing;
mod dynamics;
mod fields;
mod four_graphs;
pub mod lens;
mod lens_errors;
mod lens_loop;
mod lever;
mod loop_values;
mod manifold;
mod open;
mod paper;
mod photometry;
mod quantisation;
mod registry;
mod setup;
mod site;
mod stability_map;
mod store;
mod table3;
mod torque_rate;
mod tracking;
mod tuning;
pub mod unit;
pub mod walk;

pub use bench::Bench;
pub use claim::{Claim, Figure, Kind, Outcome, Study, Tally};
pub use registry::STUDIES;
pub use unit::{Signal, Unit};

use rayon::prelude::*;
use report::Provenance;
use std::path::{Path, PathBuf};

/// Why a study can't be run or written.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The orchestrator refused or failed.
    #[error(transparent)]
    Orchestrator(#[from] orchestrator::Error),
    /// There is no such scenario.
    #[error(transparent)]
    Scenario(#[from] scenarios::Error),
    /// A graph can't be drawn.
    #[error(transparent)]
    Report(#[from] report::Error),
    /// The mechanics can't be evaluated for the given theta.
    #[error("mechanics: {0}")]
    Mechanics(String),
    /// None of the folders with units holds this one.
    #[error("{file} was not found; looked in {looked}. `cargo xtask pack` builds it")]
    NoUnit {
        /// Name of the file.
        file: String,
        /// The folders.
        looked: String,
    },
    /// A unit has no such variable.
    #[error("{unit} has no variable `{name}`")]
    Variable {
        /// The unit.
        unit: String,
        /// What was asked for.
        name: String,
    },
    /// A unit did not take a step.
    #[error("{unit}: fmi2DoStep from {time} s by {size} s answered {status} {}", log.join("; "))]
    Step {
        /// The unit.
        unit: String,
        /// Begin of the step, s.
        time: f64,
        /// Its size, s.
        size: f64,
        /// The answer.
        status: String,
        /// What the unit logged.
        log: Vec<String>,
    },
    /// No study or claim of that name.
    #[error("no study or claim `{name}`: {hint}")]
    Unknown {
        /// As typed.
        name: String,
        /// What is like it, and what there is.
        hint: String,
    },
    /// A file can't be written.
    #[error("{}: {why}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        why: String,
    },
}

impl Error {
    /// The user's input is wrong.
    pub fn is_input(&self) -> bool {
        match self {
            Self::Orchestrator(error) => error.is_input(),
            Self::Unknown { .. } => true,
            _ => false,
        }
    }
}

/// What came out of the chosen studies, in the order of the paper.
pub struct Reproduction {
    outcomes: Vec<(&'static Study, Outcome)>,
}

/// Runs the studies whose id, or one of whose claims, is named; all of them if none is named. `done` is called after
/// each study, from any thread.
pub fn reproduce(
    ids: &[String],
    bench: &Bench,
    done: &(dyn Fn(&Study) + Sync),
) -> Result<Reproduction, Error> {
    run_all(choose(ids)?, bench, done)
}

/// Part `part` of `of` parts of these studies, from 1: every `of`th. `out` is a folder that the machines of the others
/// see, too; what is there of the same program and units is not made again.
pub fn reproduce_part(
    ids: &[String],
    (part, of): (u64, u64),
    (out, provenance): (&Path, &Provenance),
    bench: &Bench,
    done: &(dyn Fn(&Study) + Sync),
) -> Result<Reproduction, Error> {
    let of = usize::try_from(of).unwrap_or(usize::MAX).max(1);
    let mine = choose(ids)?.into_iter().skip(part.saturating_sub(1) as usize).step_by(of);
    run_all(mine.filter(|study| !store::is_there(out, study, provenance)).collect(), bench, done)
}

fn run_all(
    chosen: Vec<&'static Study>,
    bench: &Bench,
    done: &(dyn Fn(&Study) + Sync),
) -> Result<Reproduction, Error> {
    let run = |study: &'static Study| {
        let outcome = (study.run)(bench)?;
        done(study);
        Ok((study, outcome))
    };
    // Collected in order: the same bytes whatever the number of threads.
    let outcomes = chosen.into_par_iter().map(run).collect::<Result<Vec<_>, Error>>()?;
    Ok(Reproduction { outcomes })
}

/// The studies that [`reproduce`] would run.
pub fn choose(ids: &[String]) -> Result<Vec<&'static Study>, Error> {
    if ids.is_empty() {
        return Ok(STUDIES.iter().collect());
    }
    for id in ids {
        if !STUDIES.iter().any(|study| study.answers_to(id)) {
            return Err(Error::Unknown { name: id.clone(), hint: hint(id) });
        }
    }
    Ok(STUDIES.iter().filter(|study| ids.iter().any(|id| study.answers_to(id))).collect())
}

/// The nearest name if one is near, and all studies.
fn hint(id: &str) -> String {
    let known: Vec<&str> = STUDIES.iter().map(|study| study.id).collect();
    let near = orchestrator::nearest(id, known.iter().copied());
    let all = format!("there are {}", known.join(", "));
    if near.starts_with("did you mean") { format!("{near} {all}") } else { all }
}

/// What makes all of these again, whatever calls they came from.
fn command(joined: &[(&'static Study, Outcome)]) -> String {
    let ids = joined.iter().map(|(study, _)| format!(" {}", study.id));
    let some = if joined.len() < STUDIES.len() { ids.collect() } else { String::new() };
    format!("acroscope reproduce{some}")
}

impl Reproduction {
    /// All claims, in the order of the paper.
    pub fn claims(&self) -> impl Iterator<Item = &Claim> {
        self.outcomes.iter().flat_map(|(_, outcome)| &outcome.claims)
    }

    /// How many statements hold; it prints as the headline.
    pub fn tally(&self) -> Tally {
        Tally::of(self.claims())
    }

    /// Writes `claims.json`, `index.html` and a page for each study into a folder, and joins in what an earlier call, or another machine, left
    /// there of other studies.
    pub fn write(&self, out: &Path, provenance: &Provenance) -> Result<(), Error> {
        store::keep(out, &self.outcomes, provenance)?;
        loop {
            let there = store::stored(out);
            let joined = store::join(out, &self.outcomes, provenance);
            let provenance = Provenance { command: command(&joined), ..provenance.clone() };
            let claims: Vec<&Claim> = joined.iter().flat_map(|(_, outcome)| &outcome.claims).collect();
            let path = out.join("claims.json");
            let json = serde_json::to_string_pretty(&claims).map_err(|why| store::failed(&path, &why))?;
            store::write(&path, &(json + "\n"))?;
            for (name, text) in site::pages(&joined, &provenance)? {
                store::write(&out.join(name), &text)?;
            }
            // What came from elsewhere in the meantime would be missing in the page.
            if store::stored(out) == there {
                return Ok(());
            }
        }
    }
}
