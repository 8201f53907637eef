//! Single readings of an encoder that lie far off, while all others are met to within their noise.

use super::torque_shape::nearest;
use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::error::Notice;
use crate::rigs::acrobot::linked::Left;
use crate::rigs::acrobot::linked::policy::LINKED;
use crate::rigs::acrobot::simple_laws::ANGLES_OF_LOG;
use crate::text::brief;

/// Such readings, where nothing else has no name, and where they are more than the tail of the noise.
pub(super) fn doubt(found: &Found<'_>, so_far: Option<&Unknown>) -> Judgement {
    let lone = found.left.lone.as_ref().filter(|lone| so_far.is_none() && lone.stand_out);
    let told = lone.map(|lone| {
        let (run, time) = lone.first;
        Unknown {
            signal: ANGLES_OF_LOG[lone.angle].into(),
            depends_on: vec!["time".into()],
            shape: format!(
                "single readings, {} of {}, the first in {} at {time:.2} s, off by up to {} rad: an encoder that slips, or values that came late",
                lone.count,
                lone.of,
                found.runs.get(run).map_or("", String::as_str),
                brief(lone.farthest)
            ),
            nearest: nearest(found.study, found.list),
            ..Unknown::default()
        }
    });
    told.into()
}

/// Says that an encoder's noise has a heavy tail, where readings lie far off, and no more than it gives.
pub fn heavy_tail(left: &Left) -> Option<Notice> {
    let lone = left.lone.as_ref().filter(|lone| !lone.stand_out)?;
    let message = format!(
        "{} of {} readings of {} lie beyond {} standard deviations, as many as its noise leads one to expect, whose tail is heavier than a normal one's",
        lone.count, lone.of, ANGLES_OF_LOG[lone.angle], LINKED.lone
    );
    Some(Notice { file: "plant.csv".into(), line: 0, message })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::linked::LoneReadings;

    #[test]
    fn value_a_heavy_tail_is_told_where_no_reading_stands_out() {
        let told = |stand_out: bool| {
            let lone =
                LoneReadings { angle: 1, count: 11, of: 5400, first: (0, 0.0), farthest: 3e-3, stand_out };
            heavy_tail(&Left { lone: Some(lone), ..Left::default() }).map(|notice| notice.message)
        };
        assert_eq!(told(true), None);
        let told = told(false).expect("a notice");
        assert!(
            told.starts_with("11 of 5400 readings of plant.q2 lie beyond 6 standard deviations"),
            "{told}"
        );
    }
}
