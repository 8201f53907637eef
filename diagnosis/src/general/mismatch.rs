//! The gap: how far simulation and log part within windows, each from a start state of its own, without process noise.
//! The same windows give the page its courses of measured, nominal and amended.

use super::courses::courses;
use super::long::thinned;
use super::study::Studied;
use super::windows::{Model, Window, windows};
use crate::diagnosis::{Gap, Unknown, Where};
use crate::dynamics::Engine;
use crate::dynamics::build::{Built, Span, build};
use crate::dynamics::first_path::Trails;
use crate::dynamics::machine::Output;
use crate::error::{Error, Notice};
use crate::infer::Noise;
use crate::nuisance::Scatter;
use crate::observe::{Problem, Run};
use crate::overlay::Overlaid;
use crate::statistics::levels::{FAR, HALF, MORE, SMALL};
use crate::text::brief;

/// What rows say that were left out.
pub struct HeldOut {
    /// The gap of each channel, the largest first.
    pub gaps: Vec<Gap>,
    /// What they say of the model found. Names hang on this, and not on how the gap is told.
    pub squares: Squares,
    /// The courses of the last run of them.
    pub channels: Vec<Overlaid>,
    /// Where the gap stands on a part of the rows only.
    pub notice: Option<Notice>,
    /// What has no name where the nominal model runs away from the rows left out.
    pub lost: Option<Unknown>,
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
    // in the way that was searched: rows left out alone may hold nothing that a unit without states remembers
    let searched = Problem { whole: trained.built.engine.machine.whole, ..problem.clone() };
    let (rows, _) = thinned(&searched, left.to_vec())?;
    let mut built = build(&searched, &rows)?;
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
    let (order, gaps) = gaps(&built, (&before, after), &trained.fit.at.noise.channels, &names);
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
    let squares = Squares::of(&built, &before, after);
    let lost = lost(&built, &before);
    Ok(HeldOut { gaps, squares, channels, notice, lost })
}

/// What has no name where the model is many times as far from a channel as the log moves, from whatever start state: it runs away, though each row may
/// follow from the one before.
fn lost(built: &Built, windows: &[Window]) -> Option<Unknown> {
    let outputs = built.engine.machine.channels.iter().enumerate();
    let is_lost = |(channel, output): (usize, &Output)| {
        let samples = built.engine.grids.iter().flat_map(|grid| &grid.samples);
        let values: Vec<f64> =
            samples.filter(|sample| sample.channel == channel).map(|sample| sample.value).collect();
        let (apart, moves) = (mean(windows, channel)?, spread(&values));
        (moves > 0.0 && apart > FAR * moves).then(|| Unknown {
            signal: output.name.clone(),
            shape: format!(
                "the model runs away, {} {} from a log that moves by {}, though each row follows from the one before: is a column in another \
                 unit of measurement than dataset.toml says, so that what is fed is many times too large?",
                brief(apart),
                output.unit,
                brief(moves)
            ),
            nearest: "no listed effect holds the model back".into(),
            ..Unknown::default()
        })
    };
    outputs.filter_map(is_lost).next()
}

/// Standard deviation of some values.
fn spread(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    let middle = values.iter().sum::<f64>() / count;
    (values.iter().map(|value| (value - middle).powi(2)).sum::<f64>() / count).sqrt()
}

/// The name of rows left out: a run's, with its times where they are but a part of it.
fn name(run: &Run, span: Span) -> String {
    match span == run.span() {
        true => run.name.clone(),
        false => format!("{} from {:.1} to {:.1} s", run.name, span.0, span.1),
    }
}

/// The gap of each channel before and after, and the channels' places: the one first that is farthest above its noise.
fn gaps(
    built: &Built,
    (before, after): (&[Window], &[Window]),
    noise: &[f64],
    runs: &[String],
) -> (Vec<usize>, Vec<Gap>) {
    let gap = |(channel, output): (usize, &Output)| {
        let floor = output.noise.unwrap_or_else(|| floor(noise[channel], &built.scatter[channel]));
        let floor = libm::hypot(floor, by_times(after, channel));
        let told = |windows: &[Window]| mean(windows, channel).unwrap_or(f64::NAN);
        let (from, to) = (told(before), told(after));
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
        // what no row tells of comes last
        (if from.is_nan() { -1.0 } else { from / floor.max(1e-300) }, channel, gap)
    };
    let mut all: Vec<(f64, usize, Gap)> = built.engine.machine.channels.iter().enumerate().map(gap).collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    all.into_iter().map(|(_, channel, gap)| (channel, gap)).unzip()
}

