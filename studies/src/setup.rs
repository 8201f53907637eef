//! Section 3.2 and the beginning of Section 4: what the camera sees of the robot.

use crate::lens;
use crate::walk::{HALF_WIDTH, Look, Walk};
use crate::{Bench, Claim, Error, Outcome, Study};
use report::{Cell, Table};

/// This study.
pub const STUDY: Study = Study {
    id: "section-3.2",
    title: "Section 3.2: the robot in the picture",
    claims: &["C14", "C15", "C16"],
    run,
};

/// Thresholds as shares c of the contrast, and passes of defocus.
const CASES: [(f64, f64); 9] = [
    (0.5, 0.0),
    (0.7, 0.0),
    (0.715, 0.0),
    (0.75, 0.0),
    (0.785, 0.0),
    (0.9, 0.0),
    (0.99, 0.0),
    (0.65, 1.0),
    (0.6, 2.0),
];
/// Pixels of a world unit.
const PX_PER_WORLD: f64 = HALF_WIDTH / 10.0;

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let settings = CASES.map(|(share, passes)| vec![("threshold", 255.0 * share), ("N", passes)]);
    let walks = Walk::all(bench, &settings)?;
    let usual = Walk::new(bench, &[])?;
    let mut outcome = Outcome::default();
    outcome.claims.extend([height(&usual), circle_area(&usual, &walks), separation(&usual)]);
    let head = ["threshold c", "defocus N", "mean area of a circle, px", "smallest and largest"];
    let rows = CASES.iter().zip(&walks).map(|((share, passes), walk)| {
        let [low, high] = walk.areas();
        vec![
            Cell::Number(share.to_string()),
            Cell::Number(passes.to_string()),
            Cell::Number(format!("{:.1}", walk.mean_area())),
            Cell::Number(format!("{low:.0}-{high:.0}")),
        ]
    });
    let table = Table { head: head.map(str::to_owned).to_vec(), rows: rows.collect() };
    outcome.tables.push(("Pixels of a circle of radius 0.2".to_owned(), table));
    Ok(outcome)
}

/// The look at the upright.
fn upright(walk: &Walk) -> Option<&Look> {
    walk.looks.get(walk.looks.len() / 2)
}

fn height(walk: &Walk) -> Claim {
    // From the lowest point of the drum to the tip's centre.
    let drum_px = lens::DRUM_RADIUS * PX_PER_WORLD;
    let share = upright(walk).map_or(f64::NAN, |look| {
        let [first, _, third] = look.centroids_px;
        (third[1] - first[1] + drum_px) / (2.0 * HALF_WIDTH)
    });
    Claim::new(
        ["C14", "height of the upright acrobot in the picture", "approximately 70 %"],
        format!("{:.2} %", 100.0 * share),
        "± 0.5 %",
        (100.0 * share - 70.45).abs() <= 0.5,
        "link 1 is taken from the drum's centre to the joint",
    )
}

fn circle_area(usual: &Walk, walks: &[Walk]) -> Claim {
    let mean = usual.mean_area();
    let half = walks.first().map_or(f64::NAN, Walk::mean_area);
    Claim::new(
        ["C15", "pixels of an inscribed circle", "approximately 75"],
        format!("{mean:.1} on average over the manifold; a disc of that size has {:.2}", disc_px()),
        "± 1 px: a threshold between 0.715 and 0.785 of the contrast",
        (mean - 75.0).abs() <= 1.0,
        format!(
            "for a stated choice only: the paper doesn't give its threshold; at half of the contrast a circle covers {half:.1}"
        ),
    )
}

fn disc_px() -> f64 {
    let radius_px = 0.2 * PX_PER_WORLD;
    std::f64::consts::PI * radius_px * radius_px
}

fn separation(walk: &Walk) -> Claim {
    let closest = |look: &Look| {
        let [a, b, c] = look.centroids_px;
        [(a, b), (a, c), (b, c)]
            .map(|(from, to)| f64::hypot(to[0] - from[0], to[1] - from[1]))
            .into_iter()
            .fold(f64::INFINITY, f64::min)
    };
    let smallest = walk.looks.iter().map(closest).fold(f64::INFINITY, f64::min);
    let world = smallest / PX_PER_WORLD;
    Claim::new(
        ["C16", "a circle may move by half of the smallest separation between two frames", "qualitative"],
        format!(
            "smallest separation on the manifold {world:.2} units, so {:.2} units or {:.0} px a frame; every circle was \
             followed everywhere ({} of {} places lost)",
            0.5 * world,
            0.5 * smallest,
            walk.lost(),
            walk.looks.len()
        ),
        "1 % of 3.36 units: geometry, measured with centroids",
        (world / 3.36 - 1.0).abs() <= 0.01 && walk.lost() == 0,
        "",
    )
}
