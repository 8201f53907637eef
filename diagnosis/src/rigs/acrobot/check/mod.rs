//! Doubts of what was found on a cut: posterior predictive checks, each a function of what was found and of nothing else, in the
//! order in which they are asked. To add one, add a file and a line.

mod beside;
mod changing_light;
mod changing_value;
mod circle_beside;
mod clock_drift;
mod confounded;
mod differing_runs;
#[cfg(test)]
mod examples;
mod frames;
mod image_laws;
mod image_shape;
mod law_of_place;
mod lone_readings;
mod policy;
mod residual;
mod shared_scatter;
mod swinging;
mod torque_shape;
mod unlisted_law;
mod unlisted_lens;
mod unlisted_light;
mod widened_gap;

use crate::diagnosis::{Gap, Unknown};
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::linked::Left;
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::residual::image::Together;
use crate::rigs::acrobot::selection::Study;
pub use clock_drift::drifting;
pub use image_shape::is_of_angles;
pub use lone_readings::heavy_tail;
pub use torque_shape::{link_of, torque_shape};

/// What a cut shows.
pub struct Found<'a> {
    /// The search.
    pub study: &'a Study,
    /// What was measured.
    pub signals: &'a [Signal],
    /// All candidates.
    pub list: &'a [Candidate],
    /// A commanded torque was logged beside the angles.
    pub torque: bool,
    /// What linked states leave that has no name.
    pub left: &'a Left,
    /// The effects that have a continuous value.
    pub free: &'a [usize],
    /// Names of the runs.
    pub runs: &'a [String],
    /// The clock of some cut that drifts.
    pub drift: Option<&'a Unknown>,
    /// Circles that scatter together, where their scatter isn't the nominal sensor's.
    pub together: Option<Together>,
    /// How far the effects close the gap.
    pub gap: &'a Gap,
}

/// What a doubt says.
#[derive(Debug, Clone, PartialEq)]
pub enum Judgement {
    /// Nothing against what was found.
    Keep,
    /// The effects are not there.
    Withdraw,
    /// Something is missing that has no name.
    Unknown(Unknown),
}

impl From<Option<Unknown>> for Judgement {
    fn from(unknown: Option<Unknown>) -> Self {
        unknown.map_or(Self::Keep, Self::Unknown)
    }
}

/// A doubt is asked with what the ones before it said to be missing; what it says to be missing replaces that.
type Doubt = fn(&Found<'_>, Option<&Unknown>) -> Judgement;

/// Doubts of the model with its effects.
const OF_THE_MODEL: &[Doubt] = &[
    circle_beside::doubt,
    residual::doubt,
    unlisted_lens::doubt,
    unlisted_light::doubt,
    changing_light::doubt,
    unlisted_law::doubt,
    lone_readings::doubt,
    confounded::doubt,
    law_of_place::doubt,
    changing_value::doubt,
    swinging::doubt,
];
/// Doubts of the logs, and of the effects on runs that were left out.
const OF_THE_LOGS: &[Doubt] =
    &[clock_drift::doubt, differing_runs::doubt, widened_gap::doubt, shared_scatter::doubt];

/// What all doubts leave.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Judged {
    /// What is missing and has no name.
    pub unknown: Option<Unknown>,
    /// Nothing in the model is in doubt, whatever is in the logs.
    pub model_stands: bool,
    /// Names only stand for something that none of them is.
    pub confounded: bool,
    /// The effects are not there.
    pub withdrawn: bool,
}

impl Judged {
    /// Asks some doubts, one after the other.
    fn ask(&mut self, doubts: &[Doubt], found: &Found<'_>) {
        for doubt in doubts {
            match doubt(found, self.unknown.as_ref()) {
                Judgement::Keep => {}
                Judgement::Withdraw => self.withdrawn = true,
                Judgement::Unknown(unknown) => self.unknown = Some(unknown),
            }
        }
    }
}

/// Asks all doubts in their order.
pub fn judged(found: &Found<'_>) -> Judged {
    let mut judged = Judged::default();
    judged.ask(OF_THE_MODEL, found);
    judged.model_stands = judged.unknown.is_none();
    judged.ask(OF_THE_LOGS, found);
    judged.confounded = confounded::explained(found).is_some();
    judged
}
