//! Section 5: "arranging the robot in the field of view of the camera in a special way based on the existing distortion".
//!
//! The ground line is raised in the picture, everything else stays: a distortion that grows with the distance from the
//! axis then falls on another part of the robot.

use crate::closed_loop::{Case, DAMPED, run_all};
use crate::{Bench, Claim, Error, Outcome, Study};
use report::{Axis, Cell, Graph, Line, Style, Table};

/// This study.
pub const STUDY: Study = Study {
    id: "section-5-placement",
    title: "Section 5: the robot's place in the field of view",
    claims: &["S5.placement"],
    run,
};

/// World y of the ground line; the paper's is −8. Above −5 the tip leaves the picture.
const GROUNDS: [f64; 7] = [-8.0, -7.5, -7.0, -6.5, -6.0, -5.5, -5.0];
/// Lenses of Figures 21 to 27.
const LENSES: [(&str, f64); 6] =
    [("k1", 0.1), ("k1", -0.1), ("p1", 0.015), ("p2", 0.015), ("s1", 0.0125), ("s2", 0.025)];

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let course = vec![(0.0, 0.0), (2.0, 0.0), (12.0, 0.5), (20.0, 0.5)];
    let case = |(name, value): (&str, f64), ground: f64| {
        let case = Case::visual(DAMPED).with(&format!("camera.{name}"), value).with("camera.ground", ground);
        case.finding_everything().along(course.clone(), 20)
    };
    let cases: Vec<Case> = LENSES.iter().flat_map(|lens| GROUNDS.map(|ground| case(*lens, ground))).collect();
    let errors: Vec<f64> =
        run_all(bench, &cases)?.iter().map(|trace| trace.steady_error(15.0, 20.0)).collect();
    let of = |lens: usize| &errors[lens * GROUNDS.len()..(lens + 1) * GROUNDS.len()];
    let mut outcome = Outcome::default();
    outcome.claims.push(claim(of(0)));
    outcome.graph(
        figure(&of)?,
        "Steady error at z_d = 0.5 over the height of the ground line in the picture, pole set damped.",
    )?;
    let text = |error: f64| if error.is_finite() { format!("{error:.3}") } else { "unstable".to_owned() };
    let head = std::iter::once("lens".to_owned()).chain(GROUNDS.map(|ground| format!("ground at {ground}")));
    let rows = LENSES.iter().enumerate().map(|(index, (name, value))| {
        let cells = of(index).iter().map(|error| Cell::Number(text(*error)));
        std::iter::once(Cell::Text(format!("{name} = {value}"))).chain(cells).collect()
    });
    let table = Table { head: head.collect(), rows: rows.collect() };
    outcome.tables.push(("z_desired − z at z_desired = 0.5".to_owned(), table));
    Ok(outcome)
}

fn claim(radial: &[f64]) -> Claim {
    let best = GROUNDS.iter().zip(radial).min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let (ground, least) = best.map_or((f64::NAN, f64::NAN), |(ground, error)| (*ground, *error));
    let usual = radial.first().copied().unwrap_or(f64::NAN);
    Claim::new(
        [
            "S5.placement",
            "steady error for k1 = 0.1 at z_d = 0.5 with the robot elsewhere in the picture",
            "\"might be accomplished by arranging the robot in the field of view\"",
        ],
        format!("{usual:.3} with the ground at −8, {least:.3} with the ground at {ground}"),
        "less than a third",
        least.abs() < usual.abs() / 3.0,
        "joint and tip, which tell q2, come nearer to the axis where the robot bends far; every lens of Figures 21 to 27 \
         gains by it",
    )
    .measurement()
}

fn figure<'a>(of: &dyn Fn(usize) -> &'a [f64]) -> Result<Graph, Error> {
    let mut graph = Graph::new(
        "Steady error over the robot's place",
        Axis::fitted("world y of the ground line"),
        Axis::fitted("z desired − z at 0.5"),
    );
    for (index, (name, value)) in LENSES.iter().enumerate() {
        let style = if *value < 0.0 { Style::Dashed } else { Style::Solid };
        let points = GROUNDS.iter().copied().zip(of(index).iter().copied()).collect();
        graph = graph.with(Line { label: format!("{name} = {value}"), style, points });
    }
    Ok(graph)
}
