//! What the paper names as future work: an actuator whose torque can't change faster than so much a second.

use crate::closed_loop::{Case, DAMPED, Poles, SETS, Trace, run_all};
use crate::{Bench, Claim, Error, Outcome, Study, four_graphs};
use rayon::prelude::*;
use report::{Axis, Cell, Graph, Line, Style, Table};

/// C54.
pub const STUDY: Study = Study {
    id: "torque-rate",
    title: "A limit on the torque's rate of change (Sections 5, 6)",
    claims: &["C54"],
    run,
};

/// Limits on the grid of an independent implementation, N·m/s.
const GRID: [f64; 7] = [0.3, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0];
/// Frame rates of the boundary, Hz.
const RATES: [u16; 7] = [15, 20, 30, 40, 60, 90, 120];
/// Between these limits the boundary is sought, N·m/s.
const SEARCH: (f64, f64) = (0.3, 60.0);
/// Halvings of the logarithm: (60/0.3)^(1/2^6) is 9 %.
const HALVINGS: usize = 6;

/// 0 → 0.5 → 0 from (14).
fn course(case: Case) -> Case {
    case.along(vec![(0.0, 0.0), (2.0, 0.0), (12.0, 0.5), (15.0, 0.5), (25.0, 0.0)], 28)
}

fn limited(case: Case, limit: f64) -> Case {
    course(case).with("plant.dtau_max", limit)
}

/// One set of poles on the grid: the lowest limit above which it is stable, with vision and with the true state.
struct Lowest {
    poles: Poles,
    visual: Option<f64>,
    full: Option<f64>,
}

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let lowest = SETS.iter().map(|&poles| on_the_grid(bench, poles)).collect::<Result<Vec<_>, Error>>()?;
    let shown = |limit| limited(Case::visual(DAMPED), limit);
    let traces = run_all(bench, &[shown(5.0), shown(10.0), shown(20.0)])?;
    let boundaries = SETS
        .par_iter()
        .map(|&poles| Ok((poles, boundary(bench, poles)?)))
        .collect::<Result<Vec<_>, Error>>()?;

    let mut outcome = Outcome::default();
    outcome.notes.push(
        "`plant.dtau_max` limits the rate of the torque after the controller; the reference is 0 → 0.5 → 0 from (14). \
         The boundary is the lowest limit with which the loop is stable, found by halving its logarithm."
            .to_owned(),
    );
    if let [below, _, above] = traces.as_slice() {
        four_graphs::add(&mut outcome, below, "Section 5", "dtau_max = 5 N·m/s at 30 Hz: it loses balance")?;
        outcome
            .graph(oscillation(&traces)?, "Tracking error at 30 Hz with three limits, pole set damped.")?;
        outcome.claims.push(statement(&lowest, below, above));
    }
    outcome.graph(
        graph(&boundaries)?,
        "Below its line a pole set is unstable: the limit on the torque's rate that the loop needs, over the frame rate.",
    )?;
    outcome.tables.push((
        "Lowest limit with which the loop is stable, in N·m/s".to_owned(),
        table(&lowest, &boundaries),
    ));
    Ok(outcome)
}

fn on_the_grid(bench: &Bench, poles: Poles) -> Result<Lowest, Error> {
    let cases: Vec<Case> = [Case::visual(poles), Case::full_state(poles)]
        .iter()
        .flat_map(|case| GRID.map(|limit| limited(case.clone(), limit)))
        .collect();
    let stable: Vec<bool> = run_all(bench, &cases)?.iter().map(Trace::is_stable).collect();
    let lowest = |stable: &[bool]| {
        GRID.iter().zip(stable).rev().take_while(|(_, stable)| **stable).last().map(|(limit, _)| *limit)
    };
    let (visual, full) = stable.split_at(GRID.len());
    Ok(Lowest { poles, visual: lowest(visual), full: lowest(full) })
}

/// The lowest limit with which the visual loop is stable, for each of [`RATES`]; `None` where it is unstable without any.
fn boundary(bench: &Bench, poles: Poles) -> Result<Vec<Option<f64>>, Error> {
    RATES.par_iter().map(|&rate| boundary_at(bench, poles, rate)).collect()
}

fn boundary_at(bench: &Bench, poles: Poles, rate: u16) -> Result<Option<f64>, Error> {
    lowest_limit(bench, course(Case::visual(poles)).with("camera.omega_cam", rate).every(rate, 10))
}

