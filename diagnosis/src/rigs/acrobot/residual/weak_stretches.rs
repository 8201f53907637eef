//! Stretches of a log for the weak form: states on a grid, a test function, and what the log gives against it.

use super::trajectory::{State, average};
use crate::rigs::acrobot::dataset::row_times::unevenness;
use crate::rigs::acrobot::dataset::{DataSet, Table};
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::policy::RESIDUAL;
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
use std::collections::BTreeMap;

/// φ = (1 - s²)^POWER: its slopes vanish at the ends up to the third.
const POWER: i32 = 4;

/// A measured state with the torque there.
#[derive(Debug, Clone)]
pub struct Node {
    /// Index of the run.
    pub run: usize,
    /// s
    pub time: f64,
    /// q1, q2, dq1, dq2.
    pub state: State,
    /// Commanded torque, N·m.
    pub tau: f64,
    /// External torque on link 1, N·m.
    pub tau_1: f64,
}

/// A stretch of a run.
#[derive(Debug, Clone)]
pub struct Stretch {
    /// Index of the run.
    pub run: usize,
    /// s
    pub from: f64,
    /// s
    pub to: f64,
    /// Where the unit is asked: places among all nodes. Stretches overlap, and share those.
    pub nodes: Vec<usize>,
    /// φ times the distance between nodes.
    pub weights: Vec<f64>,
    /// ∫φ″q dt of the log, rad/s².
    pub measured: Vector2<f64>,
    /// What noise gives of it, rad/s².
    pub noise: [f64; 2],
    /// Torques (on link 1, at the joint) per acceleration.
    pub inertia: Matrix2<f64>,
}

impl Stretch {
    /// The node in the middle.
    pub fn middle(&self) -> usize {
        self.nodes[self.nodes.len() / 2]
    }

    /// What noise alone gives of the torques, N·m.
    pub fn floor(&self) -> [f64; 2] {
        [0, 1]
            .map(|row| (self.inertia[(row, 0)] * self.noise[0]).hypot(self.inertia[(row, 1)] * self.noise[1]))
    }
}

/// All stretches of a data set, and the nodes on which they lie.
pub fn stretches(data: &DataSet, contact: f64) -> (Vec<Stretch>, Vec<Node>) {
    let sigma = ["plant.q1", "plant.q2"]
        .map(|name| data.known_noise(name).filter(|sigma| *sigma > 0.0).unwrap_or(RESIDUAL.first_guess));
    let (mut all, mut nodes) = (Vec::new(), Vec::new());
    for (index, run) in data.runs.iter().enumerate() {
        let (Some(plant), Some(controller)) = (&run.plant, &run.controller) else { continue };
        let (Some(q1), Some(q2)) = (plant.column("q1"), plant.column("q2")) else { continue };
        let limit = q2.iter().position(|angle| angle.abs() >= contact - 0.02).unwrap_or(plant.len());
        let (begin, end) = run.driven();
        let driven = |row: &usize| (begin..=end).contains(&plant.time[*row]);
        let measured = |row: &usize| q1[*row].is_finite() && q2[*row].is_finite();
        let rows: Vec<usize> = (0..limit).filter(measured).filter(driven).collect();
        let log = Log {
            time: rows.iter().map(|row| plant.time[*row]).collect(),
            angles: [q1, q2].map(|q| rows.iter().map(|row| q[*row]).collect()),
            late: unevenness(&plant.time),
        };
        if log.time.len() > POLICY.rows as f64 as usize && log.tells_states() {
            let first = all.len();
            cut(&mut Grid::new(index, &log, controller, &mut nodes), &sigma, &mut all);
            let undriven = run.undriven();
            let known = |stretch: &Stretch| {
                undriven.iter().all(|span| span.0 >= stretch.to || span.1 <= stretch.from)
            };
            let mut place = 0;
            all.retain(|stretch| {
                place += 1;
                place <= first || known(stretch)
            });
        }
    }
    (all, nodes)
}

/// A plant's log: times, s, and angles, rad, of the rows that hold both.
struct Log {
    time: Vec<f64>,
    angles: [Vec<f64>; 2],
    /// By how much the timestamps may scatter, s: an angle is off by its rate times that.
    late: f64,
}

