//! Units of time, and rows that are missing.

use super::{Facts, Finding};
use crate::rigs::acrobot::dataset::{Run, Table, typical_gap};
use crate::rigs::acrobot::plausibility::policy::PLAUSIBLE;
use crate::rigs::acrobot::policy::POLICY;

/// Seconds since 1970 of anything that is logged today.
const EPOCH: std::ops::Range<f64> = 1e9..1e10;

/// Times in milliseconds, or less.
pub(super) fn unit(facts: &Facts<'_>) -> Option<Finding> {
    facts.runs.iter().find_map(|run| in_other_unit(run, facts))
}

fn in_other_unit(run: &Run, facts: &Facts<'_>) -> Option<Finding> {
    let gap = |log: &Option<Table>| log.as_ref().filter(|log| log.len() >= POLICY.rows).and_then(typical_gap);
    let units = [("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
    let fastest = facts.falling[0].max(facts.falling[1]);
    let found = |file: &str, sentence: String, unit: &str| Finding {
        file: format!("{}/{file}", run.name),
        line: 0,
        sentence,
        add: format!("time = {unit:?}"),
    };
    if let Some(gap) = gap(&run.camera) {
        let (unit, _) = units.into_iter().find(|(_, by)| gap * by < PLAUSIBLE.other_unit * facts.interval)?;
        return (gap > PLAUSIBLE.other_unit * facts.interval).then(|| {
            let sentence = format!(
                "frames are {gap} s apart, where the nominal camera takes one each {:.4} s: time looks like {unit}",
                facts.interval
            );
            found("camera.csv", sentence, unit)
        });
    }
    let log = run
        .plant
        .as_ref()
        .filter(|log| log.column("q1").is_some_and(|q1| q1.iter().any(|x| x.is_finite())))?;
    let gap = gap(&run.plant)?;
    // counted from 1970, a time tells its unit
    let epoch = units.into_iter().find(|(_, by)| EPOCH.contains(&(log.time[0] * by)));
    let (unit, _) = epoch.or_else(|| units.into_iter().find(|(_, by)| gap * by * fastest < POLICY.fallen))?;
    (gap * fastest > POLICY.fallen).then(|| {
        let sentence =
            format!("rows are {gap} s apart, and the arm falls in between: time looks like {unit}");
        found("plant.csv", sentence, unit)
    })
}

/// A time in which nothing was logged at all: frames would count as lost, and a torque as held.
pub(super) fn pauses(facts: &Facts<'_>) -> Option<Finding> {
    facts.runs.iter().filter(|_| !facts.gaps_stated).find_map(|run| {
        let (from, to) = pauses_of(run).first().copied()?;
        Some(Finding {
            file: run.name.clone(),
            line: 0,
            sentence: format!(
                "no log has a row from {from:.3} to {to:.3} s: logging paused, or these are two runs in one"
            ),
            add: "gaps = \"unknown\"".into(),
        })
    })
}

/// Times in which every log of a run pauses, s. Logs that lie apart are stamped by other clocks, and pause nowhere.
pub fn pauses_of(run: &Run) -> Vec<(f64, f64)> {
    let logs = || [&run.plant, &run.camera, &run.controller].into_iter().flatten();
    let usual =
        logs().filter(|log| log.len() >= POLICY.rows).filter_map(typical_gap).fold(f64::NAN, f64::min);
    let mut times: Vec<f64> = logs().flat_map(|log| log.time.iter().copied()).collect();
    times.sort_by(f64::total_cmp);
    let long = PLAUSIBLE.pause.max(PLAUSIBLE.times * usual);
    let goes_on = |from: f64, to: f64| {
        logs().all(|log| {
            log.time.first().is_some_and(|time| *time <= from)
                && log.time.last().is_some_and(|time| *time >= to)
        })
    };
    let pause = |pair: &&[f64]| pair[1] - pair[0] > long && goes_on(pair[0], pair[1]);
    times.windows(2).filter(pause).map(|pair| (pair[0], pair[1])).collect()
}

/// A time without a torque while everything else goes on: held over it, a torque looks like a spring.
pub(super) fn torque_holes(facts: &Facts<'_>) -> Option<Finding> {
    facts.runs.iter().filter(|_| !facts.gaps_stated).find_map(|run| {
        let (row, from, to) = torque_holes_of(run).first().copied()?;
        let line = run.controller.as_ref().map_or(0, |log| log.line[row]);
        Some(Finding {
            file: format!("{}/controller.csv", run.name),
            line,
            sentence: format!(
                "the torque has no row from {from:.3} to {to:.3} s, where other logs go on (if it was held, write \"known\" below)"
            ),
            add: "gaps = \"unknown\"".into(),
        })
    })
}

/// Holes in a torque that is logged by a clock: row before each, from, to (s).
pub fn torque_holes_of(run: &Run) -> Vec<(usize, f64, f64)> {
    let torque = run.controller.as_ref().filter(|log| log.len() >= POLICY.rows);
    let Some((torque, usual)) = torque.and_then(|log| Some((log, typical_gap(log)?))) else {
        return Vec::new();
    };
    let gaps = || torque.time.windows(2).map(|pair| pair[1] - pair[0]);
    let regular = gaps().filter(|gap| (gap / usual - 1.0).abs() < 0.5).count();
    if (regular as f64) < PLAUSIBLE.regular * (torque.len() - 1) as f64 {
        return Vec::new();
    }
    let others = || [&run.plant, &run.camera].into_iter().flatten();
    let inside = |from: f64, to: f64| {
        let rows = |log: &Table| log.time.iter().filter(|time| **time > from + usual && **time < to).count();
        others().map(rows).max().unwrap_or(0)
    };
    let broken: Vec<(f64, f64)> = torque.broken().collect();
    let hole = |(_, pair): &(usize, &[f64])| {
        let long = pair[1] - pair[0] > PLAUSIBLE.hole.max(PLAUSIBLE.hole_times * usual);
        long && !broken.contains(&(pair[0], pair[1])) && inside(pair[0], pair[1]) >= PLAUSIBLE.go_on
    };
    torque.time.windows(2).enumerate().filter(hole).map(|(row, pair)| (row, pair[0], pair[1])).collect()
}
