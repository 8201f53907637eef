//! Circles that scatter together from frame to frame, where a sensor's noise would scatter each on its own.

use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::residual::image::Together;
use crate::rigs::acrobot::residual::studio::AREAS;

/// What makes them, where nothing else has no name.
pub(super) fn doubt(found: &Found<'_>, so_far: Option<&Unknown>) -> Judgement {
    let shared = found.together.filter(|_| so_far.is_none());
    shared.map(|together| shared_by(together, found.signals)).into()
}

/// What two circles share, in words.
fn shared_by(together: Together, signals: &[Signal]) -> Unknown {
    let (one, other) = together.signals;
    let what = if AREAS.contains(&one) {
        "a light that flickers"
    } else {
        "timestamps that are off, or a mount that shakes"
    };
    Unknown {
        signal: signals[one].name.clone(),
        depends_on: vec!["time".into()],
        shape: format!(
            "scatters from frame to frame together with {} (correlation {:.2}), which no noise of a sensor does: as by {what}",
            signals[other].name, together.correlation
        ),
        nearest: "noise of the sensor scatters each circle on its own".into(),
        ..Unknown::default()
    }
}

#[cfg(test)]
mod tests {
    use super::super::examples::signals;
    use super::*;

    #[test]
    fn every_pair_is_told_with_what_it_may_be() {
        for (pair, what) in [((6, 7), "a light that flickers"), ((0, 4), "timestamps that are off")] {
            let all = signals();
            let told = shared_by(Together { signals: pair, correlation: -0.7 }, &all);
            assert_eq!(told.signal, all[pair.0].name);
            let together = format!("together with {} (correlation -0.70)", all[pair.1].name);
            assert!(told.shape.contains(&together) && told.shape.contains(what), "{}", told.shape);
        }
    }
}
