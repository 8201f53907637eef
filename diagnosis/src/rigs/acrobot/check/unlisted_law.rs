//! A torque, or the reading of an angle, that follows a law which no candidate gives: told by linked states where windows leave nothing of it.

use super::image_shape::Shape;
use super::torque_shape::nearest;
use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::linked::UnlistedLaw;
use crate::statistics::levels::{CERTAIN, HALF, SLIGHT};

/// Such a law, where nothing else has no name.
pub(super) fn doubt(found: &Found<'_>, so_far: Option<&Unknown>) -> Judgement {
    let sure = found.left.law.as_ref().filter(|unlisted| so_far.is_none() && is_sure(unlisted));
    let told = |unlisted: &UnlistedLaw| {
        let known = format!("{:.1} standard deviations", unlisted.deviations);
        let (signal, depends_on, shape) = in_words(unlisted, &known);
        let nearest = nearest(found.study, found.list);
        Unknown { signal, depends_on, shape, nearest, ..Unknown::default() }
    };
    sure.map(told).into()
}

/// What a torque looks like that a model lacks, where one law takes most of it: a window's torque has the error of its start state, linked
/// states have none.
pub(super) fn shape(found: &Found<'_>) -> Option<Shape> {
    let most = found.left.law.as_ref().filter(|unlisted| is_most(unlisted));
    most.map(|unlisted| in_words(unlisted, &format!("{:.0} % of it", 100.0 * unlisted.share)))
}

/// A law with how it is known.
fn in_words(unlisted: &UnlistedLaw, known: &str) -> Shape {
    let depends_on = unlisted.law.depends_on.iter().map(|name| (*name).to_owned()).collect();
    (unlisted.on.signal().to_owned(), depends_on, format!("{} ({known})", unlisted.law.words))
}

/// Whether a law is none of noise: rows whose noise is not white, as rounded ones, need process noise that no law takes away.
fn is_sure(unlisted: &UnlistedLaw) -> bool {
    is_told(unlisted) && unlisted.quiet || is_most(unlisted)
}

/// Whether a law takes most of what process noise stood for.
fn is_most(unlisted: &UnlistedLaw) -> bool {
    is_told(unlisted) && unlisted.share > HALF
}

/// Whether chance gives no such law, nor what dry friction leaves by the way in which it brings an arm to rest: a unit may smooth its sign, and
/// states near rest have no normal distribution.
fn is_told(unlisted: &UnlistedLaw) -> bool {
    unlisted.deviations > CERTAIN.max(SLIGHT * unlisted.friction)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::simple_laws::all_laws;

    fn told(deviations: f64, share: f64, quiet: bool) -> UnlistedLaw {
        let (on, law) = all_laws(false)[2].clone();
        UnlistedLaw { on, law, deviations, share, quiet, friction: 0.0 }
    }

    #[test]
    fn value_a_law_is_told_from_four_and_a_half_deviations_on() {
        assert_eq!([4.4, 4.6].map(|deviations| is_sure(&told(deviations, 0.0, true))), [false, true]);
        assert_eq!([4.4, 4.6].map(|deviations| is_sure(&told(deviations, 0.9, false))), [false, true]);
    }

    #[test]
    fn law_what_rows_that_are_rounded_leave_is_no_law() {
        // 28 s at 250 Hz with 5000 counts a turn leave process noise, and a law with 94 standard deviations that takes none of it away
        assert!(!is_sure(&told(94.0, 0.0, false)));
        assert_eq!([0.49, 0.51].map(|share| is_sure(&told(94.0, share, false))), [false, true]);
    }

    #[test]
    fn value_a_fiftieth_of_the_dry_friction_that_is_on_is_no_law() {
        // 0.02 N·m at a balanced arm's joint, told by 3200 standard deviations, left a law with 5.8
        let sure = |deviations| is_sure(&UnlistedLaw { friction: 3200.0, ..told(deviations, 0.9, true) });
        assert_eq!([5.8, 63.0, 65.0].map(sure), [false, false, true]);
    }

    #[test]
    fn value_a_law_is_told_with_its_signal_and_its_variables() {
        let (signal, depends_on, shape) = in_words(&told(7.0, 0.0, true), "7.0 standard deviations");
        assert_eq!((signal.as_str(), depends_on), ("plant torque on link 1", vec!["q1".to_owned()]));
        assert_eq!(shape, "odd in q1, like a spring (7.0 standard deviations)");
    }
}
