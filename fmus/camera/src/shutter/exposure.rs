//! The exposure as an average over sub-frames at the midpoints of equal parts of it.
//!
//! The motion within a frame is integrated by so many sub-frames that the fastest circle moves at most
//! [`SPACING_PX`] from one to the next; one is enough at rest.

use super::History;
use crate::variables::Scene;

/// Farthest that a circle may move from one sub-frame to the next, in pixels.
pub const SPACING_PX: f64 = 0.25;
/// Most sub-frames of a frame.
pub const MOST: usize = 256;
/// Parts of the exposure whose chords measure the paths of the circles.
const CHORDS: usize = 4;

/// Centres of the circles (world units) at the sub-frames of the exposure from `start` to `end` into `centres`.
pub fn sub_frames(
    history: &History,
    scene: &Scene,
    pixels_per_world: f64,
    start: f64,
    end: f64,
    centres: &mut Vec<[(f64, f64); 3]>,
) {
    let at = |share: f64| scene.centres_world(history.pose(start + share * (end - start)));
    let mut paths = [0.0; 3];
    if end > start {
        let mut last = at(0.0);
        for chord in 1..=CHORDS {
            let next = at(chord as f64 / CHORDS as f64);
            for ((path, a), b) in paths.iter_mut().zip(last).zip(next) {
                let (x, y) = (b.0 - a.0, b.1 - a.1);
                *path += (x * x + y * y).sqrt();
            }
            last = next;
        }
    }
    let longest = paths.iter().fold(0.0, |a: f64, b| a.max(*b));
    let count = (libm::ceil(longest * pixels_per_world / SPACING_PX) as usize).clamp(1, MOST);
    centres.clear();
    centres.extend((0..count).map(|i| at((i as f64 + 0.5) / count as f64)));
}
