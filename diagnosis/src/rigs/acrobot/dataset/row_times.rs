//! When the rows of a log come: how far apart, how evenly, and where some are missing.

use super::{Run, Table};
use crate::rigs::acrobot::dataset::policy::LOGS;
use crate::rigs::acrobot::policy::POLICY;
use crate::statistics::levels::MIDDLE;
use crate::statistics::median::median;

/// Median time between rows, s.
pub fn typical_gap(log: &Table) -> Option<f64> {
    typical_gaps(&log.time).map(|gaps| gaps.0)
}

/// Standard deviation of timestamps about even spacing, s; 0 where they are not even at all (a torque logged on change).
pub fn unevenness(time: &[f64]) -> f64 {
    let Some((typical, gaps)) = typical_gaps(time) else { return 0.0 };
    // neighbours: a clock that drifts, or lost rows, don't count
    let Some(off) = median(gaps.iter().map(|gap| (gap - typical).abs())) else { return 0.0 };
    let sigma = off / MIDDLE / std::f64::consts::SQRT_2;
    if sigma < 0.5 * typical { sigma } else { 0.0 }
}

/// Median of the gaps between rows, and all of them, s.
pub fn typical_gaps(time: &[f64]) -> Option<(f64, Vec<f64>)> {
    let mut gaps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps.sort_by(f64::total_cmp);
    let middle = *gaps.get(gaps.len() / 2)?;
    Some((middle, gaps))
}

/// The usual time between rows of a torque that is logged by a clock, s; `None` for one that is logged where it changes.
pub fn by_a_clock(torque: &Table) -> Option<f64> {
    let usual = typical_gap(torque).filter(|_| torque.len() >= POLICY.rows)?;
    let gaps = torque.time.windows(2).map(|pair| pair[1] - pair[0]);
    let regular = gaps.filter(|gap| (gap / usual - 1.0).abs() < 0.5).count();
    (regular as f64 >= LOGS.regular * (torque.len() - 1) as f64).then_some(usual)
}

/// Holes in a torque that is logged by a clock: row before each, from, to (s).
pub fn torque_holes_of(run: &Run) -> Vec<(usize, f64, f64)> {
    let Some((torque, usual)) = run.controller.as_ref().and_then(|log| Some((log, by_a_clock(log)?))) else {
        return Vec::new();
    };
    let others = || [&run.plant, &run.camera].into_iter().flatten();
    let inside = |from: f64, to: f64| {
        let rows = |log: &Table| log.time.iter().filter(|time| **time > from + usual && **time < to).count();
        others().map(rows).max().unwrap_or(0)
    };
    let broken: Vec<(f64, f64)> = torque.broken().collect();
    let hole = |(_, pair): &(usize, &[f64])| {
        let long = pair[1] - pair[0] > LOGS.hole.max(LOGS.hole_times * usual);
        long && !broken.contains(&(pair[0], pair[1])) && inside(pair[0], pair[1]) >= LOGS.go_on
    };
    torque.time.windows(2).enumerate().filter(hole).map(|(row, pair)| (row, pair[0], pair[1])).collect()
}

/// Times in which every log of a run pauses, s. Logs that lie apart are stamped by other clocks, and pause nowhere.
pub fn pauses_of(run: &Run) -> Vec<(f64, f64)> {
    let logs = || [&run.plant, &run.camera, &run.controller].into_iter().flatten();
    let usual =
        logs().filter(|log| log.len() >= POLICY.rows).filter_map(typical_gap).fold(f64::NAN, f64::min);
    let mut times: Vec<f64> = logs().flat_map(|log| log.time.iter().copied()).collect();
    times.sort_by(f64::total_cmp);
    let long = LOGS.pause.max(LOGS.times * usual);
    let goes_on = |from: f64, to: f64| {
        logs().all(|log| {
            log.time.first().is_some_and(|time| *time <= from)
                && log.time.last().is_some_and(|time| *time >= to)
        })
    };
    let pause = |pair: &&[f64]| pair[1] - pair[0] > long && goes_on(pair[0], pair[1]);
    times.windows(2).filter(pause).map(|pair| (pair[0], pair[1])).collect()
}
