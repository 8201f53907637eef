//! Do the effects widen the gap on runs that were left out? Then none of them is there.

use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::gap::widened;

/// All of a cut's effects are withdrawn together.
pub(super) fn doubt(found: &Found<'_>, _: Option<&Unknown>) -> Judgement {
    let withdrawn = found.torque && widened(found.study, found.free, found.gap);
    if withdrawn { Judgement::Withdraw } else { Judgement::Keep }
}
