//! What noise alone leaves of a signal, whatever a model lacks.
//!
//! A gap that closes is measured against this. Were it what the amended model itself leaves, any model would close all of the gap that
//! it was fitted to. So it is what the data set states, or what scatters where nothing but the data speak:
//! - Torques that were read off a log: what its noise gives them.
//! - Angles and rates of a plant: after a free start state and free torques in each part of each window.
//! - An image: about a linear function of pose and rates and a square one of time over a dozen neighbouring frames, with the nominal or the fitted model,
//!   whichever draws it nearer on the pixel lattice. Whatever a lens, a mount or a delay does to an image changes slowly with these; noise
//!   doesn't.

use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::residual::studio::COLUMNS;
use crate::rigs::acrobot::selection::Evaluation;
use crate::statistics::levels::ROUNDING;
use crate::statistics::linear::bare;

/// For each signal the standard deviation that noise gives a row. `nominal` is the model that nothing was fitted to; of `last` only
/// the scatter within windows counts, in which everything is free.
pub fn estimate(nominal: &Evaluation, last: &Evaluation, signals: &[Signal]) -> Vec<f64> {
    let within = |s: usize| nominal.seen[s].min(last.seen[s]).max(signals[s].least);
    (0..signals.len())
        .map(|s| {
            let signal = &signals[s];
            if let Some(noise) = of_torques(nominal, s) {
                return noise;
            }
            if !signal.name.starts_with("camera.") || s >= COLUMNS.len() {
                return signal.known.unwrap_or_else(|| within(s));
            }
            // what is seen elsewhere on the pixel lattice than a model draws it has another error of the lattice there, from frame to frame: of both
            // models the one that draws it nearer
            let scatter = || [nominal, last].into_iter().filter_map(|model| local(model, s)).reduce(f64::min);
            // frames that renderers draw otherwise, and noise
            let scatter = signal.known.or_else(scatter).unwrap_or_else(|| within(s));
            scatter.hypot(signal.tolerance)
        })
        .collect()
}

/// What noise of the log gives torques that were read off it, root mean square; `None` of other signals.
fn of_torques(nominal: &Evaluation, signal: usize) -> Option<f64> {
    let cells = nominal.blocks.iter().flat_map(|block| &block.cells).filter(|cell| !cell.floor.is_empty());
    let floors =
        cells.flat_map(|cell| cell.signal.iter().zip(&cell.floor)).filter(|(own, _)| **own == signal);
    let (square, count) =
        floors.fold((0.0, 0.0), |(sum, count), (_, floor)| (sum + floor * floor, count + 1.0));
    (count > 0.0).then(|| f64::sqrt(square / count))
}

/// A row of an image: when, in which state, and what is left of it.
struct Row {
    time: f64,
    state: [f64; 4],
    residual: f64,
}

/// The scatter of an image's signal about smooth functions of pose, rates and time; `None` where there are too few frames.
fn local(nominal: &Evaluation, signal: usize) -> Option<f64> {
    let (mut rows, mut runs): (Vec<Row>, Vec<usize>) = (Vec::new(), Vec::new());
    for block in &nominal.blocks {
        for cell in &block.cells {
            let (Some(row), [q1, q2, dq1, dq2]) =
                (cell.signal.iter().position(|own| *own == signal), cell.state.as_slice())
            else {
                continue;
            };
            let residual = bare(cell, &cell.residual, 0.0).residual[row] * cell.sigma[row];
            rows.push(Row { time: cell.time[row], state: [*q1, *q2, *dq1, *dq2], residual });
            runs.push(block.run);
        }
    }
    let ends = runs.chunk_by(|a, b| a == b).map(<[usize]>::len);
    let (mut fits, mut from): (Vec<(f64, f64)>, usize) = (Vec::new(), 0);
    for length in ends {
        fits.extend(rows[from..from + length].chunks_exact(POLICY.floor_frames).filter_map(fitted));
        from += length;
    }
    if fits.len() < POLICY.floor_fits {
        return None;
    }
    let mut each: Vec<f64> = fits.iter().map(|(square, freedom)| square / freedom).collect();
    each.sort_by(f64::total_cmp);
    let most = POLICY.wild * each[each.len() / 2];
    let tame = fits.iter().filter(|(square, freedom)| square / freedom <= most);
    let (square, freedom) = tame.fold((0.0, 0.0), |(a, b), (square, freedom)| (a + square, b + freedom));
    (freedom > 0.0).then(|| (square / freedom).sqrt())
}

