//! Our own rig's channels as the page lays them over each other.

use super::channels::{self, Measures};
use super::dataset::{DataSet, Run};
use super::residual::{Block, Signal};
use crate::overlay::{Dependence, Overlaid, at};

/// Every channel that a cut compares and that a run logged, of the last run that has rows of it: residuals of the nominal and of
/// the amended model.
pub fn channels(
    (nominal, amended): (&[Block], &[Block]),
    signals: &[Signal],
    data: &DataSet,
    left_out: bool,
) -> Vec<Overlaid> {
    let of = |(index, signal): (usize, &Signal)| {
        let last = amended.iter().rev().find(|block| holds(block, index))?.run;
        let run = data.runs.get(last)?;
        let measured = logged(run, &signal.name)?;
        let residual = |blocks: &[Block]| residuals(blocks, last, index);
        let model = |blocks: &[Block]| -> Vec<(f64, f64)> {
            let less = |(time, residual): (f64, f64)| Some((time, at(&measured, time)? - residual));
            residual(blocks).into_iter().filter_map(less).collect()
        };
        Some(Overlaid {
            run: run.name.clone(),
            left_out,
            signal: signal.name.clone(),
            unit: signal.unit.to_owned(),
            drawn: is_drawn(&signal.name),
            nominal: model(nominal),
            amended: model(amended),
            residual: residual(amended),
            over: over_states((nominal, amended), index),
            measured,
        })
    };
    signals.iter().enumerate().filter_map(of).filter(|channel| channel.amended.len() > 1).collect()
}

/// Areas say how large a circle is, not where the machine was.
fn is_drawn(signal: &str) -> bool {
    let is_area = |channel: &channels::Channel| {
        channel.measures == Measures::Area
            && signal.split_once('.') == Some((channel.file.unit(), channel.column))
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

/// Means of both residuals over windows of all runs, beside the mean state there.
fn over_states((nominal, amended): (&[Block], &[Block]), signal: usize) -> Vec<Dependence> {
    let (nominal, amended) = (window_means(nominal, signal), window_means(amended, signal));
    let pairs = |means: &[([f64; 4], f64)], place: usize| -> Vec<(f64, f64)> {
        means.iter().map(|(state, residual)| (state[place], *residual)).collect()
    };
    let of = |(place, (name, unit)): (usize, (&str, &str))| Dependence {
        name: name.to_owned(),
        unit: unit.to_owned(),
        pairs: pairs(&amended, place),
        nominal: pairs(&nominal, place),
    };
    STATES.into_iter().enumerate().map(of).collect()
}

/// The mean state of each window with rows of a signal, and the signal's mean residual there.
fn window_means(blocks: &[Block], signal: usize) -> Vec<([f64; 4], f64)> {
    let mean = |block: &Block| {
        let cells = block.cells.iter().flat_map(|cell| cell.signal.iter().zip(&cell.residual));
        let own: Vec<f64> = cells.filter(|(of, _)| **of == signal).map(|(_, residual)| *residual).collect();
        (!own.is_empty()).then(|| (block.state, own.iter().sum::<f64>() / own.len() as f64))
    };
    blocks.iter().filter_map(mean).collect()
}
