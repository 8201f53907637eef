//! Values that change along the runs: a residual that goes if one parameter may rise or fall with time, a battery that sags, say, or a mount
//! that gives way. Whatever has one name all along was named before.

use super::policy::CHECK;
use super::torque_shape::{common, torque_shape};
use super::{Found, Judgement};
use crate::diagnosis::Unknown;
use crate::rigs::acrobot::candidates::{Motion, Side};
use crate::rigs::acrobot::gap::chained;
use crate::rigs::acrobot::residual::studio::{AREAS, CENTROIDS};
use crate::rigs::acrobot::selection::{Evaluation, Steadiness, steadiness};
use crate::rigs::acrobot::story::brief;
use crate::statistics::levels::HALF;

/// What changes, if something does that explains more than a law of state or place.
pub(super) fn doubt(found: &Found<'_>, so_far: Option<&Unknown>) -> Judgement {
    let (parameter, light) = (parameter(found, so_far), light(found));
    // whatever passes for a part of it
    let best = match (&parameter, &light) {
        (Some((by, _)), Some((other, _))) if by > other => parameter,
        (_, Some(_)) => light,
        _ => parameter,
    };
    best.map(|(_, unknown)| unknown).into()
}

/// The parameter whose change with time explains most, after the squares that it explains.
fn parameter(found: &Found<'_>, so_far: Option<&Unknown>) -> Option<(f64, Unknown)> {
    let Found { study, list, .. } = *found;
    let at = &study.last;
    let steady = |index: &usize| {
        let own = &list[*index];
        // a ceiling cuts some commands and not others, which is no course of time
        let cuts = matches!(own.motion, Motion::Saturation { .. });
        matches!(own.side, Side::Plant | Side::Camera) && !own.is_discrete() && !cuts
    };
    let wanders = |index: usize| Some((index, steadiness(at, index, &study.active).filter(wanders)?));
    let all = (0..list.len()).filter(steady).filter_map(wanders);
    let (index, of) = all.max_by(|a, b| a.1.wandering.total_cmp(&b.1.wandering))?;
    let torques = found.torque || chained(found.signals) && list[index].side == Side::Plant;
    // noise that was fitted to the runs passes for what is left
    let left = (at.total.square - at.total.freedom).max(of.wandering);
    if so_far.is_some() && of.wandering < left * common(study, at, torques).max(HALF) {
        return None;
    }
    let own = &list[index];
    let lasts = at.blocks.iter().map(|block| block.to).fold(0.0, f64::max);
    let inactive = if study.active.contains(&index) { 0.0 } else { of.mean };
    let then = |sign: f64| {
        let x = at.point[index] + inactive + sign * 0.5 * lasts * of.drift.0;
        brief(own.value(x.clamp(own.range.0, own.range.1)))
    };
    let shape = format!(
        "a value that changes along the runs: {} ({}) would go from {} to {} in {} s",
        own.name,
        own.phrase,
        then(-1.0),
        then(1.0),
        brief(lasts)
    );
    let signal = so_far.map(|left| left.signal.clone());
    let signal =
        signal.unwrap_or_else(|| if torques { torque_shape(study, at).0 } else { worst(found, index) });
    let nearest = so_far.map_or_else(
        || format!("{} comes nearest, but has no one value", own.name),
        |left| left.nearest.clone(),
    );
    let unknown = Unknown { signal, depends_on: vec!["time".into()], shape, nearest, ..Unknown::default() };
    Some((of.wandering, unknown))
}

/// A drift that is beyond doubt.
fn wanders(of: &Steadiness) -> bool {
    of.drift.1.abs() > CHECK.wanders && of.wandering > CHECK.wanders_far
}

/// The signal of the image that a candidate moves most.
fn worst(found: &Found<'_>, index: usize) -> String {
    let at = &found.study.last;
    let place = at.places(&[index]);
    let square = |signal: usize| {
        let cells = at.blocks.iter().flat_map(|block| &block.cells);
        let rows = cells.flat_map(|cell| (0..cell.signal.len()).map(move |row| (cell, row)));
        let own = rows.filter(|(cell, row)| cell.signal[*row] == signal);
        own.map(|(cell, row)| {
            place.iter().map(|place| (cell.columns[(row, *place)] / cell.sigma[row]).powi(2)).sum::<f64>()
        })
        .sum::<f64>()
    };
    let best = CENTROIDS.max_by(|a, b| square(*a).total_cmp(&square(*b)));
    best.map_or_else(String::new, |signal| found.signals[signal].name.clone())
}

