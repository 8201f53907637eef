//! Whether the logs' angles are counted as the model counts them: from the upright, and both against the vertical. Many
//! arms count from hanging down, or the second angle at the joint. Such a log looks like a machine that lacks everything,
//! so where much is lacking the other ways of counting are tried, and told; nothing is changed.

use super::*;
use crate::residual::weak::Weak;
use std::f64::consts::PI;

/// To what share of itself another way of counting must bring what the model lacks.
const BETTER: f64 = 0.4;

type Turn = fn(f64, f64) -> (f64, f64);

const WAYS: [(&str, Turn); 3] = [
    ("both are counted from hanging down", |q1, q2| (q1 + PI, q2 + PI)),
    ("q2 is the angle at the joint, link 2 against link 1", |q1, q2| (q1, q1 + q2)),
    ("q1 is counted from hanging down and q2 at the joint, link 2 against link 1", |q1, q2| {
        (q1 + PI, q1 + q2 + PI)
    }),
];

/// Another way of counting that fits far better, if there is one.
pub(super) fn conventions(
    data: &DataSet,
    model: &Model,
    list: &Arc<Vec<Candidate>>,
    parts: &[Part],
) -> Result<Option<Notice>, Error> {
    if !parts.iter().any(|part| part.torque && part.study.outweighed) {
        return Ok(None);
    }
    let as_logged = lacking(data.clone(), model, list)?;
    let mut best: Option<(f64, &str)> = None;
    for (words, turn) in WAYS {
        let mut other = data.clone();
        other.runs.iter_mut().filter_map(|run| run.plant.as_mut()).for_each(|log| count(log, turn));
        let lacking = lacking(other, model, list)?;
        if lacking < best.map_or(BETTER * as_logged, |(least, _)| least) {
            best = Some((lacking, words));
        }
    }
    Ok(best.map(|(lacking, words)| {
        let message = format!(
            "the logs fit the nominal model far better ({lacking:.2e} instead of {as_logged:.2e} N·m are lacking) if {words}; \
             q1 and q2 must both be counted from the upright, against the vertical. Nothing was changed"
        );
        Notice { file: "plant.csv".into(), line: 0, message }
    }))
}

/// Counts the angles of a log in another way.
fn count(log: &mut Table, turn: Turn) {
    let (Some(q1), Some(q2)) = (log.column("q1"), log.column("q2")) else { return };
    let turned: Vec<(f64, f64)> = q1.iter().zip(q2).map(|(q1, q2)| turn(*q1, *q2)).collect();
    for (name, place) in [("q1", 0), ("q2", 1)] {
        if let Some(column) = log.column_mut(name) {
            let of = |pair: &(f64, f64)| if place == 0 { pair.0 } else { pair.1 };
            column.iter_mut().zip(&turned).for_each(|(value, pair)| *value = of(pair));
        }
    }
}

/// The torque that the nominal model typically lacks, N·m: the median, since no way of counting mends an event.
fn lacking(data: DataSet, model: &Model, list: &Arc<Vec<Candidate>>) -> Result<f64, Error> {
    let Some(mut weak) = Weak::new(&data, model, list.clone())? else { return Ok(f64::INFINITY) };
    let nominal: Vec<f64> = list.iter().map(|candidate| candidate.off).collect();
    let blocks = weak.linearise(&nominal, &[], true)?;
    let mut sizes: Vec<f64> = (blocks.iter().flat_map(|block| &block.cells))
        .flat_map(|cell| cell.residual.iter().map(|torque| torque.abs()))
        .collect();
    sizes.sort_by(f64::total_cmp);
    Ok(sizes.get(sizes.len() / 2).copied().unwrap_or(f64::INFINITY))
}
