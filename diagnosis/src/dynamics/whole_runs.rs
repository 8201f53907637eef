//! Units that nothing can start within a run: no start parameter, no output of initial "exact". A run is simulated whole, from the
//! unit's own start.
//!
//! What a channel shows beyond the model is then a state of its own, one a channel: a random walk with process noise, which is at
//! its floor where the model explains the data. Search and verdict are those of linked states; an unlisted input is one that
//! adds to this residual.
//!
//! What an input was where rows of it are missing is a few states more for each such stretch, one for each piece of it, which stay as they
//! are: what the outputs show from there on of another input is what they show.

use super::build::Span;
use super::grid::{Course, Grid, Lost};
use super::linearise::{Chord, Engine, difference};
use super::machine::{Machine, Parameter, Reference, Role, State};
use super::outliers::excluded;
use super::policy::DYNAMICS;
use super::schedule::{Schedule, output_effects};
use super::worker::Job;
use crate::error::Error;
use crate::infer::fit::Path;
use crate::infer::sweep::MOST_STATES;
use crate::infer::{Linearised, Measured};
use crate::observe::{Hold, Run};
use crate::statistics::levels::{FINE, ROUNDING, STEP};
use rayon::prelude::*;

/// One state for each channel: what it shows beyond the model.
pub(super) fn states(machine: &Machine) -> Vec<State> {
    let own = |(channel, output): (usize, &super::machine::Output)| State {
        name: output.name.clone(),
        start: Reference { instance: 0, reference: 0, kind: output.variable.kind },
        shows: None,
        nominal: 0.0,
        channel: Some(channel),
    };
    machine.channels.iter().enumerate().map(own).collect()
}

/// Times between which each piece of a stretch lies: from where what was logged last no longer holds, or the run begins.
fn pieces(lost: &Lost, begin: f64) -> Vec<(f64, f64)> {
    let from = begin.max(lost.from + lost.usual);
    let count = (((lost.to - from) / lost.usual).round() as usize).clamp(1, DYNAMICS.lost_pieces);
    let at = |piece: usize| from + (lost.to - from) * piece as f64 / count as f64;
    (0..count).map(|piece| (at(piece), at(piece + 1))).collect()
}

/// An input that is another by so much between two times.
fn moved(own: &Course, (from, to): (f64, f64), by: f64) -> Course {
    // along lines it goes there and back within a thousandth of the time
    let short = if own.hold == Hold::Linear { FINE * (to - from) } else { 0.0 };
    let ends = [(from, 0.0), (from + short, by), (to - short, by), (to, 0.0)];
    let mut points: Vec<(f64, f64)> = own.time.iter().copied().zip(own.values.iter().copied()).collect();
    points.retain(|(time, _)| *time <= from || *time >= to);
    let before = points.partition_point(|(time, _)| *time < from);
    points.splice(before..before, ends.map(|(time, by)| (time, own.value(time) + by)));
    // of the points at one time the last holds; that which was logged there is there already
    points.dedup_by(|later, earlier| {
        let same = later.0 == earlier.0;
        if same {
            *earlier = *later;
        }
        same
    });
    let (time, values) = points.into_iter().unzip();
    Course { time, values, hold: own.hold }
}

/// The same parameters, sensors as they should be.
fn without_sensors(machine: &Machine, theta: &[f64]) -> Vec<f64> {
    let of = |(parameter, value): (&Parameter, &f64)| match parameter.role {
        Role::Output(..) => parameter.neutral,
        _ => *value,
    };
    machine.parameters.iter().zip(theta).map(of).collect()
}

/// Whether something shows over some rows, or over all of these.
fn within(all: usize, shows: &mut dyn FnMut(usize) -> Result<bool, Error>) -> Result<bool, Error> {
    Ok(shows(DYNAMICS.watched.min(all))? || all > DYNAMICS.watched && shows(all)?)
}

/// What the outputs of a whole run show, a number for each row and channel.
struct Shown {
    /// By themselves.
    base: Vec<f64>,
    /// Of each unknown: another start, another input.
    unknown: Vec<Vec<f64>>,
    /// Of each chord.
    columns: Vec<Vec<f64>>,
}

