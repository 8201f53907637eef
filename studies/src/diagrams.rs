//! Figures 3 and 10, drawn from the model: the pinhole (1), (2), and the acrobot, each with what the camera unit sees.

use crate::drawing::{Drawing, Pen};
use crate::lens;
use crate::walk::{Eye, HALF_WIDTH, Look, larger};
use crate::{Bench, Claim, Error, Outcome, Study};

/// This study.
pub const STUDY: Study = Study {
    id: "figures-3-10",
    title: "Figures 3 and 10: the pinhole and the acrobot, drawn from the model",
    claims: &["F3", "F10"],
    run,
};

/// Focal length, image units, and distance of the scene's plane, world units: the unit's start values.
const FOCUS: f64 = 2.0;
const DISTANCE: f64 = 20.0;
/// Height of the axis over the ground line, world units.
const AXIS: f64 = 8.0;
/// The poses that are looked at; the first is drawn.
const POSES: [[f64; 2]; 4] = [[-0.25, 0.65], [0.0, 0.0], [0.4, -0.9], [-0.39, 1.75]];

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let mut eye = Eye::new(bench)?;
    let mut looks = vec![eye.start([0.0; 2], &[], 0)?];
    for pose in POSES {
        // Identification needs small steps: a quarter, half, three quarters of the way.
        let from = looks.last().map_or([0.0; 2], |look| look.pose);
        let between = |share: f64| [0, 1].map(|link| from[link] + share * (pose[link] - from[link]));
        for share in [0.2, 0.4, 0.6, 0.8] {
            eye.look(between(share))?;
        }
        looks.push(eye.look(pose)?);
    }
    let seen = &looks[1..];
    let mut outcome = Outcome::default();
    outcome.claims.extend([pinhole(seen), angles(seen)]);
    if let Some(look) = seen.first() {
        outcome.figure(
            figure_3(look),
            "Figure 3: the pinhole. World and image to one scale each; the crosses are the centroids that the camera unit \
             found in its frame, the lines go through the pinhole.",
        );
        outcome.figure(
            figure_10(look),
            "Figure 10: the free-standing acrobot at q₁ = −0.25, q₂ = 0.65; the crosses are the centroids in the camera \
             unit's frame, taken back to the scene's plane.",
        );
    }
    Ok(outcome)
}

/// World coordinates of the circles, from the ground line up.
fn world(pose: [f64; 2]) -> [[f64; 2]; 3] {
    lens::circles_image(pose).map(|[u, v]| [10.0 * u, 10.0 * v + AXIS])
}

fn pinhole(looks: &[Look]) -> Claim {
    let off = looks.iter().flat_map(|look| {
        let camera = world(look.pose).map(|[x, y]| [x, y - AXIS, DISTANCE]);
        let said = camera.map(|[x, y, z]| [FOCUS * x / z, FOCUS * y / z]); // (1), (2)
        (0..3).map(move |circle| {
            let seen = look.centroids_px[circle].map(|px| px / HALF_WIDTH);
            f64::hypot(seen[0] - said[circle][0], seen[1] - said[circle][1])
        })
    });
    let off = off.fold(0.0, larger);
    Claim::new(
        ["F3", "(1), (2), Figure 3: u = f·x/z, v = f·y/z", "equations"],
        format!("the circles of {} poses are seen there to {off:.1e} image units", looks.len()),
        "2e-3 image units, half a pixel: what the lattice of pixels leaves of a centroid",
        off <= 2e-3,
        "f and the distance are not given; 2 image units and 20 world units show 20 × 20 world units",
    )
    .part()
}

fn angles(looks: &[Look]) -> Claim {
    let off = looks.iter().flat_map(|look| look.error()).map(f64::abs).fold(0.0, larger);
    Claim::new(
        ["F10", "Figure 10: q1, q2 from the upright, the links' lengths, the drum on the ground", "figure"],
        format!("the camera unit reads the drawn angles to {off:.1e} rad"),
        "2e-3 rad: the lattice of pixels (C17)",
        off <= 2e-3,
        "both angles are absolute: only so are (12) and (13) those of this robot",
    )
    .part()
}

