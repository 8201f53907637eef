//! What a log says at ticks that are themselves a little off, and at its very beginning.

use crate::common;

use diagnosis::rigs::acrobot::candidates::{Candidate, candidates};
use diagnosis::rigs::acrobot::dataset::{DataSet, Table};
use diagnosis::rigs::acrobot::model::Model;
use diagnosis::rigs::acrobot::residual::Tracked;
use diagnosis::rigs::acrobot::residual::plant::PlantCut;
use diagnosis::rigs::acrobot::selection::Evaluation;
use std::sync::Arc;

/// Deviances of the true model, of which nothing is missing, with the plant's logs changed in these ways.
fn deviances<const N: usize>(name: &str, changes: [&dyn Fn(&mut Table); N]) -> [f64; N] {
    let quick = "[[0, 0], [1, 0.4], [2, 0], [3, 0.4], [4, 0], [30, 0]]";
    let folder = common::logged_along(name, quick, &[], true);
    let data = DataSet::load(folder.path()).expect("the data is good");
    let model = Model::load(&data, &common::units()).expect("it is shipped");
    let list: Arc<Vec<Candidate>> = Arc::new(candidates(&model, &[], &|_| Vec::new()));
    let point: Vec<f64> = list.iter().map(|candidate| candidate.off).collect();
    changes.map(|change| {
        let mut data = data.clone();
        data.runs.iter_mut().filter_map(|run| run.plant.as_mut()).for_each(change);
        let rows = PlantCut::new(&data, &model, list.clone()).expect("the unit runs");
        let mut rows = Tracked::new(rows.expect("there are windows"));
        Evaluation::at(&mut rows, &point, &[]).expect("the unit runs").deviance()
    })
}

#[test]
fn law_a_log_that_is_off_by_what_its_ticks_are_leaves_noise() {
    const OFF: f64 = 5e-4;
    // what arrives jumps with the command: late by anything, it is off by all of that
    let even = |log: &mut Table| log.remove("tau_applied");
    let late = |log: &mut Table| {
        even(log);
        log.time.iter_mut().for_each(|time| *time += OFF);
    };
    let known = |log: &mut Table| {
        late(log);
        log.tick_error = OFF;
    };
    let [even, late, known] = deviances("ticks", [&even, &late, &known]);
    // half a millisecond where torques change 30 times a second costs 112 of deviance; what its ticks are known to be off by takes most of that away
    assert!(late > even + 81.0 && known < even + 0.5 * (late - even), "{even} {late} {known}");
}

#[test]
fn law_what_arrives_as_a_log_begins_is_of_commands_before_it() {
    let arrives = |log: &mut Table, row: usize| {
        let applied = log.column_mut("tau_applied").expect("it was logged");
        applied[row] += 0.1;
    };
    let [before, first, second] =
        deviances("arrives", [&|_| {}, &|log| arrives(log, 0), &|log| arrives(log, 1)]);
    // ten standard deviations
    assert!(first == before && second > before + 10.0, "{before} {first} {second}");
}
