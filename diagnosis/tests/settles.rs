//! Effects that change nothing any more are dropped, and stand in the way of no other.

use crate::common;

use diagnosis::Watch;
use diagnosis::rigs::acrobot::candidates::{Candidate, candidates};
use diagnosis::rigs::acrobot::dataset::DataSet;
use diagnosis::rigs::acrobot::model::Model;
use diagnosis::rigs::acrobot::residual::plant::PlantCut;
use diagnosis::rigs::acrobot::residual::{Cut, Linearised, Tracked};
use diagnosis::rigs::acrobot::selection::study;
use std::sync::Arc;

#[test]
fn law_a_ceiling_that_cuts_nothing_is_dropped_and_the_others_are_fitted() {
    let points = "[[0, 0], [1, 0.4], [2, 0], [3, 0.4], [4, 0], [30, 0]]";
    let folder = common::logged_along("dead", points, &[("plant.I_rotor", "0.003")], false);
    let data = DataSet::load(folder.path()).expect("the data is good");
    let model = Model::load(&data, &common::units()).expect("it is shipped");
    // one that is far above all commands, 1/(N·m)
    let saturations = |_| vec![0.01];
    let list: Arc<Vec<Candidate>> = Arc::new(candidates(&model, &[], &saturations));
    let place = |name| list.iter().position(|candidate| candidate.name == name).expect("it is listed");
    let (hidden, dead) = (place("plant.I_rotor"), place("plant.tau_max"));
    let rows = PlantCut::new(&data, &model, list.clone()).expect("the unit runs");
    let mut rows = Tracked::new(rows.expect("there are windows"));
    let mut start: Vec<f64> = list.iter().map(|candidate| candidate.off).collect();
    (start[hidden], start[dead]) = (0.002, 0.01);
    let found = study(&mut rows, &list, &start, &[hidden, dead], &mut Watch::new(&mut |_| {}, None))
        .expect("the unit runs");
    assert_eq!(
        found.active,
        [hidden],
        "{:?}",
        found.active.iter().map(|index| list[*index].name).collect::<Vec<_>>()
    );
    // encoders of 2e-4 rad tell it to about a per cent
    assert!((found.last.point[hidden] / 0.003 - 1.0).abs() < 0.03, "{}", found.last.point[hidden]);
}

#[test]
fn law_a_linearisation_depends_on_its_point_and_nuisances_alone() {
    let points = "[[0, 0], [1, 0.4], [2, 0], [3, 0.4], [4, 0], [30, 0]]";
    let folder = common::logged_along("value", points, &[("plant.I_rotor", "0.003")], false);
    let data = DataSet::load(folder.path()).expect("the data is good");
    let model = Model::load(&data, &common::units()).expect("it is shipped");
    let list: Arc<Vec<Candidate>> = Arc::new(candidates(&model, &[], &|_| Vec::new()));
    let hidden = list.iter().position(|candidate| candidate.name == "plant.I_rotor").expect("it is listed");
    let cut = PlantCut::new(&data, &model, list.clone()).expect("the unit runs");
    let mut cut = cut.expect("there are windows");
    let off: Vec<f64> = list.iter().map(|candidate| candidate.off).collect();
    let mut elsewhere = off.clone();
    elsewhere[hidden] = 0.01;
    let begin = cut.initial();
    let rows = |found: &Linearised| -> Vec<f64> {
        found.blocks.iter().flat_map(|block| &block.cells).flat_map(|cell| cell.residual.clone()).collect()
    };
    let first = cut.linearise(&off, &[], &begin).expect("the unit runs");
    let step = cut.chord(&elsewhere, &[], &first.nuisances).expect("the unit runs");
    // as long as the cut is elsewhere, nothing of that may stay in it
    cut.linearise(&elsewhere, &[], &step.nuisances).expect("the unit runs");
    let again = cut.linearise(&off, &[], &begin).expect("the unit runs");
    assert_eq!(rows(&first), rows(&again));
    let second = cut.chord(&elsewhere, &[], &first.nuisances).expect("the unit runs");
    assert_eq!(rows(&step), rows(&second));
    assert_ne!(rows(&first), rows(&step));
}