/// What the best model leaves of a channel whose noise nobody states: the noise that was estimated with the model, as far as the log scatters.
///
/// What rows scatter by in the middle is less where they are rounded to steps as large as the noise: the median of their differences is a step or
/// none, and the least of several orders is taken. By their squares it is as much as the noise with its rounding, and more where the machine moves
/// within a few rows. The fit knows what the model moves, and what it lacks is not to count as noise: so no more than those. A channel that is
/// sampled seldom moves between any two rows, and scatters by much more than its noise. Only where the fit left next to nothing to
/// the sensor, and all to process noise, the log's own scatter is what there is.
fn floor(fitted: f64, scatter: &Scatter) -> f64 {
    if fitted < SMALL * scatter.quiet { scatter.quiet } else { fitted.min(scatter.noise) }
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

/// What rows left out say of the model found: mean squares of all channels, each in units of its noise.
///
/// Rows that a bold fit follows say nothing here. And the noise is that of the log without any model: a model that is judged by the noise that
/// was fitted with it forgives itself what it lacks.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Squares {
    /// With the nominal model.
    before: f64,
    /// With the model found.
    after: f64,
    /// What noise alone leaves: one of each channel that has any, and what timestamps that scatter add.
    noise: f64,
}

impl Squares {
    fn of(built: &Built, before: &[Window], after: &[Window]) -> Self {
        let noise = |(output, scatter): (&Output, &Scatter)| output.noise.unwrap_or(scatter.quiet);
        let sizes: Vec<f64> = built.engine.machine.channels.iter().zip(&built.scatter).map(noise).collect();
        Self {
            before: judged(before, &sizes),
            after: judged(after, &sizes),
            noise: left_by_noise(after, &sizes),
        }
    }

    /// Whether the model found is farther from the rows left out than the nominal one.
    pub fn are_widened(self) -> bool {
        self.after > self.before
    }

    /// Whether the model found closes hardly any of a gap that stands far above the noise: what else is missing there is much more than what has
    /// names.
    pub fn close_little(self) -> bool {
        let Self { before, after, noise } = self;
        after > MORE * MORE * noise && before - after < SMALL * (before - noise)
    }

    /// What has no name where the model found is far worse there: it stands for something else, whatever process noise says.
    pub fn unlike(self) -> Option<Unknown> {
        let Self { before, after, .. } = self;
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
}

/// Mean squares of the windows by which a model is judged, all channels that have noise together, each in units of it.
fn judged(windows: &[Window], noise: &[f64]) -> f64 {
    let square = |(channel, size): (usize, &f64)| {
        mean(windows.iter().filter(|window| !window.is_bold), channel)
            .map_or(0.0, |mean| (mean / size).powi(2))
    };
    noise.iter().enumerate().filter(|(_, size)| **size > 0.0).map(square).sum()
}

/// Mean squares that noise leaves of these windows, and the scatter of timestamps with it, all channels that have noise together, each in
/// units of it.
fn left_by_noise(windows: &[Window], noise: &[f64]) -> f64 {
    let judging = || windows.iter().filter(|window| !window.is_bold);
    let square = |(channel, size): (usize, &f64)| 1.0 + (by_times(judging(), channel) / size).powi(2);
    noise.iter().enumerate().filter(|(_, size)| **size > 0.0).map(square).sum()
}

/// Root mean square of a channel's residuals over windows, in the channel's unit; nothing where there is no value.
fn mean<'a>(windows: impl IntoIterator<Item = &'a Window>, channel: usize) -> Option<f64> {
    let add = |(s, n): (f64, f64), w: &Window| (s + w.sums[channel].square, n + w.sums[channel].count);
    let (square, count) = windows.into_iter().fold((0.0, 0.0), add);
    (count > 0.0).then(|| (square / count).sqrt())
}

