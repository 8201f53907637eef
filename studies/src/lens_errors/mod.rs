//! Figures 13 to 17: the estimation error under each distortion, and what Section 4.1.2 says of the curves.
//!
//! Everything is read from rendered frames: the figures and sizes from 512 × 512 px, as the paper has it; symmetry,
//! sign and proportion from 2048 × 2048 px, averaged over ±60 mrad, since the lattice of pixels blurs them. The curves
//! of (3)-(10) stand beside them: a curve must have their sign and size, not only a shape of its own.

mod claims;
mod signs;

use crate::lens::{DISTORTIONS, Lens};
use crate::walk::{self, Walk, pair};
use crate::{Bench, Error, Outcome, Study};
use rayon::prelude::*;
use report::{Cell, Table};

/// Strength of Figures 13 to 17.
const STRENGTH: f64 = 0.1;
/// The weaker distortion that it is compared with.
const WEAK: f64 = 0.01;
/// Places to each side over which curves from 2048 × 2048 px are averaged, 5 mrad apart.
const SMOOTH: usize = 12;

/// This study.
pub const STUDY: Study = Study {
    id: "figures-13-17",
    title: "Figures 13-17: estimation error under each lens distortion",
    claims: &["C26", "C27", "C27.worded", "C28", "C29", "C30", "C31", "C32", "C33", "C34", "F13-17"],
    run,
};

/// A curve from frames of 2048 × 2048 px beside that of the equations, averaged alike.
struct Curve {
    /// As measured, and averaged.
    raw: Vec<[f64; 2]>,
    seen: Vec<[f64; 2]>,
    /// By (3)-(10), as they are, and averaged.
    exact: Vec<[f64; 2]>,
    said: Vec<[f64; 2]>,
}

impl Curve {
    fn new(bench: &Bench, lens: Lens) -> Result<Self, Error> {
        let raw = Walk::new(bench, &walk::finely_through(lens))?.errors();
        let exact = walk::by_equations(lens);
        let [seen, said] = [&raw, &exact].map(|errors| walk::smoothed(errors, SMOOTH));
        Ok(Self { raw, seen, exact, said })
    }

    /// The factor by which the frames' curve is that of the equations: 1 in sign and size.
    fn gain(&self) -> f64 {
        walk::gain(&self.seen, &self.said)
    }

    /// The largest error of q₁ and of q₂.
    fn largest(&self) -> [f64; 2] {
        walk::largest(&self.seen)
    }

    /// Largest difference to another curve, as a share of the largest error.
    fn defect(&self, other: impl Fn(usize) -> [f64; 2]) -> [f64; 2] {
        let differences: Vec<[f64; 2]> = (self.seen.iter().enumerate())
            .map(|(place, here)| {
                let there = other(place);
                [here[0] - there[0], here[1] - there[1]]
            })
            .collect();
        let (off, size) = (walk::largest(&differences), self.largest());
        [off[0] / size[0], off[1] / size[1]]
    }

    /// e(q₂) against sign·e(−q₂).
    fn mirror_defect(&self, sign: f64) -> [f64; 2] {
        self.defect(|place| self.seen[self.seen.len() - 1 - place].map(|error| sign * error))
    }
}

/// One distortion at ±0.1 and ±0.01.
struct Curves {
    name: &'static str,
    /// At ±0.1 with 512 × 512 px.
    walks: [Walk; 2],
    /// At ±0.1.
    strong: [Curve; 2],
    /// At ±0.01.
    weak: [Curve; 2],
}

const PLUS: usize = 0;
const MINUS: usize = 1;

