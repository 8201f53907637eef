//! Figures 1 and 2: vision in an outer loop that gives set points, against vision that closes the loop.
//!
//! `dual-loop`: the camera looks at an object, an arm led along the manifold; the place that vision reads is the set
//! point of an inner loop that balances the robot by its true state at 600 Hz. `visual-servo`: the camera looks at the
//! robot itself, and what it reads closes the loop. The introduction says that with the first the errors of imaging "can
//! easily be overshadowed", at the expense of performance.

use super::newton_metres;
use crate::closed_loop::{Case, DAMPED, Trace, run_all};
use crate::{Bench, Claim, Error, Outcome, Study, four_graphs};
use report::{Cell, Table};

/// This study.
pub const STUDY: Study = Study {
    id: "figures-1-2",
    title: "Figures 1 and 2: dual-loop and direct visual servo",
    claims: &["F1-2.errors", "F1-2.delay"],
    run,
};

/// What happens to the camera, in both loops.
type Disturbance = (&'static str, &'static [(&'static str, f64)]);

const NOTHING: usize = 0;
/// Lenses of Figures 21, 22 and 25.
const LENSES: [usize; 3] = [1, 2, 3];
/// Delays.
const DELAYS: [usize; 3] = [4, 5, 6];

const DISTURBANCES: [Disturbance; 8] = [
    ("nothing", &[]),
    ("k1 = 0.1", &[("k1", 0.1)]),
    ("k1 = −0.1", &[("k1", -0.1)]),
    ("p2 = 0.015", &[("p2", 0.015)]),
    ("delay 1.0 T", &[("T_delay", 1.0 / 30.0)]),
    ("delay 1.5 T", &[("T_delay", 1.5 / 30.0)]),
    ("delay 6 T", &[("T_delay", 6.0 / 30.0)]),
    ("10 Hz", &[("omega_cam", 10.0)]),
];
/// At rest at z = 0.5, s.
const REST: (f64, f64) = (15.0, 20.0);

/// Dual-loop and direct.
struct Both([Trace; 2]);

impl Both {
    /// 0.5 − z at rest; not a number where it fell.
    fn errors(&self) -> [f64; 2] {
        [0, 1].map(|index| 0.5 - self.0[index].mean_z(REST.0, REST.1))
    }
}

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let course = vec![(0.0, 0.0), (2.0, 0.0), (12.0, 0.5), (20.0, 0.5)];
    let cases: Vec<Case> = DISTURBANCES
        .iter()
        .flat_map(|(_, set)| {
            [Case::dual_loop(DAMPED), Case::visual(DAMPED)]
                .map(|case| case.through(set).along(course.clone(), 20))
        })
        .collect();
    let mut traces = run_all(bench, &cases)?.into_iter();
    let mut measured = Vec::new();
    while let (Some(dual), Some(direct)) = (traces.next(), traces.next()) {
        measured.push(Both([dual, direct]));
    }
    let mut outcome = Outcome::default();
    outcome.claims.extend([errors(&measured), delay(&measured)]);
    four_graphs::add(
        &mut outcome,
        &measured[1].0[0],
        "Figure 1",
        "dual-loop visual servo behind k1 = 0.1; z desired is the set point that vision gives",
    )?;
    let head = ["camera", "dual loop", "0.5 − z", "std of τ, N·m", "direct", "0.5 − z", "std of τ, N·m"];
    let rows = DISTURBANCES.iter().zip(&measured).map(|((name, _), both)| {
        let of = |index: usize| {
            let trace = &both.0[index];
            let number =
                |value: f64, text: String| Cell::Number(if value.is_nan() { "-".to_owned() } else { text });
            let (error, ripple) = (both.errors()[index], trace.ripple(REST.0, REST.1));
            [
                Cell::Text(trace.fate()),
                number(error, format!("{error:.4}")),
                number(error, newton_metres(ripple)),
            ]
        };
        std::iter::once(Cell::from(*name)).chain(of(0)).chain(of(1)).collect()
    });
    let table = Table { head: head.map(str::to_owned).to_vec(), rows: rows.collect() };
    outcome.tables.push(("At rest at z = 0.5, pole set `damped`".to_owned(), table));
    outcome.notes.push(
        "The scenarios are `dual-loop` and `visual-servo`: `acroscope run dual-loop`. In the first the camera has no part \
         in keeping the robot up, so that neither a lens nor a delay can make it fall; a delay only makes it late. A \
         robot that rolls has no sensor but the camera, which is why the paper turns to the second."
            .to_owned(),
    );
    Ok(outcome)
}

fn errors(measured: &[Both]) -> Claim {
    let factor = |index: usize| {
        let [dual, direct] = measured[index].errors().map(f64::abs);
        direct / dual
    };
    let listed = LENSES.map(|index| {
        let [dual, direct] = measured[index].errors();
        format!("{}: {dual:.4} and {direct:.4}", DISTURBANCES[index].0)
    });
    let [usual, _] = measured[NOTHING].errors();
    Claim::new(
        [
            "F1-2.errors",
            "steady error behind a lens, dual loop and direct",
            "imaging errors are easily overshadowed in dual loops (introduction)",
        ],
        format!("0.5 − z at rest: {}; without distortion {usual:.4} in the dual loop", listed.join("; ")),
        "at least four times smaller in the dual loop",
        LENSES.iter().all(|index| factor(*index) > 4.0) && usual.abs() < 0.003,
        "in the dual loop the error is that of the reading; in the direct one the law multiplies it (tuning study)",
    )
    .measurement()
}

fn delay(measured: &[Both]) -> Claim {
    let fates = DELAYS.map(|index| {
        let [dual, direct] = &measured[index].0;
        format!("{}: {} and {}", DISTURBANCES[index].0, dual.fate(), direct.fate())
    });
    Claim::new(
        [
            "F1-2.delay",
            "delay of the vision, dual loop and direct",
            "the inner loop guarantees stability; performance suffers (introduction)",
        ],
        fates.join("; "),
        "the dual loop is stable with each, the direct one is unstable from 1.5 T on",
        DELAYS.iter().all(|index| measured[*index].0[0].is_stable())
            && DELAYS[1..].iter().all(|index| !measured[*index].0[1].is_stable()),
        "",
    )
    .measurement()
}
