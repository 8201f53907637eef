//! Figures 4 to 8: the fields of the distortions by (3)-(8), and the same displacements in the camera unit's frames.

use crate::lens::{self, DISTORTIONS, Lens};
use crate::walk::{self, Eye, HALF_WIDTH, larger};
use crate::{Bench, Claim, Error, Outcome, Study};
use rayon::prelude::*;
use report::{Axis, VectorField};

/// This study.
pub const STUDY: Study = Study {
    id: "figures-4-8",
    title: "Figures 4-8: fields of the lens distortions",
    claims: &["C1", "C2", "C3", "C4", "F4-8"],
    run,
};

/// Strength at which frames are compared.
const STRENGTH: f64 = 0.1;
/// Points of the drawn grid on each side of the axis, and how far out they reach.
const GRID: i32 = 8;
const SIDE: f64 = 0.95;
/// Angles of the links at which circles are seen, rad.
const TURNS: [f64; 9] = [-1.2, -0.9, -0.6, -0.3, 0.0, 0.3, 0.6, 0.9, 1.2];
/// Frames of 2048 px, so that the lattice of pixels counts for little.
const FINE: f64 = 4.0;

/// A circle as it is seen.
#[derive(Debug, Clone, Copy)]
struct Spot {
    ideal: [f64; 2],
    seen: [f64; 2],
}

impl Spot {
    fn displacement(&self) -> [f64; 2] {
        [self.seen[0] - self.ideal[0], self.seen[1] - self.ideal[1]]
    }
}

/// Where a lens shows the circles of many poses that all lie inside the picture.
fn spots(bench: &Bench, lens: Lens) -> Result<Vec<Spot>, Error> {
    let mut eye = Eye::new(bench)?;
    let size = 2.0 * HALF_WIDTH * FINE;
    let set: Vec<_> = lens
        .settings()
        .into_iter()
        .chain([
            ("width", size),
            ("height", size),
            ("N_min", 20.0 * FINE * FINE),
            ("N_max", 250.0 * FINE * FINE),
        ])
        .collect();
    eye.start([0.0; 2], &set, 0)?;
    let mut spots = Vec::new();
    for pose in TURNS.iter().flat_map(|q1| TURNS.map(|q2| [*q1, q2])) {
        let look = eye.look(pose)?;
        let ideal = lens::circles_image(pose);
        // At the edge a circle may be cut off.
        let inside = ideal.iter().flat_map(|p| [*p, lens.image(*p)]).flatten().all(|x| x.abs() < 0.95);
        if look.valid && inside {
            let seen = look.centroids_px.map(|px| px.map(|x| x / (HALF_WIDTH * FINE)));
            spots.extend(ideal.into_iter().zip(seen).map(|(ideal, seen)| Spot { ideal, seen }));
        }
    }
    Ok(spots)
}

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let lenses: Vec<Lens> = DISTORTIONS
        .iter()
        .flat_map(|name| [Lens::with(name, STRENGTH), Lens::with(name, -STRENGTH)])
        .collect();
    let seen = lenses.par_iter().map(|lens| spots(bench, *lens)).collect::<Result<Vec<_>, Error>>()?;
    let mut outcome = Outcome::default();
    outcome.claims.push(outward(&seen[0]));
    // In pairs of + and −, in the order of DISTORTIONS: p1 comes second, s1 and s2 are the last two.
    let strengths: Vec<f64> = lenses.iter().zip(&seen).map(|(lens, spots)| strength(*lens, spots)).collect();
    outcome.claims.push(mirrored(&seen[2], &seen[3], &strengths[2..6]));
    outcome.claims.push(flipped(&seen[6..], &strengths[6..]));
    outcome.claims.extend(third_order(&lenses, &seen));
    for (figure, name) in (4..).zip(DISTORTIONS) {
        let svg = field(name).to_svg()?;
        let caption = format!(
            "Figure {figure}: normalized field of a positive {name}; an arrow begins at the ideal point."
        );
        outcome.figure(svg, caption);
    }
    Ok(outcome)
}