impl Engine {
    /// Each run is simulated from its begin on, whatever rows of it are compared; the states are what channels show beyond the model.
    pub(super) fn follow_whole(&mut self, runs: &[(&Run, Span)], sizes: &[f64]) {
        for (grid, (run, (from, to))) in self.grids.iter_mut().zip(runs) {
            *grid = Grid::new(&self.machine, run, run.span().0, *to);
            let first = |channel: usize| grid.samples.iter().find(|sample| sample.channel == channel);
            let begun = |(state, scale): (&State, &f64)| {
                (state.channel.and_then(first).map_or(state.nominal, |sample| sample.value), *scale)
            };
            grid.begin = self.machine.states.iter().zip(&self.scales).map(begun).collect();
            grid.samples.retain(|sample| sample.time >= *from);
        }
        let rests = states(&self.machine);
        self.machine.begins = std::mem::replace(&mut self.machine.states, rests);
        self.machine.whole = true;
        self.scales = sizes.to_vec();
        self.outliers = excluded(&self.machine, &self.grids);
    }

    /// How many states a whole run has at least: one a channel, and one for each start value. Pieces of unknown inputs take the room that
    /// this leaves.
    ///
    /// # Errors
    /// They are more than the sweep follows, with one left for an unlisted input.
    pub(super) fn whole_states(&self) -> Result<usize, Error> {
        let (channels, begins) = (self.machine.order(), self.machine.begins.len());
        let (count, most) = (channels + begins, MOST_STATES - 1);
        if count > most {
            return Err(Error::Model(format!(
                "runs that are simulated whole have a state for each of {channels} compared outputs and of {begins} start values: {count} \
                 in all; this way follows at most {most}. Compare fewer outputs"
            )));
        }
        Ok(count)
    }

    /// Whether the outputs after some rows depend on what was before them: a fresh start there gives others.
    pub(super) fn remembers(&self, sizes: &[f64]) -> Result<bool, Error> {
        // what moves slowly shows over the whole log only
        let half = (self.grids[0].time.len() - 1) / 2;
        within(half, &mut |rows| self.remembers_over(rows, sizes))
    }

    fn remembers_over(&self, watched: usize, sizes: &[f64]) -> Result<bool, Error> {
        let grid = &self.grids[0];
        let schedule = Schedule::new(&self.machine, grid, &self.machine.neutral());
        let (n, channels) = (self.machine.order(), self.machine.channels.len());
        self.with_worker(|worker| {
            let (mut through, mut fresh) = (Vec::new(), Vec::new());
            let states = self.nominal_states(grid, 0);
            let job = |row: usize, count: usize| Job {
                each_row: true,
                reads: &[],
                ..schedule.job(grid.time[row], row, count, &states)
            };
            worker.interval(&self.machine, &job(0, 2 * watched), &mut through)?;
            worker.interval(&self.machine, &job(watched, watched), &mut fresh)?;
            Ok((1..=watched).any(|row| {
                (0..channels).any(|channel| {
                    let there = through[n + (watched + row) * channels + channel];
                    let here = fresh[n + row * channels + channel];
                    (there - here).abs() > (0.5 * self.sensors[channel]).max(1e-3 * sizes[channel])
                })
            }))
        })
    }

    /// Outputs of a run at its rows, as the log would show them: rows of channels.
    fn simulated(&self, grid: &Grid, theta: &[f64]) -> Result<Vec<f64>, Error> {
        let (machine, channels) = (&self.machine, self.machine.channels.len());
        // what sensors do is done to the rows' values; units step as they would without, since not all bear other steps
        let schedule = Schedule::new(machine, grid, &without_sensors(machine, theta));
        let set = self.set(theta);
        let states = self.nominal_states(grid, 0);
        let whole = schedule.job(grid.time[0], 0, grid.time.len() - 1, &states);
        let mut out = Vec::new();
        self.with_worker(|worker| {
            worker.interval(machine, &Job { parameters: &set, each_row: true, reads: &[], ..whole }, &mut out)
        })?;
        let rows = out.split_off(machine.order());
        let mut shown = vec![0.0; rows.len()];
        for (channel, effect) in output_effects(machine, theta).iter().enumerate() {
            let values: Vec<f64> = rows.iter().skip(channel).step_by(channels).copied().collect();
            let sensed = super::sensed(&grid.time, &values, effect.delay, effect.lag);
            for (row, value) in sensed.into_iter().enumerate() {
                shown[row * channels + channel] = effect.shown(value, grid.time[row] - grid.origin);
            }
        }
        Ok(shown)
    }