impl Log {
    /// Median time between rows, s.
    fn typical(&self) -> f64 {
        let mut gaps: Vec<f64> = self.time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        gaps.sort_by(f64::total_cmp);
        gaps[gaps.len() / 2]
    }

    /// Whether rows are so near to one another that a cubic through some of them is a state, and not another motion.
    fn tells_states(&self) -> bool {
        (RESIDUAL.around_rows - 1) as f64 * self.typical() < RESIDUAL.seen * RESIDUAL.length
    }
}

/// The nodes of one run, at even distances from its first row; half a stretch is a whole number of them.
struct Grid<'a> {
    run: usize,
    log: &'a Log,
    controller: &'a Table,
    length: f64,
    typical: f64,
    /// Nodes of a stretch, and s between them.
    count: usize,
    step: f64,
    /// By number from the first row on: the place among all nodes; `None` where the log says too little.
    known: BTreeMap<usize, Option<usize>>,
    all: &'a mut Vec<Node>,
}

impl<'a> Grid<'a> {
    /// A grid over the log of a run, with no node yet: as many steps to a stretch as the unit is asked for at most.
    fn new(run: usize, log: &'a Log, controller: &'a Table, all: &'a mut Vec<Node>) -> Self {
        let typical = log.typical();
        let length = RESIDUAL.length.max(POLICY.rows as f64 * typical);
        let count = 2 * (0.5 * length / RESIDUAL.grid).ceil() as usize;
        let step = length / count as f64;
        Self { run, log, controller, length, typical, count, step, known: BTreeMap::new(), all }
    }

    /// The node with a number.
    fn node(&mut self, number: usize) -> Option<usize> {
        if let Some(known) = self.known.get(&number) {
            return *known;
        }
        let made = self.made(number).map(|node| {
            self.all.push(node);
            self.all.len() - 1
        });
        self.known.insert(number, made);
        made
    }

    /// State and torques at a place of the grid; `None` where too few rows tell the state.
    fn made(&self, number: usize) -> Option<Node> {
        let time = self.log.time[0] + (number as f64 + 0.5) * self.step;
        let (q1, dq1) = local(self.log, 0, time)?;
        let (q2, dq2) = local(self.log, 1, time)?;
        let half = 0.5 * self.step;
        let held = |name: &str| match self.controller.column(name) {
            Some(_) => average(self.controller, name, time - half, time + half),
            None => 0.0,
        };
        let (tau, tau_1) = (held("tau"), held("tau_1"));
        Some(Node { run: self.run, time, state: [q1, q2, dq1, dq2], tau, tau_1 })
    }
}

/// Adds all stretches of a log, each half a length after the one before, but for those that lack rows. `sigma` are the angles' standard
/// deviations, rad.
fn cut(grid: &mut Grid<'_>, sigma: &[f64; 2], into: &mut Vec<Stretch>) {
    let time = &grid.log.time;
    let end = time[time.len() - 1];
    for half in 0.. {
        let from = time[0] + 0.5 * grid.length * f64::from(half);
        let to = from + grid.length;
        if to > end + 1e-9 {
            return;
        }
        let rows = time.partition_point(|t| *t < from)..time.partition_point(|t| *t <= to);
        if (rows.len() as f64) < 0.7 * grid.length / grid.typical || torn(time, &rows, grid) {
            continue;
        }
        let first = half as usize * (grid.count / 2);
        let nodes: Option<Vec<usize>> = (0..grid.count).map(|k| grid.node(first + k)).collect();
        if let Some(nodes) = nodes {
            into.push(stretch(grid, nodes, sigma, rows, (from, to)));
        }
    }
}

/// Whether rows are lacking that the integral over a stretch would miss.
fn torn(time: &[f64], rows: &std::ops::Range<usize>, grid: &Grid<'_>) -> bool {
    let most = (POLICY.steps * grid.typical).max(RESIDUAL.torn_share * grid.length);
    // with the neighbours: a gap at an end would weigh the last row too much
    let all = rows.start.saturating_sub(1)..(rows.end + 1).min(time.len());
    time[all].windows(2).any(|pair| pair[1] - pair[0] > most)
}

