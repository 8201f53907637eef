//! Windows of a run, each followed from a start state of its own without process noise: the same ones with each model.

use super::policy::GENERAL;
use super::study::Studied;
use super::times_off;
use crate::dynamics::Engine;
use crate::dynamics::grid::Sample;
use crate::infer::fit::{At, Fit, Options, Path, fit};
use crate::infer::{Linearised, Noise};
use crate::statistics::levels::SMALL;
use rayon::prelude::*;

/// Sums of one channel over windows.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sum {
    /// Sum of squared residuals, in the channel's unit squared.
    pub square: f64,
    /// Number of values, less those that the start states take away.
    pub count: f64,
    /// What timestamps that scatter leave of the squares.
    pub by_times: f64,
}

/// One window's residuals, and the states that it was followed through.
#[derive(Debug, Clone)]
pub struct Window {
    /// Place of its run.
    pub run: usize,
    /// Time of its first row, s.
    pub from: f64,
    /// Time of its last row, s.
    pub to: f64,
    /// Sums of each channel.
    pub sums: Vec<Sum>,
    /// The compared values.
    pub points: Vec<Point>,
    /// States, n a row.
    pub states: Vec<f64>,
    /// Whether a bold fit was needed, of this model or of another one: what is left is told, and no name hangs on it.
    pub is_bold: bool,
}

/// One compared value of a window.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    /// Place of the channel.
    pub channel: usize,
    /// Time, s.
    pub time: f64,
    /// Measured less simulated, in the channel's unit.
    pub residual: f64,
    /// Row of the window.
    pub row: usize,
}

/// Parameters, and the paths from which start states are looked for.
pub type Model<'a> = (&'a [f64], &'a [Path]);

/// Windows of so many rows, before any is halved.
fn windows_of(rows: usize) -> usize {
    rows.div_ceil(GENERAL.window).max(1)
}

/// Whether so many rows tell of a model at all.
fn tells(rows: usize) -> bool {
    rows >= GENERAL.shortest_window
}

/// Whether so many values tell how a window is followed from so many start states that are fitted to it.
fn is_compared(values: f64, states: usize) -> bool {
    values >= GENERAL.compared * states as f64
}

/// Whether a state moved by so little of its scale that a window's fit has ended: a tenth, for the smoother gives the rest of the way.
fn is_at_rest(by: f64, scale: f64) -> bool {
    by.abs() < SMALL * scale
}

/// Knobs of a window's fit. Only its states move, from a path that is near already. Numerical only: what has not settled is halved.
fn window_fit() -> Options {
    Options { rounds: 6, settled: 1e-2, ..Options::default() }
}

/// The same for rows of which no part is followed otherwise: no round is turned back. A path that follows the log is none of the model's, and its
/// linear model promises less than any start state leaves where the model bends on the way to its own: a tank whose level runs away from the log's.
/// Nothing but that it settles says that it went the right way, so that it is asked last.
fn bold_fit() -> Options {
    Options { rise: f64::INFINITY, ..window_fit() }
}

/// The fit of a window's states from a path on, with how far they move after its last round, which the smoother gives; nothing where it has not
/// settled.
fn settled(window: &Engine, start: &At, options: &Options) -> Option<(Fit, Vec<f64>)> {
    let fitted = fit(window, start, &[], None, options).ok()?;
    let run = &fitted.runs[0];
    let moved = crate::infer::smooth(run, &start.noise).state;
    let rests = (moved.chunks(run.states.max(1)))
        .all(|row| row.iter().zip(&window.scales).all(|(by, scale)| is_at_rest(*by, *scale)));
    rests.then_some((fitted, moved))
}

/// All windows of an engine's runs for each model, each followed from its own start state: the same ones for all, so that they are compared
/// on the same rows.
pub fn windows(engine: &Engine, models: &[Model<'_>], trained: &Studied) -> Vec<Vec<Window>> {
    // no process noise: the least that the sweep takes
    let mut noise = Noise { disturbance: None, jitter: 0.0, ..trained.fit.at.noise.clone() };
    noise.process.iter_mut().zip(&engine.scales).for_each(|(size, scale)| *size = 1e-9 * scale);
    let mut list: Vec<Rows<'_>> = Vec::new();
    for (run, grid) in engine.grids.iter().enumerate() {
        let rows = grid.time.len();
        // what begins nowhere but at its start is one window
        let count = if engine.machine.whole { 1 } else { windows_of(rows) };
        let part = |part| Rows {
            engine,
            noise: &noise,
            jitter: trained.fit.at.noise.jitter,
            run,
            from: part * rows / count,
            to: (part + 1) * rows / count,
        };
        list.extend((0..count).map(part));
    }
    let all: Vec<Vec<Vec<Window>>> = list.into_par_iter().map(|rows| rows.follow(models)).collect();
    let of = |model: usize| all.iter().flatten().map(|each| each[model].clone()).collect();
    (0..models.len()).map(of).collect()
}

/// Rows of a run, from one to before another, that are followed with noise of the sensors only.
#[derive(Clone, Copy)]
struct Rows<'a> {
    engine: &'a Engine,
    noise: &'a Noise,
    /// Standard deviation of the timestamps, s, which the fit of a window knows nothing of.
    jitter: f64,
    run: usize,
    from: usize,
    to: usize,
}

