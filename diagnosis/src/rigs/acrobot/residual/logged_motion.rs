//! Motion straight from the encoders, for runs without a torque that could drive the plant along them.
//!
//! A cubic spline through the rows: nothing is smoothed, so that what is known of the motion is what is known of a row.

use super::trajectory::{Motion, State};
use crate::rigs::acrobot::dataset::Run;
use crate::rigs::acrobot::dataset::policy::LOGS;
use crate::rigs::acrobot::residual::policy::RESIDUAL;
use crate::statistics::levels::MIDDLE;
use crate::statistics::median::median;

/// The motion of a run as its encoders have it, and how well it is known (rad): what rows scatter by about the cubic through
/// their neighbours, which holds noise and what a spline misses. `None` without angles close enough to each other, or where they
/// cover no image.
pub fn motion(run: &Run) -> Option<(Motion, f64)> {
    let log = run.plant.as_ref()?;
    let (q1, q2) = (log.column("q1")?, log.column("q2")?);
    let rows = (0..log.len()).filter(|row| q1[*row].is_finite() && q2[*row].is_finite());
    let mut stretches: Vec<Vec<(f64, [f64; 2])>> = Vec::new();
    for row in rows {
        let (time, angles) = (log.time[row], [q1[row], q2[row]]);
        match stretches.last_mut() {
            Some(last) if last.last().is_some_and(|before| time - before.0 <= LOGS.torn) => {
                last.push((time, angles))
            }
            _ => stretches.push(vec![(time, angles)]),
        }
    }
    stretches.retain(|stretch| stretch.len() >= RESIDUAL.fewest);
    // of a normal distribution
    let sigma = median(stretches.iter().flat_map(|stretch| misses(stretch)))? / MIDDLE;
    let splined = |stretch: &Vec<(f64, [f64; 2])>| {
        let times: Vec<f64> = stretch.iter().map(|row| row.0).collect();
        let rates = [0, 1].map(|angle| rates(stretch, angle));
        let state = |(row, at): (usize, &(f64, [f64; 2]))| -> State {
            [at.1[0], at.1[1], rates[0][row], rates[1][row]]
        };
        let states = stretch.iter().enumerate().map(state).collect();
        (times, states)
    };
    let motion = Motion { stretches: stretches.iter().map(splined).collect() };
    let pictures = run.camera.iter().flat_map(|log| &log.time);
    pictures.into_iter().any(|time| motion.at(*time).is_some()).then_some((motion, sigma))
}

/// How far rows lie from the cubic through the two on either side, in standard deviations of a row's own noise.
fn misses(rows: &[(f64, [f64; 2])]) -> Vec<f64> {
    let mut all = Vec::new();
    for five in rows.windows(5) {
        let others = [0, 1, 3, 4];
        // Lagrange
        let weight = |own: usize| {
            let rest = others.iter().filter(|other| **other != own);
            rest.map(|other| (five[2].0 - five[*other].0) / (five[own].0 - five[*other].0)).product::<f64>()
        };
        let weights = others.map(weight);
        let noise = (1.0 + weights.iter().map(|weight| weight * weight).sum::<f64>()).sqrt();
        for angle in 0..2 {
            let cubic: f64 =
                others.iter().zip(weights).map(|(own, weight)| weight * five[*own].1[angle]).sum();
            all.push((five[2].1[angle] - cubic).abs() / noise);
        }
    }
    all
}

/// Slopes of the cubic spline through an angle's rows that has no bend at its ends (de Boor, A Practical Guide to Splines, IV).
fn rates(rows: &[(f64, [f64; 2])], angle: usize) -> Vec<f64> {
    let n = rows.len();
    let gap = |row: usize| rows[row + 1].0 - rows[row].0;
    let slope = |row: usize| (rows[row + 1].1[angle] - rows[row].1[angle]) / gap(row);
    let (mut below, mut middle, mut above, mut right) =
        (vec![0.0; n], vec![2.0; n], vec![0.0; n], vec![0.0; n]);
    (above[0], right[0]) = (1.0, 3.0 * slope(0));
    (below[n - 1], right[n - 1]) = (1.0, 3.0 * slope(n - 2));
    for row in 1..n - 1 {
        let (before, after) = (gap(row - 1), gap(row));
        (below[row], middle[row], above[row]) = (after, 2.0 * (before + after), before);
        right[row] = 3.0 * (after * slope(row - 1) + before * slope(row));
    }
    // Thomas: the middle outweighs its neighbours in every row
    for row in 1..n {
        let by = below[row] / middle[row - 1];
        middle[row] -= by * above[row - 1];
        right[row] -= by * right[row - 1];
    }
    right[n - 1] /= middle[n - 1];
    for row in (0..n - 1).rev() {
        right[row] = (right[row] - above[row] * right[row + 1]) / middle[row];
    }
    right
}
