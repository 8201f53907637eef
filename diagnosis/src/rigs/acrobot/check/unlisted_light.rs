//! Light that is not the same all over the image: areas of circles that grow along u or along v, beside what all differ by and beside the
//! effects that are on.

use super::beside::{Laws, surest};
use super::torque_shape::nearest;
use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::residual::studio::AREAS;
use crate::statistics::levels::CERTAIN;
use crate::statistics::linear::Cell;
use nalgebra::DMatrix;

/// Direction of growth: that of all circles alike comes first.
const ALONG: [&str; 3] = ["", "u", "v"];

/// Such a light, where nothing else has no name.
pub(super) fn doubt(found: &Found<'_>, so_far: Option<&Unknown>) -> Judgement {
    if so_far.is_some() || found.torque {
        return Judgement::Keep;
    }
    let told = surest(&found.study.last, &found.study.active, found.signals, &LAWS);
    let Some((law, deviations)) = told.filter(|(_, deviations)| deviations.abs() > CERTAIN) else {
        return Judgement::Keep;
    };
    let how = if deviations < 0.0 { "shrinks" } else { "grows" };
    Judgement::Unknown(Unknown {
        signal: found.signals[AREAS.start].name.clone(),
        depends_on: vec![ALONG[law].into()],
        shape: format!(
            "the area of every circle {how} along {} ({:.1} standard deviations): light or sensitivity that isn't even",
            ALONG[law],
            deviations.abs()
        ),
        nearest: nearest(found.study, found.list),
        ..Unknown::default()
    })
}

/// Those asked for, and a level beside them.
const LAWS: Laws<'static> = Laws { columns: &columns, asked: 1..ALONG.len(), free: 0..1 };

/// By how much each law changes the rows of a frame.
fn columns(cell: &Cell) -> DMatrix<f64> {
    let grows = |row: usize| match cell.drawn.get(row) {
        Some(drawn) if AREAS.contains(&cell.signal[row]) => [1.0, drawn.place[0], drawn.place[1]],
        _ => [0.0; ALONG.len()],
    };
    DMatrix::from_fn(cell.residual.len(), ALONG.len(), |row, law| grows(row)[law])
}

#[cfg(test)]
mod tests {
    use super::super::examples::{frames, place, signals};
    use super::*;

    /// What is told where areas grow by so much per px along u and along v, and all of them by so much.
    fn told(along: [f64; 2], all: f64) -> (usize, f64) {
        let at = frames(|moment, signal| {
            let [u, v] = place(signal, moment.state);
            if AREAS.contains(&signal) { all + along[0] * u + along[1] * v } else { 0.0 }
        });
        surest(&at, &[0], &signals(), &LAWS).expect("900 frames")
    }

    #[test]
    fn law_light_that_falls_to_one_side_is_told_with_the_side() {
        let (law, deviations) = told([0.01, 0.0], 0.3);
        assert!(ALONG[law] == "u" && deviations > CERTAIN, "{law} {deviations}");
        let (law, deviations) = told([0.0, -0.01], 0.3);
        assert!(ALONG[law] == "v" && deviations < -CERTAIN, "{law} {deviations}");
    }

    #[test]
    fn law_what_all_areas_differ_by_is_no_such_light() {
        // the larger of two
        let (_, deviations) = told([0.0; 2], 3.0);
        assert!(deviations.abs() < 3.0, "{deviations}");
    }
}
