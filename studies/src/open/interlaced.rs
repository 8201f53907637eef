//! Section 2.3: a camera that delivers half frames at twice the rate.
//!
//! The paper speaks of an N_x/2 × N_y/2 frame. A field of an interlaced sensor has every second row with all its columns;
//! half of the columns is what a frame grabber of the time left to keep pixels square. The camera unit gives the field
//! (`interlaced`); the paper's words are met by a sensor of 256 × 256 px at 60 Hz, which stands beside it.

use super::newton_metres;
use crate::closed_loop::{Case, DAMPED, Trace, run_all};
use crate::walk::{Walk, small};
use crate::{Bench, Claim, Error, Outcome, Study};
use report::{Cell, Table};

/// This study.
pub const STUDY: Study = Study {
    id: "section-2.3-interlaced",
    title: "Section 2.3: interlaced cameras",
    claims: &["S2.3.interlaced"],
    run,
};

/// Name, pictures a second, parameters of the camera.
type Camera = (&'static str, f64, &'static [(&'static str, f64)]);

const CAMERAS: [Camera; 4] = [
    ("512 × 512 px, 30 Hz", 30.0, &[]),
    ("fields of 512 × 256 px, 60 Hz", 60.0, &[("interlaced", 1.0)]),
    (
        "256 × 256 px, 60 Hz",
        60.0,
        &[("width", 256.0), ("height", 256.0), ("N_min", 10.0), ("N_max", 33.0), ("omega_cam", 60.0)],
    ),
    ("512 × 512 px, 60 Hz", 60.0, &[("omega_cam", 60.0)]),
];
/// At rest at z = 0.5, s.
const REST: (f64, f64) = (15.0, 20.0);

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let course = vec![(0.0, 0.0), (2.0, 0.0), (12.0, 0.5), (20.0, 0.5)];
    let cases = CAMERAS.map(|(_, _, set)| Case::visual(DAMPED).through(set).along(course.clone(), 20));
    let traces = run_all(bench, &cases)?;
    let walks = Walk::all(bench, &CAMERAS.map(|(_, _, set)| at_rest(set)))?;
    let ripple = |index: usize| traces[index].chatter(1.0 / CAMERAS[index].1, REST.0, REST.1);
    let mut outcome = Outcome::default();
    outcome.claims.push(claim(&traces, [0, 1, 2, 3].map(ripple)));
    let head = [
        "camera",
        "fate",
        "rms step of the torque between pictures, N·m",
        "std of the torque, N·m",
        "abs(z_d − z)",
        "rms error of the estimates along the manifold, rad",
    ];
    let rows = CAMERAS.iter().enumerate().map(|(index, (name, ..))| {
        let trace = &traces[index];
        vec![
            (*name).into(),
            trace.fate().into(),
            Cell::Number(newton_metres(ripple(index))),
            Cell::Number(newton_metres(trace.ripple(REST.0, REST.1))),
            Cell::Number(format!("{:.4}", trace.steady_error(REST.0, REST.1).abs())),
            Cell::Number(small(walks[index].rms())),
        ]
    });
    let table = Table { head: head.map(str::to_owned).to_vec(), rows: rows.collect() };
    outcome.tables.push(("What the pictures do to the torque, at rest at z = 0.5".to_owned(), table));
    outcome.notes.push(
        "A pixel of a field stands for two of a frame in `N_min` and `N_max`; those of 256 × 256 px are a quarter. Odd and \
         even rows see a circle at other places of the lattice, so that an estimate jumps from field to field even of a \
         robot at rest, and half the time between two pictures doubles what a jump is as a rate."
            .to_owned(),
    );
    Ok(outcome)
}

/// The parameters for a look at a robot at rest, at the usual 30 looks a second.
fn at_rest(set: &[(&'static str, f64)]) -> Vec<(&'static str, f64)> {
    set.iter().copied().filter(|(name, _)| *name != "omega_cam").collect()
}

fn claim(traces: &[Trace], ripples: [f64; 4]) -> Claim {
    let listed: Vec<String> = CAMERAS
        .iter()
        .zip(traces.iter().zip(ripples))
        .map(|((name, ..), (trace, ripple))| format!("{name}: {}, {}", trace.fate(), newton_metres(ripple)))
        .collect();
    let [_, fields, _, frames] = ripples;
    Claim::new(
        [
            "S2.3.interlaced",
            "ripple of the torque at rest with fields against full frames at the same 60 Hz",
            "\"N_x/2 × N_y/2 at twice this rate\"; no statement on control",
        ],
        format!("rms step of the torque between pictures in N·m: {}", listed.join("; ")),
        "the loop is stable with fields, and they make the torque rougher by half at least",
        traces[1].is_stable() && fields > 1.5 * frames,
        "our unit halves the rows only: a field has all columns; the paper's halved columns are a sensor of 256 × 256 px",
    )
    .measurement()
}
