//! The rows of a run: every time at which a compared channel has a value.

use super::machine::Machine;
use crate::observe::{Hold, Run};
use crate::statistics::levels::{FINE, SEVERAL, SLIGHT};

/// A value of a compared channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Place among [`Machine::channels`].
    pub channel: usize,
    /// When, s.
    pub time: f64,
    /// In the variable's own unit.
    pub value: f64,
}

/// A fed input over time, as logged.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// Times, s.
    pub time: Vec<f64>,
    /// Values.
    pub values: Vec<f64>,
    /// Between them.
    pub hold: Hold,
}

impl Course {
    /// The value from a time on; before the first row its value.
    pub fn value(&self, time: f64) -> f64 {
        let after = self.time.partition_point(|t| *t <= time);
        let Some(place) = after.checked_sub(1) else { return self.values.first().copied().unwrap_or(0.0) };
        match (self.hold, self.time.get(after)) {
            (Hold::Linear, Some(next)) => {
                let share = (time - self.time[place]) / (next - self.time[place]);
                self.values[place] + share * (self.values[after] - self.values[place])
            }
            _ => self.values[place],
        }
    }
}

/// A held input jumps where it changes by more than so many times its usual change.
const JUMP: f64 = SEVERAL;

impl Course {
    /// Times at which it jumps: at all where it seldom moves, by more than usual where it always does.
    pub fn jumps(&self) -> Vec<f64> {
        let moves: Vec<f64> = self.values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
        let mut sorted = moves.clone();
        sorted.sort_by(f64::total_cmp);
        let usual = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
        let times = self.time.iter().skip(1).zip(&moves);
        times.filter(|(_, by)| **by > JUMP * usual).map(|(time, _)| *time).collect()
    }
}

/// One run, as the sweep walks it.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Name of the run.
    pub name: String,
    /// Times of the rows, s.
    pub time: Vec<f64>,
    /// Values, ordered by time.
    pub samples: Vec<Sample>,
    /// Fed inputs, as [`Machine::inputs`].
    pub inputs: Vec<Course>,
    /// When the run begins, s: drifts count from there.
    pub origin: f64,
    /// Whether rows are missing after each row, with what was fed meanwhile.
    pub torn: Vec<bool>,
}

/// Times closer than this share of the usual distance are one row: stamps of two columns written by hand.
const SAME: f64 = FINE;

/// Intervals of more than so many usual ones lack rows, if a held input is another after it; of twice as many in any case.
const MISSING: f64 = 1.8;
/// Where more than this share of the intervals would lack rows, the log is irregular and none of them does.
const SELDOM: f64 = SLIGHT;

/// Intervals in which rows are missing, and with them what a held input was that is logged row by row.
fn torn(machine: &Machine, time: &[f64], inputs: &[Course]) -> Vec<bool> {
    let usual = |time: &[f64]| {
        let mut gaps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
        gaps.sort_by(f64::total_cmp);
        gaps.get(gaps.len() / 2).copied().unwrap_or(f64::INFINITY)
    };
    let row = usual(time);
    let held = machine.inputs.iter().zip(inputs).filter(|(input, course)| {
        input.channel.is_some() && course.hold == Hold::Zero && usual(&course.time) < MISSING * row
    });
    let held: Vec<&Course> = held.map(|(_, course)| course).collect();
    let lacks = |pair: &[f64]| {
        let (from, to) = (pair[0], pair[1]);
        let long = (to - from) / row;
        long > MISSING
            && held.iter().any(|course| {
                let until = course.time.partition_point(|time| *time < to);
                let logged = course.time.partition_point(|time| *time <= from) < until;
                !logged && (long > 2.0 * MISSING || course.value(from) != course.value(to))
            })
    };
    let torn: Vec<bool> = time.windows(2).map(lacks).collect();
    let count = torn.iter().filter(|torn| **torn).count();
    if count as f64 > SELDOM * torn.len() as f64 { vec![false; torn.len()] } else { torn }
}

impl Grid {
    /// Of a run, between two times.
    pub fn new(machine: &Machine, run: &Run, from: f64, to: f64) -> Self {
        let mut samples: Vec<Sample> = Vec::new();
        for (channel, output) in machine.channels.iter().enumerate() {
            let series = &run.series[output.channel];
            let within = series.time.iter().zip(&series.values).filter(|(t, _)| (from..=to).contains(*t));
            samples.extend(within.map(|(time, value)| Sample { channel, time: *time, value: *value }));
        }
        samples.sort_by(|a, b| a.time.total_cmp(&b.time).then(a.channel.cmp(&b.channel)));
        let mut time: Vec<f64> = samples.iter().map(|sample| sample.time).collect();
        let span = time.last().zip(time.first()).map_or(0.0, |(last, first)| last - first);
        let near = SAME * span / time.len().max(1) as f64;
        time.dedup_by(|later, earlier| *later - *earlier <= near);
        let mut row = 0;
        for sample in &mut samples {
            while row + 1 < time.len() && time[row + 1] <= sample.time {
                row += 1;
            }
            sample.time = time[row];
        }
        let inputs: Vec<Course> = machine
            .inputs
            .iter()
            .map(|input| {
                let (begin, series) = match input.channel {
                    Some(channel) => (0.0, &run.series[channel]),
                    None => (run.span().0, &input.given),
                };
                let time: Vec<f64> = series.time.iter().map(|time| begin + time).collect();
                let values = series.values.clone();
                Course { time, values, hold: input.hold }
            })
            .collect();
        let torn = torn(machine, &time, &inputs);
        let begins = machine.channels.iter().filter_map(|output| run.series[output.channel].time.first());
        let origin = begins.copied().fold(f64::INFINITY, f64::min);
        Self { name: run.name.clone(), time, samples, inputs, origin, torn }
    }

    /// Length, s.
    pub fn span(&self) -> f64 {
        self.time.last().zip(self.time.first()).map_or(0.0, |(last, first)| last - first)
    }
}
