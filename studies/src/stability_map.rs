//! Frame rate against total delay: where the loop is stable by theory, and where it is when simulated.

use crate::closed_loop::{Case, ClosedLoop, DAMPED, Poles};
use crate::{Bench, Claim, Error, Outcome, Study};
use mechanics::{Linearisation, Place, Rates, Sampling, Theta};
use rayon::prelude::*;
use report::{Axis, Cell, Contour, HeatMap, Table};

/// The stability map.
pub const STUDY: Study =
    Study { id: "stability-map", title: "Frame rate against delay: a stability map", claims: &["Map"], run };

/// The pole set of the shipped scenarios.
const POLES: Poles = DAMPED;
/// Frame rates, Hz.
const RATES: [u16; 28] = [
    5, 6, 8, 10, 11, 12, 13, 14, 15, 16, 18, 20, 22, 24, 27, 30, 33, 36, 40, 44, 48, 53, 58, 64, 80, 120,
    160, 240,
];
/// Total delays in eighths of a period: 0 ... 3 periods.
const EIGHTHS: std::ops::RangeInclusive<u16> = 0..=24;
/// Parts of a period at which the units communicate, so that every delay of the map falls on such a point even where
/// half a period of it is the shutter's.
const PARTS: u16 = 8;
/// Places on the manifold; a cell is stable if the loop is so at all of them.
const PLACES: [f64; 3] = [0.0, 0.25, 0.5];
/// How far from the equilibrium q₁ begins, rad: enough to see a slow growth within a run.
const KICK: f64 = 0.01;

/// How the delay comes about.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shutter {
    /// E_t = 0.01; the rest is T_delay.
    Short,
    /// Open as long as the total delay allows: E_t = twice the delay up to 1; the rest is T_delay.
    Open,
}

impl Shutter {
    /// E_t, and T_delay in periods.
    fn split(self, delay: f64) -> (f64, f64) {
        match self {
            // Half of E_t = 0.01 is less than anything that is resolved here; T_delay stays on the grid.
            Shutter::Short => (0.01, delay),
            Shutter::Open => {
                let exposure = (2.0 * delay).clamp(0.01, 1.0);
                (exposure, (delay - 0.5).max(0.0))
            }
        }
    }
}

fn periods(eighths: u16) -> f64 {
    f64::from(eighths) / 8.0
}

/// A cell: what theory and simulation say.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Square {
    rate: u16,
    delay: f64,
    /// Growth over a second by theory: ρ^rate, the largest of the places.
    growth: f64,
    simulated: bool,
}

impl Square {
    fn agrees(&self) -> bool {
        (self.growth < 1.0) == self.simulated
    }
}

fn mechanics(error: mechanics::MechanicsError) -> Error {
    Error::Mechanics(error.to_string())
}

fn run(bench: &Bench) -> Result<Outcome, Error> {
    let mut outcome = Outcome::default();
    outcome.notes.push(format!(
        "Pole set {}. A blue cell loses balance when simulated: let go at rest {KICK} rad beside the manifold at z = 0, 0.25 or \
         0.5, through the rendering camera. The line is the analytic boundary: the largest spectral radius of the \
         sampled loop (plant linearised at these places, torque held, first-order differences, total delay) is 1. \
         Total delay = T_delay + E_t·T/2. In the second map the shutter is open as long as the total delay allows: \
         E_t is twice the delay, and 1 from half a period on.",
        POLES.name
    ));
    let boundary = boundary()?;
    let maps = [(Shutter::Short, "E_t = 0.01"), (Shutter::Open, "E_t = 1 from half a period on")];
    let mut counts = Vec::new();
    for (shutter, words) in maps {
        let squares = simulate(bench, shutter)?;
        outcome.figure(draw(&squares, &boundary, words)?, format!("Stability map, {words}."));
        counts.push((words, squares));
    }
    outcome.claims.push(statement(&counts));
    outcome.tables.push(("Cells on which theory and simulation differ".to_owned(), differing(&counts)));
    Ok(outcome)
}

/// The plant at [`PLACES`].
fn plants() -> Result<Vec<Linearisation>, Error> {
    let place = Place::new(&Theta::TABLE_2).map_err(mechanics)?;
    PLACES.iter().map(|z| Theta::TABLE_2.linearisation(place.q2(*z)).map_err(mechanics)).collect()
}

/// The largest spectral radius over the places.
fn radius(plants: &[Linearisation], rate: f64, delay: f64) -> Result<f64, Error> {
    let sampling = Sampling { period: 1.0 / rate, delay: delay / rate, rates: Rates::FirstDifference };
    plants.iter().try_fold(0.0, |largest: f64, plant| {
        Ok(largest.max(plant.spectral_radius(POLES.polynomial(), &sampling).map_err(mechanics)?))
    })
}

/// The analytic boundary: (log₁₀ rate, delay in periods), where there is one below 3 periods.
fn boundary() -> Result<Vec<(f64, f64)>, Error> {
    const POINTS: u32 = 120;
    let plants = plants()?;
    let at = |point: u32| {
        let rate = 5.0 * (240f64 / 5.0).powf(f64::from(point) / f64::from(POINTS));
        let (mut low, mut high) = (0.0, 3.0);
        if radius(&plants, rate, low)? >= 1.0 || radius(&plants, rate, high)? < 1.0 {
            return Ok(None);
        }
        for _ in 0..12 {
            let middle = 0.5 * (low + high);
            if radius(&plants, rate, middle)? < 1.0 { low = middle } else { high = middle }
        }
        Ok(Some((rate.log10(), low)))
    };
    let points = (0..=POINTS).into_par_iter().map(at).collect::<Result<Vec<_>, Error>>()?;
    Ok(points.into_iter().flatten().collect())
}