/// What timestamps that scatter leave of a channel over windows, root mean square, in the channel's unit.
fn by_times<'a>(windows: impl IntoIterator<Item = &'a Window>, channel: usize) -> f64 {
    let add = |(s, n): (f64, f64), w: &Window| (s + w.sums[channel].by_times, n + w.sums[channel].count);
    let (square, count) = windows.into_iter().fold((0.0, 0.0), add);
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
    use crate::dynamics::tests::pendulum;
    use crate::general::windows::Sum;
    use crate::nuisance::scatter;
    use crate::statistics::random::Random;

    /// A window of four values of each channel that have these root mean squares.
    fn window(means: &[f64], is_bold: bool) -> Window {
        let sums =
            means.iter().map(|mean| Sum { square: 4.0 * mean * mean, count: 4.0, by_times: 0.0 }).collect();
        Window { run: 0, from: 0.0, to: 1.0, sums, points: Vec::new(), states: Vec::new(), is_bold }
    }

    fn squares(before: f64, after: f64) -> Squares {
        Squares { before: before * before, after: after * after, noise: 1.0 }
    }

    #[test]
    fn law_channels_count_by_their_noise_and_one_without_counts_nothing() {
        // a small loss of a quiet sensor is more than a large gain of a noisy one
        let judged = |means: [f64; 2]| judged(&[window(&means, false)], &[0.01, 1.0]);
        assert!(judged([1.1, 1.0]) > judged([1.0, 9.0]) && judged([1.0, 9.0]) > judged([1.0, 1.0]));
        assert_eq!(super::judged(&[window(&[1.0, 3.0], false)], &[0.0, 2.0]), 2.25);
        assert_eq!(super::judged(&[], &[1.0]), 0.0);
    }

    #[test]
    fn law_no_name_hangs_on_rows_that_only_a_bold_fit_follows() {
        let both = [window(&[1.0], false), window(&[8.0], true)];
        assert_eq!((judged(&both, &[0.5]), judged(&both[1..], &[0.5])), (4.0, 0.0));
        // they are told
        assert_eq!(mean(&both, 0).map(|mean| mean * mean), Some(32.5));
        assert!(mean(&[], 0).is_none(), "no row is no gap of nothing");
    }

    #[test]
    fn value_rows_left_out_judge_a_model_by_how_much_worse_it_is() {
        assert!(squares(1.0, 1.1).are_widened() && !squares(1.0, 1.0).are_widened());
        // half as far again is far worse, a little more is not
        assert!(squares(1.0, 1.55).unlike().is_some() && squares(1.0, 1.45).unlike().is_none());
        // of 24 noises' squares above the noise's 2 are closed, or 3; and of hardly any nothing need be
        assert!(squares(5.0, 23f64.sqrt()).close_little() && !squares(5.0, 22f64.sqrt()).close_little());
        assert!(!squares(1.45, 1.45).close_little() && squares(1.55, 1.55).close_little());
        let none = Squares::default();
        assert!(!none.are_widened() && !none.close_little() && none.unlike().is_none());
    }

    #[test]
    fn value_a_model_runs_away_that_is_ten_times_as_far_off_as_the_log_moves() {
        let built = pendulum("lost", 400);
        let built = build(&built, &built.whole_runs()).expect("a pendulum");
        let moves = spread(&built.engine.grids[0].samples.iter().map(|one| one.value).collect::<Vec<_>>());
        let at = |times: f64| lost(&built, &[window(&[times * moves; 2], false)]);
        assert!(at(5.0).is_none() && at(20.0).is_some_and(|lost| lost.shape.contains("runs away")));
        assert_eq!(spread(&[1.0, 3.0]), 1.0);
    }

    #[test]
    fn value_a_gap_is_closed_where_there_is_one() {
        // squares above the noise's: from 3 to 1
        assert_eq!(closed(2.0, 2f64.sqrt(), 1.0).map(|share| (1e6 * share).round()), Some(666_667.0));
        assert!(closed(1.06, 1.0, 1.0).is_some(), "worse than the noise by more than it scatters");
        assert!(closed(1.04, 1.0, 1.0).is_none() && closed(0.0, 0.0, 0.0).is_none());
        assert!(closed(f64::NAN, f64::NAN, 1.0).is_none(), "of what no row tells");
        // a window tells of a model by half as much again as noise alone would leave
        assert!(is_telling(55.0, 100.0) && !is_telling(45.0, 100.0) && !is_telling(0.0, 0.0));
    }

    #[test]
    fn value_the_floor_of_a_rounded_log_is_its_noise_with_the_rounding() {
        let mut random = Random::new(9);
        // noise of 0.58 of a step about a course that moves some steps: with the rounding 0.65
        let value = |row: u32| (50.0 * libm::sin(0.02 * f64::from(row)) + 0.58 * random.normal()).round();
        let scatter = scatter(&[&(0..2000).map(value).collect::<Vec<f64>>()]);
        let all = 0.58f64.hypot(1.0 / 12f64.sqrt());
        assert!((floor(all, &scatter) / all - 1.0).abs() < 0.03, "{scatter:?}");
        // by the rows in the middle it was a step of a high difference or none
        assert!(scatter.quiet < 0.97 * all, "{scatter:?}");
        // of a channel that moves between its rows the fit knows the noise
        assert_eq!(floor(0.15 * scatter.quiet, &scatter), 0.15 * scatter.quiet);
        // what a model lacks is no noise, nor is what a fit takes for process noise none
        assert_eq!((floor(10.0 * all, &scatter), floor(0.0, &scatter)), (scatter.noise, scatter.quiet));
    }
}
