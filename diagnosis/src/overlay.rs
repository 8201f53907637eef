//! Measured, nominal and amended laid over each other for the report: each channel of one run, and its residual over time,
//! over its own past, over the states and the inputs.

use crate::rigs::acrobot::channels::{self, Measures};
use crate::rigs::acrobot::dataset::{DataSet, Run};
use crate::rigs::acrobot::residual::{Block, Signal};

/// A measured channel of a run, with what both models give in its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name of the run.
    pub run: String,
    /// Nothing was fitted to it but where its windows begin.
    pub left_out: bool,
    /// `instance.variable`.
    pub signal: String,
    /// Its unit.
    pub unit: String,
    /// The page lays measured, nominal and amended over each other.
    pub drawn: bool,
    /// Time in s and value, row by row of the log.
    pub measured: Vec<(f64, f64)>,
    /// What the nominal model gives, where it was compared.
    pub nominal: Vec<(f64, f64)>,
    /// What the amended one gives.
    pub amended: Vec<(f64, f64)>,
    /// Measured less amended, over time.
    pub residual: Vec<(f64, f64)>,
    /// The residual beside each state and input.
    pub over: Vec<Dependence>,
}

/// A residual beside what it may depend on.
#[derive(Debug, Clone, PartialEq)]
pub struct Dependence {
    /// The state or input.
    pub name: String,
    /// Its unit; empty: none is known.
    pub unit: String,
    /// Its value, and the residual there.
    pub pairs: Vec<(f64, f64)>,
}

/// Every channel that a cut compares and that a run logged, of the last run that has rows of it: residuals of the nominal and of
/// the amended model.
pub fn channels(
    (nominal, amended): (&[Block], &[Block]),
    signals: &[Signal],
    data: &DataSet,
    left_out: bool,
) -> Vec<Channel> {
    let of = |(index, signal): (usize, &Signal)| {
        let last = amended.iter().rev().find(|block| holds(block, index))?.run;
        let run = data.runs.get(last)?;
        let measured = logged(run, &signal.name)?;
        let residual = |blocks: &[Block]| residuals(blocks, last, index);
        let model = |blocks: &[Block]| -> Vec<(f64, f64)> {
            let less = |(time, residual): (f64, f64)| Some((time, at(&measured, time)? - residual));
            residual(blocks).into_iter().filter_map(less).collect()
        };
        Some(Channel {
            run: run.name.clone(),
            left_out,
            signal: signal.name.clone(),
            unit: signal.unit.to_owned(),
            drawn: is_drawn(&signal.name),
            nominal: model(nominal),
            amended: model(amended),
            residual: residual(amended),
            over: over_states(amended, index),
            measured,
        })
    };
    signals.iter().enumerate().filter_map(of).filter(|channel| channel.amended.len() > 1).collect()
}

/// Areas say how large a circle is, not where the machine was.
fn is_drawn(signal: &str) -> bool {
    let is_area = |channel: &channels::Channel| {
        channel.measures == Measures::Area && signal.split_once('.') == Some((channel.file.unit(), channel.column))
    };
    !channels::CHANNELS.iter().any(is_area)
}

fn holds(block: &Block, signal: usize) -> bool {
    block.cells.iter().any(|cell| cell.signal.contains(&signal))
}

/// The rows of a log that hold a number.
fn logged(run: &Run, signal: &str) -> Option<Vec<(f64, f64)>> {
    let (instance, variable) = signal.split_once('.')?;
    let table = match instance {
        "camera" => run.camera.as_ref()?,
        "plant" => run.plant.as_ref()?,
        _ => return None,
    };
    let rows = table.time.iter().copied().zip(table.column(variable)?.iter().copied());
    let rows: Vec<(f64, f64)> = rows.filter(|(_, value)| value.is_finite()).collect();
    (rows.len() > 1).then_some(rows)
}

/// A log at a time: between two rows on the straight line, since rows that lie close are compared as their mean.
pub(crate) fn at(rows: &[(f64, f64)], time: f64) -> Option<f64> {
    let next = rows.partition_point(|(of, _)| *of < time);
    let (t1, v1) = *rows.get(next)?;
    if t1 == time || next == 0 {
        return (t1 == time).then_some(v1);
    }
    let (t0, v0) = rows[next - 1];
    Some(v0 + (time - t0) / (t1 - t0) * (v1 - v0))
}