/// The lowest limit with which each of some loops follows 0 → 0.5 → 0.
pub(crate) fn lowest_limits(bench: &Bench, cases: &[Case]) -> Result<Vec<Option<f64>>, Error> {
    cases.par_iter().map(|case| lowest_limit(bench, course(case.clone()))).collect()
}

fn lowest_limit(bench: &Bench, case: Case) -> Result<Option<f64>, Error> {
    let mut closed = case.build(bench)?;
    let mut stable = |limit: f64| {
        closed.set("plant.dtau_max", limit)?;
        Ok::<_, Error>(closed.run()?.is_stable())
    };
    if !stable(0.0)? {
        return Ok(None); // 0 is no limit at all
    }
    let (mut low, mut high) = SEARCH;
    for _ in 0..HALVINGS {
        let middle = (low * high).sqrt();
        if stable(middle)? { high = middle } else { low = middle }
    }
    Ok(Some(high))
}

fn statement(lowest: &[Lowest], below: &Trace, above: &Trace) -> Claim {
    let text = |limit: Option<f64>| limit.map_or_else(|| "none".to_owned(), |limit| limit.to_string());
    let listed: Vec<String> = (lowest.iter())
        .map(|set| format!("{} {} and {}", set.poles.name, text(set.visual), text(set.full)))
        .collect();
    let needs_more =
        |set: &Lowest| matches!((set.visual, set.full), (Some(visual), Some(full)) if visual >= full);
    Claim::new(
        ["C54", "a limit on the torque's rate of change", "could cause oscillations or instability"],
        format!(
            "lowest limit with which it is stable, visual and full state, in N·m/s: {}",
            listed.join("; ")
        ),
        "a step of the grid 0.3, 0.5, 1, 2, 3, 5, 10 N·m/s; the loop is unstable below, stable above, and vision never needs \
         less than full state feedback",
        !below.is_stable() && above.is_stable() && lowest.iter().all(needs_more),
        "an independent implementation found 5, 5, 10 with vision and 3, 3, 5 with full state feedback; the boundary \
         over the frame rate is drawn below",
    )
}

fn oscillation(traces: &[Trace]) -> Result<Graph, Error> {
    let mut graph = Graph::new(
        "Tracking error with a rate limit",
        Axis::fitted("time in s"),
        Axis::over("z desired − z", -0.3, 0.3),
    );
    let line = [dotted, Line::dashed, Line::solid];
    for ((trace, line), limit) in traces.iter().zip(line).zip([5, 10, 20]) {
        let error = trace.z_desired.iter().zip(&trace.z).map(|(desired, z)| desired - z);
        graph = graph.with(line(format!("{limit} N·m/s"), trace.times.iter().copied().zip(error).collect()));
    }
    Ok(graph)
}

fn dotted(label: String, points: Vec<(f64, f64)>) -> Line {
    Line { label, style: Style::Dotted, points }
}

type Boundary = (Poles, Vec<Option<f64>>);

fn graph(boundaries: &[Boundary]) -> Result<Graph, Error> {
    let mut graph = Graph::new(
        "Stability boundary of a rate limit",
        Axis::fitted("frame rate in Hz"),
        Axis::fitted("lowest dtau_max in N·m/s"),
    );
    for ((poles, limits), line) in boundaries.iter().zip([dotted, Line::dashed, Line::solid]) {
        let points = RATES.iter().zip(limits).filter_map(|(rate, limit)| Some((f64::from(*rate), (*limit)?)));
        graph = graph.with(line(poles.name.to_owned(), points.collect()));
    }
    Ok(graph)
}

fn table(lowest: &[Lowest], boundaries: &[Boundary]) -> Table {
    let mut head = vec!["poles".to_owned(), "grid, visual".to_owned(), "grid, full state".to_owned()];
    head.extend(RATES.map(|rate| format!("{rate} Hz")));
    let number = |limit: Option<f64>| {
        Cell::Number(limit.map_or_else(|| "unstable".to_owned(), |limit| format!("{limit:.2}")))
    };
    let rows = lowest.iter().zip(boundaries).map(|(lowest, (_, limits))| {
        let mut row = vec![lowest.poles.name.into(), number(lowest.visual), number(lowest.full)];
        row.extend(limits.iter().map(|limit| number(*limit)));
        row
    });
    Table { head, rows: rows.collect() }
}
