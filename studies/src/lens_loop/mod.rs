//! Section 4.2.2, Figures 21 to 27: the closed loop behind a lens that distorts.

mod claims;

use crate::closed_loop::{Case, DAMPED, Poles, SETS, Trace, run_all};
use crate::walk::{Look, Walk};
use crate::{Bench, Error, Outcome, Study, four_graphs};
use rayon::prelude::*;
use report::{Axis, Cell, Graph, Line, Table};

/// Figures 21 to 27; C45 to C53.
pub const STUDY: Study = Study {
    id: "figures-21-27",
    title: "The closed loop under lens distortions (Section 4.2.2, Figures 21-27)",
    claims: &[
        "C45",
        "C46",
        "C47",
        "C48",
        "C48.k1",
        "C48.p1",
        "C48.p2",
        "C48.s1",
        "C48.s2",
        "C49",
        "C50",
        "C51",
        "C52",
        "C53",
        "S5.tangential",
        "F21",
        "F22",
        "F23",
        "F24",
        "F25",
        "F26",
        "F27",
    ],
    run,
};

/// One distortion.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Lens {
    parameter: &'static str,
    value: f64,
    /// The paper's figure, if it has one.
    figure: Option<&'static str>,
}

const fn lens(parameter: &'static str, value: f64, figure: Option<&'static str>) -> Lens {
    Lens { parameter, value, figure }
}

/// The paper's distortions, with the signs that it has no figure for.
const LENSES: [Lens; 9] = [
    lens("k1", 0.1, Some("Figure 21")),
    lens("k1", -0.1, Some("Figure 22")),
    lens("p1", 0.015, Some("Figure 23")),
    lens("p1", -0.015, Some("Figure 24")),
    lens("p2", 0.015, Some("Figure 25")),
    lens("p2", -0.015, None),
    lens("s1", 0.0125, Some("Figure 26")),
    lens("s2", 0.025, Some("Figure 27")),
    lens("s2", -0.025, None),
];

impl Lens {
    fn label(&self) -> String {
        format!("{} = {}", self.parameter, self.value)
    }

    fn variable(&self) -> String {
        format!("camera.{}", self.parameter)
    }

    /// The paper shows negative places only for k1, p1 and p2.
    fn is_shown_both_ways(&self) -> bool {
        !self.parameter.starts_with('s')
    }
}

/// Places at which a steady error is measured.
const PLACES: [f64; 9] = [-0.5, -0.375, -0.25, -0.125, 0.0, 0.125, 0.25, 0.375, 0.5];
/// Index of z = 0.
const UPRIGHT: usize = 4;
/// Index of z = 0.5.
const FAR: usize = 8;

/// Steady errors z_desired − z of one lens with one set of poles, at [`PLACES`]; NaN where it fell.
struct Stairs {
    lens: Lens,
    errors: [f64; 9],
}

impl Stairs {
    /// The largest magnitude; infinite where it fell.
    fn largest(&self) -> f64 {
        let size = |error: &f64| if error.is_finite() { error.abs() } else { f64::INFINITY };
        self.errors.iter().map(size).fold(0.0, f64::max)
    }

    fn at(&self, place: usize) -> f64 {
        self.errors[place]
    }

    fn is_stable(&self) -> bool {
        self.errors.iter().all(|error| error.is_finite())
    }
}

/// Holds at 0, ±1/8, ... ±1/2 for 9 s each, with ramps of 3 s between.
fn stairs(case: Case, side: f64) -> Case {
    let mut points = vec![(0.0, 0.0), (12.0, 0.0)];
    for step in 1..=4 {
        let (z, begin) = (0.125 * side * f64::from(step), 12.0 * f64::from(step));
        points.extend([(begin + 3.0, z), (begin + 12.0, z)]);
    }
    case.along(points, 60)
}

/// The error at the end of each hold: the mean of its last 4 s, in which the chatter averages out.
fn read(up: &Trace, down: &Trace) -> [f64; 9] {
    let at = |trace: &Trace, step: usize| {
        let end = 12.0 * (step + 1) as f64;
        trace.steady_error(end - 4.0, end)
    };
    std::array::from_fn(
        |place| if place >= UPRIGHT { at(up, place - UPRIGHT) } else { at(down, UPRIGHT - place) },
    )
}

/// Everything that was measured.
struct Measured {
    /// One for each of [`SETS`]: one for each of [`LENSES`].
    stairs: Vec<(Poles, Vec<Stairs>)>,
    /// The figures' runs.
    figures: Vec<(Lens, Trace)>,
    /// Whether larger distortions fall: (set, lens, trace).
    large: Vec<(Poles, Lens, Trace)>,
    /// Estimation error of s1 = 0.1 along the manifold.
    looks: Vec<Look>,
    /// The smallest value of each parameter with which `damped` falls on the way to z = 0.5.
    limits: Vec<(&'static str, f64)>,
}

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let measured = measure(bench)?;
    let mut outcome = Outcome::default();
    outcome.notes.push(
        "Figures 21 to 27 show the pole set `damped`. The paper's reference is unknown: 0 → 0.5 → 0 → −0.5 → 0 at \
         0.05/s on average where it speaks of both signs, and its positive half for thin prism. No noise, defocus, \
         delay or blur. Steady errors are read from stairs of nine places between z = −0.5 and 0.5, 9 s each."
            .to_owned(),
    );
    for (lens, trace) in &measured.figures {
        let figure = lens.figure.unwrap_or("beside the figures");
        four_graphs::add(&mut outcome, trace, figure, &format!("visual servo with {}", lens.label()))?;
    }
    for (_, stairs) in measured.stairs.iter().filter(|(poles, _)| *poles == DAMPED) {
        for (positive, words) in [(true, "positive"), (false, "negative")] {
            let caption = format!("Steady error over the place, pole set damped, {words} parameters.");
            outcome.figure(graph(stairs, positive)?, caption);
        }
    }
    outcome.claims = claims::claims(&measured)?;
    for (poles, stairs) in &measured.stairs {
        outcome.tables.push((format!("Steady error z_desired − z, pole set {}", poles.name), table(stairs)));
    }
    Ok(outcome)
}

