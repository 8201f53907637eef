//! The gap: how far simulation and log part within windows, each from a start state of its own, without process noise.
//! The same windows give the page its courses of measured, nominal and amended.

use super::courses::courses;
use super::study::Studied;
use super::windows::{Model, Window, windows};
use crate::diagnosis::{Gap, Unknown, Where};
use crate::dynamics::Engine;
use crate::dynamics::build::{Built, Span, build};
use crate::dynamics::first_path::Trails;
use crate::dynamics::machine::Output;
use crate::error::{Error, Notice};
use crate::infer::Noise;
use crate::observe::{Problem, Run};
use crate::overlay::Channel;
use crate::statistics::levels::{HALF, MORE, SMALL};

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
    let names: Vec<String> = left.iter().map(|(run, span)| name(run, *span)).collect();
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

/// The name of rows left out: a run's, with its times where they are but a part of it.
fn name(run: &Run, span: Span) -> String {
    match span == run.span() {
        true => run.name.clone(),
        false => format!("{} from {:.1} to {:.1} s", run.name, span.0, span.1),
    }
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

/// Whether the model found closes hardly any of a gap that stands far above the noise: what else is missing there is much more than what has
/// names.
pub fn closes_little(gaps: &[Gap]) -> bool {
    let (before, after) = squares(gaps);
    let floor = gaps.iter().filter(|gap| gap.floor > 0.0).count() as f64;
    after > MORE * MORE * floor && before - after < SMALL * (before - floor)
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

/// Root mean square of a channel's residuals over windows, in the channel's unit; 0 where there is no value.
fn mean(windows: &[Window], channel: usize) -> f64 {
    let (square, count) =
        windows.iter().fold((0.0, 0.0), |(s, n), w| (s + w.sums[channel].square, n + w.sums[channel].count));
    if count > 0.0 { (square / count).sqrt() } else { 0.0 }
}

/// Whether a channel's excess over its noise tells of a model where so many values are compared: half as much again as the noise.
fn is_telling(excess: f64, values: f64) -> bool {
    excess > 0.5 * values
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
        // of 24 noises' squares above the noise's 2 are closed, or 3; and of hardly any nothing need be
        assert!(
            closes_little(&[gap(5.0, 23f64.sqrt(), 1.0)]) && !closes_little(&[gap(5.0, 22f64.sqrt(), 1.0)])
        );
        assert!(!closes_little(&[gap(1.45, 1.45, 1.0)]) && closes_little(&[gap(1.55, 1.55, 1.0)]));
        assert!(!widened(&[gap(1.0, 1.0, 0.1)]) && !widened(&[gap(1.0, 2.0, 0.0)]) && !widened(&[]));
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
