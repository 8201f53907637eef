//! Single readings of an encoder that lie far off, while all others are met to within their noise.

use super::torque_shape::nearest;
use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::simple_laws::ANGLES_OF_LOG;
use crate::text::brief;

/// Such readings, where nothing else has no name.
pub(super) fn doubt(found: &Found<'_>, so_far: Option<&Unknown>) -> Judgement {
    let lone = found.left.lone.as_ref().filter(|_| so_far.is_none());
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
