//! Ways to count that only the motion tells: the nominal model, asked which torques it lacks, lacks far less if logs are read otherwise.
//!
//! Nothing is fitted. The unit is asked at the measured states ([`Weak`]), as the logs are and as they would be.

use super::{Finding, angles};
use crate::error::Error;
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::dataset::{DataSet, Nominal, Run, Table};
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::plausibility::policy::PLAUSIBLE;
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::residual::weak::Weak;
use crate::statistics::linear::Cell;
use crate::statistics::median::median;
use std::f64::consts::PI;
use std::sync::Arc;

/// Another way to count: what `[log]` must say, in words, what it makes of (q1, q2), and the torque's factor.
struct Way {
    add: &'static str,
    words: &'static str,
    turn: fn(f64, f64) -> (f64, f64),
    torque: f64,
}

const fn way(add: &'static str, words: &'static str, turn: fn(f64, f64) -> (f64, f64), torque: f64) -> Way {
    Way { add, words, turn, torque }
}

fn same(q1: f64, q2: f64) -> (f64, f64) {
    (q1, q2)
}

const MILLI: &str = "torque = \"mN·m\"";
const CENTI: &str = "torque = \"N·cm\"";
const DEGREES: &str = "angles = \"deg\"";

/// Signs of both angles and of the torque can't be told from each other by a motion: the equations are the same in a mirror.
const WAYS: &[Way] = &[
    way(MILLI, "the torque is in mN·m", same, 1e-3),
    way(CENTI, "the torque is in N·cm", same, 1e-2),
    way("torque_sign = -1", "the torque has the other sign, or both angles have", same, -1.0),
    way("q1_sign = -1", "q1 has the other sign, or q2 and the torque have", |a, b| (-a, b), 1.0),
    way("q2_sign = -1", "q2 has the other sign, or q1 and the torque have", |a, b| (a, -b), 1.0),
    way(
        "q2_sign = -1\nq2 = \"relative\"",
        "q2 is the angle at the joint and has the other sign",
        |a, b| (a, a - b),
        1.0,
    ),
    way("zero = \"hanging\"", "both angles are counted from hanging down", |a, b| (a + PI, b + PI), 1.0),
    way("q2 = \"relative\"", "q2 is the angle at the joint, link 2 against link 1", |a, b| (a, a + b), 1.0),
    way(
        "zero = \"hanging\"\nq2 = \"relative\"",
        "q1 is counted from hanging down and q2 at the joint, link 2 against link 1",
        |a, b| (a + PI, a + b + PI),
        1.0,
    ),
    way("links = \"swapped\"", "q1 and q2 are exchanged", |a, b| (b, a), 1.0),
    way(DEGREES, "angles are in degrees", |a, b| (a * PI / 180.0, b * PI / 180.0), 1.0),
];

/// Another way of counting that fits far better than the one in use, if there is one.
///
/// # Errors
/// A unit failed.
pub fn other_way_of_counting(
    data: &DataSet,
    model: &Model,
    list: &Arc<Vec<Candidate>>,
) -> Result<Option<Finding>, Error> {
    let mut logs = data.clone();
    logs.runs.iter_mut().for_each(stand_in);
    let Some((as_logged, noise)) = lacking(&logs, model, list)? else { return Ok(None) };
    if as_logged < PLAUSIBLE.noise * noise {
        return Ok(None);
    }
    // a way that no unit can follow is none; an arm that stays within three degrees does nothing that a log is taken for
    let wide = logs.runs.iter().any(|run| run.plant.as_ref().is_some_and(turns));
    let read = |way: &Way| {
        let mut other = logs.clone();
        other.runs.iter_mut().for_each(|run| count(run, way));
        Some(lacking(&other, model, list).ok()??.0)
    };
    let strong = drives(&logs.runs, Nominal::of(&data.path, &data.manifest)?.gravity);
    let mut all: Vec<(f64, &Way)> = (WAYS.iter())
        .filter(|way| (wide || way.add != DEGREES) && (strong || ![MILLI, CENTI].contains(&way.add)))
        .filter_map(|way| Some((read(way)?, way)))
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [(least, way), second, ..] = all.as_slice() else { return Ok(None) };
    let beyond = *least < PLAUSIBLE.better * as_logged && *least < PLAUSIBLE.clearly * second.0;
    if !beyond {
        return Ok(None);
    }
    Ok(Some(Finding {
        file: "plant.csv and controller.csv".into(),
        line: 0,
        sentence: format!(
            "the nominal model lacks {as_logged:.2e} N·m at the logged states, and {least:.2e} N·m if {}",
            way.words
        ),
        add: way.add.into(),
    }))
}