    /// What the outputs show of another start, by how far each start value may be off.
    fn begins_elsewhere(&self, grid: &Grid, theta: &[f64], base: &[f64]) -> Result<Vec<Vec<f64>>, Error> {
        let shows = |place: usize| -> Result<Vec<f64>, Error> {
            let mut other = grid.clone();
            other.begin[place].0 += STEP * grid.begin[place].1;
            let none = || vec![0.0; base.len()];
            // where another start can't be followed it stays where it was seen
            let Ok(there) = self.simulated(&other, theta) else { return Ok(none()) };
            let shown: Vec<f64> = there.iter().zip(base).map(|(there, here)| (there - here) / STEP).collect();
            let sizes = self.scales.iter().cycle();
            let reasonable = shown.iter().zip(sizes).all(|(by, size)| ROUNDING * by.abs() < *size);
            Ok(if reasonable { shown } else { none() })
        };
        (0..grid.begin.len()).into_par_iter().map(shows).collect()
    }

    /// What the outputs show of another input where nobody knows it, by its whole size in each piece of a stretch; of the longest
    /// stretches, as many as there is room for.
    fn unknown_inputs(&self, grid: &Grid, theta: &[f64], base: &[f64]) -> Result<Vec<Vec<f64>>, Error> {
        let (begin, end) = (grid.time[0], grid.time[grid.time.len() - 1]);
        let mut lost: Vec<&Lost> =
            grid.lost.iter().filter(|lost| lost.to > begin && lost.from < end).collect();
        lost.sort_by(|a, b| (b.to - b.from).total_cmp(&(a.to - a.from)));
        let each =
            lost.iter().flat_map(|lost| pieces(lost, begin).into_iter().map(|piece| (lost.input, piece)));
        let room = MOST_STATES - 1 - self.whole_states()?;
        let all: Vec<(usize, (f64, f64))> = each.take(room).collect();
        let shows = |(input, piece): &(usize, (f64, f64))| -> Result<Vec<f64>, Error> {
            let mut other = grid.clone();
            other.inputs[*input] = moved(&grid.inputs[*input], *piece, self.input_scales[*input]);
            let there = self.simulated(&other, theta)?;
            Ok(there.iter().zip(base).map(|(there, here)| there - here).collect())
        };
        all.par_iter().map(shows).collect()
    }

    /// A run about its path of rests.
    pub(super) fn whole(
        &self,
        run: usize,
        theta: &[f64],
        path: &Path,
        chords: &[Chord],
    ) -> Result<Linearised, Error> {
        let (grid, n, p) = (&self.grids[run], self.machine.order(), chords.len());
        let base = self.simulated(grid, theta)?;
        let column = |chord: &Chord| -> Result<Vec<f64>, Error> {
            let mut there = theta.to_vec();
            there[chord.parameter] = chord.to;
            let changed = self.simulated(grid, &there).map(|there| difference(&there, &base, chord.per));
            self.or_refused(chord, changed, || vec![0.0; base.len()])
        };
        let columns = chords.par_iter().map(column).collect::<Result<Vec<_>, _>>()?;
        let mut unknown = self.begins_elsewhere(grid, theta, &base)?;
        unknown.extend(self.unknown_inputs(grid, theta, &base)?);
        let (rows, wide) = (grid.time.len(), n + unknown.len());
        let mut out = Linearised {
            states: wide,
            parameters: p,
            time: grid.time.clone(),
            first: vec![0],
            start: self.start(run, path),
            drive: vec![0.0; (rows - 1) * wide * p],
            ..Linearised::default()
        };
        out.start.0.extend(unknown.iter().map(|_| 0.0));
        out.start.1.extend(unknown.iter().map(|_| 1.0));
        for row in 0..rows - 1 {
            // what a channel shows beyond the model stays what it is, and so does what is unknown
            let one = |place| if place % (wide + 1) == 0 { 1.0 } else { 0.0 };
            out.transition.extend((0..wide * wide).map(one));
            out.defect.extend((0..n).map(|i| path[row * n + i] - path[(row + 1) * n + i]));
            out.defect.extend(unknown.iter().map(|_| 0.0));
        }
        self.add_whole_values(run, path, &Shown { base, unknown, columns }, &mut out);
        Ok(out)
    }

