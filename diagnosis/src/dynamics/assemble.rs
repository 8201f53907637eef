//! A linearised run of the differences of its rows. Effects at inputs follow by the chain rule from the mean of what is fed; effects at
//! outputs are exact.

use super::input_begin::{Begin, as_states};
use super::lag;
use super::linearise::{Chord, RowParts, RunAt, difference};
use super::machine::Role;
use super::schedule::{Placed, Schedule, output_effects};
use crate::infer::{Linearised, Measured};
use crate::observe::{InputEffect, OutputEffect, Reading};
use crate::ports::output;

/// A run with the differences of its rows, and what effects at ports change.
pub(super) struct Assembly<'a> {
    /// The run, its parameters, its path.
    pub about: RunAt<'a>,
    /// Differences, one a row.
    pub parts: &'a [RowParts],
    /// Effects at the outputs.
    pub effects: Vec<output::Effects>,
    /// Inputs that have differences.
    moved: Vec<usize>,
    /// What each chord changes at an input, if it is at one.
    fed: Vec<Option<Fed>>,
    /// What each chord of a delay or lag at an output changes of its channel, row by row, where the path has none yet.
    sensed: Vec<Option<Vec<f64>>>,
}

/// What an effect changes at an input: the mean over each interval, and the value at each row.
struct Fed {
    mean: Vec<f64>,
    at_row: Vec<f64>,
}

impl<'a> Assembly<'a> {
    pub fn new(about: RunAt<'a>, parts: &'a [RowParts], moved: Vec<usize>) -> Self {
        Self {
            fed: (about.chords.iter().map(|chord| about.fed_difference(chord)))
                .chain(about.begins.iter().map(|begin| Some(about.fed_at_begin(begin))))
                .collect(),
            sensed: (about.chords.iter().map(|chord| about.sensed(parts, chord)))
                .chain(about.begins.iter().map(|_| None))
                .collect(),
            effects: output_effects(&about.engine.machine, about.theta),
            about,
            parts,
            moved,
        }
    }

    /// The run, with a state more for each sensor and each input that lags.
    pub fn linearised(&self) -> Linearised {
        let RunAt { engine, run, grid, path, begins, schedule, .. } = self.about;
        let mut out = Linearised {
            states: engine.machine.order(),
            parameters: self.columns(),
            time: grid.time.clone(),
            first: vec![0],
            torn: grid.torn(&schedule.late),
            start: engine.start(run, path),
            ..Linearised::default()
        };
        self.add_intervals(&mut out);
        self.add_values(&mut out);
        let lags = lag::active(&engine.machine, self.about.theta);
        let out = if lags.is_empty() { out } else { self.augmented(out, &lags) };
        let sds: Vec<f64> = begins.iter().map(|begin| begin.sd).collect();
        if sds.is_empty() { out } else { as_states(&out, &sds) }
    }

    /// Columns: the chords', and one for each begin of an input's lag.
    pub fn columns(&self) -> usize {
        self.about.chords.len() + self.about.begins.len()
    }

    /// What a column is of.
    fn role(&self, place: usize) -> Role {
        let RunAt { engine, chords, begins, .. } = self.about;
        let begun = || Role::Input(begins[place - chords.len()].input, InputEffect::Lag);
        chords.get(place).map_or_else(begun, |chord| engine.machine.parameters[chord.parameter].role)
    }

    /// ∂(entry of a row)/∂θ of one chord, an entry of what [`super::worker::Worker::interval`] gives.
    pub fn column(&self, row: usize, place: usize, entry: usize) -> f64 {
        let machine = &self.about.engine.machine;
        let simulated = self.parts[row].simulated.get(place).filter(|column| !column.is_empty());
        match (self.role(place), simulated) {
            (Role::Unit(_), None) | (Role::Output(..), _) => 0.0,
            (Role::Unit(_) | Role::Input(..), Some(column)) => column[entry],
            (Role::Input(input, _), None) => {
                let (Some(fed), Some(slot)) =
                    (&self.fed[place], self.moved.iter().position(|known| *known == input))
                else {
                    return 0.0;
                };
                let outputs = machine.order()..machine.order() + machine.channels.len();
                let at_row = outputs.contains(&entry) || row + 1 == self.parts.len();
                let by = if at_row { &fed.at_row } else { &fed.mean };
                self.parts[row].inputs[slot][entry] * by[row * self.about.schedule.width + input]
            }
        }
    }

    /// Transition, defect and drive of each interval.
    fn add_intervals(&self, out: &mut Linearised) {
        let (n, path) = (out.states, self.about.path);
        for (row, part) in self.parts[..self.parts.len().saturating_sub(1)].iter().enumerate() {
            for i in 0..n {
                out.transition.extend(part.states.iter().map(|column| column[i]));
                out.defect.push(part.base[i] - path[(row + 1) * n + i]);
            }
            for place in 0..out.parameters {
                out.drive.extend((0..n).map(|i| self.column(row, place, i)));
            }
            out.late.extend((0..n).map(|i| part.late.get(i).copied().unwrap_or(0.0)));
        }
    }

    /// The values of each row.
    fn add_values(&self, out: &mut Linearised) {
        let RunAt { engine, grid, schedule, .. } = self.about;
        let mut placed = schedule.placed.iter().peekable();
        let unknown = grid.rows_with_unknown_input(engine.machine.reading, &schedule.late);
        for (row, blind) in unknown.into_iter().enumerate() {
            while let Some(at) = placed.next_if(|at| at.row == row) {
                self.add_value(at, at.early || blind, out);
            }
            out.first.push(out.measured.len());
        }
    }

