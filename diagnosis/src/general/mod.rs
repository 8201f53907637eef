//! The diagnosis of any unit (`format = 2`), from end to end.
//!
//! - `study.rs`: problem → engine → search → what has no name → [`Diagnosis`]
//! - `reading.rs`: whether a row's outputs were read before or after its inputs began to act
//! - `rows_or_whole_runs.rs`: whether rows can be begun anew, or each run is simulated whole
//! - `long.rs`: which stretches of long logs are searched, and the fit of what was found to all rows
//! - `residual.rs`: whether process noise stays above its floor, where, and what its smoothed course follows
//! - `rest.rs`: what is tried where something is left that no single effect takes away
//! - `events.rs`: when it acted, where it is quiet between
//! - `runs.rs`: whether runs differ by what has no name
//! - `sensor.rs`: what a sensor shows that neither the model nor noise gives
//! - `after_moves.rs`: what is left of an output that follows past moves of an input
//! - `fit_given.rs`: a fit of what was asked for, in place of a search
//! - `rows_left_out.rs`: which rows are searched, and which are left out for the gap
//! - `mismatch.rs`: the gap on rows that nothing was fitted to
//! - `windows.rs`: windows of a run, each followed from a start state of its own
//! - `times_off.rs`: what timestamps that scatter leave of one
//! - `courses.rs`: measured, nominal and amended there, for the page
//! - `findings.rs`: effects, classes, what the data would show
//! - `equivalent.rs`: an unlisted input as a signal at a declared one
//! - `amended.rs`, `table.rs`: the scenario with what was found, and what the logs fed it
//! - `misread.rs`: logs that count otherwise than is said, of a machine that lacks something as well
//! - `held_or_lines.rs`: which reading of inputs that run smoothly is the likelier one
//! - `blame.rs`: what most likely made a diagnosis fail
//! - `policy.rs`: the numbers that decide, with their reasons

mod after_moves;
mod amended;
mod blame;
mod courses;
mod equivalent;
mod events;
mod findings;
mod fit_given;
mod held_or_lines;
mod long;
mod mismatch;
mod misread;
mod noisy_inputs;
mod policy;
mod reading;
mod residual;
mod rest;
mod rows_left_out;
mod rows_or_whole_runs;
mod runs;
mod sensor;
mod study;
mod table;
mod times_off;
mod windows;

pub(crate) use held_or_lines::likelier_lines;
pub use study::diagnosed;
pub use table::{INPUT_LINES, INPUTS};
