//! Which region is which circle (Section 3.2).
//!
//! From frame to frame by the nearest neighbour, as long as every circle has moved less than half the smallest
//! separation of any two. At the first frame, and after a loss, by the known geometry: the ordered triple of regions
//! whose first lies where a drum that rolls is (at the height of its centre, R q₁ from the middle), and whose
//! distances are the links' lengths. The rolling matters: near q₂ = 1.79 on the manifold the tip is as far from the
//! drum as the joint is. Nothing is below the ground, unless there is no drum (R = 0: the robot is pinned). The triple
//! has to be clearly better than any other; otherwise nothing is identified.
//! *Deviations*: the paper assumes "an initial knowledge of the correspondence" and says nothing of what follows a
//! loss.

use super::Feature;
use crate::variables::{Scene, Sensor};

/// Features of circles 1, 2, 3.
pub type Triple = [Feature; 3];

/// Largest share by which a link may look longer or shorter than it is. The paper's strongest lens (p₂ = 0.1)
/// stretches the picture by up to 30 %.
const LENGTH_TOLERANCE: f64 = 0.4;
/// Largest height of the drum's centre above or below its own place, in image units.
const HEIGHT_TOLERANCE: f64 = 0.3;
/// How far below the ground line a circle may look to be, in image units.
const GROUND_TOLERANCE: f64 = 0.15;
/// Weight of the drum's horizontal place. It is what tells q₂ = 1.79 from its mirror image, 0.12 image units apart.
const ROLLING: f64 = 4.0;
/// How far beside the middle of the picture the scene's middle may lie, in image units: a camera that is turned aside by
/// 0.05 rad shows it 0.1 off.
const OFF_CENTRE: f64 = 0.105;
/// What a camera that is turned aside so far can do to the lengths of the links (sum of squares): 2.2 % each.
const LENGTHS_TURNED_ASIDE: f64 = 5e-4;
/// How much better the best triple has to be than the next one (sums of squares): by a factor, and by what the
/// grid of pixels can do to the lengths.
const CLEARLY: (f64, f64) = (1.5, 1e-4);
/// With more regions than this the geometry is not tried: chance would find triples.
const MOST_CANDIDATES: usize = 16;

fn squared_distance(a: (f64, f64), b: (f64, f64)) -> f64 {
    let (du, dv) = (a.0 - b.0, a.1 - b.1);
    du * du + dv * dv
}

/// The circles of the last frame found again; `None` if one has moved too far or two have become one.
pub fn nearest(candidates: &[Feature], last: &Triple) -> Option<Triple> {
    let pairs = [(0, 1), (0, 2), (1, 2)];
    let separation = |(i, j): (usize, usize)| squared_distance(last[i].centre_px, last[j].centre_px);
    let smallest = pairs.into_iter().map(separation).fold(f64::INFINITY, f64::min);
    let mut found = [0; 3];
    for (circle, known) in last.iter().enumerate() {
        let distance = |i: &usize| squared_distance(candidates[*i].centre_px, known.centre_px);
        let best = (0..candidates.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        if distance(&best) >= 0.25 * smallest || found[..circle].contains(&best) {
            return None;
        }
        found[circle] = best;
    }
    Some(found.map(|i| candidates[i]))
}

/// The circles identified by the robot's geometry as a perfect pinhole would show it.
pub fn by_geometry(candidates: &[Feature], scene: &Scene, sensor: &Sensor) -> Option<Triple> {
    if !(3..=MOST_CANDIDATES).contains(&candidates.len()) {
        return None;
    }
    let half = (f64::from(sensor.width) / 2.0, f64::from(sensor.height) / 2.0);
    let image =
        |feature: &Feature| sensor.upright((feature.centre_px.0 / half.0, feature.centre_px.1 / half.1));
    let world_unit = 2.0 / scene.field_of_view;
    let height = (scene.ground_height + scene.drum_radius) * world_unit;
    let misfit = |a: (f64, f64), b: (f64, f64), length: f64| {
        squared_distance(a, b).sqrt() / (length * world_unit) - 1.0
    };
    let lowest = if scene.drum_radius > 0.0 {
        scene.ground_height * world_unit - GROUND_TOLERANCE
    } else {
        f64::NEG_INFINITY
    };
    let mut triples: Vec<Identified> = Vec::new();
    for drum in candidates {
        let too_high = image(drum).1 - height;
        if too_high.abs() > HEIGHT_TOLERANCE {
            continue;
        }
        for joint in candidates.iter().filter(|joint| *joint != drum) {
            let first = misfit(image(drum), image(joint), scene.link1_length);
            if first.abs() > LENGTH_TOLERANCE || image(joint).1 < lowest {
                continue;
            }
            for tip in candidates.iter().filter(|tip| *tip != drum && *tip != joint) {
                let second = misfit(image(joint), image(tip), scene.link2_length);
                if second.abs() > LENGTH_TOLERANCE || image(tip).1 < lowest {
                    continue;
                }
                let ((a, b), (c, d)) = (image(drum), image(joint));
                let astray = a - scene.drum_radius * world_unit * libm::atan2(c - a, d - b);
                let base = too_high * too_high + first * first + second * second;
                triples.push(Identified { circles: [*drum, *joint, *tip], base, astray });
            }
        }
    }
    let best = *triples.iter().min_by(|a, b| a.cost().total_cmp(&b.cost()))?;
    let is_certain =
        triples.iter().all(|other| other.circles == best.circles || best.is_clearly_before(other));
    is_certain.then_some(best.circles)
}

/// Regions taken for circles 1, 2, 3, and how well they fit the robot.
#[derive(Debug, Clone, Copy)]
struct Identified {
    circles: Triple,
    /// Sum of squares of what lengths and the drum's height are off by.
    base: f64,
    /// How far the drum's centre lies right of where it would have rolled to, in image units.
    astray: f64,
}

impl Identified {
    fn cost(&self) -> f64 {
        self.base + ROLLING * self.astray * self.astray
    }

    /// The same for a camera that is turned aside so that it fits best.
    fn cost_turned_aside(&self) -> f64 {
        let astray = (self.astray.abs() - OFF_CENTRE).max(0.0);
        self.base + ROLLING * astray * astray
    }

    /// Whether it fits clearly better than another, and better even if the camera should be turned aside.
    fn is_clearly_before(&self, other: &Identified) -> bool {
        other.cost() > CLEARLY.0 * self.cost() + CLEARLY.1
            && other.cost_turned_aside() > self.cost_turned_aside() + LENGTHS_TURNED_ASIDE
    }
}
