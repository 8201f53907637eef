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
//! `diagnosis.json` holds. The way of a diagnosis, a room each:
//! 1. `dataset` reads a folder and puts aside what can't be used; `plausibility` stops at logs that count otherwise than the model.
//! 2. `model` loads the nominal scenario; `bench` holds its units, reached through FMI only.
//! 3. `residual` cuts the loop at every interface and compares, with the columns of all `candidates`.
//! 4. `selection` names, one effect at a time, with the `statistics` that keep it honest.
//! 5. `rest` says whether what remains is noise, `imitation` whether names only stand for something else, `gap` how far it closed, `amend` writes the better model.
//! 6. `correction` fits labelled torques to a rest that has no name, for the residual unit.
//! 7. `observe` reads the general form of a data set, for any unit; `general` is where a data set's format decides who diagnoses it.
//! 8. `dynamics` and `ports` make any unit a function of one interval, `infer` links its states, `search` finds what it lacks.
//! 9. `experiment` simulates what a lab could do about a class that stays open, and chooses; `earlier` is what was known before it.

#![forbid(unsafe_code)]

mod amend;
mod bench;
mod counting;
mod design;
mod diagnosis;
mod differ;
mod dynamics;
mod earlier;
mod error;
mod experiment;
mod floor;
mod gap;
mod general;
mod imitation;
mod import;
mod nuisance;
mod overlay;
mod pipeline;
mod places;
mod plausibility;
mod ports;
mod provenance;
mod replay;
mod report_graphs;
mod report_page;
mod rest;
mod story;
mod watch;
mod write;

// No part of the face: what the tests of this crate look into.
#[doc(hidden)]
pub mod candidates;
#[doc(hidden)]
pub mod correction;
#[doc(hidden)]
pub mod dataset;
#[doc(hidden)]
pub mod infer;
#[doc(hidden)]
pub mod model;
#[doc(hidden)]
pub mod observe;
#[doc(hidden)]
pub mod record;
#[doc(hidden)]
pub mod residual;
#[doc(hidden)]
pub mod search;
#[doc(hidden)]
pub mod selection;
#[doc(hidden)]
pub mod statistics;

pub use diagnosis::{Diagnosis, Effect, Gap, NextExperiment, Separation, Trace, Unknown, Verdict, Where};
pub use earlier::Earlier;
pub use error::{Error, Notice};
pub use general::diagnose;
pub use import::{Imported, import};
pub use overlay::Channel;
pub use pipeline::{Budget, Options};
pub use provenance::{Provenance, Used};
pub use record::{Recording, record};
pub use watch::{Doing, Known, Listener, Watch};
