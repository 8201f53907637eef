//! Inputs that no log feeds: what the scenario's sources deliver, and what nobody knows.

use super::log::Log;
use super::{Channel, Hold, Nominal, Series, VariableId};
use crate::error::{Error, Notice};
use orchestrator::Kind;
use orchestrator::fmu::Causality;
use orchestrator::scenario::{Shape, SignalEntry};
use std::path::Path;

/// An input without a channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Unlogged {
    /// The variable.
    pub variable: VariableId,
    /// Between its points.
    pub hold: Hold,
    /// Its course from a run's begin on.
    pub series: Series,
    /// Neither a log nor the scenario says what it was: it may have been another value.
    pub open: bool,
}

/// Lines of a smooth source's piece: they are off by less than a thousandth of its rise.
const PARTS: usize = 40;

/// All of them: sources first, in the scenario's order.
pub(super) fn unlogged(
    model: &Nominal,
    channels: &[Channel],
    notices: &mut Vec<Notice>,
) -> Result<Vec<Unlogged>, Error> {
    let logged = |id: VariableId| channels.iter().any(|channel| channel.variable == id);
    let mut list = Vec::new();
    for source in &model.scenario.sources {
        let Ok(variable) = super::nominal::find(&model.scenario, &model.fmus, &source.to) else { continue };
        if logged(variable) || model.variable(variable).kind == Kind::String {
            continue;
        }
        let (hold, series) = course(model, &source.signal)?;
        if !series.time.is_empty() {
            list.push(Unlogged { variable, hold, series, open: false });
        }
    }
    if !list.is_empty() {
        let names: Vec<String> = list.iter().map(|one| model.name(one.variable)).collect();
        let message =
            format!("{}: fed by the scenario's sources, from each run's first row on", names.join(", "));
        notices.push(Notice { file: "dataset.toml".into(), line: 0, message });
    }
    let known = list.len();
    for instance in 0..model.fmus.len() {
        for (place, described) in model.description(instance).variables.iter().enumerate() {
            let variable = VariableId { instance, place };
            let is_open = described.causality == Causality::Input && described.kind == Kind::Real;
            if !is_open || logged(variable) || model.is_driven(variable) {
                continue;
            }
            let series = Series { time: vec![0.0], values: vec![model.number(variable).unwrap_or(0.0)] };
            list.push(Unlogged { variable, hold: Hold::Zero, series, open: true });
        }
    }
    let held = |one: &Unlogged| format!("{} = {}", model.name(one.variable), one.series.values[0]);
    if list.len() > known {
        let values: Vec<String> = list[known..].iter().map(held).collect();
        let message = format!(
            "no channel and nothing in the scenario feeds {}: held, and looked for a bias",
            values.join(", ")
        );
        notices.push(Notice { file: "dataset.toml".into(), line: 0, message });
    }
    Ok(list)
}

fn course(model: &Nominal, signal: &SignalEntry) -> Result<(Hold, Series), Error> {
    let (shape, points) = match signal {
        SignalEntry::Constant(value) => {
            let number = value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
            let number = number.or_else(|| value.as_bool().map(|on| f64::from(u8::from(on))));
            (Shape::Hold, number.map(|value| (0.0, value)).into_iter().collect())
        }
        SignalEntry::Table { shape, points } => (*shape, points.clone()),
        SignalEntry::Csv { file, column, shape } => {
            let folder = model.scenario.origin.parent().unwrap_or(Path::new(""));
            let log = Log::read(&folder.join(file))?;
            let times = log.times(0, 1.0, file, &mut Vec::new())?;
            let place = log.place(column).ok_or_else(|| Error::Nominal(log.lacks(column)))?;
            let series = log.series(place, &times)?;
            (*shape, series.time.into_iter().zip(series.values).collect::<Vec<_>>())
        }
    };
    let points = if shape == Shape::Smooth { lines(&points) } else { points };
    let hold = if shape == Shape::Hold { Hold::Zero } else { Hold::Linear };
    let (time, values) = points.into_iter().unzip();
    Ok((hold, Series { time, values }))
}

/// A smooth table by short lines.
fn lines(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut all = Vec::new();
    for pair in points.windows(2) {
        let ((from, first), (to, last)) = (pair[0], pair[1]);
        all.extend((0..PARTS).map(|part| {
            let share = part as f64 / PARTS as f64;
            (from + share * (to - from), first + orchestrator::smooth_step(share) * (last - first))
        }));
    }
    all.extend(points.last());
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_a_smooth_source_is_followed_by_lines() {
        let all = lines(&[(0.0, 1.0), (2.0, 3.0)]);
        assert_eq!((all.len(), all[0], all[PARTS]), (PARTS + 1, (0.0, 1.0), (2.0, 3.0)));
        assert_eq!(all[PARTS / 2], (1.0, 2.0));
    }
}
