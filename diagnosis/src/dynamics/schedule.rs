//! What is fed and read within each interval of a run, after the effects at ports.

use super::grid::Grid;
use super::lag;
use super::machine::{Machine, Role};
use super::policy::DYNAMICS;
use super::worker::Job;
use crate::observe::{InputEffect, OutputEffect, Reading};
use crate::ports::{input, output};
use crate::statistics::levels::ROUNDING;

/// A value and where in the run the model gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// Place among the grid's samples.
    pub sample: usize,
    /// Row whose state gives it.
    pub row: usize,
    /// Place among the row's reads within the interval; `None`: at the row itself.
    pub read: Option<usize>,
    /// It lies before the run: not compared.
    pub early: bool,
}

/// A stretch with constant inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Begin, s: no sum of lengths, whose rounding would make some units step once more.
    pub from: f64,
    /// Length, s.
    pub span: f64,
    /// Reads at its end.
    pub reads: usize,
}

/// The schedule of one run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Schedule {
    /// Inputs.
    pub width: usize,
    /// Where the pieces of each row's interval begin; one more than rows.
    pub first: Vec<usize>,
    /// All pieces.
    pub pieces: Vec<Piece>,
    /// Inputs of each piece.
    pub fed: Vec<f64>,
    /// Inputs with which the outputs of each row are read: just before it, or just after.
    pub at_row: Vec<f64>,
    /// Mean inputs over each interval.
    pub mean: Vec<f64>,
    /// All values, by row.
    pub placed: Vec<Placed>,
    /// Channels of the reads within each interval, in order.
    pub reads: Vec<Vec<usize>>,
    /// For each row and channel that lags: times since the row, s, and places among its reads.
    pub inner: Vec<Vec<Vec<(f64, usize)>>>,
    /// How late each input is, s.
    pub late: Vec<f64>,
}

/// The effects at the inputs for these parameters.
pub fn input_effects(machine: &Machine, theta: &[f64]) -> Vec<input::Effects> {
    let mut effects = vec![input::Effects::OFF; machine.inputs.len()];
    for (parameter, value) in machine.parameters.iter().zip(theta) {
        if let Role::Input(place, effect) = parameter.role {
            let at = &mut effects[place];
            *match effect {
                InputEffect::Gain => &mut at.gain,
                InputEffect::Bias => &mut at.bias,
                InputEffect::Delay => &mut at.delay,
                InputEffect::Lag => &mut at.lag,
                InputEffect::Saturation => &mut at.saturation,
                InputEffect::RateLimit => &mut at.rate_limit,
            } = *value;
        }
    }
    effects
}

/// The effects at the outputs for these parameters.
pub fn output_effects(machine: &Machine, theta: &[f64]) -> Vec<output::Effects> {
    let mut effects = vec![output::Effects::OFF; machine.channels.len()];
    for (parameter, value) in machine.parameters.iter().zip(theta) {
        if let Role::Output(place, effect) = parameter.role {
            let at = &mut effects[place];
            *match effect {
                OutputEffect::Gain => &mut at.gain,
                OutputEffect::Offset => &mut at.offset,
                OutputEffect::Delay => &mut at.delay,
                OutputEffect::Lag => &mut at.lag,
                OutputEffect::Drift => &mut at.drift,
            } = *value;
        }
    }
    effects
}

impl Schedule {
    /// Of a run with these parameters.
    pub fn new(machine: &Machine, grid: &Grid, theta: &[f64]) -> Self {
        Self::later(machine, grid, theta, 0.0)
    }

