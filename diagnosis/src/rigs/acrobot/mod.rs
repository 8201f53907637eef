//! Our own rig: the rolling acrobot that a camera looks at, in the short form of a data set (`format = 1`).
//!
//! The way of a diagnosis, a room each:
//! 1. `dataset` reads a folder and puts aside what can't be used; `plausibility` stops at logs that count otherwise than the model;
//!    `load` does both.
//! 2. `model` loads the nominal scenario; `bench` holds its units, reached through FMI only.
//! 3. `residual` cuts the loop at every interface and compares, with the columns of all `candidates`.
//! 4. `selection` names, one effect at a time; `pipeline` goes the whole way.
//! 5. `check` doubts what was found: is the residual noise, do names only stand for something else, do clocks drift, do runs differ;
//!    `gap` is how far it closed above the `noise_floor`, `amend` writes the better model.
//! 6. `correction` fits labelled torques to a residual that has no name, for the residual unit.
//! 7. `experiment` simulates what a lab could do about a class that stays open, and chooses; `earlier` is what was known before it.
//! 8. `linked` follows the plant with its states linked from row to row, the engine of any unit, where windows leave a class open, and for laws
//!    that nobody lists; `simple_laws` has them.
//! 9. `story` tells it. `record` turns finished runs into a data set, to rehearse; `replay` feeds a log to the amended scenario.
//!
//! `channels` is the table of all columns of logs, `parameters` names what is asked for and never freed, `policy` holds the numbers that
//! several rooms share.

mod amend;
mod bench;
pub mod candidates;
mod channels;
mod check;
pub mod correction;
pub mod dataset;
mod diagnosis_forms;
mod earlier;
mod experiment;
mod gap;
mod linked;
mod load;
mod lost_frames;
pub mod model;
mod noise_floor;
mod overlay;
mod parameters;
pub(crate) mod pipeline;
pub(crate) mod plausibility;
mod policy;
pub mod record;
mod replay;
pub mod residual;
mod residual_places;
pub mod selection;
mod simple_laws;
pub(crate) mod story;