/// Vectors at the points of the drawn grid.
fn field(name: &str) -> VectorField {
    let spacing = SIDE / f64::from(GRID);
    let lens = Lens::with(name, 1.0);
    let at = |[u, v]: [f64; 2]| {
        let [du, dv] = lens.displacement([u, v]);
        ((u, v), (du, dv))
    };
    let points = (-GRID..=GRID).flat_map(|row| {
        (-GRID..=GRID).map(move |column| [column, row].map(|step| spacing * f64::from(step)))
    });
    let axes = (Axis::over("u", -1.2, 1.2), Axis::over("v", -1.2, 1.2));
    VectorField::normalized(format!("{name} > 0"), axes, spacing, &points.map(at).collect::<Vec<_>>())
}

fn outward(seen: &[Spot]) -> Claim {
    let outwards = seen.iter().filter(|spot| {
        let ([u, v], [du, dv]) = (spot.ideal, spot.displacement());
        u * du + v * dv > 0.0
    });
    // At the axis the displacement is smaller than the lattice of pixels can show.
    let far: Vec<&Spot> = seen.iter().filter(|spot| f64::hypot(spot.ideal[0], spot.ideal[1]) > 0.3).collect();
    let outwards = outwards.filter(|spot| f64::hypot(spot.ideal[0], spot.ideal[1]) > 0.3).count();
    Claim::new(
        ["C1", "(3), (4), Figure 4: a positive k1 moves points away from the axis", "outward"],
        format!("outward for {outwards} of {} circles farther than 0.3 from the axis", far.len()),
        "exact; nearer the axis a displacement is smaller than a pixel's share in a centroid",
        outwards == far.len() && !far.is_empty(),
        "the text calls this barrel; by the usual definition an outward displacement is pincushion. The equation decides",
    )
}

/// Points on which identities of the equations are checked.
fn sample() -> impl Iterator<Item = [f64; 2]> {
    (0..400).map(|index| [f64::from(index % 20) / 10.0 - 0.95, f64::from(index / 20) / 10.0 - 0.95])
}

/// The largest of |displacement − expected| over spots of two lenses whose ideal points correspond.
fn mismatch(
    plus: &[Spot],
    minus: &[Spot],
    place: impl Fn([f64; 2]) -> [f64; 2],
    vector: impl Fn([f64; 2]) -> [f64; 2],
) -> f64 {
    let distance = |a: [f64; 2], b: [f64; 2]| f64::hypot(a[0] - b[0], a[1] - b[1]);
    let pairs = plus.iter().filter_map(|spot| {
        let there = place(spot.ideal);
        let other = minus.iter().find(|other| distance(other.ideal, there) < 1e-9)?;
        Some(distance(other.displacement(), vector(spot.displacement())))
    });
    // Without any pair nothing was measured.
    pairs
        .fold(None, |worst: Option<f64>, off| Some(worst.map_or(off, |worst| larger(worst, off))))
        .unwrap_or(f64::NAN)
}

/// By which factor the displacements in frames are those of the equations: 1 in sign and size.
fn strength(lens: Lens, spots: &[Spot]) -> f64 {
    let seen: Vec<[f64; 2]> = spots.iter().map(Spot::displacement).collect();
    let said: Vec<[f64; 2]> = spots.iter().map(|spot| lens.displacement(spot.ideal)).collect();
    walk::gain(&seen, &said)
}

/// How far such a factor may be from 1: a centroid is not the image of the centre.
const STRENGTH_OFF: f64 = 0.02;

fn follow(strengths: &[f64]) -> bool {
    strengths.iter().all(|factor| (factor - 1.0).abs() <= STRENGTH_OFF)
}

/// `1.000, 0.999, ...`
fn listed(strengths: &[f64]) -> String {
    strengths.iter().map(|factor| format!("{factor:.3}")).collect::<Vec<_>>().join(", ")
}