/// Areas of all circles that grow or shrink together, after the squares that this explains: no parameter of the camera is its light or its
/// threshold.
fn light(found: &Found<'_>) -> Option<(f64, Unknown)> {
    let at = &found.study.last;
    let (squares, drift) = growing(at).filter(|_| !found.torque)?;
    let lasts = at.blocks.iter().map(|block| block.to).fold(0.0, f64::max);
    let shape = format!(
        "the area of every circle {} along the runs, by {} px in {} s: the light, the aperture or the threshold changes",
        if drift < 0.0 { "shrinks" } else { "grows" },
        brief((lasts * drift).abs()),
        brief(lasts)
    );
    let nearest = "no listed effect changes with time".into();
    let signal = found.signals[AREAS.start].name.clone();
    Some((squares, Unknown { signal, depends_on: vec!["time".into()], shape, nearest, ..Unknown::default() }))
}

/// How fast all areas grow alike, px a second, after the squares that this explains; `None` where they don't beyond doubt.
fn growing(at: &Evaluation) -> Option<(f64, f64)> {
    let drifts: Vec<(f64, f64)> = AREAS.filter_map(|area| drift(at, area)).collect();
    let sure = |sign: f64| drifts.iter().all(|(_, errors)| sign * errors > CHECK.wanders);
    let mean = drifts.iter().map(|(drift, _)| drift).sum::<f64>() / drifts.len() as f64;
    let squares = drifts.iter().map(|(_, errors)| errors * errors).sum();
    (drifts.len() == AREAS.len() && (sure(1.0) || sure(-1.0))).then_some((squares, mean))
}

/// Drift of a signal within runs, in its unit a second, and how many standard errors that is.
fn drift(at: &Evaluation, signal: usize) -> Option<(f64, f64)> {
    let mut rows: Vec<(usize, f64, f64)> = Vec::new();
    for block in &at.blocks {
        for cell in &block.cells {
            let own = cell.signal.iter().position(|own| *own == signal);
            rows.extend(own.map(|row| (block.run, cell.time[row], cell.residual[row])));
        }
    }
    let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
    for run in rows.chunk_by(|a, b| a.0 == b.0) {
        let count = run.len() as f64;
        let time = run.iter().map(|row| row.1).sum::<f64>() / count;
        let mean = run.iter().map(|row| row.2).sum::<f64>() / count;
        for (_, at, value) in run {
            xy += (at - time) * (value - mean);
            xx += (at - time).powi(2);
            yy += (value - mean).powi(2);
        }
    }
    if xx <= 0.0 {
        return None;
    }
    let scatter = (yy - xy * xy / xx).max(0.0) / rows.len() as f64;
    Some((xy / xx, xy / (xx * scatter).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::super::examples::frames;
    use super::*;

    #[test]
    fn value_a_drift_counts_from_where_it_is_beyond_doubt() {
        let of = |errors: f64, squares: f64| {
            let none = (0.0, 0.0);
            wanders(&Steadiness {
                runs: [(0, none)].into(),
                mean: 0.0,
                decrease: 0.0,
                apart: 0.0,
                within: 0.0,
                squares: 0.0,
                drift: (1.0, errors),
                wandering: squares,
            })
        };
        assert_eq!([4.4, -4.4, 4.6, -4.6].map(|errors| of(errors, 100.0)), [false, false, true, true]);
        assert_eq!([55.0, 65.0].map(|squares| of(6.0, squares)), [false, true]);
    }

    #[test]
    fn law_a_mount_that_gives_way_wanders_and_one_that_is_off_does_not() {
        let shifted =
            |by: fn(f64) -> f64| {
                let at = frames(|moment, signal| {
                    if signal < AREAS.start && signal.is_multiple_of(2) { by(moment.time) } else { 0.0 }
                });
                steadiness(&at, 0, &[]).expect("frames show it")
            };
        let (off, gives_way) = (shifted(|_| 0.1), shifted(|time| 0.002 * time));
        assert!(!wanders(&off) && wanders(&gives_way));
        // 0.025 px of noise in 2700 rows over 30 s leaves 3 % of it, three times that is chance
        assert!((gives_way.drift.0 / 0.002 - 1.0).abs() < 0.09, "{:?}", gives_way.drift);
    }

    #[test]
    fn law_a_light_that_fades_is_told_by_all_areas_and_not_by_one() {
        let fading = |circles: usize| {
            growing(&frames(move |moment, signal| {
                if (AREAS.start..AREAS.start + circles).contains(&signal) { -0.04 * moment.time } else { 0.0 }
            }))
        };
        let (_, drift) = fading(3).expect("it fades");
        // 1 px of noise over 900 frames of 30 s leaves 0.004 px a second of each of the three
        assert!((drift + 0.04).abs() < 0.008, "{drift}");
        assert_eq!([fading(0), fading(1), fading(2)], [None; 3]);
    }
}
