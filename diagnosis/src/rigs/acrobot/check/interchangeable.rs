//! Is a name one of too many? Where nearly anything could stand in its place, all that is known is that something is there.

use super::shape::nominal_shape;
use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::check::policy::CHECK;
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::selection::{Alternative, CLASS, Study};

/// Such an effect is none, unless something is left that tells more.
pub(super) fn doubt(found: &Found<'_>, so_far: Option<&Unknown>) -> Judgement {
    if so_far.is_some() {
        return Judgement::Keep;
    }
    explained(found).into()
}

/// What the name only stands for, if it does.
pub(super) fn explained(found: &Found<'_>) -> Option<Unknown> {
    anything(found.study, found.signals, found.list, found.classes, found.torque)
}

/// An effect in whose place nearly anything could stand: something is there, and that is all that is known of it.
fn anything(
    study: &Study,
    signals: &[Signal],
    candidates: &[Candidate],
    classes: &[(usize, Vec<Alternative>)],
    torque: bool,
) -> Option<Unknown> {
    let open = |alternatives: &[Alternative]| alternatives.iter().filter(|other| other.loss < CLASS).count();
    let seen = study.seen.len() as f64;
    let (index, count) = classes
        .iter()
        .map(|(index, alternatives)| (*index, open(alternatives)))
        .find(|(_, count)| *count > 2 && *count as f64 > CHECK.anything * seen)?;
    let (signal, depends_on, shape) = nominal_shape(study, signals, torque)?;
    let nearest = format!("{} and {} others explain it equally well", candidates[index].name, count - 1);
    Some(Unknown { signal, depends_on, shape, nearest, ..Unknown::default() })
}