/// Angles as images show them, where no encoder logged any.
fn stand_in(run: &mut Run) {
    if run.plant.is_none() {
        run.plant = run.camera.as_ref().map(angles::seen).filter(|log| !log.is_empty());
    }
}

/// Whether some angle goes beyond half a turn, counted as it stands there.
fn turns(log: &Table) -> bool {
    ["q1", "q2"].iter().filter_map(|name| log.column(name)).flatten().any(|angle| angle.abs() > PI)
}

/// Whether some torque is so large against gravity's (N·m) that it may be one of a hundredth or a thousandth: a motor of an arm gives
/// more than a thousandth of what gravity pulls with, and one whose torque hardly arrives looks as if it gave that.
fn drives(runs: &[Run], gravity: f64) -> bool {
    let torques = runs.iter().filter_map(|run| run.controller.as_ref());
    let all = torques.flat_map(|log| ["tau", "tau_1"].into_iter().filter_map(|name| log.column(name)));
    all.flatten().any(|torque| torque.abs() > PLAUSIBLE.drives * gravity)
}

/// Reads a run in another way.
fn count(run: &mut Run, way: &Way) {
    if let Some(log) = &mut run.controller {
        ["tau", "tau_1"].iter().for_each(|name| scaled(log, name, way.torque));
    }
    let Some(log) = &mut run.plant else { return };
    let (Some(q1), Some(q2)) = (log.column("q1"), log.column("q2")) else { return };
    let turned: Vec<(f64, f64)> = q1.iter().zip(q2).map(|(q1, q2)| (way.turn)(*q1, *q2)).collect();
    for (name, of) in [("q1", 0), ("q2", 1)] {
        let column = log.column_mut(name).into_iter().flatten();
        column.zip(&turned).for_each(|(value, pair)| *value = if of == 0 { pair.0 } else { pair.1 });
    }
}

fn scaled(log: &mut Table, name: &str, by: f64) {
    log.column_mut(name).into_iter().flatten().for_each(|value| *value *= by);
}

/// The torque that the nominal model typically lacks, and what noise gives, N·m: medians, since no way of counting mends an event, of each
/// link by itself. A way that frees one link of all torque and leaves another with it frees the machine of nothing: in degrees a machine
/// hardly moves, so that link 1 lacks nothing and the joint what drives it.
fn lacking(data: &DataSet, model: &Model, list: &Arc<Vec<Candidate>>) -> Result<Option<(f64, f64)>, Error> {
    let Some(mut weak) = Weak::new(data, model, list.clone())?.map(Tracked::new) else { return Ok(None) };
    let nominal: Vec<f64> = list.iter().map(|candidate| candidate.off).collect();
    let blocks = weak.chord(&nominal, &[])?;
    let typical = |of: &dyn Fn(&Cell, usize) -> f64| {
        let link = |link| {
            median(blocks.iter().flat_map(|block| &block.cells).map(|cell| of(cell, link)))
                .unwrap_or(f64::INFINITY)
        };
        f64::hypot(link(0), link(1))
    };
    Ok(Some((typical(&|cell, link| cell.residual[link].abs()), typical(&|cell, link| cell.floor[link]))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::dataset::stated_log::Stated;

    #[test]
    fn value_degrees_are_asked_of_angles_beyond_half_a_turn() {
        let log = |angle: f64| Table::new(vec![0.0, 0.1], vec![("q1".into(), vec![0.0, -angle])]);
        assert_eq!([3.1, 3.2].map(|angle| turns(&log(angle))), [false, true]);
    }

    #[test]
    fn every_unit_of_torque_is_asked_and_its_line_does_what_was_asked() {
        let stated =
            |line: &str| Stated::read(&line.parse().expect("it is TOML")).map(|stated| stated.torque);
        for way in WAYS.iter().filter(|way| way.torque != 1.0) {
            assert_eq!(stated(way.add).as_ref(), Ok(&way.torque), "{}", way.add);
        }
        for unit in ["mN·m", "N·mm", "N·cm"] {
            let torque = stated(&format!("torque = \"{unit}\"")).expect("it is known");
            assert!(WAYS.iter().any(|way| way.torque == torque), "{unit}");
        }
    }

    #[test]
    fn value_thousandths_are_asked_of_torques_beyond_half_of_gravity_s() {
        let run = |torque: f64| Run {
            name: "run-01".into(),
            camera: None,
            controller: Some(Table::new(vec![0.0, 0.1], vec![("tau".into(), vec![0.0, -torque])])),
            plant: None,
        };
        assert_eq!([2.4, 2.6].map(|torque| drives(&[run(torque)], 5.0)), [false, true]);
    }
}
