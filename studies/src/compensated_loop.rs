//! What Section 5 proposes: a known distortion, corrected through the curves of the estimation error.
//!
//! The curves come from the camera looking at poses on the manifold, as in Section 4.1.2; they are read at the
//! estimated q₂ and added to the estimates before the controller gets them. The units are stepped by the master; the
//! correction stands between camera and controller and costs one communication interval, 1/600 s, of delay.

use crate::closed_loop::{ANY_AREA, Case, DAMPED};
use crate::walk::{Look, Walk};
use crate::{Bench, Claim, Error, Outcome, Study};
use orchestrator::Simulation;
use rayon::prelude::*;
use report::{Axis, Cell, Graph, Line, Table};

/// Section 5's compensation.
pub const STUDY: Study = Study {
    id: "compensation-in-the-loop",
    title: "Compensating a known distortion (Section 5)",
    claims: &["S5.compensation.loop"],
    run,
};

/// Half the width over which a curve is averaged against the lattice of pixels, in estimated q₂, rad.
const WINDOW: f64 = 0.05;
/// Over this span the steady error at z_desired = 0.5 is read, s.
const STEADY: (f64, f64) = (15.0, 20.0);

/// A lens by name and the variables that make it.
type Lens = (&'static str, &'static [(&'static str, f64)]);

/// The lens of Figure 21, one that fells the uncorrected loop, and that of Section 4.1.3.
const LENSES: [Lens; 3] = [
    ("k1 = 0.1", &[("k1", 0.1)]),
    ("k1 = -0.3", &[("k1", -0.3)]),
    ("composite of 4.1.3", &[("k1", 0.2), ("p1", 0.002), ("p2", 0.002), ("s1", 0.02), ("s2", 0.01)]),
];

/// Mean estimation error over estimated q₂.
struct Curve {
    points: Vec<(f64, [f64; 2])>,
}

impl Curve {
    fn new(looks: &[Look]) -> Curve {
        let looks: Vec<&Look> = looks.iter().filter(|look| look.valid).collect();
        let mean_around = |centre: f64| {
            let near = looks.iter().filter(|look| (look.estimate[1] - centre).abs() <= WINDOW);
            let (sum, count) = near.fold(([0.0; 2], 0.0), |(sum, count): ([f64; 2], f64), look| {
                let error = look.error();
                ([sum[0] + error[0], sum[1] + error[1]], count + 1.0)
            });
            sum.map(|sum| sum / count)
        };
        let mut points: Vec<_> =
            looks.iter().map(|look| (look.estimate[1], mean_around(look.estimate[1]))).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Curve { points }
    }

    /// The error to be added to an estimate; beyond the curve's ends that of the end.
    fn at(&self, estimated_q2: f64) -> [f64; 2] {
        let next = self.points.partition_point(|(q2, _)| *q2 <= estimated_q2);
        let (Some(from), Some(to)) = (self.points.get(next.wrapping_sub(1)), self.points.get(next)) else {
            let end = if next == 0 { self.points.first() } else { self.points.last() };
            return end.map_or([0.0; 2], |(_, error)| *error);
        };
        let share = (estimated_q2 - from.0) / (to.0 - from.0);
        [0, 1].map(|i| from.1[i] + share * (to.1[i] - from.1[i]))
    }
}

/// A run to z = 0.5: tracking error over time, and when it fell.
struct Run {
    error: Vec<(f64, f64)>,
    fell: Option<f64>,
}

impl Run {
    /// Mean error at the end; NaN where it fell.
    fn steady(&self) -> f64 {
        if self.fell.is_some() {
            return f64::NAN;
        }
        let late: Vec<f64> = (self.error.iter())
            .filter(|(time, _)| (STEADY.0..=STEADY.1).contains(time))
            .map(|(_, error)| *error)
            .collect();
        late.iter().sum::<f64>() / late.len() as f64
    }

    fn fate(&self) -> String {
        self.fell
            .map_or_else(|| format!("{:.4}", self.steady()), |time| format!("loses balance at {time:.1} s"))
    }
}

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let measured = LENSES
        .par_iter()
        .map(|(_, lens)| {
            let curve = Curve::new(&Walk::new(bench, &[*lens, &ANY_AREA[..]].concat())?.looks);
            let (without, with) =
                rayon::join(|| steered(bench, lens, None), || steered(bench, lens, Some(&curve)));
            Ok([without?, with?])
        })
        .collect::<Result<Vec<_>, Error>>()?;
    let mut outcome = Outcome::default();
    outcome.notes.push(
        "The estimates are corrected by the mean estimation error at the estimated q₂, read from the camera itself \
         looking along the manifold; the rates are differences of corrected angles. Both loops, with and without the \
         correction, bear the same extra 1/600 s that it takes to stand between camera and controller. Pole set damped; \
         N_min and N_max let every circle through."
            .to_owned(),
    );
    for ((name, _), runs) in LENSES.iter().zip(&measured) {
        let words = format!("Tracking error on the way to z = 0.5 behind the lens {name}.");
        outcome.graph(graph(name, runs), words)?;
    }
    outcome.claims.push(claim(&measured));
    outcome.tables.push(("With and without the correction".to_owned(), table(&measured)));
    Ok(outcome)
}

/// The tracking error behind a lens, without the correction and with it.
fn graph(name: &str, [without, with]: &[Run; 2]) -> Graph {
    Graph::new(
        format!("Tracking error, {name}"),
        Axis::fitted("time in s"),
        Axis::over("z desired − z", -0.3, 0.3),
    )
    .with(Line::dashed("as it is", without.error.clone()))
    .with(Line::solid("corrected", with.error.clone()))
}

fn claim(measured: &[[Run; 2]]) -> Claim {
    let texts: Vec<String> = (LENSES.iter().zip(measured))
        .map(|((name, _), [without, with])| format!("{name}: {} → {}", without.fate(), with.fate()))
        .collect();
    Claim::new(
        [
            "S5.compensation.loop",
            "a known distortion corrected through the estimation-error curves",
            "possible",
        ],
        format!("z_d − z at z_d = 0.5: {}", texts.join("; ")),
        "the corrected loop is stable, its error below 0.01: three times the offset of the undistorted loop",
        measured.iter().all(|[_, with]| with.steady().abs() < 0.01),
        "",
    )
    .part()
}

fn table(measured: &[[Run; 2]]) -> Table {
    let head = ["lens", "steady error as it is", "steady error corrected"].map(str::to_owned).to_vec();
    let row = |((name, _), runs): (&Lens, &[Run; 2])| {
        std::iter::once(Cell::from(*name)).chain(runs.iter().map(|run| Cell::Number(run.fate()))).collect()
    };
    Table { head, rows: LENSES.iter().zip(measured).map(row).collect() }
}

/// The visual loop to z = 0.5, with the estimates handed over by hand.
fn steered(bench: &Bench, lens: &[(&str, f64)], curve: Option<&Curve>) -> Result<Run, Error> {
    let case = Case::visual(DAMPED).finding_everything();
    let case = case.along(vec![(0.0, 0.0), (2.0, 0.0), (12.0, 0.5)], 20);
    let case = case.through(lens);
    let mut scenario = case.scenario(bench)?;
    scenario.connections.retain(|connection| !connection.to.starts_with("controller."));
    scenario.set("controller.frame", "0")?;
    let mut simulation = bench.simulation(&scenario)?;
    simulation.initialize()?;
    let mut run = Run { error: Vec::new(), fell: None };
    let mut last: Option<(f64, [f64; 2])> = None;
    let mut handed = 0.0;
    loop {
        let frame = simulation.value("camera.frame")?;
        if frame != handed {
            handed = frame;
            hand_over(&mut simulation, frame, curve, &mut last)?;
        }
        let Some(time) = simulation.advance()? else { return Ok(run) };
        run.error.push((time, simulation.value("controller.z_desired")? - simulation.value("plant.z")?));
        if simulation.value("plant.contact")? > 0.5 {
            run.fell = Some(time);
            return Ok(run);
        }
    }
}

/// Corrects the newest estimate and gives it to the controller.
fn hand_over(
    simulation: &mut Simulation,
    frame: f64,
    curve: Option<&Curve>,
    last: &mut Option<(f64, [f64; 2])>,
) -> Result<(), Error> {
    let estimate = [simulation.value("camera.q1_est")?, simulation.value("camera.q2_est")?];
    let error = curve.map_or([0.0; 2], |curve| curve.at(estimate[1]));
    let angles = [estimate[0] + error[0], estimate[1] + error[1]];
    let time = simulation.value("camera.t_mid")?;
    let rates = match *last {
        Some((before, old)) if time > before => [0, 1].map(|i| (angles[i] - old[i]) / (time - before)),
        _ => [0.0; 2],
    };
    *last = Some((time, angles));
    let inputs = [("q1", angles[0]), ("q2", angles[1]), ("dq1", rates[0]), ("dq2", rates[1])];
    for (name, value) in inputs {
        simulation.set(&format!("controller.{name}"), value)?;
    }
    Ok(simulation.set("controller.frame", frame as i32)?)
}
