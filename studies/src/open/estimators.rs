//! Section 6 asks for "more accurate velocity calculations and smooth control": what better centres of the circles do.
//!
//! The camera's `estimator` finds a circle's centre in the binary picture (0, the paper's), by the grey levels around it
//! (1), or by maximum likelihood (2). Rates stay first-order differences.

use super::{AT_REST, chatter, newton_metres};
use crate::closed_loop::{Case, DAMPED, Trace, run_all};
use crate::walk::{Walk, small, worse};
use crate::{Bench, Claim, Error, Outcome, Study, torque_rate};
use report::{Axis, Cell, Graph, Line, Style, Table};

/// This study.
pub const STUDY: Study = Study {
    id: "section-6-velocities",
    title: "Section 6: more accurate velocities, smoother control",
    claims: &["S6.velocities", "S6.rate-limit"],
    run,
};

const NAMES: [&str; 4] =
    ["binary centroid (paper)", "centroid of grey levels", "maximum likelihood", "full state"];

fn cases() -> [Case; 4] {
    let seeing = |estimator: i32| Case::visual(DAMPED).with("camera.estimator", estimator);
    [seeing(0), seeing(1), seeing(2), Case::full_state(DAMPED)]
}

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let traces = run_all(bench, &cases())?;
    let limits = torque_rate::lowest_limits(bench, &cases())?;
    let walks = Walk::all(bench, &[0.0, 1.0, 2.0].map(|estimator| vec![("estimator", estimator)]))?;
    let mut outcome = Outcome::default();
    outcome.notes.push(
        "The reference of Figures 19 and 20, pole set `damped`, no noise. The chatter is the rms step of the torque \
         between frames; the limit is the lowest `plant.dtau_max` with which the loop follows 0 → 0.5 → 0, found by \
         halving its logarithm, to 9 %."
            .to_owned(),
    );
    outcome.claims.push(smoother(&traces, &walks));
    outcome.claims.push(gentler(&limits));
    outcome.graph(
        figure(&traces)?,
        "The torque at rest at z = 0.5: with grey levels the steps of the binary picture are gone.",
    )?;
    let head = [
        "centres by",
        "rms error at rest, q₁ / q₂ in rad",
        "chatter, whole run, N·m",
        "chatter at rest at z = 0.5, N·m",
        "std there, N·m",
        "lowest rate limit, N·m/s",
    ];
    let rows = NAMES.iter().enumerate().map(|(index, name)| {
        let [moving, resting] = chatter(&traces[index]);
        vec![
            (*name).into(),
            Cell::Number(walks.get(index).map_or_else(|| "-".to_owned(), |walk| small(walk.rms()))),
            Cell::Number(newton_metres(moving)),
            Cell::Number(newton_metres(resting)),
            Cell::Number(newton_metres(traces[index].ripple(AT_REST.0, AT_REST.1))),
            Cell::Number(limits[index].map_or_else(|| "unstable".to_owned(), |limit| format!("{limit:.1}"))),
        ]
    });
    let table = Table { head: head.map(str::to_owned).to_vec(), rows: rows.collect() };
    outcome.tables.push(("What the torque makes of the centres".to_owned(), table));
    Ok(outcome)
}

fn smoother(traces: &[Trace], walks: &[Walk]) -> Claim {
    let [binary, grey, likely, full] = [0, 1, 2, 3].map(|index| chatter(&traces[index]));
    let both =
        |[moving, resting]: [f64; 2]| format!("{} / {}", newton_metres(moving), newton_metres(resting));
    Claim::new(
        [
            "S6.velocities",
            "chatter of the torque with better centres of the circles, on the way / at rest at z = 0.5",
            "\"attempts to generate more accurate velocity calculations and smooth control\" are of interest",
        ],
        format!(
            "{} N·m with the binary centroid, {} by grey levels, {} by maximum likelihood, {} with full state; the \
             estimates' rms error falls from {} to {} and {} rad",
            both(binary),
            both(grey),
            both(likely),
            both(full),
            small(walks[0].rms()),
            small(walks[1].rms()),
            small(walks[2].rms()),
        ),
        "at least ten times less on the way, a hundred times at rest, with each of both; the way itself needs what full \
         state feedback has",
        [grey, likely].iter().all(|better| better[0] < 0.1 * binary[0] && better[1] < 0.01 * binary[1])
            && walks[1..].iter().all(|walk| worse(walk.rms()) < 0.2 * worse(walks[0].rms())),
        "differences of accurate angles are accurate rates: no filter is needed at 30 Hz",
    )
    .measurement()
}

fn gentler(limits: &[Option<f64>]) -> Claim {
    let text = |limit: Option<f64>| limit.map_or_else(|| "none".to_owned(), |limit| format!("{limit:.1}"));
    let listed: Vec<String> =
        NAMES.iter().zip(limits).map(|(name, limit)| format!("{name} {}", text(*limit))).collect();
    let holds = match limits {
        [Some(binary), Some(grey), Some(likely), Some(full)] => {
            grey.max(*likely) < 0.8 * binary && full.max(grey.max(*likely)) < 1.3 * full
        }
        _ => false,
    };
    Claim::new(
        [
            "S6.rate-limit",
            "lowest limit on the torque's rate that the loop tolerates, with better centres",
            "\"a fixed maximum of the torque's rate\" is future work",
        ],
        format!("{} N·m/s", listed.join(", ")),
        "the better centres need at least a fifth less than the binary ones, and what full state feedback needs to 30 %: \
         three steps of the search",
        holds,
        "",
    )
    .measurement()
}

fn figure(traces: &[Trace]) -> Result<Graph, Error> {
    let mut graph =
        Graph::new("Torque at rest", Axis::over("time in s", 16.0, 18.0), Axis::fitted("τ in N·m"));
    let styles = [Style::Solid, Style::Dashed, Style::Dotted, Style::Solid];
    for ((trace, name), style) in traces.iter().zip(NAMES).zip(styles) {
        let points = trace.times.iter().copied().zip(trace.tau.iter().copied());
        let points = points.filter(|(time, _)| (16.0..=18.0).contains(time)).collect();
        graph = graph.with(Line { label: name.to_owned(), style, points });
    }
    Ok(graph)
}