    /// A measured value against the path; `left_out`: the model says nothing of it.
    fn add_value(&self, at: &Placed, left_out: bool, out: &mut Linearised) {
        let RunAt { engine, run, grid, .. } = self.about;
        let (row, sample) = (at.row, grid.samples[at.sample]);
        let (n, channels) = (engine.machine.order(), engine.machine.channels.len());
        let effect = self.effects[sample.channel];
        let entry = n + at.read.map_or(sample.channel, |read| channels + read);
        let value = self.parts[row].base[entry];
        let slope = self.slope(at, sample.channel);
        let since = sample.time - grid.origin;
        let outlier = engine.outliers[run].get(at.sample).copied().unwrap_or(false);
        if left_out && !outlier {
            // as one that is met to within its noise
            out.left_out += 1.0 + 2.0 * libm::log(engine.sensors[sample.channel]);
        }
        out.measured.push(Measured {
            channel: sample.channel,
            time: sample.time,
            residual: sample.value - effect.shown(value, since),
            slope: effect.gain * slope,
            weight: if left_out || outlier { 0.0 } else { 1.0 },
        });
        out.observe.extend(self.parts[row].states.iter().map(|column| effect.gain * column[entry]));
        for place in 0..self.columns() {
            let through = effect.gain * self.column(row, place, entry);
            let late = |_| self.sensed[place].as_ref().map_or(-slope, |by| by[row]);
            out.direct.push(through + self.at_port(place, sample.channel, value, since, late));
        }
    }

    /// What a column of an effect at a channel changes of one value of it: `since` the log's begin, s; `late` is what a later reading
    /// changes, per s.
    pub fn at_port(
        &self,
        place: usize,
        channel: usize,
        value: f64,
        since: f64,
        late: impl FnOnce(OutputEffect) -> f64,
    ) -> f64 {
        match self.role(place) {
            Role::Output(own, kind) if own == channel => {
                self.effects[channel].sensitivity(kind, value, since, late(kind))
            }
            _ => 0.0,
        }
    }

    /// Rate of change of an output along the path, per s, where a value is read.
    fn slope(&self, at: &Placed, channel: usize) -> f64 {
        let (parts, time) = (self.parts, &self.about.grid.time);
        let (row, last) = (at.row, parts.len() - 1);
        let entry = self.about.engine.machine.order() + channel;
        // read before the row's inputs acted, a value that is read a little earlier lies in the interval before
        let jumps = self.about.engine.machine.reading == Reading::Before;
        let within = if at.read.is_some() { Some(row) } else { row.checked_sub(1) };
        let (from, to, begun) = match within.filter(|row| jumps && *row < last) {
            Some(row) => (row, row + 1, parts[row].begun[channel]),
            None => {
                let from = row.saturating_sub(1);
                (from, (row + 1).min(last), parts[from].base[entry])
            }
        };
        let span = time[to] - time[from];
        if span > 0.0 { (parts[to].base[entry] - begun) / span } else { 0.0 }
    }
}

impl RunAt<'_> {
    /// What a chord of an effect at an input changes of what is fed.
    fn fed_difference(&self, chord: &Chord) -> Option<Fed> {
        let machine = &self.engine.machine;
        let Role::Input(..) = machine.parameters[chord.parameter].role else { return None };
        let mut theta = self.theta.to_vec();
        theta[chord.parameter] = chord.to;
        let there = Schedule::new(machine, self.grid, &theta);
        Some(Fed {
            mean: difference(&there.mean, &self.schedule.mean, chord.per),
            at_row: difference(&there.at_row, &self.schedule.at_row, chord.per),
        })
    }

    /// What a unit of what an input's lag held when the log began changes of what is fed.
    fn fed_at_begin(&self, begin: &Begin) -> Fed {
        let width = self.schedule.width;
        let spread = |own: &[f64]| {
            let mut all = vec![0.0; own.len() * width];
            own.iter().enumerate().for_each(|(row, value)| all[row * width + begin.input] = *value);
            all
        };
        Fed { mean: spread(&begin.mean), at_row: spread(&begin.at_row) }
    }

    /// What a chord of a delay or lag at an output changes of its channel, row by row: along the path where it has none yet.
    fn sensed(&self, parts: &[RowParts], chord: &Chord) -> Option<Vec<f64>> {
        let machine = &self.engine.machine;
        let Role::Output(channel, kind) = machine.parameters[chord.parameter].role else { return None };
        if self.theta[chord.parameter] != 0.0 || chord.per != 1.0 {
            return None;
        }
        let entry = machine.order() + channel;
        let values: Vec<f64> = parts.iter().map(|part| part.base[entry]).collect();
        let begun: Vec<f64> = match machine.reading {
            Reading::Before => parts.iter().map(|part| part.begun[channel]).collect(),
            Reading::After => values.clone(),
        };
        let there = match kind {
            OutputEffect::Lag => lag::lagged(&self.grid.time, &begun, &values, chord.to),
            OutputEffect::Delay => lag::delayed(&self.grid.time, &begun, &values, chord.to),
            OutputEffect::Gain | OutputEffect::Offset | OutputEffect::Drift => return None,
        };
        Some(difference(&there, &values, chord.per))
    }
}