/// What a linear function of the state and a square one of time leave of some rows: squares, and rows less numbers fitted.
fn fitted(rows: &[Row]) -> Option<(f64, f64)> {
    let mut basis: Vec<Vec<f64>> = vec![vec![1.0 / (rows.len() as f64).sqrt(); rows.len()]];
    let regressors = (0..4)
        .map(|place| rows.iter().map(|row| row.state[place]).collect::<Vec<f64>>())
        .chain([1, 2].map(|power| rows.iter().map(|row| (row.time - rows[0].time).powi(power)).collect()));
    for mut column in regressors {
        let before = norm(&column);
        // twice is enough (Parlett, The Symmetric Eigenvalue Problem, section 6.9)
        for _ in 0..2 {
            basis.iter().for_each(|known| take_out(known, &mut column));
        }
        let after = norm(&column);
        if after > ROUNDING * before {
            basis.push(column.iter().map(|x| x / after).collect());
        }
    }
    let mut residual: Vec<f64> = rows.iter().map(|row| row.residual).collect();
    basis.iter().for_each(|known| take_out(known, &mut residual));
    let freedom = rows.len() as f64 - basis.len() as f64;
    (freedom > 0.0).then(|| (norm(&residual).powi(2), freedom))
}

fn norm(column: &[f64]) -> f64 {
    column.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn take_out(direction: &[f64], column: &mut [f64]) {
    let along: f64 = direction.iter().zip(column.iter()).map(|(a, b)| a * b).sum();
    column.iter_mut().zip(direction).for_each(|(x, unit)| *x -= along * unit);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::channels::Measures;
    use crate::rigs::acrobot::residual::Block;
    use crate::statistics::linear::Cell;
    use crate::statistics::random::Random;
    use nalgebra::DMatrix;

    /// 1200 frames of u3 of an arm that swings, with white noise of 0.025 px and an error of the lens and a delay of some 2 px.
    fn frames(error: f64) -> Evaluation {
        let (mut random, mut blocks) = (Random::new(5), Vec::new());
        for frame in 0..1200 {
            let time = f64::from(frame) / 30.0;
            let (q1, dq1) = (0.2 * libm::sin(2.0 * time), 0.4 * libm::cos(2.0 * time));
            let (q2, dq2) = (0.3 * libm::sin(3.1 * time), 0.93 * libm::cos(3.1 * time));
            let wrong = error * (20.0 * (q1 + q2).powi(3) + 2.0 * dq2 + 1.0);
            let cell = Cell {
                residual: vec![wrong + 0.025 * random.normal()],
                sigma: vec![1.0],
                signal: vec![4],
                time: vec![time],
                hard: DMatrix::zeros(1, 0),
                soft: DMatrix::zeros(1, 0),
                discrepancy: 0,
                inertia_scale: 1.0,
                columns: DMatrix::zeros(1, 0),
                floor: Vec::new(),
                state: vec![q1, q2, dq1, dq2],
                lattice: Vec::new(),
                drawn: Vec::new(),
            };
            blocks.push(Block { run: 0, from: time, to: time, cells: vec![cell], state: [0.0; 4] });
        }
        let signal = |name: &str| Signal {
            name: format!("camera.{name}"),
            unit: "px",
            measures: Measures::Centroid,
            known: None,
            sigma: 1.0,
            least: 0.0,
            tolerance: 0.0,
        };
        Evaluation::of(blocks, &[], &[], &COLUMNS.map(signal))
    }

    #[test]
    fn law_noise_is_the_same_whatever_the_model_lacks() {
        // 0.025 px is known to 1 / sqrt(2 * 500) of itself, 3 %; twice that, and what a cubic bends over 0.4 s
        for error in [0.0, 0.1, 1.0] {
            let noise = local(&frames(error), 4).expect("frames enough");
            assert!((noise / 0.025 - 1.0).abs() < 0.08, "{error}: {noise}");
        }
    }
}
