//! The distortions of the closed-loop simulations (Section 4.2.2), chosen for errors of about 0.01 rad.

use crate::lens::Lens;
use crate::walk::{self, Walk, larger, pair, worse};
use crate::{Bench, Claim, Error, Outcome, Study};
use report::{Cell, Table};

/// Figures 21 to 27.
const VALUES: [(&str, f64, &str); 7] = [
    ("k1", 0.1, "21"),
    ("k1", -0.1, "22"),
    ("p1", 0.015, "23"),
    ("p1", -0.015, "24"),
    ("p2", 0.015, "25"),
    ("s1", 0.0125, "26"),
    ("s2", 0.025, "27"),
];

/// This study.
pub const STUDY: Study = Study {
    id: "section-4.2.2-values",
    title: "Estimation errors at the distortions of the closed-loop simulations",
    claims: &["C36"],
    run,
};

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let lenses = VALUES.map(|(name, value, _)| Lens::with(name, value));
    let walks = Walk::all(bench, &lenses.map(walk::through))?;
    let equations = lenses.map(|lens| walk::largest(&walk::by_equations(lens)));
    let range = equations.iter().fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], errors| {
        [low.min(worse(*errors)), high.max(worse(*errors))]
    });
    let lattice = walks.iter().zip(equations).map(|(walk, ideal)| {
        let seen = walk.largest();
        larger((seen[0] - ideal[0]).abs(), (seen[1] - ideal[1]).abs())
    });
    let lattice = lattice.fold(0.0, larger);
    let texts = VALUES
        .iter()
        .zip(equations)
        .map(|((name, value, _), errors)| format!("{}: {}", distortion(name, *value), pair(errors, 4)));
    let mut outcome = Outcome::default();
    outcome.claims.push(Claim::new(
        ["C36", "the closed-loop distortions give a largest estimation error of", "approximately 0.01 rad"],
        format!("{}; frames add up to {lattice:.4}", texts.collect::<Vec<_>>().join(", ")),
        "between 0.005 and 0.022 rad, the larger of both links: \"approximately\"; 2 % between implementations; frames \
         within the lattice's 2.5e-3 rad",
        (0.005..=0.022).contains(&range[0]) && (0.005..=0.022).contains(&range[1]) && lattice <= 2.5e-3,
        "k1 = ±0.1 gives twice as much",
    ));
    let head = ["figure", "distortion", "largest error q₁ / q₂ by the equations", "from frames"];
    let rows = VALUES.iter().zip(equations).zip(&walks).map(|(((name, value, figure), ideal), walk)| {
        vec![
            (*figure).into(),
            distortion(name, *value).into(),
            Cell::Number(pair(ideal, 4)),
            Cell::Number(pair(walk.largest(), 4)),
        ]
    });
    let table = Table { head: head.map(str::to_owned).to_vec(), rows: rows.collect() };
    outcome.tables.push(("Figures 21-27: what the estimates are off by".to_owned(), table));
    Ok(outcome)
}

fn distortion(name: &str, value: f64) -> String {
    format!("{name} = {}{}", if value < 0.0 { "−" } else { "" }, value.abs())
}
