//! A camera that swings by less than a gap shows: one of its effects at one frequency, in all frames of a run, with a phase for each run.

use super::frames::{Frames, Swing};
use super::torque_shape::{nearest, widest};
use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::statistics::levels::CERTAIN;

/// What swings, where nothing else has no name.
pub(super) fn doubt(found: &Found<'_>, so_far: Option<&Unknown>) -> Judgement {
    if so_far.is_some() || found.torque {
        return Judgement::Keep;
    }
    let Found { study, list, signals, .. } = *found;
    let swing = Frames::of(&study.last).swing(&study.last, list).filter(is_evident);
    let told = |swing: Swing| Unknown {
        signal: signals[widest(&study.last)].name.clone(),
        depends_on: vec!["time".into()],
        shape: format!("{} ({:.1} standard deviations)", swing.words(list), swing.deviations()),
        nearest: nearest(study, list),
        ..Unknown::default()
    };
    swing.map(told).into()
}

/// Whether it is none of noise, the best of some thousand frequencies and effects: it has 3.4 to 4.2 standard deviations on sets where nothing
/// swings, 19 where a focus breathes by 0.00015 and 24 where a mount sways by 0.04 px.
fn is_evident(swing: &Swing) -> bool {
    swing.deviations() > 2.0 * CERTAIN
}

#[cfg(test)]
mod tests {
    use super::super::examples::{candidates, frames};
    use super::*;
    use crate::rigs::acrobot::residual::studio::CENTROIDS;
    use std::f64::consts::TAU;

    /// What swings where all circles move along u by so much, px, 0.9 times a second.
    fn swung(size: f64) -> Swing {
        let at = frames(|moment, signal| {
            let along_u = CENTROIDS.contains(&signal) && signal.is_multiple_of(2);
            if along_u { size * libm::sin(TAU * 0.9 * moment.time) } else { 0.0 }
        });
        Frames::of(&at).swing(&at, &candidates()).expect("a run of 30 s")
    }

    #[test]
    fn law_a_swing_of_a_tenth_of_the_noise_shows_and_noise_does_not() {
        let (none, some) = (swung(0.0), swung(0.01));
        assert!(!is_evident(&none) && is_evident(&some), "{none:?} {some:?}");
        assert!(some.words(&candidates()).starts_with("swinging 0.90 times a second, as if shift"));
    }

    #[test]
    fn value_a_swing_is_told_from_nine_deviations_on() {
        // of squares with two degrees of freedom these gains have 8.9 and 9.1
        assert_eq!([114.0, 120.0].map(|gain| is_evident(&Swing { gain, ..swung(0.0) })), [false, true]);
    }
}
