//! The most likely path and process noise, by the adjoint of the sweep (Bryson and Frazier), which inverts no covariance.
//!
//! λ̃ before a row's values and λ̂ after them obey λ̃ = (I - K H)ᵀ λ̂ - Hᵀ e/s and λ̂(k) = Aᵀ λ̃(k+1); then
//! x = m - P λ̂ and the process noise is w = -Q Gᵀ λ̃(k+1). Bierman, *Factorization Methods*, Academic Press 1977, X.

use super::linearised::Linearised;
use super::noise::Noise;
use super::sweep::{Interval, dimension, direction, sized, sweep_kept};

/// What is most likely, given all values of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    /// Deviation from the path, n numbers a row, in the states' units.
    pub state: Vec<f64>,
    /// The unlisted input at each row, if there is one.
    pub disturbance: Vec<f64>,
    /// Process noise of each equation held over each interval, n an interval, unit of the state per s.
    pub process: Vec<f64>,
}

/// Smooths a run.
pub fn smooth(run: &Linearised, noise: &Noise) -> Smoothed {
    sized!(run, noise; backward(run, noise))
}

fn backward<const N: usize>(run: &Linearised, noise: &Noise) -> Smoothed {
    let (_, kept) = sweep_kept(run, noise);
    let (n, rows) = (run.states, run.rows());
    let intervals = rows.saturating_sub(1);
    let mut smoothed = Smoothed {
        state: vec![0.0; rows * n],
        disturbance: if noise.disturbance.is_some() { vec![0.0; rows] } else { Vec::new() },
        process: vec![0.0; intervals * n],
    };
    let mut adjoint = [0.0; N];
    for row in (0..rows).rev() {
        for i in 0..dimension(run, noise) {
            let spread = &kept.covariance[(row * N + i) * N..(row * N + i + 1) * N];
            let pull: f64 = spread.iter().zip(&adjoint).map(|(p, adjoint)| p * adjoint).sum();
            let state = kept.mean[row * N + i] - pull;
            if i < n {
                smoothed.state[row * n + i] = state;
            } else {
                smoothed.disturbance[row] = state;
            }
        }
        for value in run.values(row).rev() {
            let variance = kept.variance[value];
            if variance.is_infinite() {
                continue;
            }
            let gain = &kept.gain[value * N..(value + 1) * N];
            let along: f64 = gain.iter().zip(&adjoint).map(|(gain, adjoint)| gain * adjoint).sum();
            let pull = (kept.innovation[value] + along) / variance;
            let observe = &run.observe[value * n..(value + 1) * n];
            adjoint.iter_mut().zip(observe).for_each(|(adjoint, h)| *adjoint -= h * pull);
        }
        if row > 0 {
            let step = Interval::<N>::new(run, noise, row - 1);
            processed(run, noise, row - 1, &adjoint, &mut smoothed.process[(row - 1) * n..row * n]);
            adjoint =
                std::array::from_fn(|j| (0..N).map(|i| step.transition[i][j] * adjoint[i]).sum::<f64>());
        }
    }
    smoothed
}

/// -Q Gᵀ λ̃, equation by equation.
fn processed<const N: usize>(
    run: &Linearised,
    noise: &Noise,
    row: usize,
    adjoint: &[f64; N],
    into: &mut [f64],
) {
    let dt = run.interval(row);
    for (equation, into) in into.iter_mut().enumerate() {
        // a sensor's lag has none
        let q = noise.process.get(equation).copied().unwrap_or(0.0);
        let along: f64 = (0..run.states).map(|i| direction(run, row, equation, i) * adjoint[i]).sum();
        *into = -q * q / dt * along;
    }
}
