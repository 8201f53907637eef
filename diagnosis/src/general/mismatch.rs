//! The gap: how far simulation and log part within windows, each from a start state of its own, without process noise.
//! The same windows give the page its courses of measured, nominal and amended.

use super::courses::courses;
use super::study::Studied;
use crate::diagnosis::{Gap, Where};
use crate::dynamics::Engine;
use crate::dynamics::build::{Span, build};
use crate::dynamics::first_path::Trails;
use crate::error::Error;
use crate::infer::fit::{At, Options, Path, fit};
use crate::observe::{Problem, Run};
use crate::overlay::Channel;
use crate::statistics::levels::{DOUBTED, ROWS};
use rayon::prelude::*;

/// Rows of a window at first; halved where a window can't be followed.
const WINDOW: usize = 200;
/// Windows shorter than this say nothing of a model.
const SHORTEST: usize = ROWS;
/// A window is as good as followed when this many values for each start state are compared.
const ENOUGH: f64 = DOUBTED;

/// Sums of one channel over windows.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    square: f64,
    count: f64,
}

/// One window's residuals, and the states that it was followed through.
pub struct Window {
    /// Place of its run.
    pub run: usize,
    from: f64,
    to: f64,
    sums: Vec<Sum>,
    /// The compared values.
    pub points: Vec<Point>,
    /// States, n a row.
    pub states: Vec<f64>,
}

/// One compared value of a window.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    /// Place of the channel.
    pub channel: usize,
    /// When, s.
    pub time: f64,
    /// Measured less simulated.
    pub residual: f64,
    /// Row of the window.
    pub row: usize,
}

/// The gap of each channel on rows left out, the largest first, and the courses of the last run of them. Where the rows were followed
/// joins what is known.
///
/// # Errors
/// A unit failed everywhere.
pub fn held_out(
    problem: &Problem,
    left: &[(&Run, Span)],
    trained: &Studied,
    known: &mut Trails,
) -> Result<(Vec<Gap>, Vec<Channel>), Error> {
    let mut built = build(problem, left)?;
    let neutral = built.engine.machine.neutral();
    let paths = built.engine.first_paths(&neutral, &built.noise)?;
    let runs = built.engine.chords(&neutral, &paths, &[])?;
    let noise = crate::infer::Noise { disturbance: None, ..trained.fit.at.noise.clone() };
    built.engine.readmit(&neutral, &runs, &noise);
    known.add(&built.engine, &paths);
    let before = windows(&built.engine, &neutral, &paths, trained);
    let after = if trained.effects.is_empty() {
        None
    } else {
        let theta = &trained.fit.at.theta;
        Some(windows(&built.engine, theta, &built.engine.first_paths(theta, &trained.built.noise)?, trained))
    };
    let after = after.as_ref().unwrap_or(&before);
    let names: Vec<String> = left.iter().map(|(run, _)| run.name.clone()).collect();
    let mut gaps: Vec<(f64, usize, Gap)> = Vec::new();
    for (channel, output) in built.engine.machine.channels.iter().enumerate() {
        let floor = output.noise.unwrap_or(built.scatter[channel].quiet);
        let (from, to) = (mean(&before, channel), mean(after, channel));
        let closed = (from > floor)
            .then(|| 1.0 - (to * to - floor * floor) / (from * from - floor * floor))
            .filter(|_| from > 1.05 * floor);
        let gap = Gap {
            before: from,
            after: to,
            floor,
            closed,
            held_out_runs: names.clone(),
            cross_validated: Vec::new(),
            signal: output.name.clone(),
            unit: output.unit.clone(),
        };
        gaps.push((from / floor.max(1e-300), channel, gap));
    }
    gaps.sort_by(|a, b| b.0.total_cmp(&a.0));
    let order: Vec<usize> = gaps.iter().map(|(_, channel, _)| *channel).collect();
    let channels = courses(&built.engine, &order, &before, after);
    Ok((gaps.into_iter().map(|(_, _, gap)| gap).collect(), channels))
}

