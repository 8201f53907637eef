//! Finds where simulation and measured data disagree, and names the effect that the model lacks.
//!
//! The way of a diagnosis, a room each:
//! 1. [`dataset`] reads a folder and puts aside what can't be used.
//! 2. [`model`] loads the nominal scenario; [`mod@bench`] holds its units, reached through FMI only.
//! 3. [`residual`] cuts the loop at every interface and compares, with the columns of all [`candidates`].
//! 4. [`selection`] names, one effect at a time, with the [`statistics`] that keep it honest.
//! 5. [`rest`] says whether what remains is noise, `imitation` whether names only stand for something else, [`gap`] how far it closed, [`amend`] writes the better model.
//! 6. [`correction`] fits labelled torques to a rest that has no name, for the residual unit.
//! 7. `experiment` simulates what a lab could do about a class that stays open, and chooses; `earlier` is what was known before it.

pub mod amend;
pub mod bench;
pub mod candidates;
pub mod correction;
pub mod counting;
pub mod dataset;
mod diagnosis;
mod earlier;
mod error;
mod experiment;
pub mod gap;
mod imitation;
pub mod model;
mod pipeline;
pub mod record;
mod report_page;
pub mod residual;
pub mod rest;
pub mod selection;
pub mod statistics;
mod story;
mod write;

pub use diagnosis::{Diagnosis, Effect, Gap, NextExperiment, Separation, Trace, Unknown, Verdict, Where};
pub use earlier::Earlier;
pub use error::{Error, Notice};
pub use pipeline::{Options, diagnose};