/// The residual of a signal in a run, in order of time; of windows that overlap the first one's.
fn residuals(blocks: &[Block], run: usize, signal: usize) -> Vec<(f64, f64)> {
    let cells = blocks.iter().filter(|block| block.run == run).flat_map(|block| &block.cells);
    let mut points: Vec<(f64, f64)> = cells
        .flat_map(|cell| (0..cell.residual.len()).map(move |row| (cell, row)))
        .filter(|(cell, row)| cell.signal[*row] == signal)
        .filter_map(|(cell, row)| Some((*cell.time.get(row)?, cell.residual[row])))
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.dedup_by(|a, b| a.0 == b.0);
    points
}

/// The states of our own rig, as [`Block::state`] has them.
const STATES: [(&str, &str); 4] = [("q1", "rad"), ("q2", "rad"), ("dq1", "rad/s"), ("dq2", "rad/s")];

/// Means of the residual over windows of all runs, beside the mean state there.
fn over_states(blocks: &[Block], signal: usize) -> Vec<Dependence> {
    let mean = |block: &Block| {
        let cells = block.cells.iter().flat_map(|cell| cell.signal.iter().zip(&cell.residual));
        let own: Vec<f64> = cells.filter(|(of, _)| **of == signal).map(|(_, residual)| *residual).collect();
        (!own.is_empty()).then(|| (block.state, own.iter().sum::<f64>() / own.len() as f64))
    };
    let means: Vec<([f64; 4], f64)> = blocks.iter().filter_map(mean).collect();
    let of = |(place, (name, unit)): (usize, (&str, &str))| Dependence {
        name: name.to_owned(),
        unit: unit.to_owned(),
        pairs: means.iter().map(|(state, residual)| (state[place], *residual)).collect(),
    };
    STATES.into_iter().enumerate().map(of).collect()
}

/// The correlation of a series with itself so many rows before, from 1 row on; none of a series too short or still.
pub fn autocorrelation(points: &[(f64, f64)], most: usize) -> Vec<(f64, f64)> {
    let mean = points.iter().map(|(_, value)| value).sum::<f64>() / points.len().max(1) as f64;
    let off: Vec<f64> = points.iter().map(|(_, value)| value - mean).collect();
    let square: f64 = off.iter().map(|value| value * value).sum();
    if square <= 0.0 || points.len() < 8 {
        return Vec::new();
    }
    let at = |lag: usize| off.iter().zip(&off[lag..]).map(|(a, b)| a * b).sum::<f64>() / square;
    (1..=most.min(points.len() / 2)).map(|lag| (lag as f64, at(lag))).collect()
}

/// Means of equally many neighbours in the first number of each pair: a dependence shows, single points don't hide it.
pub fn binned(mut pairs: Vec<(f64, f64)>, bins: usize) -> Vec<(f64, f64)> {
    pairs.retain(|(x, y)| x.is_finite() && y.is_finite());
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let size = pairs.len().div_ceil(bins.max(1)).max(1);
    let mean = |part: &[(f64, f64)]| {
        let many = part.len() as f64;
        (
            part.iter().map(|pair| pair.0).sum::<f64>() / many,
            part.iter().map(|pair| pair.1).sum::<f64>() / many,
        )
    };
    let mut means: Vec<(f64, f64)> = pairs.chunks(size).map(mean).collect();
    means.dedup_by(|a, b| a.0 == b.0);
    means
}

#[cfg(test)]
mod tests {
    use super::{at, autocorrelation, binned};

    #[test]
    fn value_autocorrelation_of_a_known_series() {
        // +1, -1, +1, ...: one row before everything is opposite, n - 1 products of n squares; two rows before equal.
        let points: Vec<(f64, f64)> =
            (0..10).map(|row| (f64::from(row), if row % 2 == 0 { 1.0 } else { -1.0 })).collect();
        assert_eq!(autocorrelation(&points, 2), [(1.0, -0.9), (2.0, 0.8)]);
        assert!(autocorrelation(&points.iter().map(|(t, _)| (*t, 3.0)).collect::<Vec<_>>(), 2).is_empty());
    }

    #[test]
    fn value_bins_are_means_of_neighbours() {
        let pairs = vec![(3.0, 30.0), (1.0, 10.0), (4.0, 40.0), (2.0, f64::NAN), (2.0, 20.0)];
        assert_eq!(binned(pairs, 2), [(1.5, 15.0), (3.5, 35.0)]);
    }

    #[test]
    fn law_a_log_is_known_between_its_rows_only() {
        let rows = [(0.0, 1.0), (1.0, 3.0)];
        assert_eq!([0.0, 0.5, 1.0].map(|time| at(&rows, time)), [Some(1.0), Some(2.0), Some(3.0)]);
        assert_eq!([-0.1, 1.1].map(|time| at(&rows, time)), [None, None]);
    }
}