/// Whether the model found is farther from the rows left out than the nominal one, all channels together, each in units of its noise.
pub fn widened(gaps: &[Gap]) -> bool {
    let square = |of: fn(&Gap) -> f64| -> f64 {
        gaps.iter().filter(|gap| gap.floor > 0.0).map(|gap| (of(gap) / gap.floor).powi(2)).sum()
    };
    square(|gap| gap.after) > square(|gap| gap.before)
}

fn mean(windows: &[Window], channel: usize) -> f64 {
    let (square, count) =
        windows.iter().fold((0.0, 0.0), |(s, n), w| (s + w.sums[channel].square, n + w.sums[channel].count));
    if count > 0.0 { (square / count).sqrt() } else { 0.0 }
}

/// All windows of an engine's runs, each followed from its own start state, which is looked for from these paths on.
fn windows(engine: &Engine, theta: &[f64], paths: &[Path], trained: &Studied) -> Vec<Window> {
    let mut noise = trained.fit.at.noise.clone();
    noise.disturbance = None;
    let mut list: Vec<(usize, usize, usize)> = Vec::new();
    for (run, grid) in engine.grids.iter().enumerate() {
        let rows = grid.time.len();
        // what begins nowhere but at its start is one window
        let count = if engine.machine.whole { 1 } else { rows.div_ceil(WINDOW).max(1) };
        list.extend((0..count).map(|part| (run, part * rows / count, (part + 1) * rows / count)));
    }
    // no process noise: the least that the sweep takes
    noise.process.iter_mut().zip(&engine.scales).for_each(|(size, scale)| *size = 1e-9 * scale);
    noise.jitter = 0.0;
    let n = engine.machine.order();
    let all: Vec<Vec<Window>> = list
        .into_par_iter()
        .map(|(run, from, to)| followed(engine, theta, run, &paths[run], (from, to), &noise, n))
        .collect();
    all.into_iter().flatten().collect()
}

/// One stretch of rows, or its halves where it can't be followed as a whole.
fn followed(
    engine: &Engine,
    theta: &[f64],
    run: usize,
    path: &[f64],
    (from, to): (usize, usize),
    noise: &crate::infer::Noise,
    n: usize,
) -> Vec<Window> {
    if to - from < SHORTEST {
        return Vec::new();
    }
    if engine.machine.whole {
        return window(engine, theta, run, path, (from, to), noise, n).into_iter().collect();
    }
    if let Some(window) = window(engine, theta, run, path, (from, to), noise, n) {
        return vec![window];
    }
    let half = (from + to) / 2;
    let mut both = followed(engine, theta, run, path, (from, half), noise, n);
    both.extend(followed(engine, theta, run, path, (half, to), noise, n));
    both
}

