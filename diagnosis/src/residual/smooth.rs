//! Stretches of a log for the weak form: states on a grid, a test function, and what the log gives against it.

use super::trajectory::{State, average};
use crate::dataset::{DataSet, Run, Table};
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

/// Length of a stretch, s; at least so many rows; the next one begins half of it later.
const LENGTH: f64 = 0.3;
const ROWS: f64 = 12.0;
/// Most time between states at which the unit is asked, s.
const GRID: f64 = 0.008;
/// A state is read off a local cubic over rows this far to either side, s, and at least so many rows in all.
const AROUND: f64 = 0.03;
const AROUND_ROWS: usize = 7;
/// Standard deviation of an angle where none is stated, rad.
const FIRST_GUESS: f64 = 1e-3;
/// φ = (1 - s²)^POWER: its slopes vanish at the ends up to the third.
const POWER: i32 = 4;

/// A measured state with the torque there.
#[derive(Debug, Clone)]
pub struct Node {
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
    /// Where the unit is asked.
    pub nodes: Vec<Node>,
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
    pub fn middle(&self) -> &Node {
        &self.nodes[self.nodes.len() / 2]
    }

    /// What noise alone gives of the torques, N·m.
    pub fn floor(&self) -> [f64; 2] {
        [0, 1]
            .map(|row| (self.inertia[(row, 0)] * self.noise[0]).hypot(self.inertia[(row, 1)] * self.noise[1]))
    }
}

/// All stretches of a data set.
pub fn stretches(data: &DataSet, contact: f64) -> Vec<Stretch> {
    let sigma = ["plant.q1", "plant.q2"]
        .map(|name| data.known_noise(name).filter(|sigma| *sigma > 0.0).unwrap_or(FIRST_GUESS));
    let mut all = Vec::new();
    for (index, run) in data.runs.iter().enumerate() {
        let (Some(plant), Some(controller)) = (&run.plant, &run.controller) else { continue };
        let (Some(q1), Some(q2)) = (plant.column("q1"), plant.column("q2")) else { continue };
        let fallen = q2.iter().position(|angle| angle.abs() >= contact - 0.02).unwrap_or(plant.len());
        let rows: Vec<usize> =
            (0..fallen).filter(|row| q1[*row].is_finite() && q2[*row].is_finite()).collect();
        let log = Log {
            time: rows.iter().map(|row| plant.time[*row]).collect(),
            angles: [q1, q2].map(|q| rows.iter().map(|row| q[*row]).collect()),
        };
        if log.time.len() > ROWS as usize {
            cut(index, run, &log, controller, &sigma, &mut all);
        }
    }
    all
}

struct Log {
    time: Vec<f64>,
    angles: [Vec<f64>; 2],
}

fn cut(index: usize, run: &Run, log: &Log, controller: &Table, sigma: &[f64; 2], into: &mut Vec<Stretch>) {
    let mut gaps: Vec<f64> = log.time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps.sort_by(f64::total_cmp);
    let typical = gaps[gaps.len() / 2];
    let length = LENGTH.max(ROWS * typical);
    let mut from = log.time[0];
    let end = log.time[log.time.len() - 1];
    while from + length <= end + 1e-9 {
        let rows = log.time.partition_point(|t| *t < from)..log.time.partition_point(|t| *t <= from + length);
        let whole = rows.len() as f64 >= 0.7 * length / typical;
        if whole
            && let Some(stretch) = stretch(index, run, log, controller, sigma, rows, (from, from + length))
        {
            into.push(stretch);
        }
        from += 0.5 * length;
    }
}

fn stretch(
    index: usize,
    run: &Run,
    log: &Log,
    controller: &Table,
    sigma: &[f64; 2],
    rows: std::ops::Range<usize>,
    (from, to): (f64, f64),
) -> Option<Stretch> {
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
            measured[axis] += weight * (log.angles[axis][row] - middle);
            noise[axis] += weight * weight * sigma[axis] * sigma[axis];
        }
        noise[axis] = noise[axis].sqrt();
    }
    let count = ((to - from) / GRID).ceil() as usize;
    let step = (to - from) / count as f64;
    let mut nodes = Vec::with_capacity(count);
    let mut weights = Vec::with_capacity(count);
    for k in 0..count {
        let time = from + (k as f64 + 0.5) * step;
        let (q1, dq1) = local(log, 0, time)?;
        let (q2, dq2) = local(log, 1, time)?;
        let held = |name: &str| {
            let all = controller.column(name).is_some();
            if all { average(controller, name, time - 0.5 * step, time + 0.5 * step) } else { 0.0 }
        };
        nodes.push(Node { time, state: [q1, q2, dq1, dq2], tau: held("tau"), tau_1: held("tau_1") });
        weights.push(step * bump(place(time)) / (half * AREA));
    }
    debug_assert!(run.plant.is_some());
    Some(Stretch { run: index, from, to, nodes, weights, measured, noise, inertia: Matrix2::zeros() })
}

/// ∫ (1 - s²)⁴ ds from -1 to 1.
const AREA: f64 = 256.0 / 315.0;

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
    let (mut from, mut to) =
        (log.time.partition_point(|t| *t < time - AROUND), log.time.partition_point(|t| *t <= time + AROUND));
    while to - from < AROUND_ROWS && (from > 0 || to < log.time.len()) {
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
