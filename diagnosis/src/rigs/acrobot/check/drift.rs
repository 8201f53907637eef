//! Do clocks drift apart? What that leaves resembles much else.

use super::shape::nearest;
use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::candidates::{Attribute, Candidate, Side, place};
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::selection::{Study, steadiness};

/// Where something is left that has no name, the drift of any cut's clock stands for it; elsewhere this cut's own.
pub(super) fn doubt(found: &Found<'_>, so_far: Option<&Unknown>) -> Judgement {
    match so_far {
        Some(_) => found.drift.cloned().into(),
        None => drifting(found.study, found.list).into(),
    }
}

/// Clocks that drift apart: by how much the log's, or the image's delay, moves along the runs.
pub fn drifting(study: &Study, candidates: &[Candidate]) -> Option<Unknown> {
    let clock = candidates.iter().position(|candidate| candidate.side == Side::Clock);
    let delay = place(candidates, Attribute::ImageDelay);
    let stamps = [(clock, "timestamps of the plant's log"), (delay, "timestamps of the image")];
    stamps.into_iter().find_map(|(index, signal)| {
        let index = index?;
        let (rate, clear) = steadiness(&study.last, index, &study.active)?.drift;
        let told = || Unknown {
            signal: signal.to_owned(),
            depends_on: vec!["time".into()],
            shape: format!("clocks that drift apart, by some {:.0} ms in a minute", 6e4 * rate),
            nearest: nearest(study, candidates),
            ..Unknown::default()
        };
        (clear.abs() > POLICY.clear).then(told)
    })
}