impl Rows<'_> {
    /// These rows' windows, one a model: as a whole by a bold fit where a model can't follow any part of them otherwise.
    fn follow(&self, models: &[Model<'_>]) -> Vec<Vec<Window>> {
        let usual = self.follow_parts(models);
        if !usual.is_empty() || !tells(self.to - self.from) {
            return usual;
        }
        let mut bold = self.follow_whole(models, &[window_fit(), bold_fit()]);
        // of all models, for they are compared on the same rows
        bold.iter_mut().flatten().for_each(|window| window.is_bold = true);
        bold.into_iter().collect()
    }

    /// These rows as one window, by the first of these fits that settles with each model.
    fn follow_whole(&self, models: &[Model<'_>], fits: &[Options]) -> Option<Vec<Window>> {
        models.iter().map(|(theta, paths)| self.window(theta, &paths[self.run], fits)).collect()
    }

    /// These rows, or their halves where a model can't follow them as a whole.
    fn follow_parts(&self, models: &[Model<'_>]) -> Vec<Vec<Window>> {
        if !tells(self.to - self.from) {
            return Vec::new();
        }
        if let Some(all) = self.follow_whole(models, &[window_fit()]) {
            return vec![all];
        }
        if self.engine.machine.whole {
            return Vec::new();
        }
        let half = (self.from + self.to) / 2;
        let mut both = Self { to: half, ..*self }.follow_parts(models);
        both.extend(Self { from: half, ..*self }.follow_parts(models));
        both
    }

    /// A window with these parameters, begun where a path of its run goes; nothing where none of these fits follows it.
    fn window(&self, theta: &[f64], path: &[f64], fits: &[Options]) -> Option<Window> {
        let Self { engine, noise, from, to, .. } = *self;
        let n = engine.machine.order();
        let single = self.as_only_run(&path[from * n..(from + 1) * n]);
        let start =
            At { theta: theta.to_vec(), paths: vec![path[from * n..to * n].to_vec()], noise: noise.clone() };
        let (fitted, moved) = fits.iter().find_map(|options| settled(&single, &start, options))?;
        let run = &fitted.runs[0];
        let wide = run.states;
        let (mut sums, points) = residuals(run, &moved, engine.machine.channels.len());
        let all: f64 = sums.iter().map(|sum| sum.count).sum();
        if !is_compared(all, n) {
            return None;
        }
        // each start state takes a value's worth of the residual away
        let share = (all - n as f64) / all;
        sums.iter_mut().for_each(|sum| sum.count *= share);
        let by_times = times_off::squares(run, &noise.channels, self.jitter);
        sums.iter_mut().zip(by_times).for_each(|(sum, by)| sum.by_times = by);
        let path = &fitted.at.paths[0];
        let states = (0..run.rows()).flat_map(|row| (0..n).map(move |i| (row * n + i, row * wide + i)));
        let states = states.map(|(at, by)| path[at] + moved[by]).collect();
        let time = &single.grids[0].time;
        Some(Window {
            run: self.run,
            from: time[0],
            to: time[time.len() - 1],
            sums,
            points,
            states,
            is_bold: false,
        })
    }

    /// The engine with these rows as its only run, which begins near a state.
    fn as_only_run(&self, begin: &[f64]) -> Engine {
        let Self { engine, run, from, to, .. } = *self;
        let grid = &engine.grids[run];
        let mut part = grid.clone();
        part.time = grid.time[from..to].to_vec();
        let span = part.time[0]..=part.time[part.time.len() - 1];
        let inside = |sample: &Sample| span.contains(&sample.time);
        let outliers = (part.samples.iter().zip(&engine.outliers[run]))
            .filter(|(sample, _)| inside(sample))
            .map(|(_, out)| *out)
            .collect();
        part.samples.retain(inside);
        Engine {
            outliers: vec![outliers],
            starts: vec![(begin.to_vec(), engine.starts[run].1.clone())],
            ..engine.with_runs(engine.machine.clone(), vec![part])
        }
    }
}

/// What a run leaves of its values after states moved: sums of each channel, and each value.
fn residuals(run: &Linearised, moved: &[f64], channels: usize) -> (Vec<Sum>, Vec<Point>) {
    let (wide, mut sums, mut points) = (run.states, vec![Sum::default(); channels], Vec::new());
    for row in 0..run.rows() {
        for value in run.values(row).filter(|value| run.measured[*value].weight > 0.0) {
            let measured = &run.measured[value];
            let by: f64 = (0..wide).map(|i| run.observe[value * wide + i] * moved[row * wide + i]).sum();
            let residual = measured.residual - by;
            let sum = &mut sums[measured.channel];
            sum.square += residual * residual;
            sum.count += 1.0;
            points.push(Point { channel: measured.channel, time: measured.time, residual, row });
        }
    }
    (sums, points)
}

#[cfg(test)]
mod tests {
    use super::{is_at_rest, is_compared, tells, windows_of};

    #[test]
    fn value_windows_are_long_enough_to_tell_and_short_enough_to_be_followed() {
        // two seconds at 100 Hz: a motor's start and settling, and no more than a slightly wrong model is followed through
        assert_eq!([1, 180, 220, 1_900].map(windows_of), [1, 1, 2, 10]);
        // twelve rows tell of four start values and of what is asked of them; half a dozen would be fitted
        assert!(!tells(10) && tells(13));
        // as many values as start states are met exactly, whatever the model: four states and three values each will do
        assert!(!is_compared(11.0, 4) && is_compared(13.0, 4) && is_compared(0.0, 0));
        // a fit that stands, and one that still goes somewhere
        assert!(is_at_rest(-0.09, 1.0) && !is_at_rest(-0.11, 1.0));
    }
}