fn measure(bench: &Bench) -> Result<Measured, Error> {
    let behind = |poles, lens: &Lens| Case::visual(poles).with(&lens.variable(), lens.value);
    let once = vec![(0.0, 0.0), (2.0, 0.0), (12.0, 0.5), (18.0, 0.5), (28.0, 0.0), (31.0, 0.0)];
    let shown: Vec<Lens> = LENSES.into_iter().filter(|lens| lens.figure.is_some()).collect();
    let large: Vec<(Poles, Lens)> = SETS
        .into_iter()
        .flat_map(|poles| {
            let [k1, p1] = if poles == DAMPED { [-0.3, 0.08] } else { [-0.15, 0.06] };
            [(poles, lens("k1", k1, None)), (poles, lens("p1", p1, None))]
        })
        .collect();
    let mut cases: Vec<Case> = shown
        .iter()
        .map(|lens| match lens.is_shown_both_ways() {
            true => behind(DAMPED, lens),
            false => behind(DAMPED, lens).along(once.clone(), 31),
        })
        .collect();
    let strong =
        |(poles, lens): &(Poles, Lens)| behind(*poles, lens).finding_everything().along(once.clone(), 31);
    cases.extend(large.iter().map(strong));
    for poles in SETS {
        for lens in &LENSES {
            cases.extend([1.0, -1.0].map(|side| stairs(behind(poles, lens), side)));
        }
    }
    let mut traces = run_all(bench, &cases)?.into_iter();
    let figures = shown.into_iter().zip(traces.by_ref()).collect();
    let large =
        large.into_iter().zip(traces.by_ref()).map(|((poles, lens), trace)| (poles, lens, trace)).collect();
    let mut measured = Measured {
        stairs: Vec::new(),
        figures,
        large,
        looks: Walk::new(bench, &[("s1", 0.1)])?.looks,
        limits: limits(bench)?,
    };
    for poles in SETS {
        let mut of_set = Vec::new();
        for lens in LENSES {
            if let (Some(up), Some(down)) = (traces.next(), traces.next()) {
                of_set.push(Stairs { lens, errors: read(&up, &down) });
            }
        }
        measured.stairs.push((poles, of_set));
    }
    Ok(measured)
}

/// For each parameter the smallest positive value with which the damped loop falls, within 2 %.
fn limits(bench: &Bench) -> Result<Vec<(&'static str, f64)>, Error> {
    let limit = |&parameter: &&'static str| {
        let course = vec![(0.0, 0.0), (2.0, 0.0), (12.0, 0.5)];
        let mut closed = Case::visual(DAMPED).finding_everything().along(course, 20).build(bench)?;
        let (mut stands, mut falls): (f64, f64) = (0.02, 0.4);
        while falls > 1.02 * stands {
            let middle = (stands * falls).sqrt();
            closed.set(&format!("camera.{parameter}"), middle)?;
            if closed.run()?.is_stable() { stands = middle } else { falls = middle }
        }
        Ok((parameter, falls))
    };
    ["k1", "p1", "p2", "s1", "s2"].par_iter().map(limit).collect()
}

fn graph(stairs: &[Stairs], positive: bool) -> Result<String, Error> {
    let mut graph = Graph::new(
        "Steady error, damped poles",
        Axis::fitted("z desired"),
        Axis::over("z desired − z", -0.15, 0.25), // room for the legend
    );
    for stairs in stairs.iter().filter(|stairs| (stairs.lens.value > 0.0) == positive) {
        let points = PLACES.into_iter().zip(stairs.errors).collect();
        let line = if positive { Line::solid } else { Line::dashed };
        graph = graph.with(line(stairs.lens.label(), points));
    }
    Ok(graph.to_svg()?)
}

/// An error, or that there is none.
fn size(error: f64) -> String {
    if error.is_finite() { format!("{error:.3}") } else { "falls".to_owned() }
}

fn table(stairs: &[Stairs]) -> Table {
    let head = std::iter::once("lens".to_owned()).chain(PLACES.map(|z| format!("z = {z}"))).collect();
    let rows = stairs.iter().map(|stairs| {
        let cells = stairs.errors.iter().map(|error| Cell::Number(size(*error)));
        std::iter::once(Cell::Text(stairs.lens.label())).chain(cells).collect()
    });
    Table { head, rows: rows.collect() }
}
