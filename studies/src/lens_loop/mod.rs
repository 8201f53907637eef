//! Section 4.2.2, Figures 21 to 27: the closed loop behind a lens that distorts.

mod claims;
mod growth;

use crate::closed_loop::{Case, DAMPED, Poles, SETS, Trace, run_all};
use crate::lens::Lens as Equations;
use crate::walk::{Look, Walk};
use crate::{Bench, Error, Outcome, Study, four_graphs, lever};
use mechanics::{Place, Theta};
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

    /// z_desired − z at a place by the equations of the lens and first-order theory, pole set `damped`.
    fn theory(&self, z_desired: f64) -> Result<f64, Error> {
        lever::rest(Equations::with(self.parameter, self.value), &DAMPED, z_desired)
    }

    fn variable(&self) -> String {
        format!("camera.{}", self.parameter)
    }

    /// The paper shows negative places only for k1, p1 and p2.
    fn is_shown_both_ways(&self) -> bool {
        !self.parameter.starts_with('s')
    }
}

/// Places at which a steady error is measured. The outermost are near the arm's end, z = 0.66.
const PLACES: [f64; 11] = [-0.6, -0.5, -0.375, -0.25, -0.125, 0.0, 0.125, 0.25, 0.375, 0.5, 0.6];
/// Index of z = 0.
const UPRIGHT: usize = 5;
/// Index of z = 0.5.
const FAR: usize = 9;
/// Index of the place on the other arm.
const fn opposite(place: usize) -> usize {
    PLACES.len() - 1 - place
}

/// Steady errors z_desired − z of one lens with one set of poles, at [`PLACES`]; NaN where it fell or was not asked.
struct Stairs {
    lens: Lens,
    errors: [f64; 11],
}

impl Stairs {
    /// The errors from z = −0.5 to 0.5, where the paper's figures end.
    fn figured(&self) -> &[f64] {
        &self.errors[opposite(FAR)..=FAR]
    }

    /// The largest magnitude there; infinite where it fell.
    fn largest(&self) -> f64 {
        let size = |error: &f64| if error.is_finite() { error.abs() } else { f64::INFINITY };
        self.figured().iter().map(size).fold(0.0, f64::max)
    }

    fn at(&self, place: usize) -> f64 {
        self.errors[place]
    }

    fn is_stable(&self) -> bool {
        self.figured().iter().all(|error| error.is_finite())
    }
}

/// Steps of the stairs: to ±0.6 with `damped`, to ±0.5 with the other sets.
fn steps(poles: Poles) -> usize {
    if poles == DAMPED { UPRIGHT } else { FAR - UPRIGHT }
}

/// Holds at the places of one arm for 9 s each, with ramps of 3 s between.
fn stairs(case: Case, side: f64, steps: usize) -> Case {
    let mut points = vec![(0.0, 0.0), (12.0, 0.0)];
    let mut end: u16 = 12;
    for z in PLACES.iter().skip(UPRIGHT + 1).take(steps) {
        let begin = f64::from(end);
        points.extend([(begin + 3.0, side * z), (begin + 12.0, side * z)]);
        end += 12;
    }
    case.along(points, end)
}

/// The error at the end of each hold: the mean of its last 4 s, in which the chatter averages out.
fn read(up: &Trace, down: &Trace) -> [f64; 11] {
    let at = |trace: &Trace, step: usize| {
        let end = 12.0 * (step + 1) as f64;
        if trace.times.last().is_some_and(|last| *last >= end - 1e-9) {
            trace.steady_error(end - 4.0, end)
        } else {
            f64::NAN
        }
    };
    std::array::from_fn(
        |place| if place >= UPRIGHT { at(up, place - UPRIGHT) } else { at(down, UPRIGHT - place) },
    )
}

/// Steady errors over z, each from a rest of its own on the manifold.
struct Fine {
    lens: Lens,
    errors: Vec<(f64, f64)>,
}

/// The two whose curves have the shape of a W, with `damped`.
fn fine(bench: &Bench) -> Result<Vec<Fine>, Error> {
    const HALF: i32 = 12;
    let place = Place::new(&Theta::TABLE_2).map_err(|why| Error::Mechanics(why.to_string()))?;
    let shown = [lens("p1", 0.015, None), lens("s1", 0.0125, None)];
    let places: Vec<f64> = (-HALF..=HALF).map(|step| 0.6 * f64::from(step) / f64::from(HALF)).collect();
    let case = |lens: &Lens, z: f64| {
        let start = crate::lens::on_manifold(place.q2(z));
        Case::visual(DAMPED).with(&lens.variable(), lens.value).resting(start, z, 12)
    };
    let cases: Vec<Case> = shown.iter().flat_map(|lens| places.iter().map(|z| case(lens, *z))).collect();
    let errors: Vec<f64> =
        run_all(bench, &cases)?.iter().map(|trace| trace.steady_error(6.0, 12.0)).collect();
    let of = |(lens, errors): (Lens, &[f64])| Fine {
        lens,
        errors: places.iter().copied().zip(errors.iter().copied()).collect(),
    };
    Ok(shown.into_iter().zip(errors.chunks_exact(places.len())).map(of).collect())
}