/// One stretch from its rows and nodes: the mean acceleration under the test function that the log's angles give, and its noise, rad/s².
fn stretch(
    grid: &Grid<'_>,
    nodes: Vec<usize>,
    sigma: &[f64; 2],
    rows: std::ops::Range<usize>,
    (from, to): (f64, f64),
) -> Stretch {
    let log = grid.log;
    let half = 0.5 * (to - from);
    let place = |time: f64| (time - from - half) / half;
    let first = rows.start.saturating_sub(1);
    let (mut measured, mut noise) = (Vector2::zeros(), [0.0; 2]);
    for axis in 0..2 {
        let values = &log.angles[axis][rows.clone()];
        let middle = values.iter().sum::<f64>() / values.len().max(1) as f64;
        for row in rows.clone() {
            // trapezoids; the ends don't count, φ″ is 0 there
            let before = log.time[row.saturating_sub(1).max(first)];
            let after = log.time[(row + 1).min(log.time.len() - 1)];
            let weight = 0.5 * (after - before) * second(place(log.time[row])) / (half * half * half * AREA);
            let rate = (log.angles[axis][(row + 1).min(log.time.len() - 1)]
                - log.angles[axis][row.saturating_sub(1).max(first)])
                / (after - before);
            measured[axis] += weight * (log.angles[axis][row] - middle);
            noise[axis] += (weight * sigma[axis].hypot(log.late * rate)).powi(2);
        }
        noise[axis] = noise[axis].sqrt();
    }
    let weigh = |node: &usize| grid.step * bump(place(grid.all[*node].time)) / (half * AREA);
    let weights = nodes.iter().map(weigh).collect();
    Stretch { run: grid.run, from, to, nodes, weights, measured, noise, inertia: Matrix2::zeros() }
}

/// ∫ φ ds from -1 to 1 (Wallis).
const AREA: f64 = {
    let (mut area, mut power) = (2.0, 1);
    while power <= POWER {
        area *= 1.0 - 1.0 / (2 * power + 1) as f64;
        power += 1;
    }
    area
};

/// The test function φ, 0 outside -1 to 1.
fn bump(s: f64) -> f64 {
    (1.0 - s * s).max(0.0).powi(POWER)
}

/// Second derivative of `bump`.
fn second(s: f64) -> f64 {
    let rest = (1.0 - s * s).max(0.0);
    let p = f64::from(POWER);
    -2.0 * p * rest.powi(POWER - 1) + 4.0 * p * (p - 1.0) * s * s * rest.powi(POWER - 2)
}

/// Angle and rate by a cubic through the rows around, least squares (Savitzky and Golay, Anal. Chem. 36 (1964) 1627).
fn local(log: &Log, axis: usize, time: f64) -> Option<(f64, f64)> {
    let at = log.time.partition_point(|t| *t < time);
    let (mut from, mut to) = (
        log.time.partition_point(|t| *t < time - POLICY.around),
        log.time.partition_point(|t| *t <= time + POLICY.around),
    );
    while to - from < RESIDUAL.around_rows && (from > 0 || to < log.time.len()) {
        // the nearer side first
        let left = if from > 0 { time - log.time[from - 1] } else { f64::INFINITY };
        let right = if to < log.time.len() { log.time[to] - time } else { f64::INFINITY };
        if left <= right { from -= 1 } else { to += 1 }
    }
    if to - from < 5 || at > log.time.len() {
        return None;
    }
    let scale = (log.time[to - 1] - log.time[from]).max(1e-9);
    let design = DMatrix::from_fn(to - from, 4, |row, power| {
        ((log.time[from + row] - time) / scale).powi(power as i32)
    });
    let middle = log.angles[axis][from];
    let values = DVector::from_fn(to - from, |row, _| log.angles[axis][from + row] - middle);
    let solved = crate::statistics::linear::solve(&design.tr_mul(&design), &design.tr_mul(&values))?;
    Some((middle + solved[0], solved[1] / scale))
}