    /// The same where every input acts later by so much than its log says, s.
    pub fn later(machine: &Machine, grid: &Grid, theta: &[f64], by: f64) -> Self {
        let mut effects = input_effects(machine, theta);
        effects.iter_mut().for_each(|effects| effects.delay += by);
        let lines: Vec<input::Lines> = grid
            .inputs
            .iter()
            .zip(&effects)
            .map(|(course, effects)| input::arriving(course, effects))
            .collect();
        let (placed, mut moments, inner) = placed(machine, grid, theta);
        // beyond the end the last inputs hold: there a state is read through what would follow
        let mut time = grid.time.clone();
        let usual = grid.span() / (time.len() - 1).max(1) as f64;
        for _ in 0..machine.horizon {
            time.push(time[time.len() - 1] + usual);
            moments.push(Vec::new());
        }
        let rows = time.len();
        let width = lines.len();
        let late = effects.iter().map(|effects| effects.delay).collect();
        let mut schedule = Self { width, first: vec![0], placed, inner, late, ..Self::default() };
        schedule.reads =
            moments.iter().map(|row| row.iter().map(|(_, channel)| *channel).collect()).collect();
        let mut near = vec![0; width];
        for (row, moments) in moments.iter().enumerate() {
            let from = time[row];
            let at_row = lines.iter().zip(&mut near).map(|(lines, near)| match machine.reading {
                Reading::Before => lines.before(from, near),
                Reading::After => lines.after(from, near),
            });
            schedule.at_row.extend(at_row);
            if row + 1 < rows {
                let to = time[row + 1];
                let means = lines.iter().zip(&mut near).map(|(lines, near)| lines.mean(from, to, near));
                schedule.mean.extend(means);
                let mut ends = Vec::new();
                if machine.any_step {
                    for (lines, near) in lines.iter().zip(&mut near) {
                        lines.breaks(from, to, near, &mut ends);
                    }
                    ends.extend(moments.iter().map(|(time, _)| *time));
                }
                schedule.cut(machine, from, to, ends, moments, &lines, &mut near);
            }
            schedule.first.push(schedule.pieces.len());
        }
        schedule
    }

    #[allow(clippy::too_many_arguments, reason = "one interval with all that cuts it")]
    fn cut(
        &mut self,
        machine: &Machine,
        from: f64,
        to: f64,
        mut ends: Vec<f64>,
        moments: &[(f64, usize)],
        lines: &[input::Lines],
        near: &mut [usize],
    ) {
        let whole = to - from;
        ends.push(to);
        ends.sort_by(f64::total_cmp);
        ends.dedup_by(|later, earlier| *later - *earlier < ROUNDING * whole);
        // the interval's end is exact, whatever fell on it
        if let Some(last) = ends.last_mut() {
            *last = to;
        }
        let mut begin = from;
        let mut reads = moments.iter().peekable();
        for end in ends {
            let moves = lines.iter().zip(near.iter_mut()).any(|(lines, near)| lines.moves(begin, near));
            // a unit that is faster than a row sees the course of its input, and not only its mean
            let longest = match machine.any_step && moves {
                true => machine.longest.min(whole / DYNAMICS.moving_parts),
                false => machine.longest,
            };
            let parts = parts(end - begin, longest);
            let span = (end - begin) / parts;
            for part in 0..parts as usize {
                let at = begin + part as f64 * span;
                self.fed.extend(
                    lines.iter().zip(near.iter_mut()).map(|(lines, near)| lines.mean(at, at + span, near)),
                );
                let last = part + 1 == parts as usize;
                let mut count = 0;
                while last && reads.peek().is_some_and(|(time, _)| *time <= end + ROUNDING * whole) {
                    reads.next();
                    count += 1;
                }
                self.pieces.push(Piece { from: at, span, reads: count });
            }
            begin = end;
        }
    }

    /// What happens over so many intervals after a row, as far as the schedule goes.
    pub fn job<'a>(&'a self, time: f64, row: usize, intervals: usize, states: &'a [f64]) -> Job<'a> {
        let last = (row + intervals).min(self.first.len() - 2);
        let (begin, end, width) = (self.first[row], self.first[last], self.width);
        Job {
            time,
            states,
            parameters: &[],
            at_row: &self.at_row[row * width..(last + 1) * width],
            first: &self.first[row..=last],
            pieces: &self.pieces[begin..end],
            fed: &self.fed[begin * width..end * width],
            reads: &self.reads[row],
            each_row: false,
        }
    }
}

/// Steps of a unit in a stretch of an interval.
fn parts(span: f64, longest: f64) -> f64 {
    (span / longest - ROUNDING).ceil().clamp(1.0, DYNAMICS.most_parts)
}

/// For each row the times and channels that are read within its interval.
type Moments = Vec<Vec<(f64, usize)>>;

/// For each row and channel that lags: times since the row and places among the row's reads.
type Inner = Vec<Vec<Vec<(f64, usize)>>>;

