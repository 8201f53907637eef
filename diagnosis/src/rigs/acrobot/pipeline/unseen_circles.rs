//! A camera that sees nothing: that no frame can be compared is a finding, where the nominal camera sees its circles.

use super::Rig;
use crate::diagnosis::Unknown;
use crate::error::Error;
use crate::rigs::acrobot::dataset::Run;
use crate::rigs::acrobot::residual::studio::{Shot, Studio};
use crate::statistics::levels::{HALF, SAMPLE};

/// That runs hold frames without a circle, though the nominal camera finds all of them in most poses that encoders tell.
pub(super) fn frames_without_circles(rig: &Rig<'_>) -> Result<Option<Unknown>, Error> {
    let Rig { data, model, .. } = rig;
    let runs = data.runs.iter().filter_map(|run| Some((run, data.blind.get(&run.name)?)));
    let poses: Vec<[f64; 2]> = runs.flat_map(|(run, frames)| poses(run, frames)).collect();
    if poses.is_empty() || model.camera.is_none() {
        return Ok(None);
    }
    let still = |[q1, q2]: &[f64; 2]| [*q1, *q2, 0.0, 0.0];
    let some = poses.iter().step_by(poses.len().div_ceil(SAMPLE));
    let shots: Vec<Shot> =
        some.map(|pose| Shot { before: still(pose), end: still(pose), odd: false }).collect();
    let seen = Studio::new(model)?.take(&[], &shots)?.iter().flatten().count();
    Ok((seen as f64 > HALF * shots.len() as f64).then(|| Unknown {
        signal: "camera.valid".into(),
        shape: "the camera finds its circles in no frame, where the nominal camera finds all three: far out of focus, dark, or looking \
                elsewhere"
            .into(),
        nearest: "no frame can be compared, so that none of the camera's effects is excluded".into(),
        ..Unknown::default()
    }))
}

/// Poses that encoders tell while frames were taken.
fn poses(run: &Run, frames: &[f64]) -> Vec<[f64; 2]> {
    let Some(log) = &run.plant else { return Vec::new() };
    let (Some(q1), Some(q2)) = (log.column("q1"), log.column("q2")) else { return Vec::new() };
    let during = |time: f64| frames.first() <= Some(&time) && Some(&time) <= frames.last();
    let rows =
        (0..log.len()).filter(|row| during(log.time[*row]) && q1[*row].is_finite() && q2[*row].is_finite());
    rows.map(|row| [q1[row], q2[row]]).collect()
}
