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
        "time stamps that are off, or a mount that shakes"
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
        let told = |signals: (usize, usize)| Together { signals, correlation: -0.7 };
        let [light, stamps] = [(6, 7), (0, 4)].map(|pair| shared_by(told(pair), &self::signals()));
        assert_eq!((light.signal.as_str(), stamps.signal.as_str()), ("camera.area1", "camera.u1"));
        assert!(light.shape.contains("camera.area2 (correlation -0.70)") && light.shape.contains("a light"));
        assert!(
            stamps.shape.contains("camera.u3") && stamps.shape.contains("time stamps"),
            "{}",
            stamps.shape
        );
    }
}