fn placed(machine: &Machine, grid: &Grid, theta: &[f64]) -> (Vec<Placed>, Moments, Inner) {
    let delays: Vec<f64> = output_effects(machine, theta).iter().map(|effects| effects.delay).collect();
    let mut moments: Moments = vec![Vec::new(); grid.time.len()];
    let mut all = Vec::with_capacity(grid.samples.len());
    let mut timed: Vec<(f64, usize)> = (grid.samples.iter().enumerate())
        .map(|(place, sample)| (sample.time - delays[sample.channel], place))
        .collect();
    timed.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut row = 0;
    for (time, sample) in timed {
        let early = time < grid.time[0];
        while row + 1 < grid.time.len() && grid.time[row + 1] <= time {
            row += 1;
        }
        let length = grid.time.get(row + 1).map_or(1.0, |next| next - grid.time[row]);
        let mut read = None;
        if !early && machine.any_step && time - grid.time[row] > ROUNDING * length {
            read = Some(moments[row].len());
            moments[row].push((time, grid.samples[sample].channel));
        }
        all.push(Placed { sample, row, read, early });
    }
    let lags = lag::active(machine, theta);
    let mut inner = Vec::new();
    if machine.any_step && !lags.is_empty() {
        let intervals = grid.time.len().saturating_sub(1);
        let bent = moments.iter_mut().take(intervals).enumerate();
        inner.extend(bent.map(|(row, moments)| bend(grid, row, &lags, moments, &mut all)));
    }
    (all, moments, inner)
}

/// Adds reads within a row's interval for the channels that lag, among those that are there; where they then are.
fn bend(
    grid: &Grid,
    row: usize,
    lags: &[lag::Lag],
    moments: &mut Vec<(f64, usize)>,
    placed: &mut [Placed],
) -> Vec<Vec<(f64, usize)>> {
    let (from, span) = (grid.time[row], grid.time[row + 1] - grid.time[row]);
    let at = |part: usize| from + span * (part + 1) as f64 / (DYNAMICS.lag_reads + 1) as f64;
    let own = (0..moments.len()).map(|place| (moments[place].0, moments[place].1, Some(place), 0));
    let new = lags.iter().enumerate().flat_map(|(slot, lag)| {
        (0..DYNAMICS.lag_reads)
            .map(move |part| (part, slot, lag.channel))
            .map(|(part, slot, channel)| (at(part), channel, None, slot))
    });
    let mut merged: Vec<(f64, usize, Option<usize>, usize)> = own.chain(new).collect();
    merged.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut inner = vec![Vec::new(); lags.len()];
    let mut to = vec![0; moments.len()];
    for (place, (time, _, old, slot)) in merged.iter().enumerate() {
        match old {
            Some(old) => to[*old] = place,
            None => inner[*slot].push((time - from, place)),
        }
    }
    let own = placed.partition_point(|one| one.row < row)..placed.partition_point(|one| one.row <= row);
    placed[own].iter_mut().for_each(|one| one.read = one.read.map(|old| to[old]));
    *moments = merged.into_iter().map(|(time, channel, ..)| (time, channel)).collect();
    inner
}

#[cfg(test)]
mod tests {
    use super::{Machine, Schedule, parts};
    use crate::dynamics::tests::{built, pendulum, place};

    #[test]
    fn value_where_an_input_moves_a_row_has_ten_steps_or_more() {
        let problem = pendulum("moving", 101);
        let built = built(&problem);
        let engine = &built.engine;
        let machine = Machine { longest: f64::INFINITY, ..engine.machine.clone() };
        let mut theta = machine.neutral();
        let most = |theta: &[f64]| {
            let schedule = Schedule::new(&machine, &engine.grids[0], theta);
            schedule.first.windows(2).take(100).map(|rows| rows[1] - rows[0]).max()
        };
        assert_eq!(most(&theta), Some(1), "held inputs");
        theta[place(&built, "tau:lag")] = 0.1;
        let lagging = most(&theta);
        assert!(
            lagging.is_some_and(|most| (10..=14).contains(&most)),
            "{lagging:?}: its own cuts may lie among them"
        );
    }

    #[test]
    fn value_an_interval_is_cut_into_steps_of_the_unit() {
        assert_eq!([parts(0.02, 0.01), parts(0.021, 0.01), parts(0.005, 0.01)], [2.0, 3.0, 1.0]);
        assert_eq!(parts(0.1 + 0.2, 0.1), 3.0, "but for rounding");
        // a log of an hour's rows, of a unit in steps of 4 s: all of them; in steps of 3 s a log of that would take minutes
        assert_eq!(parts(3600.0, 4.0), 900.0);
        assert!(parts(3600.0, 3.0) < 1100.0);
    }
}
