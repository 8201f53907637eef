//! Doubts before anything is fitted: logs that count otherwise than the model does look like a machine that lacks everything, and
//! a diagnosis of them names effects that aren't there.
//!
//! An ordered list. The first that is beyond doubt ends the diagnosis with one sentence and the line that `dataset.toml`, or the
//! log, needs. Nothing is changed by guess.
//!
//! - `stuck.rs`: a sensor that stood still for a while: the log alone tells
//! - `one_value.rs`: one that stood still throughout a run: the model moves it
//! - `wrapped.rs`: an angle that wraps in the log: the model turns on
//! - `readings.rs`: the model follows the logs when they are read otherwise, and not as they are
//! - `by_inputs.rs`: and what it is fed has a say in that
//! - `pairs_of_ways.rs`: in two ways at once, where one alone doesn't help
//! - `ways.rs`: how else they can be read: signs, exchanged columns
//! - `units.rs`: other units of measurement
//! - `times.rs`: of these, units of time
//! - `kinds.rs`: of these, rates per minute or hour, and columns of one kind alike
//! - `lines.rs`: inputs that run along lines between rows and are read as held
//! - `nearer.rs`: readings that are nearer and not near, for what follows a fit
//! - `held_over.rs`: readings that a log repeats: what isn't measured is taken out, and told
//! - `hints.rs`: what looks odd and is no proof: notices
//! - `policy.rs`: the numbers that decide, with their reasons

mod by_inputs;
mod held_over;
mod hints;
mod kinds;
mod lines;
mod nearer;
mod one_value;
mod pairs_of_ways;
mod policy;
mod readings;
mod stuck;
mod times;
mod units;
mod ways;
mod wrapped;

pub(crate) use hints::hinted;
pub(crate) use lines::{Runs, along_lines, lines, may_be_lines};
pub(crate) use nearer::{Reading, nearer, unit_of_ratio};
pub(crate) use policy::STRETCH;
pub(crate) use readings::{Signs, signs, too_long_times};
pub(crate) use stuck::stood_still;

use crate::error::Error;
use crate::observe::Problem;

/// Something that can't be.
#[derive(Debug, Clone, PartialEq)]
struct Doubt {
    /// Line of `dataset.toml` that it is about.
    line: usize,
    /// One sentence: what was found.
    sentence: String,
    /// What to add or change.
    add: String,
}

/// A doubt of a data set, if there is one.
type Check = fn(&Problem) -> Option<Doubt>;

/// In the order in which one thing hides another: no model follows a sensor that stands still.
const CHECKS: &[Check] = &[stuck::still, one_value::still, wrapped::wrapped, readings::otherwise];

/// Ends with the first doubt.
///
/// # Errors
/// A log that can't be what `dataset.toml` says it is.
pub fn plausible(problem: &Problem) -> Result<(), Error> {
    let nominal = &problem.as_it_is();
    match CHECKS.iter().find_map(|check| check(nominal)) {
        None => Ok(()),
        Some(Doubt { line, sentence, add }) => Err(Error::Manifest {
            path: problem.path.join("dataset.toml"),
            line: line.max(1),
            problem: format!("{sentence}. {add}"),
        }),
    }
}