    /// The values of a whole run against its path.
    fn add_whole_values(&self, run: usize, path: &Path, shown: &Shown, out: &mut Linearised) {
        let (grid, n, base) = (&self.grids[run], self.machine.order(), &shown.base);
        let rows = grid.time.len();
        let mut samples = grid.samples.iter().zip(&self.outliers[run]).peekable();
        for row in 0..rows {
            let around = (row.saturating_sub(1), (row + 1).min(rows - 1));
            let span = (grid.time[around.1] - grid.time[around.0]).max(1e-300);
            while let Some((sample, outlier)) = samples.next_if(|(sample, _)| sample.time <= grid.time[row]) {
                let entry = row * n + sample.channel;
                out.measured.push(Measured {
                    channel: sample.channel,
                    time: sample.time,
                    residual: sample.value - base[entry] - path[entry],
                    slope: (base[around.1 * n + sample.channel] - base[around.0 * n + sample.channel]) / span,
                    weight: if *outlier { 0.0 } else { 1.0 },
                });
                out.observe.extend((0..n).map(|i| if i == sample.channel { 1.0 } else { 0.0 }));
                out.observe.extend(shown.unknown.iter().map(|shows| shows[entry]));
                out.direct.extend(shown.columns.iter().map(|column| column[entry]));
            }
            out.first.push(out.measured.len());
        }
    }

    /// A parameter's largest change of a whole run, in units of noise.
    pub(super) fn telling_whole(&self, theta: &[f64], there: &[f64], noise: &[f64]) -> Result<f64, Error> {
        let grid = &self.grids[0];
        let here = self.simulated(grid, theta)?;
        let Ok(there) = self.simulated(grid, there) else { return Ok(0.0) };
        let changes = here.iter().zip(&there).enumerate();
        Ok(changes.map(|(entry, (a, b))| (b - a).abs() / noise[entry % noise.len()]).fold(0.0, f64::max))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_each_piece_of_an_unknown_stretch_moves_the_mean_of_the_input_and_nothing_else() {
        let lost = Lost { input: 0, from: 3.0, to: 9.0, usual: 1.0 };
        let (time, values) = (vec![0.0, 1.0, 2.0, 3.0, 9.0, 10.0], vec![1.0, 4.0, 4.0, 2.0, 7.0, 7.0]);
        assert_eq!(pieces(&lost, 0.0).first().map(|piece| piece.0), Some(4.0), "until then row 3 holds");
        assert_eq!(pieces(&lost, 0.0).last().map(|piece| piece.1), Some(9.0));
        assert_eq!(pieces(&Lost { to: 5.0, ..lost }, 0.0), [(4.0, 5.0)], "one row, one piece");
        let before = Lost { from: f64::NEG_INFINITY, to: 2.0, ..lost };
        assert_eq!(pieces(&before, 0.0), [(0.0, 1.0), (1.0, 2.0)], "from where the run begins");
        for hold in [Hold::Zero, Hold::Linear] {
            let own = Course { time: time.clone(), values: values.clone(), hold };
            for (from, to) in pieces(&lost, 0.0) {
                let other = moved(&own, (from, to), 10.0);
                let inside = |at: f64| at > from && at < to;
                for at in (0..100).map(|part| 0.1 * f64::from(part) + 0.05) {
                    let by = if inside(at) { 10.0 } else { 0.0 };
                    // along lines two numbers of size 10 are rounded
                    assert!((other.value(at) - own.value(at) - by).abs() < 1e-12, "{hold:?} {from} {at}");
                }
                assert!(
                    time.iter()
                        .all(|row| (other.value(*row) - own.value(*row)).abs() < 1e-12 || inside(*row))
                );
            }
        }
    }

    #[test]
    fn value_an_unknown_stretch_is_no_more_than_what_units_remember_of_it() {
        // rows that lack, and pieces: each is an unknown of the fit, and most units remember two or three states of it
        let count = |rows: f64| pieces(&Lost { input: 0, from: 3.0, to: 4.0 + rows, usual: 1.0 }, 0.0).len();
        assert_eq!([1.0, 2.0, 3.0, 4.0, 200.0].map(count), [1, 2, 3, 3, 3]);
    }

    #[test]
    fn value_over_how_many_rows_a_unit_is_watched() {
        // what it remembers, seen over these rows after a fresh start and not over others
        let seen = |all: usize, from: usize, to: usize| {
            within(all, &mut |rows| Ok((from..=to).contains(&rows))).expect("no unit, no fault")
        };
        assert!(seen(500, 20, 40), "forgotten after a second or so of a log at 30 Hz");
        assert!(seen(500, 400, 500), "what moves slowly");
        assert!(seen(10, 10, 10), "a short log");
        assert!(
            !seen(500, 1, 12),
            "what is forgotten within a dozen rows is not worth a simulation as a whole"
        );
    }
}
