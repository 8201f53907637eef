//! Who makes the chatter of Figure 19, and whether the rates' errors have a part in the steady error of Figures 21, 22.
//!
//! The paper accounts for the chatter "by the discrete nature of the state estimates in combination with the first order
//! velocity approximations" (4.2), and for the steady error by "very small errors in the state ... together with the
//! erroneous values of velocities" (4.2.2). Here each of the two is exchanged by itself for the truth.

use super::{AT_REST, END, PERIOD, chatter, newton_metres};
use crate::closed_loop::{Case, DAMPED, Trace, rms, run_all};
use crate::{Bench, Claim, Error, Outcome, Study};
use report::{Cell, Table};

/// This study.
pub const STUDY: Study = Study {
    id: "section-4.2-causes",
    title: "Section 4.2: who makes the chatter, and what false velocities do to the steady error",
    claims: &["S4.2.chatter", "S4.2.2.velocities"],
    run,
};

/// With the plant's own rates instead of differences.
fn true_rates(case: Case) -> Case {
    case.fed("controller.dq1", "plant.dq1").fed("controller.dq2", "plant.dq2")
}

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let lens = |k1: f64| Case::visual(DAMPED).with("camera.k1", k1);
    let cases = [
        Case::visual(DAMPED),
        true_rates(Case::visual(DAMPED)),
        Case::full_state(DAMPED),
        lens(0.1),
        true_rates(lens(0.1)),
        lens(-0.1),
        true_rates(lens(-0.1)),
    ];
    let traces = run_all(bench, &cases)?;
    let [seen, seen_true, full] = [0, 1, 2].map(|index| chatter(&traces[index]));
    let differenced = differenced(bench)?;
    let mut outcome = Outcome::default();
    outcome.claims.push(cause(seen, seen_true, differenced));
    outcome.claims.push(steady(&traces[3..]));
    let rows = [
        ("binary picture", "differences", seen),
        ("binary picture", "true", seen_true),
        ("true", "differences", differenced),
        ("true", "true", full),
    ];
    let rows = rows.map(|(angles, rates, [moving, resting])| {
        vec![
            angles.into(),
            rates.into(),
            Cell::Number(newton_metres(moving)),
            Cell::Number(newton_metres(resting)),
        ]
    });
    let head = ["angles", "rates", "chatter, whole run, N·m", "chatter at rest at z = 0.5, N·m"];
    let table = Table { head: head.map(str::to_owned).to_vec(), rows: rows.to_vec() };
    outcome
        .tables
        .push(("Rms step of the torque between frames, 30 Hz, pole set `damped`".to_owned(), table));
    outcome.notes.push(
        "Differences of true angles are taken 1/600 s before the controller gets them, since they are handed over between \
         two communication points; at rest that is no matter."
            .to_owned(),
    );
    Ok(outcome)
}

/// The loop of Figure 20 with rates that are first-order differences of true angles: its chatter.
fn differenced(bench: &Bench) -> Result<[f64; 2], Error> {
    /// Communication points of the plant between two of the controller.
    const STEPS: usize = 20;
    let mut scenario = Case::full_state(DAMPED).scenario(bench)?;
    scenario.connections.retain(|connection| !connection.to.starts_with("controller.dq"));
    let mut simulation = bench.simulation(&scenario)?;
    simulation.initialize()?;
    let mut torques = Vec::new();
    let mut last: Option<[f64; 2]> = None;
    for step in 1.. {
        if step % STEPS == 0 {
            let angles = [simulation.value("plant.q1")?, simulation.value("plant.q2")?];
            if let Some(before) = last {
                simulation.set("controller.dq1", (angles[0] - before[0]) / PERIOD)?;
                simulation.set("controller.dq2", (angles[1] - before[1]) / PERIOD)?;
            }
            last = Some(angles);
        }
        let Some(time) = simulation.advance()? else { break };
        if step % STEPS == 0 {
            torques.push((time, simulation.value("controller.tau")?));
        }
    }
    let steps = |(from, to): (f64, f64)| {
        let pairs = torques.windows(2).filter(move |pair| pair[0].0 >= from && pair[1].0 <= to);
        rms(pairs.map(|pair| pair[1].1 - pair[0].1))
    };
    Ok([steps((0.0, END)), steps(AT_REST)])
}

fn cause(seen: [f64; 2], seen_true: [f64; 2], differenced: [f64; 2]) -> Claim {
    Claim::new(
        [
            "S4.2.chatter",
            "chatter at rest at z = 0.5 with binary pictures and differences, with either of both exchanged for the truth",
            "both in combination",
        ],
        format!(
            "{} N·m with both; {} with true rates; {} with true angles and their differences",
            newton_metres(seen[1]),
            newton_metres(seen_true[1]),
            newton_metres(differenced[1])
        ),
        "true rates leave less than a fifth, true angles less than a thousandth: the combination makes it, as the paper \
         says; differences alone make nothing of it",
        seen_true[1] < 0.2 * seen[1] && differenced[1] < 1e-3 * seen[1],
        "the discrete angles are the cause; differencing makes them ten to twenty times as loud",
    )
    .measurement()
}

fn steady(traces: &[Trace]) -> Claim {
    let errors: Vec<f64> = traces.iter().map(|trace| trace.steady_error(15.0, 18.0)).collect();
    let largest = errors.chunks_exact(2).map(|pair| (pair[0] - pair[1]).abs()).fold(0.0, f64::max);
    let listed: Vec<String> = ["k1 = 0.1", "k1 = −0.1"]
        .iter()
        .zip(errors.chunks_exact(2))
        .map(|(lens, pair)| {
            format!("{lens}: {:.3} with differences, {:.3} with true rates", pair[0], pair[1])
        })
        .collect();
    Claim::new(
        [
            "S4.2.2.velocities",
            "steady error at z_d = 0.5 with and without false velocities",
            "false velocities are named as a part of the cause",
        ],
        listed.join("; "),
        "0.01: what the chatter moves the robot by; a cause would change the error by more",
        largest < 0.01,
        "they have no part in it: at rest the rates are zero on average, and only the angles' errors stay",
    )
    .measurement()
}
