//! Finds where simulation and measured data disagree, and names the effect that the model lacks.
//!
//! The way of a diagnosis, a room each:
//! 1. [`dataset`] reads a folder and puts aside what can't be used.
//! 2. [`model`] loads the nominal scenario; [`mod@bench`] holds its units, reached through FMI only.
//! 3. [`residual`] cuts the loop at every interface and compares, with the columns of all [`candidates`].
//! 4. [`selection`] names, one effect at a time, with the [`statistics`] that keep it honest.
//! 5. [`rest`] says whether what remains is noise, `imitation` whether names only stand for something else, [`gap`] how far it closed, [`amend`] writes the better model.
//! 6. [`correction`] fits labelled torques to a rest that has no name, for the residual unit.
//! 7. [`observe`] reads the general form of a data set, for any unit; `general` is where a data set's format decides who diagnoses it.
//! 8. `import` makes a data set of a unit and logs.
//! 9. `experiment` simulates what a lab could do about a class that stays open, and chooses; `earlier` is what was known before it.

pub mod amend;
pub mod bench;
pub mod candidates;
pub mod correction;
pub mod counting;
pub mod dataset;
mod diagnosis;
pub mod dynamics;
mod earlier;
mod error;
mod experiment;
mod floor;
pub mod gap;
mod general;
mod imitation;
mod import;
pub mod infer;
pub mod model;
pub mod nuisance;
pub mod observe;
mod pipeline;
mod places;
pub mod plausibility;
pub mod ports;
mod provenance;
pub mod record;
mod replay;
mod report_page;
pub mod residual;
pub mod rest;
pub mod search;
pub mod selection;
pub mod statistics;
mod story;
mod watch;
mod write;

pub use diagnosis::{Diagnosis, Effect, Gap, NextExperiment, Separation, Trace, Unknown, Verdict, Where};
pub use earlier::Earlier;
pub use error::{Error, Notice};
pub use general::diagnose;
pub use import::{Imported, import};
pub use pipeline::{Budget, Options};
pub use provenance::{Provenance, Used};
pub use watch::{Doing, Known, Listener, Watch};
