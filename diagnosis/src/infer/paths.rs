//! Paths that follow a step of the parameters: each to the smoothed one, or a share of the way.

use super::fit::Path;
use super::linearised::Linearised;
use super::noise::Noise;
use super::smooth::smooth;
use rayon::prelude::*;

/// Moves every path to the smoothed one, after the parameters moved by `shift`; the largest move in units of the scales.
pub(super) fn smooth_paths(
    paths: &mut [Path],
    runs: &[Linearised],
    noise: &Noise,
    shift: &[f64],
    scales: &[f64],
) -> f64 {
    let shift: Vec<(usize, f64)> = shift.iter().copied().enumerate().collect();
    let moves: Vec<Vec<f64>> = runs.par_iter().map(|run| smooth(&run.shifted(&shift), noise).state).collect();
    let mut largest = 0.0;
    let own = scales.len().max(1);
    for ((path, moves), run) in paths.iter_mut().zip(&moves).zip(runs) {
        // states beyond the path's own are sensors' lags, which follow it
        for (path, moves) in path.chunks_mut(own).zip(moves.chunks(run.states.max(1))) {
            for ((state, by), scale) in path.iter_mut().zip(moves).zip(scales) {
                *state += by;
                largest = f64::max(largest, by.abs() / scale);
            }
        }
    }
    largest
}

/// Moves every path a share of the way to the smoothed one; the largest move in units of the scales.
pub(super) fn smooth_paths_damped(
    paths: &mut [Path],
    runs: &[Linearised],
    noise: &Noise,
    shift: &[f64],
    scales: &[f64],
    share: f64,
) -> f64 {
    let before = paths.to_vec();
    let moved = smooth_paths(paths, runs, noise, shift, scales);
    for (path, before) in paths.iter_mut().zip(&before) {
        path.iter_mut().zip(before).for_each(|(to, from)| *to = from + share * (*to - from));
    }
    share * moved
}