impl Curves {
    fn all(bench: &Bench) -> Result<(Walk, Vec<Self>), Error> {
        let of = |name: &'static str| -> Result<Self, Error> {
            let both =
                |strength: f64| [1.0, -1.0].map(|sign| Curve::new(bench, Lens::with(name, sign * strength)));
            let [plus, minus] =
                [1.0, -1.0].map(|sign| Walk::new(bench, &walk::through(Lens::with(name, sign * STRENGTH))));
            let ([strong, reversed], [weak, weak_reversed]) = (both(STRENGTH), both(WEAK));
            Ok(Self {
                name,
                walks: [plus?, minus?],
                strong: [strong?, reversed?],
                weak: [weak?, weak_reversed?],
            })
        };
        let curves = DISTORTIONS.into_par_iter().map(of).collect::<Result<_, Error>>()?;
        Ok((Walk::new(bench, &walk::through(Lens::default()))?, curves))
    }

    /// The largest error at + or −, from frames of 512 × 512 px.
    fn rendered(&self, sign: usize) -> [f64; 2] {
        self.walks[sign].largest()
    }

    /// e at −p against −e at p.
    fn reversal_defect(&self) -> [f64; 2] {
        self.strong[PLUS].defect(|place| self.strong[MINUS].seen[place].map(|error| -error))
    }

    /// 10·e at a tenth of the strength against e, the worse of both signs.
    fn proportion_defect(&self) -> [f64; 2] {
        let of = |sign: usize| {
            let factor = STRENGTH / WEAK;
            self.strong[sign].defect(|place| self.weak[sign].seen[place].map(|error| factor * error))
        };
        let ([a, b], [c, d]) = (of(PLUS), of(MINUS));
        [walk::larger(a, c), walk::larger(b, d)]
    }

    /// The factors by which the frames' curves at ±0.1 are those of the equations.
    fn gains(&self) -> [f64; 2] {
        [PLUS, MINUS].map(|sign| self.strong[sign].gain())
    }

    /// Both have the equations' sign and size.
    fn is_that_of_the_equations(&self) -> bool {
        self.gains().iter().all(|gain| (gain - 1.0).abs() <= GAIN)
    }
}

/// How far a factor may be from 1: the centroid of a circle's image is not the image of its centre, and k₁, whose
/// errors are smallest, leaves half a per cent.
const GAIN: f64 = 0.02;

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let (perfect, curves) = Curves::all(bench)?;
    let mut outcome = Outcome::default();
    outcome.claims.push(claims::frames_agree(&curves, &perfect));
    outcome.claims.extend([signs::symmetry(&curves), signs::reflection(&curves), signs::as_worded(&curves)]);
    outcome.claims.extend([signs::reversal(&curves), signs::k1_magnitude(&curves)]);
    outcome.claims.extend([signs::smaller_q1(&curves), signs::q2_larger_inside(&curves)]);
    outcome.claims.extend([claims::proportion(&curves), claims::areas(&curves, &perfect)]);
    outcome.claims.push(claims::within_a_tenth(&curves));
    for (number, curve) in (13..).zip(&curves) {
        let title = format!("{} = {STRENGTH}", curve.name);
        let errors = curve.walks[PLUS].errors();
        let graph = walk::error_graph(&title, &errors);
        outcome
            .graph(graph, format!("Figure {number}: {title}, q₁ solid, q₂ dashed; from rendered frames."))?;
        let title = format!("{} = −{STRENGTH}", curve.name);
        let errors = curve.walks[MINUS].errors();
        let graph = walk::error_graph(&title, &errors);
        outcome.graph(
            graph,
            format!("Beside Figure {number}: the other sign, on which Section 4.1.2 comments."),
        )?;
    }
    outcome.tables.push(("Each distortion at ±0.1: frames, and the equations".to_owned(), table(&curves)));
    outcome
        .tables
        .push(("Circles at setup, the robot upright".to_owned(), claims::setup_table(&curves, &perfect)));
    outcome.notes.push(
        "For all curves of this section `N_min` = 20 and `N_max` = 200: with p₂ = 0.1 the circles cover less than the \
         usual 40 px in places (C33)."
            .to_owned(),
    );
    Ok(outcome)
}

fn named<'a>(curves: &'a [Curves], names: &'a [&str]) -> impl Iterator<Item = &'a Curves> {
    curves.iter().filter(move |curve| names.contains(&curve.name))
}

/// `name a / b` for each of some distortions.
fn list(curves: &[Curves], names: &[&str], of: impl Fn(&Curves) -> String) -> String {
    named(curves, names).map(|curve| format!("{} {}", curve.name, of(curve))).collect::<Vec<_>>().join(", ")
}

fn table(curves: &[Curves]) -> Table {
    let head = [
        "parameter",
        "largest error q₁ / q₂ from frames",
        "by the equations",
        "frames over equations",
        "circles cover, px",
        "not identified",
    ];
    let rows = curves.iter().flat_map(|curve| {
        [(PLUS, ""), (MINUS, "−")].map(|(sign, minus)| {
            let [low, high] = curve.walks[sign].areas();
            vec![
                format!("{} = {minus}{STRENGTH}", curve.name).into(),
                Cell::Number(pair(curve.rendered(sign), 4)),
                Cell::Number(pair(walk::largest(&curve.strong[sign].exact), 4)),
                Cell::Number(format!("{:.4}", curve.strong[sign].gain())),
                Cell::Number(format!("{low:.0}-{high:.0}")),
                Cell::Number(curve.walks[sign].lost().to_string()),
            ]
        })
    });
    Table { head: head.map(str::to_owned).to_vec(), rows: rows.collect() }
}
