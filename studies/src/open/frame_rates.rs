//! Frame rates up to 10 000 Hz, the fastest that Section 2.2 names: faster is not better.
//!
//! A short period takes delay out of the loop; but an error of the estimates that jumps from frame to frame becomes an
//! error of the rate that grows with the rate of the frames.

use super::newton_metres;
use crate::closed_loop::{Case, DAMPED, Trace, rms, run_all};
use crate::{Bench, Claim, Error, Outcome, Study};
use report::{Axis, Cell, Graph, Line, Table};

/// This study.
pub const STUDY: Study = Study {
    id: "section-2.2-frame-rates",
    title: "Section 2.2: frame rates up to 10 000 Hz",
    claims: &["S2.2.rates"],
    run,
};

/// Frame rates in Hz, and communication points in a period.
const RATES: [(u16, u16); 12] = [
    (15, 40),
    (20, 30),
    (25, 24),
    (30, 20),
    (60, 10),
    (120, 5),
    (240, 3),
    (480, 2),
    (1000, 1),
    (2000, 1),
    (5000, 1),
    (10_000, 1),
];
/// Index of the paper's rate.
const THIRTY: usize = 3;
/// Begin of what is measured, and end of a run, s.
const SPAN: (f64, u16) = (1.0, 3);
/// Where the robot is to rest.
const PLACE: f64 = 0.3;

/// What a rate does at rest.
struct Rest {
    rate: f64,
    trace: Trace,
    /// Rms of z about its mean.
    wander: f64,
    /// Standard deviation of the torque, N·m.
    ripple: f64,
}

fn measure(bench: &Bench, estimator: i32) -> Result<Vec<Rest>, Error> {
    let place =
        mechanics::Place::new(&mechanics::Theta::TABLE_2).map_err(|why| Error::Mechanics(why.to_string()))?;
    let pose = crate::lens::on_manifold(place.q2(PLACE));
    let cases = RATES.map(|(rate, parts)| {
        let case = Case::visual(DAMPED).with("camera.omega_cam", rate).with("camera.estimator", estimator);
        case.every(rate, parts).resting(pose, PLACE, SPAN.1)
    });
    let traces = run_all(bench, &cases)?;
    let rest = |((rate, _), trace): ((u16, u16), Trace)| {
        let late: Vec<f64> = (trace.times.iter().zip(&trace.z))
            .filter(|(time, _)| **time >= SPAN.0)
            .map(|(_, z)| *z)
            .collect();
        let mean = late.iter().sum::<f64>() / late.len() as f64;
        Rest {
            rate: f64::from(rate),
            wander: if trace.is_stable() { rms(late.iter().map(|z| z - mean)) } else { f64::NAN },
            ripple: if trace.is_stable() { trace.ripple(SPAN.0, f64::from(SPAN.1)) } else { f64::NAN },
            trace,
        }
    };
    Ok(RATES.into_iter().zip(traces).map(rest).collect())
}

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let binary = measure(bench, 0)?;
    let grey = measure(bench, 1)?;
    let mut outcome = Outcome::default();
    outcome.claims.push(claim(&binary));
    outcome.graph(figure(&binary, &grey)?, "How far z wanders at rest at z = 0.3, over the frame rate: least at 30 Hz, below which the loop nears its limit (C44).")?;
    let text =
        |value: f64, rest: &Rest| if value.is_nan() { rest.trace.fate() } else { format!("{value:.1e}") };
    let head = [
        "frame rate, Hz",
        "rms of z, binary",
        "std of τ, binary, N·m",
        "rms of z, grey levels",
        "std of τ, grey levels, N·m",
    ];
    let rows = binary.iter().zip(&grey).map(|(binary, grey)| {
        vec![
            Cell::Number(binary.rate.to_string()),
            Cell::Number(text(binary.wander, binary)),
            Cell::Number(if binary.ripple.is_nan() { "-".to_owned() } else { newton_metres(binary.ripple) }),
            Cell::Number(text(grey.wander, grey)),
            Cell::Number(if grey.ripple.is_nan() { "-".to_owned() } else { newton_metres(grey.ripple) }),
        ]
    });
    let table = Table { head: head.map(str::to_owned).to_vec(), rows: rows.collect() };
    outcome.tables.push(("At rest at z = 0.3, pole set `damped`, no noise".to_owned(), table));
    Ok(outcome)
}

fn claim(rests: &[Rest]) -> Claim {
    let best =
        rests.iter().filter(|rest| rest.wander.is_finite()).min_by(|a, b| a.wander.total_cmp(&b.wander));
    let best = best.map_or(f64::NAN, |rest| rest.rate);
    let at = |index: usize| {
        let rest = &rests[index];
        if rest.trace.is_stable() {
            format!("{:.1e} and {} N·m at {} Hz", rest.wander, newton_metres(rest.ripple), rest.rate)
        } else {
            format!("{} at {} Hz", rest.trace.fate(), rest.rate)
        }
    };
    let last = rests.len() - 1;
    let (slow, fast) = (&rests[THIRTY], &rests[last]);
    Claim::new(
        [
            "S2.2.rates",
            "wander of z and ripple of the torque at rest, over the frame rate",
            "\"frame rates as high as 10,000\" exist; the sample period should be as low as possible (5)",
        ],
        format!("rms of z and std of τ: {}, {}, {}; z is quietest at {best} Hz", at(0), at(THIRTY), at(last)),
        "an optimum far below the fastest: z quietest below 100 Hz; the torque rougher at 10 000 Hz than at 30 Hz by at \
         least ten times, since differencing makes the lattice of pixels louder with the rate",
        best < 100.0 && fast.ripple > 10.0 * slow.ripple,
        "with the paper's differences between two frames; a camera that is faster needs a filter or better centres",
    )
    .measurement()
}

fn figure(binary: &[Rest], grey: &[Rest]) -> Result<Graph, Error> {
    let points = |rests: &[Rest]| {
        rests.iter().map(|rest| (rest.rate.log10(), rest.wander.log10())).collect::<Vec<_>>()
    };
    let graph = Graph::new(
        "Wander of z at rest",
        Axis::fitted("log₁₀ of the frame rate in Hz"),
        Axis::fitted("log₁₀ of the rms of z"),
    )
    .with(Line::solid("binary centroid", points(binary)))
    .with(Line::dashed("centroid of grey levels", points(grey)));
    Ok(graph)
}
