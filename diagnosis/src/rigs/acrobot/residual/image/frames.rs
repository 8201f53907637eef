//! Which of a log's images are compared, and what of each: any of the camera's outputs will do where a motion was logged; where
//! none was, two circles must tell a pose, or angles that the rig's own vision read.

use super::Frame;
use crate::rigs::acrobot::dataset::DataSet;
use crate::rigs::acrobot::residual::image::policy::IMAGES;
use crate::rigs::acrobot::residual::studio::{ANGLES, CENTROIDS, COLUMNS, Seen, Shot, circle_of};
use std::f64::consts::{PI, TAU};

/// Coordinates of circles 2 and 3: where circle 1 is then, the angles say.
const JOINT_AND_TIP: std::ops::Range<usize> = CENTROIDS.start + 2..CENTROIDS.end;

/// All frames that say something, at no pose yet.
pub(super) fn frames(data: &DataSet, motion: bool) -> Vec<Frame> {
    let mut frames = Vec::new();
    for (run, log) in data.runs.iter().enumerate() {
        let Some(camera) = &log.camera else { continue };
        for row in 0..camera.len() {
            let cell = |name: &str| camera.column(name).map_or(f64::NAN, |column| column[row]);
            let seen = once(COLUMNS.map(cell));
            let some = seen.iter().any(|value| value.is_finite());
            if if motion { some } else { tells_pose(&seen) } {
                let shot = Shot { before: [0.0; 4], end: [0.0; 4], odd: false };
                frames.push(Frame { run, time: camera.time[row], seen, shot, known: false });
            }
        }
    }
    frames
}

/// Nothing twice: where circles are logged that tell a pose, angles are only read off them; elsewhere angles say what
/// the circles would.
fn once(mut seen: Seen) -> Seen {
    let all = |places: std::ops::Range<usize>| seen[places].iter().all(|value| value.is_finite());
    if all(JOINT_AND_TIP) {
        seen[ANGLES].fill(f64::NAN);
    } else if all(ANGLES) {
        seen[CENTROIDS].fill(f64::NAN);
    }
    seen
}

/// Whether a pose can be read off it.
pub(super) fn tells_pose(seen: &Seen) -> bool {
    [JOINT_AND_TIP, ANGLES].into_iter().any(|places| seen[places].iter().all(|value| value.is_finite()))
}

/// What a measured frame differs by from a made one; angles may count turns.
pub(super) fn residual(signal: usize, seen: &Seen, made: &Seen) -> f64 {
    let residual = seen[signal] - made[signal];
    if ANGLES.contains(&signal) { (residual + PI).rem_euclid(TAU) - PI } else { residual }
}

/// Which cell of a pixel the circle of a signal sits in, where it was found or, not measured, where it is made.
pub(super) fn lattice(seen: &Seen, made: &Seen, signal: usize) -> usize {
    let circle = circle_of(signal);
    let cell = |place: usize| {
        let at = if seen[place].is_finite() { seen[place] } else { made[place] };
        ((at - at.floor()) * IMAGES.lattice as f64) as usize
    };
    cell(2 * circle) * IMAGES.lattice + cell(2 * circle + 1)
}
