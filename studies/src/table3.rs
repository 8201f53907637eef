//! Table 3: how strongly each distortion moves the estimates, from rendered frames, with the equations beside them.

use crate::lens::{DISTORTIONS, Lens};
use crate::walk::{self, Walk, larger};
use crate::{Bench, Claim, Error, Outcome, Study};
use report::{Cell, Table};

/// Strength at which the constants are taken, as in Figures 13 to 17.
pub(crate) const STRENGTH: f64 = 0.1;
/// The paper's (K_q1, K_q2).
pub(crate) const PAPER: [[f64; 2]; 5] = [[0.2, 0.1], [0.8, 0.5], [1.0, 0.8], [0.8, 0.5], [0.3, 0.4]];

/// This study.
pub const STUDY: Study = Study {
    id: "table-3",
    title: "Table 3: proportionality constants for estimation error",
    claims: &["C25", "T3", "T3.k1", "T3.p1", "T3.p2", "T3.s1", "T3.s2"],
    run,
};

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let lenses = DISTORTIONS.map(|name| Lens::with(name, STRENGTH));
    let walks = Walk::all(bench, &lenses.map(walk::through))?;
    let constants = |largest: [f64; 2]| largest.map(|error| error / STRENGTH);
    let rendered: Vec<_> = walks.iter().map(|walk| constants(walk.largest())).collect();
    let equations = lenses.map(|lens| constants(walk::largest(&walk::by_equations(lens))));

    let mut outcome = Outcome::default();
    let mut agreeing = 0;
    let mut rows = Vec::new();
    let mut claims = Vec::new();
    for (index, name) in DISTORTIONS.into_iter().enumerate() {
        let (paper, ours, ideal) = (PAPER[index], rendered[index], equations[index]);
        agreeing += agree(ours, paper).iter().filter(|agrees| **agrees).count();
        claims.push(claim(name, paper, ours, ideal));
        rows.push(row(name, paper, ours, ideal));
    }
    outcome.claims.push(Claim::new(
        ["C25", "Table 3: the ten constants from rendered frames", "ten values with one decimal"],
        format!("{agreeing} of 10 round to the paper's"),
        "± 0.05: the paper gives one decimal",
        agreeing == 10,
        "with the ground line at world y = −8 and circle 1 at the drum's centre, which the paper doesn't say: no other \
         choice tried gives all ten",
    ));
    outcome.claims.extend(claims);
    outcome.claims.push(Claim::new(
        ["T3", "Table 3 as a whole, frames against equations", "-"],
        format!("largest difference {:.3}", largest_difference(&rendered, &equations)),
        "≤ 0.025: the lattice of pixels moves an error by up to 2e-3 rad, which is 0.02 at a strength of 0.1",
        largest_difference(&rendered, &equations) <= 0.025,
        "",
    ).part());
    let head = [
        "parameter",
        "K_q1, paper",
        "by the equations",
        "from frames",
        "K_q2, paper",
        "by the equations",
        "from frames",
    ];
    let table = Table { head: head.map(str::to_owned).to_vec(), rows };
    outcome.tables.push(("Table 3, at a strength of 0.1".to_owned(), table));
    Ok(outcome)
}

/// Whether the constants of each link are the paper's.
fn agree(ours: [f64; 2], paper: [f64; 2]) -> [bool; 2] {
    [0, 1].map(|link| rounds_to(ours[link], paper[link]))
}

/// The claim of one distortion: constants of the paper, from frames and by the equations.
fn claim(name: &str, paper: [f64; 2], ours: [f64; 2], ideal: [f64; 2]) -> Claim {
    Claim::new(
        [
            &format!("T3.{name}"),
            &format!("K_q1, K_q2 of {name}: largest error on the manifold over the parameter"),
            &walk::pair(paper, 1),
        ],
        format!("{} from frames, {} by the equations", walk::pair(ours, 3), walk::pair(ideal, 3)),
        "± 0.05: the paper gives one decimal",
        agree(ours, paper) == [true; 2] && agree(ideal, paper) == [true; 2],
        "",
    )
    .part()
}

fn row(name: &str, paper: [f64; 2], ours: [f64; 2], ideal: [f64; 2]) -> Vec<Cell> {
    let numbers = [paper[0], ideal[0], ours[0], paper[1], ideal[1], ours[1]];
    let cells = numbers.iter().enumerate().map(|(column, value)| {
        let decimals = if column % 3 == 0 { 1 } else { 3 };
        Cell::Number(format!("{value:.decimals$}"))
    });
    std::iter::once(Cell::from(name)).chain(cells).collect()
}

/// Whether a number is the paper's when written with one decimal.
pub(crate) fn rounds_to(ours: f64, paper: f64) -> bool {
    format!("{ours:.1}") == format!("{paper:.1}")
}

fn largest_difference(rendered: &[[f64; 2]], equations: &[[f64; 2]; 5]) -> f64 {
    let pairs = rendered.iter().flatten().zip(equations.iter().flatten());
    pairs.map(|(ours, ideal)| (ours - ideal).abs()).fold(0.0, larger)
}
