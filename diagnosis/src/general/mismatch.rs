//! The gap: how far simulation and log part within windows, each from a start state of its own, without process noise.
//! The same windows give the page its courses of measured, nominal and amended.

use super::courses::courses;
use super::policy::GENERAL;
use super::study::Studied;
use crate::diagnosis::{Gap, Unknown, Where};
use crate::dynamics::Engine;
use crate::dynamics::build::{Built, Span, build};
use crate::dynamics::first_path::Trails;
use crate::dynamics::grid::Sample;
use crate::dynamics::machine::Output;
use crate::error::{Error, Notice};
use crate::infer::fit::{At, Options, Path, fit};
use crate::infer::{Linearised, Noise};
use crate::observe::{Problem, Run};
use crate::overlay::Channel;
use crate::statistics::levels::{HALF, MORE};
use rayon::prelude::*;

/// Sums of one channel over windows.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    square: f64,
    count: f64,
}

/// One window's residuals, and the states that it was followed through.
#[derive(Debug, Clone)]
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

/// What rows say that were left out.
pub struct HeldOut {
    /// The gap of each channel, the largest first.
    pub gaps: Vec<Gap>,
    /// The courses of the last run of them.
    pub channels: Vec<Channel>,
    /// Where the gap stands on a part of the rows only.
    pub notice: Option<Notice>,
}

/// Judges a model on rows left out. Where they were followed joins what is known.
///
/// # Errors
/// A unit failed everywhere.
pub fn held_out(
    problem: &Problem,
    left: &[(&Run, Span)],
    trained: &Studied,
    known: &mut Trails,
) -> Result<HeldOut, Error> {
    let mut built = build(problem, left)?;
    let neutral = built.engine.machine.neutral();
    let paths = built.engine.first_paths(&neutral, &built.noise)?;
    let runs = built.engine.chords(&neutral, &paths, &[])?;
    let noise = Noise { disturbance: None, ..trained.fit.at.noise.clone() };
    built.engine.readmit(&neutral, &runs, &noise);
    known.add(&built.engine, &paths);
    let amended = match trained.effects.is_empty() {
        true => None,
        false => {
            let theta = &trained.fit.at.theta;
            Some((theta.as_slice(), built.engine.first_paths(theta, &trained.built.noise)?))
        }
    };
    let mut models: Vec<Model<'_>> = vec![(&neutral, &paths)];
    models.extend(amended.as_ref().map(|(theta, paths)| (*theta, paths.as_slice())));
    let mut both = windows(&built.engine, &models, trained);
    let before = both.remove(0);
    let after = both.first().unwrap_or(&before);
    let names: Vec<String> = left.iter().map(|(run, _)| run.name.clone()).collect();
    let (order, gaps) = gaps(&built, &before, after, &names);
    let channels = courses(&built.engine, &order, &before, after);
    let share = share(after, &built.engine);
    let notice = (share < HALF).then(|| Notice {
        file: "dataset.toml".into(),
        line: 0,
        message: format!(
            "the gap is that of {:.0} % of the rows left out: elsewhere no start state was found from which a model follows the log",
            100.0 * share
        ),
    });
    Ok(HeldOut { gaps, channels, notice })
}

/// The gap of each channel before and after, and the channels' places: the one first that is farthest above its noise.
fn gaps(built: &Built, before: &[Window], after: &[Window], runs: &[String]) -> (Vec<usize>, Vec<Gap>) {
    let gap = |(channel, output): (usize, &Output)| {
        let floor = output.noise.unwrap_or(built.scatter[channel].quiet);
        let (from, to) = (mean(before, channel), mean(after, channel));
        let gap = Gap {
            before: from,
            after: to,
            floor,
            closed: closed(from, to, floor),
            held_out_runs: runs.to_vec(),
            cross_validated: Vec::new(),
            signal: output.name.clone(),
            unit: output.unit.clone(),
        };
        (from / floor.max(1e-300), channel, gap)
    };
    let mut all: Vec<(f64, usize, Gap)> = built.engine.machine.channels.iter().enumerate().map(gap).collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    all.into_iter().map(|(_, channel, gap)| (channel, gap)).unzip()
}

/// The share of a gap that was closed, of squares above the noise's; nothing where there is hardly a gap: a twentieth above the noise is what
/// a few hundred values scatter.
fn closed(before: f64, after: f64, floor: f64) -> Option<f64> {
    let above = |gap: f64| gap * gap - floor * floor;
    (before > 1.05 * floor).then(|| 1.0 - above(after) / above(before))
}

/// The share of the rows left out that both models could be followed through.
fn share(windows: &[Window], engine: &Engine) -> f64 {
    let n = engine.machine.order();
    if n == 0 {
        // a unit without states is followed from anywhere
        return 1.0;
    }
    let rows: usize = engine.grids.iter().map(|grid| grid.time.len()).sum();
    windows.iter().map(|window| window.states.len() / n).sum::<usize>() as f64 / rows.max(1) as f64
}

/// Whether the model found is farther from the rows left out than the nominal one, all channels together, each in units of its noise.
pub fn widened(gaps: &[Gap]) -> bool {
    let (before, after) = squares(gaps);
    after > before
}

/// What has no name where the model found is far worse there: it stands for something else, whatever process noise says.
pub fn unlike(gaps: &[Gap]) -> Option<Unknown> {
    let (before, after) = squares(gaps);
    (after > MORE * MORE * before).then(|| Unknown {
        signal: "the whole model".into(),
        shape: format!(
            "with what was found the rows left out are followed {:.1} times worse than by the nominal model",
            (after / before).sqrt()
        ),
        nearest: "what was found stands for something else".into(),
        ..Unknown::default()
    })
}