fn mirrored(plus: &[Spot], minus: &[Spot], strengths: &[f64]) -> Claim {
    // δ of −p1 at (−u, v) is δ of p1 at (u, v), mirrored left to right; for p2 with up and down.
    let off = sample().flat_map(|[u, v]| {
        let (a, b) =
            (Lens::with("p1", 1.0).displacement([u, v]), Lens::with("p1", -1.0).displacement([-u, v]));
        let (c, d) =
            (Lens::with("p2", 1.0).displacement([u, v]), Lens::with("p2", -1.0).displacement([u, -v]));
        [a[0] + b[0], a[1] - b[1], c[0] - d[0], c[1] + d[1]]
    });
    let off = off.map(f64::abs).fold(0.0, larger);
    let seen = mismatch(plus, minus, |[u, v]| [-u, v], |[du, dv]| [-du, dv]);
    Claim::new(
        ["C2", "−p1 mirrors Figure 5 left to right, −p2 mirrors Figure 6 top to bottom", "yes"],
        format!(
            "off by {off:.0} in (5), (6); for p1 by {seen:.1e} image units in frames; the displacements of +p1, −p1, +p2, \
             −p2 in frames are those of (5), (6) times {}",
            listed(strengths)
        ),
        format!(
            "exact: an identity of (5), (6); 1e-4 in frames, where pixels that lie on the threshold may differ; sign and \
             size to {STRENGTH_OFF}"
        ),
        off == 0.0 && seen <= 1e-4 && follow(strengths),
        "the robot stands on the ground, so that its pictures have no mirror image top to bottom; that the frames follow \
         (6) is C4",
    )
}

fn flipped(seen: &[Vec<Spot>], strengths: &[f64]) -> Claim {
    let off = ["s1", "s2"].iter().flat_map(|name| {
        sample().flat_map(|at| {
            let (a, b) = (Lens::with(name, 1.0).displacement(at), Lens::with(name, -1.0).displacement(at));
            [a[0] + b[0], a[1] + b[1]]
        })
    });
    let off = off.map(f64::abs).fold(0.0, larger);
    let seen = seen.chunks_exact(2).map(|pair| mismatch(&pair[0], &pair[1], |at| at, |[du, dv]| [-du, -dv]));
    let seen = seen.fold(0.0, larger);
    Claim::new(
        ["C3", "−s1, −s2 change the sign of the vectors of Figures 7, 8", "yes"],
        format!(
            "off by {off:.0} in (7), (8); by {seen:.1e} image units in frames; the displacements of +s1, −s1, +s2, −s2 in \
             frames are those of (7), (8) times {}",
            listed(strengths)
        ),
        format!(
            "exact: an identity of (7), (8); in frames twice as much as C4 allows, a pixel being 9.8e-4; sign and size to \
             {STRENGTH_OFF}"
        ),
        off == 0.0 && seen <= 2e-3 && follow(strengths),
        "",
    )
}

/// The unit's displacements against the equations: nothing but the terms up to the third order acts.
fn third_order(lenses: &[Lens], seen: &[Vec<Spot>]) -> [Claim; 2] {
    let differences = lenses.iter().zip(seen).flat_map(|(lens, spots)| {
        spots.iter().map(|spot| {
            let said = lens.image(spot.ideal);
            f64::hypot(spot.seen[0] - said[0], spot.seen[1] - said[1])
        })
    });
    let differences: Vec<f64> = differences.collect();
    let rms = f64::sqrt(differences.iter().map(|x| x * x).sum::<f64>() / differences.len() as f64);
    let largest = differences.iter().copied().fold(0.0, larger);
    let farthest = seen.iter().flatten().flat_map(|spot| spot.ideal).map(f64::abs).fold(0.0, larger);
    let ours = format!(
        "{} circles in frames of 2048 × 2048 px, ±0.1 of each distortion: rms {rms:.1e}, largest {largest:.1e}",
        differences.len()
    );
    let holds = rms <= 2e-4 && largest <= 1e-3;
    [
        Claim::new(
            ["C4", "(9), (10): the sum of the terms up to the third order, for −1 ≤ u, v ≤ 1", "equations"],
            format!("{ours} image units, out to abs(u), abs(v) = {farthest:.2}"),
            "rms 2e-4, largest 1e-3 image units, a pixel being 9.8e-4: a centroid is not the image of the centre",
            holds,
            "arguments are ideal coordinates; k2 (fifth order) is an extra of the unit and off",
        ),
        Claim::new(
            ["F4-8", "Figures 4-8", "figures"],
            "drawn from (3)-(8), which the frames follow as C4 says".to_owned(),
            "as C4",
            holds,
            "",
        )
        .part(),
    ]
}
