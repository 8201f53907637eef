//! Angles in degrees, and encoders beside images: both show the same motion, whatever torque is said to have driven it.

use super::{Facts, Finding};
use crate::rigs::acrobot::dataset::{Run, Table, angle_in_degrees, directions, in_degrees};
use crate::rigs::acrobot::plausibility::policy::PLAUSIBLE;
use crate::rigs::acrobot::policy::POLICY;

/// Degrees instead of radians.
pub(super) fn degrees(facts: &Facts<'_>) -> Option<Finding> {
    facts.runs.iter().find_map(|run| {
        let of = |file: &str, (line, sentence): (usize, String), key: &str| Finding {
            file: format!("{}/{file}", run.name),
            line,
            sentence,
            add: format!("{key} = \"deg\""),
        };
        let logged =
            run.plant.as_ref().and_then(|log| in_degrees(log, run.camera.as_ref(), facts.nominal.falling));
        if let Some(found) = logged {
            return Some(of("plant.csv", found, "angles"));
        }
        let camera = run.camera.as_ref()?;
        let read = (0..2)
            .find_map(|link| angle_in_degrees(camera, run.plant.as_ref(), link, facts.nominal.falling[link]));
        read.map(|found| of("camera.csv", found, "vision_angles"))
    })
}

/// Another way to count angles: what `[log]` must say, in words, and what it makes of those logged.
type Way = (&'static str, &'static str, fn(f64, f64) -> (f64, f64));

/// Offsets are no matter: a mount may be turned by any angle.
const WAYS: [Way; 8] = [
    ("angles_sign = -1", "angles are counted against the image", |q1, q2| (-q1, -q2)),
    ("q2 = \"relative\"", "q2 is link 2 against link 1", |q1, q2| (q1, q1 + q2)),
    ("links = \"swapped\"", "q1 and q2 are exchanged", |q1, q2| (q2, q1)),
    ("q1_sign = -1", "q1 is counted against the image", |q1, q2| (-q1, q2)),
    ("q2_sign = -1", "q2 is counted against the image", |q1, q2| (q1, -q2)),
    (
        "q2_sign = -1\nq2 = \"relative\"",
        "q2 is link 2 against link 1, counted against the image",
        |q1, q2| (q1, q1 - q2),
    ),
    (
        "angles_sign = -1\nq2 = \"relative\"",
        "angles are counted against the image, and q2 against link 1",
        |q1, q2| (-q1, -q1 - q2),
    ),
    (
        "angles_sign = -1\nlinks = \"swapped\"",
        "q1 and q2 are exchanged and counted against the image",
        |q1, q2| (-q2, -q1),
    ),
];

/// Encoders that count otherwise than the image shows.
pub(super) fn against_pictures(facts: &Facts<'_>) -> Option<Finding> {
    facts.runs.iter().find_map(|run| {
        let pairs = pairs(run)?;
        if left(&pairs, |q1, q2| (q1, q2))? < PLAUSIBLE.differs {
            return None;
        }
        let (add, words, _) =
            WAYS.iter().find(|way| left(&pairs, way.2).is_some_and(|left| left < PLAUSIBLE.agrees))?;
        Some(Finding {
            file: format!("{}/plant.csv", run.name),
            line: 0,
            sentence: format!("q1 and q2 don't move as the links do in the images, unless {words}"),
            add: (*add).into(),
        })
    })
}

/// Directions of the links in an image, and the angles logged then, rad.
type Pair = ([f64; 2], [f64; 2]);

/// Pairs of a run that holds images beside encoders; `None` where these are too few.
fn pairs(run: &Run) -> Option<Vec<Pair>> {
    let (log, camera) = (run.plant.as_ref()?, run.camera.as_ref()?);
    let logged = [log.column("q1")?, log.column("q2")?];
    let at = |time: f64| {
        let next = log.time.partition_point(|row| *row <= time);
        if next == 0 || next >= log.len() {
            return None;
        }
        let share = (time - log.time[next - 1]) / (log.time[next] - log.time[next - 1]);
        let angle = |values: &[f64]| values[next - 1] + share * (values[next] - values[next - 1]);
        Some([angle(logged[0]), angle(logged[1])]).filter(|pair| pair.iter().all(|angle| angle.is_finite()))
    };
    let both = directions(camera).into_iter().filter_map(|(time, seen)| Some((seen, at(time)?)));
    Some(both.collect::<Vec<_>>()).filter(|pairs| pairs.len() >= PLAUSIBLE.frames)
}

/// Share of the motion in the image that is left beside the angles, counted so; `None` where little moves.
fn left(pairs: &[Pair], way: fn(f64, f64) -> (f64, f64)) -> Option<f64> {
    let spread = |value: &dyn Fn(&Pair) -> f64| {
        let mean = pairs.iter().map(value).sum::<f64>() / pairs.len() as f64;
        pairs.iter().map(|pair| (value(pair) - mean).powi(2)).sum::<f64>()
    };
    let counted = |(_, logged): &Pair, link: usize| {
        let (q1, q2) = way(logged[0], logged[1]);
        [q1, q2][link]
    };
    let motion: f64 = (0..2).map(|link| spread(&|pair| pair.0[link])).sum();
    let residual: f64 = (0..2).map(|link| spread(&|pair| pair.0[link] - counted(pair, link))).sum();
    ((motion / pairs.len() as f64).sqrt() > POLICY.least_motion).then(|| (residual / motion).sqrt())
}

/// A log of angles as images show them, for what only the motion can tell.
pub(super) fn seen(camera: &Table) -> Table {
    let seen = directions(camera);
    let column = |link: usize| seen.iter().map(|(_, pair)| pair[link]).collect();
    let time = seen.iter().map(|(time, _)| *time).collect();
    Table::new(time, vec![("q1".into(), column(0)), ("q2".into(), column(1))])
}