/// Side view: scene, pinhole and image plane along the optical axis z, heights to the left and right in their own units.
fn figure_3(look: &Look) -> String {
    // The image plane stands before the pinhole, as in the paper; 1 image unit is drawn as 3 world units.
    const IMAGE: f64 = 6.0;
    let from_image = |v: f64| AXIS + 3.0 * v;
    let mut drawing = Drawing::new([-2.5, 23.5], [-3.2, 19.2]);
    let plane = |x: f64, low: f64, high: f64| [[x, low], [x, high]];
    drawing.line(&[[-2.0, AXIS], [23.0, AXIS]], Pen::Thin);
    drawing.line(&plane(DISTANCE, AXIS - 10.0, AXIS + 10.0), Pen::Solid);
    drawing.line(&plane(IMAGE, from_image(-1.0), from_image(1.0)), Pen::Solid);
    for (centre, centroid) in world(look.pose).iter().zip(look.centroids_px) {
        drawing.line(&[[0.0, AXIS], [DISTANCE, centre[1]]], Pen::Dashed);
        drawing.circle([DISTANCE, centre[1]], 0.2, true);
        drawing.cross([IMAGE, from_image(centroid[1] / HALF_WIDTH)], 0.15);
    }
    drawing.circle([0.0, AXIS], 0.12, true);
    let words = [
        ([-2.3, AXIS - 1.0], "pinhole"),
        ([IMAGE - 2.6, from_image(1.0) + 0.5], "image plane, z = f"),
        ([DISTANCE - 5.2, AXIS + 10.4], "scene's plane, z = 10 f"),
        ([21.0, AXIS + 0.4], "axis z"),
        ([IMAGE + 0.4, from_image(0.86)], "v"),
        ([DISTANCE + 0.5, AXIS + 8.6], "y"),
    ];
    words.into_iter().for_each(|(at, text)| drawing.words(at, text));
    drawing.to_svg()
}

/// The robot to scale.
fn figure_10(look: &Look) -> String {
    let [drum, joint, tip] = world(look.pose);
    let [q1, q2] = look.pose;
    let mut drawing = Drawing::new([-8.5, 9.0], [-1.2, 15.2]);
    drawing.line(&[[-8.0, 0.0], [8.5, 0.0]], Pen::Solid);
    drawing.circle(drum, lens::DRUM_RADIUS, false);
    drawing.line(&[drum, joint, tip], Pen::Solid);
    for (from, angle, name) in [(drum, q1, "q₁"), (joint, q2, "q₂")] {
        drawing.line(&[from, [from[0], from[1] + 4.0]], Pen::Dashed);
        let point = |share: f64| {
            let turned = share * angle;
            [from[0] + 3.0 * libm::sin(turned), from[1] + 3.0 * libm::cos(turned)]
        };
        let arc: Vec<[f64; 2]> = (0..=20).map(|step| point(f64::from(step) / 20.0)).collect();
        drawing.line(&arc, Pen::Thin);
        let [x, y] = point(0.5);
        drawing.words([x - 0.25, y + 0.3], name);
    }
    for (centre, centroid) in [drum, joint, tip].into_iter().zip(look.centroids_px) {
        drawing.circle(centre, 0.2, true);
        let [x, y] = centroid.map(|px| 10.0 * px / HALF_WIDTH);
        drawing.cross([x, y + AXIS], 0.3);
    }
    let middle = |a: [f64; 2], b: [f64; 2]| [0.5 * (a[0] + b[0]) + 0.4, 0.5 * (a[1] + b[1]) - 0.2];
    let beside_link_1 = middle(drum, joint);
    drawing.words([beside_link_1[0] - 3.3, beside_link_1[1]], "l₁ = 6.19");
    drawing.words(middle(joint, tip), "l₂ = 6.9");
    drawing.words([drum[0] + 1.2, 0.5], "R = 1");
    drawing.words([joint[0] + 0.4, joint[1] - 0.5], "τ");
    drawing.to_svg()
}
