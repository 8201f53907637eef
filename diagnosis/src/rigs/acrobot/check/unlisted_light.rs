//! Light that is not the same all over the image: areas of circles that grow along u or along v, beside what all differ by and beside the
//! effects that are on.

use super::beside::{Laws, surest};
use super::torque_shape::nearest;
use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::residual::image::IMAGES;
use crate::rigs::acrobot::residual::studio::AREAS;
use crate::rigs::acrobot::selection::Evaluation;
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
    if let Some(by) = level(&found.study.last).filter(|by| by.abs() > IMAGES.unlit) {
        return Judgement::Unknown(all_alike(by + by.signum() * IMAGES.level, found));
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

/// By how much all areas differ from the model's alike, px, beyond what right renderers may; nothing where no area was logged.
fn level(at: &Evaluation) -> Option<f64> {
    let cells = at.blocks.iter().flat_map(|block| &block.cells);
    let rows = cells.flat_map(|cell| cell.signal.iter().zip(&cell.residual));
    let areas = rows.filter(|(signal, _)| AREAS.contains(signal));
    let (sum, count) = areas.fold((0.0, 0.0), |(sum, count), (_, by)| (sum + by, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

/// Circles that are all larger or smaller by so much, px.
fn all_alike(by: f64, found: &Found<'_>) -> Unknown {
    let than = if by < 0.0 { "smaller" } else { "larger" };
    Unknown {
        signal: found.signals[AREAS.start].name.clone(),
        shape: format!(
            "constant: all circles are {:.1} px {than} than the model has them: another light, threshold or size of the markers",
            by.abs()
        ),
        nearest: nearest(found.study, found.list),
        ..Unknown::default()
    }
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
    fn law_the_level_is_that_of_areas_alone() {
        let at = frames(|_, signal| if AREAS.contains(&signal) { 2.5 } else { 9.0 });
        assert!(level(&at).is_some_and(|by| (by - 2.5).abs() < 0.5), "{:?}", level(&at));
    }

    #[test]
    fn law_what_all_areas_differ_by_is_no_such_light() {
        // the larger of two
        let (_, deviations) = told([0.0; 2], 3.0);
        assert!(deviations.abs() < 3.0, "{deviations}");
    }
}