fn window(
    engine: &Engine,
    theta: &[f64],
    run: usize,
    path: &[f64],
    (from, to): (usize, usize),
    noise: &crate::infer::Noise,
    n: usize,
) -> Option<Window> {
    let grid = &engine.grids[run];
    let mut part = grid.clone();
    part.time = grid.time[from..to].to_vec();
    let (begin, end) = (part.time[0], part.time[part.time.len() - 1]);
    let inside = |sample: &crate::dynamics::grid::Sample| (begin..=end).contains(&sample.time);
    let outliers = (part.samples.iter().zip(&engine.outliers[run]))
        .filter(|(sample, _)| inside(sample))
        .map(|(_, out)| *out)
        .collect();
    part.samples.retain(inside);
    let single = Engine {
        outliers: vec![outliers],
        starts: vec![(path[from * n..(from + 1) * n].to_vec(), engine.starts[run].1.clone())],
        ..engine.beside(engine.machine.clone(), vec![part])
    };
    let start =
        At { theta: theta.to_vec(), paths: vec![path[from * n..to * n].to_vec()], noise: noise.clone() };
    let options = Options { rounds: 6, settled: 1e-2, ..Options::default() };
    let fitted = fit(&single, &start, &[], None, &options).ok()?;
    let own = run;
    let run = &fitted.runs[0];
    // what is left after the path's last small move, which the smoother gives
    let moved = crate::infer::smooth(run, noise);
    let wide = run.states;
    let settled = (moved.state.chunks(wide))
        .all(|row| row.iter().zip(&engine.scales).all(|(by, scale)| by.abs() < 0.1 * scale));
    if !settled {
        return None;
    }
    let mut sums = vec![Sum::default(); engine.machine.channels.len()];
    let mut points = Vec::new();
    for row in 0..run.rows() {
        for value in run.values(row).filter(|value| run.measured[*value].weight > 0.0) {
            let measured = &run.measured[value];
            let by: f64 =
                (0..wide).map(|i| run.observe[value * wide + i] * moved.state[row * wide + i]).sum();
            let residual = measured.residual - by;
            let sum = &mut sums[measured.channel];
            sum.square += residual * residual;
            sum.count += 1.0;
            points.push(Point { channel: measured.channel, time: measured.time, residual, row });
        }
    }
    let all: f64 = sums.iter().map(|sum| sum.count).sum();
    if all < ENOUGH * n as f64 {
        return None;
    }
    // each start state takes a value's worth of the residual away
    let share = (all - n as f64) / all;
    sums.iter_mut().for_each(|sum| sum.count *= share);
    let path = &fitted.at.paths[0];
    let states = (0..run.rows()).flat_map(|row| (0..n).map(move |i| (row * n + i, row * wide + i)));
    let states = states.map(|(at, by)| path[at] + moved.state[by]).collect();
    Some(Window { run: own, from: begin, to: end, sums, points, states })
}

/// Where the nominal model parts from the log, over all runs.
pub fn places(studied: &Studied) -> Vec<Where> {
    let engine = &studied.built.engine;
    let windows = windows(engine, &engine.machine.neutral(), &studied.nominal, studied);
    let sizes = &studied.fit.at.noise.channels;
    let mut places: Vec<Where> = Vec::new();
    let excess = |window: &Window, channel: usize| {
        let sum = window.sums[channel];
        (sum.square / (sizes[channel] * sizes[channel]) - sum.count).max(0.0)
    };
    let whole: f64 =
        windows.iter().map(|w| (0..sizes.len()).map(|channel| excess(w, channel)).sum::<f64>()).sum();
    for (channel, output) in engine.machine.channels.iter().enumerate() {
        let own: f64 = windows.iter().map(|window| excess(window, channel)).sum();
        let telling: Vec<&Window> = windows
            .iter()
            .filter(|window| excess(window, channel) > 0.5 * window.sums[channel].count)
            .collect();
        if whole > 0.0 && own > 0.0 && !telling.is_empty() {
            places.push(Where {
                signal: output.name.clone(),
                share: own / whole,
                from: telling.iter().map(|window| window.from).fold(f64::INFINITY, f64::min),
                to: telling.iter().map(|window| window.to).fold(f64::NEG_INFINITY, f64::max),
                region: format!("{} of {} windows", telling.len(), windows.len()),
            });
        }
    }
    places.sort_by(|a, b| b.share.total_cmp(&a.share));
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gap(before: f64, after: f64, floor: f64) -> Gap {
        let (signal, unit) = (String::new(), String::new());
        let (held_out_runs, cross_validated) = (Vec::new(), Vec::new());
        Gap { before, after, floor, closed: None, held_out_runs, cross_validated, signal, unit }
    }

    #[test]
    fn law_channels_count_by_their_noise_and_one_without_counts_nothing() {
        // a small loss of a quiet sensor is more than a large gain of a noisy one
        assert!(widened(&[gap(1.0, 1.1, 0.01), gap(9.0, 1.0, 1.0)]));
        assert!(!widened(&[gap(1.1, 1.0, 0.01), gap(1.0, 9.0, 1.0)]));
        assert!(!widened(&[gap(1.0, 1.0, 0.1)]) && !widened(&[gap(1.0, 2.0, 0.0)]) && !widened(&[]));
    }
}