/// Squares of all channels, each in units of its noise, before and after.
fn squares(gaps: &[Gap]) -> (f64, f64) {
    let square = |of: fn(&Gap) -> f64| -> f64 {
        gaps.iter().filter(|gap| gap.floor > 0.0).map(|gap| (of(gap) / gap.floor).powi(2)).sum()
    };
    (square(|gap| gap.before), square(|gap| gap.after))
}

fn mean(windows: &[Window], channel: usize) -> f64 {
    let (square, count) =
        windows.iter().fold((0.0, 0.0), |(s, n), w| (s + w.sums[channel].square, n + w.sums[channel].count));
    if count > 0.0 { (square / count).sqrt() } else { 0.0 }
}

/// Parameters, and the paths from which start states are looked for.
type Model<'a> = (&'a [f64], &'a [Path]);

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
    by.abs() < 0.1 * scale
}

/// Knobs of a window's fit. Only its states move, from a path that is near already. Numerical only: what has not settled is halved.
fn window_fit() -> Options {
    Options { rounds: 6, settled: 1e-2, ..Options::default() }
}

/// Whether a channel's excess over its noise tells of a model where so many values are compared: half as much again as the noise.
fn is_telling(excess: f64, values: f64) -> bool {
    excess > 0.5 * values
}

/// All windows of an engine's runs for each model, each followed from its own start state: the same ones for all, so that they are compared
/// on the same rows.
fn windows(engine: &Engine, models: &[Model<'_>], trained: &Studied) -> Vec<Vec<Window>> {
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
    run: usize,
    from: usize,
    to: usize,
}

impl Rows<'_> {
    /// These rows, or their halves where a model can't follow them as a whole: their windows, one a model.
    fn follow(&self, models: &[Model<'_>]) -> Vec<Vec<Window>> {
        if !tells(self.to - self.from) {
            return Vec::new();
        }
        let of = |(theta, paths): &Model<'_>| self.window(theta, &paths[self.run]);
        if let Some(all) = models.iter().map(of).collect::<Option<Vec<Window>>>() {
            return vec![all];
        }
        if self.engine.machine.whole {
            return Vec::new();
        }
        let half = (self.from + self.to) / 2;
        let mut both = Self { to: half, ..*self }.follow(models);
        both.extend(Self { from: half, ..*self }.follow(models));
        both
    }

    /// A window with these parameters, begun where a path of its run goes; nothing where it can't be followed.
    fn window(&self, theta: &[f64], path: &[f64]) -> Option<Window> {
        let Self { engine, noise, from, to, .. } = *self;
        let n = engine.machine.order();
        let single = self.as_only_run(&path[from * n..(from + 1) * n]);
        let start =
            At { theta: theta.to_vec(), paths: vec![path[from * n..to * n].to_vec()], noise: noise.clone() };
        let fitted = fit(&single, &start, &[], None, &window_fit()).ok()?;
        let run = &fitted.runs[0];
        // what is left after the path's last small move, which the smoother gives
        let moved = crate::infer::smooth(run, noise).state;
        let wide = run.states;
        let settled = (moved.chunks(wide.max(1)))
            .all(|row| row.iter().zip(&engine.scales).all(|(by, scale)| is_at_rest(*by, *scale)));
        if !settled {
            return None;
        }
        let (mut sums, points) = residuals(run, &moved, engine.machine.channels.len());
        let all: f64 = sums.iter().map(|sum| sum.count).sum();
        if !is_compared(all, n) {
            return None;
        }
        // each start state takes a value's worth of the residual away
        let share = (all - n as f64) / all;
        sums.iter_mut().for_each(|sum| sum.count *= share);
        let path = &fitted.at.paths[0];
        let states = (0..run.rows()).flat_map(|row| (0..n).map(move |i| (row * n + i, row * wide + i)));
        let states = states.map(|(at, by)| path[at] + moved[by]).collect();
        let time = &single.grids[0].time;
        Some(Window { run: self.run, from: time[0], to: time[time.len() - 1], sums, points, states })
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

/// Where the nominal model parts from the log, over all runs.
pub fn places(studied: &Studied) -> Vec<Where> {
    let engine = &studied.built.engine;
    let neutral = engine.machine.neutral();
    let windows = windows(engine, &[(&neutral, &studied.nominal)], studied).remove(0);
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
            .filter(|window| is_telling(excess(window, channel), window.sums[channel].count))
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
        // half as far again is far worse, a little more is not
        assert!(unlike(&[gap(1.0, 1.55, 0.1)]).is_some() && unlike(&[gap(1.0, 1.45, 0.1)]).is_none());
        assert!(!widened(&[gap(1.0, 1.0, 0.1)]) && !widened(&[gap(1.0, 2.0, 0.0)]) && !widened(&[]));
    }

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

    #[test]
    fn value_a_gap_is_closed_where_there_is_one() {
        // squares above the noise's: from 3 to 1
        assert_eq!(closed(2.0, 2f64.sqrt(), 1.0).map(|share| (1e6 * share).round()), Some(666_667.0));
        assert!(closed(1.06, 1.0, 1.0).is_some(), "worse than the noise by more than it scatters");
        assert!(closed(1.04, 1.0, 1.0).is_none() && closed(0.0, 0.0, 0.0).is_none());
        // a window tells of a model by half as much again as noise alone would leave
        assert!(is_telling(55.0, 100.0) && !is_telling(45.0, 100.0) && !is_telling(0.0, 0.0));
    }
}