/// All cells, rate by rate.
fn simulate(bench: &Bench, shutter: Shutter) -> Result<Vec<Square>, Error> {
    let plants = plants()?;
    let columns: Vec<(u16, f64)> = RATES.iter().flat_map(|&rate| PLACES.map(|z| (rate, z))).collect();
    let stable = columns
        .par_iter()
        .map(|&(rate, z)| column(bench, shutter, rate, z))
        .collect::<Result<Vec<_>, Error>>()?;
    let mut squares = Vec::new();
    for (rate, stable) in RATES.iter().zip(stable.chunks(PLACES.len())) {
        for (index, eighths) in EIGHTHS.enumerate() {
            let delay = periods(eighths);
            squares.push(Square {
                rate: *rate,
                delay,
                growth: radius(&plants, f64::from(*rate), delay)?.powi(i32::from(*rate)),
                simulated: stable.iter().all(|of_place| of_place[index]),
            });
        }
    }
    Ok(squares)
}

/// Whether the loop is stable, for each delay, at one rate and place. One instance of each unit serves the column.
fn column(bench: &Bench, shutter: Shutter, rate: u16, z: f64) -> Result<Vec<bool>, Error> {
    let place = Place::new(&Theta::TABLE_2).map_err(mechanics)?;
    let q2 = place.q2(z);
    let q1 = Theta::TABLE_2.manifold_q1(q2).map_err(mechanics)? + KICK;
    // A fast loop that grows at all grows within fewer seconds.
    let seconds = if rate <= 64 { 10 } else { 3 };
    let case =
        Case::visual(POLES).with("camera.omega_cam", rate).every(rate, PARTS).resting([q1, q2], z, seconds);
    let mut closed: ClosedLoop = case.build(bench)?;
    let mut stable = Vec::new();
    for eighths in EIGHTHS {
        let (exposure, processing) = shutter.split(periods(eighths));
        closed.set("camera.E_t", exposure)?;
        closed.set("camera.T_delay", processing / f64::from(rate))?;
        stable.push(closed.run()?.is_stable());
    }
    Ok(stable)
}

fn draw(squares: &[Square], boundary: &[(f64, f64)], words: &str) -> Result<String, Error> {
    let logs: Vec<f64> = RATES.iter().map(|rate| f64::from(*rate).log10()).collect();
    let mut x_edges = vec![logs[0]];
    x_edges.extend(logs.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])));
    x_edges.extend(logs.last());
    let y_edges: Vec<f64> =
        EIGHTHS.chain([25]).map(|eighths| (periods(eighths) - 0.0625).clamp(0.0, 3.0)).collect();
    let rows = EIGHTHS.count();
    // Squares run delay by delay within a rate; the map wants them rate by rate within a delay.
    let values = (0..rows)
        .flat_map(|row| (0..RATES.len()).map(move |column| column * rows + row))
        .map(|at| if squares[at].simulated { 0.0 } else { 0.6 })
        .collect();
    let map = HeatMap {
        title: format!("Stable (white) and falling (blue), {words}"),
        x: Axis::over("frame rate in Hz", 5f64.log10(), 240f64.log10()),
        y: Axis::over("total delay in periods", 0.0, 3.0),
        log_x: true,
        ticks: Default::default(),
        x_edges,
        y_edges,
        values,
        contours: vec![Contour { label: "spectral radius 1 (theory)".to_owned(), points: boundary.to_vec() }],
        bar: None,
    };
    Ok(map.to_svg()?)
}

fn statement(counts: &[(&str, Vec<Square>)]) -> Claim {
    let all = || counts.iter().flat_map(|(_, squares)| squares);
    let total = all().count();
    let agreeing = all().filter(|square| square.agrees()).count();
    let share = agreeing as f64 / total as f64;
    let worst =
        all().filter(|square| !square.agrees()).map(|square| square.growth.ln().abs()).fold(0.0, f64::max);
    Claim::new(
        [
            "Map",
            "analytic and simulated stability over frame rate and delay",
            "no statement: nobody drew it then",
        ],
        format!(
            "{agreeing} of {total} cells agree ({:.1} %); where they differ theory grows or shrinks by at most \
             e^{worst:.1} in a second",
            100.0 * share
        ),
        "at least 95 % of the cells",
        share >= 0.95,
        "a slowly growing motion does not fall within a run, and far from the manifold or under the noise of \
         differencing a linear boundary is not the whole truth",
    )
    .measurement()
}

fn differing(counts: &[(&str, Vec<Square>)]) -> Table {
    let head = ["shutter", "rate in Hz", "delay in periods", "growth in a second by theory", "simulated"];
    let rows = counts.iter().flat_map(|(words, squares)| {
        squares.iter().filter(|square| !square.agrees()).map(move |square| {
            vec![
                Cell::from(*words),
                Cell::Number(square.rate.to_string()),
                Cell::Number(format!("{:.3}", square.delay)),
                Cell::Number(format!("{:.3}", square.growth)),
                Cell::from(if square.simulated { "stable" } else { "unstable" }),
            ]
        })
    });
    Table { head: head.map(str::to_owned).to_vec(), rows: rows.collect() }
}
