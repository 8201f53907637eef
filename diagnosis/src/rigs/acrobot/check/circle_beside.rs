//! Circles that stand beside their link's line. Where images alone tell the angles, one that is off all the time against the pull of gravity is
//! no encoder's zero, which is set by hand: a target is bent, or was glued on beside the joint or the tip.

use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::gap::chained;
use crate::text::brief;

/// The circle at the end of each link, of which its angle is read, and that angle.
const ENDS: [(&str, &str, &str); 2] =
    [("camera.u2", "q1", "circle 2 on link 1"), ("camera.u3", "q2", "circle 3 on link 2")];

/// The angle that is off most, if images alone tell it.
pub(super) fn doubt(found: &Found<'_>, _: Option<&Unknown>) -> Judgement {
    if !chained(found.signals) {
        return Judgement::Keep;
    }
    let off = |index: &usize| found.list[*index].zero().map(|angle| (angle, found.study.last.point[*index]));
    let most = found.study.active.iter().filter_map(off).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    most.map(|(angle, by)| beside(angle, by)).into()
}

/// A circle that images show at this angle from its link's line, rad.
fn beside(angle: usize, by: f64) -> Unknown {
    let (signal, name, circle) = ENDS[angle];
    Unknown {
        signal: signal.into(),
        depends_on: vec![name.into()],
        shape: format!(
            "constant: {circle} is seen {} rad off where gravity has the link, as by a bent target or a circle that is {} of the link's \
             length beside its line",
            brief(by),
            brief(by.tan().abs())
        ),
        nearest: "Nothing on the list moves a circle across its link".into(),
        ..Unknown::default()
    }
}