/// Everything that was measured.
struct Measured {
    /// One for each of [`SETS`]: one for each of [`LENSES`].
    stairs: Vec<(Poles, Vec<Stairs>)>,
    /// The figures' runs.
    figures: Vec<(Lens, Trace)>,
    /// Whether larger distortions fall: (set, lens, trace).
    large: Vec<(Poles, Lens, Trace)>,
    /// What the camera makes of the manifold with s1 of Figure 26.
    looks: Vec<Look>,
    /// The two curves over z that have the shape of a W.
    fine: Vec<Fine>,
    /// The smallest value of each parameter with which `damped` loses balance on the way to z = 0.5.
    limits: Vec<(&'static str, f64)>,
}

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let measured = measure(bench)?;
    let mut outcome = Outcome::default();
    outcome.notes.push(
        "Figures 21 to 27 show the pole set `damped`. The paper's reference is unknown: 0 → 0.5 → 0 → −0.5 → 0 at \
         0.05/s on average where it speaks of both signs, and its positive half for thin prism. No noise, defocus, \
         delay or blur. Steady errors are read from stairs of places between z = −0.5 and 0.5, with `damped` between \
         −0.6 and 0.6, 9 s each. By theory: what the equations of the lens and the loop's polynomial give, to first order."
            .to_owned(),
    );
    for (lens, trace) in &measured.figures {
        let figure = lens.figure.unwrap_or("beside the figures");
        four_graphs::add(&mut outcome, trace, figure, &format!("visual servo with {}", lens.label()))?;
    }
    for (_, stairs) in measured.stairs.iter().filter(|(poles, _)| *poles == DAMPED) {
        for (positive, words) in [(true, "positive"), (false, "negative")] {
            let caption = format!("Steady error over the place, pole set damped, {words} parameters.");
            outcome.graph(graph(stairs, positive)?, caption)?;
        }
    }
    outcome.graph(
        growth::figure(&measured.fine)?,
        "The size of the steady error over the place, pole set damped: for p1 it has the shape of a W, at whose bottoms \
         z = ±0.5 lies. At the ends of the arm it is larger than at z = 0, as Section 5 says.",
    )?;
    outcome.claims = claims::claims(&measured)?;
    for (poles, stairs) in &measured.stairs {
        outcome
            .tables
            .push((format!("Steady error z_desired − z, pole set {}", poles.name), table(*poles, stairs)));
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
            cases.extend([1.0, -1.0].map(|side| stairs(behind(poles, lens), side, steps(poles))));
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
        looks: Walk::new(bench, &[("s1", 0.0125)])?.looks,
        fine: fine(bench)?,
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

/// For each parameter the smallest positive value with which the damped loop loses balance, within 2 %.
fn limits(bench: &Bench) -> Result<Vec<(&'static str, f64)>, Error> {
    let limit = |&parameter: &&'static str| {
        let course = vec![(0.0, 0.0), (2.0, 0.0), (12.0, 0.5)];
        let mut closed = Case::visual(DAMPED).finding_everything().along(course, 20).build(bench)?;
        let (mut stable, mut unstable): (f64, f64) = (0.02, 0.4);
        while unstable > 1.02 * stable {
            let middle = (stable * unstable).sqrt();
            closed.set(&format!("camera.{parameter}"), middle)?;
            if closed.run()?.is_stable() { stable = middle } else { unstable = middle }
        }
        Ok((parameter, unstable))
    };
    ["k1", "p1", "p2", "s1", "s2"].par_iter().map(limit).collect()
}

fn graph(stairs: &[Stairs], positive: bool) -> Result<Graph, Error> {
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
    Ok(graph)
}

/// An error, or that there is none.
fn size(error: f64) -> String {
    if error.is_finite() { format!("{error:.3}") } else { "unstable".to_owned() }
}

fn table(poles: Poles, stairs: &[Stairs]) -> Table {
    let head = std::iter::once("lens".to_owned()).chain(PLACES.map(|z| format!("z = {z}"))).collect();
    let rows = stairs.iter().map(|stairs| {
        let asked = |place: usize| steps(poles) == UPRIGHT || (opposite(FAR)..=FAR).contains(&place);
        let cell = |(place, error): (usize, &f64)| match asked(place) {
            true => Cell::Number(size(*error)),
            false => Cell::Number("-".to_owned()),
        };
        let cells = stairs.errors.iter().enumerate().map(cell);
        std::iter::once(Cell::Text(stairs.lens.label())).chain(cells).collect()
    });
    Table { head, rows: rows.collect() }
}
