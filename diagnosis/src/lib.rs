//! Finds where simulation and measured data disagree, and names the effect that the model lacks.
//!
//! ```
//! use diagnosis::{Options, Verdict, diagnose};
//! use orchestrator::UnitPath;
//!
//! # fn main() -> Result<(), diagnosis::Error> {
//! # let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
//! # let (dataset, packed) = (root.join("examples/hidden-effect"), root.join("target/fmus"));
//! let units = UnitPath::new().with(packed);
//! let found = diagnose(&dataset, &units, &Options::default(), &mut |_| {})?;
//! assert_eq!(found.verdict, Verdict::Named);
//! let effect = &found.effects[0];
//! assert_eq!(effect.name, "plant.b_joint"); // 0.02 N.m.s/rad was hidden there
//! assert!(effect.ci95[0] < 0.02 && 0.02 < effect.ci95[1]);
//! # Ok(())
//! # }
//! ```
//!
//! [`diagnose`] is where to begin; [`import`] makes a data set of logs, [`record()`] one of finished runs. A [`Diagnosis`] is what
//! `diagnosis.json` holds. The general rooms know no machine by name, in the order in which data flow:
//! 1. `observe` reads a data set: channels, states, candidates, ports, runs; `import` writes one from logs.
//! 2. `dynamics` and `ports` make any unit a function of one interval with sensitivities; `check` doubts logs that count otherwise
//!    than the model does.
//! 3. `infer` links its states from row to row, with the `nuisance`s of the log; `statistics` is what it counts with.
//! 4. `search` finds what the model lacks, `design` the experiment that would tell what stays open.
//! 5. `general` goes this way from end to end.
//! 6. `report_page`, `report_graphs` and `write` tell it.
//!
//! `rigs` holds what only one machine has. So far that is our own: [`rigs::acrobot`]. A data set's format decides who diagnoses it.

#![forbid(unsafe_code)]

mod check;
mod design;
mod diagnosis;
mod dynamics;
mod earlier;
mod error;
mod gap;
mod general;
mod import;
mod infer;
mod nuisance;
mod observe;
mod opened;
mod options;
mod overlay;
mod planned;
mod ports;
mod provenance;
mod report_graphs;
mod report_page;
mod search;
mod statistics;
mod step_budget;
mod text;
mod watch;
mod write;

// No part of the face: the rig's rooms, and of the general ones what the tests of this crate look into.
#[doc(hidden)]
pub mod rigs;
#[doc(hidden)]
pub mod testing;

pub use diagnosis::{
    Closing, Correction, Diagnosis, Effect, Gap, Member, NextExperiment, RunTrace, Separation, Term, Trace,
    Unknown, Verdict, Where,
};
pub use earlier::Earlier;
pub use error::{Error, Finding, Notice};
pub use import::{Clock, Import, Imported, import};
pub use options::{Budget, Options};
pub use overlay::Overlaid;
pub use provenance::{Provenance, Used};
pub use rigs::acrobot::record::{Recorded, Recording, record, recorded};
pub use watch::{Doing, Known, Listener, Watch};
pub use write::FILES;

use orchestrator::UnitPath;
use std::path::Path;

/// Diagnoses a data set: `format = 1` is our own rig's, `format = 2` any unit's, and any other an error. `tell` hears of each stage.
///
/// # Errors
/// The data set or the nominal model can't be used, or a unit failed.
pub fn diagnose(
    path: &Path,
    units: &UnitPath,
    options: &Options,
    tell: Listener<'_>,
) -> Result<Diagnosis, Error> {
    match observe::format(path) {
        Some(2) => {
            let problem = observe::load(path, units, options.isolation.as_ref())?;
            let (scenario, fmus) = (&problem.model.scenario, &problem.model.fmus);
            options.earlier.iter().try_for_each(|earlier| earlier.fits_model(scenario, fmus))?;
            general::diagnosed(&problem, units, options, tell)
        }
        // it tells, too, what is wrong with a data set of another format or without one
        Some(_) | None => {
            options.earlier.iter().try_for_each(Earlier::fits_our_rig)?;
            rigs::acrobot::pipeline::diagnose(path, units, options, tell)
        }
    }
}
