//! The choice keeps its rules, and the predictions say what is known of delays.

use super::catalogue::{AGAIN, CATALOGUE, Change};
use super::choose::{Tried, sort, words};
use super::scenario::{Logs, Prepared};
use super::simulate::{Simulated, simulate};
use super::*;
use crate::rigs::acrobot::candidates::candidates;
use crate::rigs::acrobot::dataset::Manifest;

fn entry(name: &str) -> &'static Experiment {
    CATALOGUE.iter().find(|entry| entry.name == name).expect("it is in the catalogue")
}

fn pair(name: &str, loss: f64) -> Tried {
    Tried { entry: entry(name), losses: vec![vec![0.0, loss], vec![loss, 0.0]], times: 1.0 }
}

fn first(mut tried: Vec<Tried>) -> &'static str {
    sort(&mut tried, &[1.0, 1.0]);
    tried[0].entry.name
}

#[test]
fn law_of_equals_the_cheaper_comes_first() {
    // 400 and 4000 are both beyond doubt
    assert_eq!(first(vec![pair("torque logged", 4000.0), pair("swing", 400.0)]), "swing");
    assert_eq!(first(vec![pair("swing", 3.0), pair("torque logged", 40.0)]), "torque logged");
    // same certainty, same cost: the larger loss
    assert_eq!(first(vec![pair("swing", 500.0), pair("faster steps", 600.0)]), "faster steps");
}

#[test]
fn law_a_loss_below_nine_separates_nobody_and_is_said_so() {
    let one = pair("swing", 8.9);
    assert_eq!(one.groups().len(), 1);
    assert!(words(&one).starts_with("Nothing in the catalogue tells them apart"));
    let one = pair("swing", 9.1);
    assert_eq!(one.groups().len(), 2);
    assert_eq!(words(&one), one.entry.what);
    let three = Tried {
        entry: entry("joint angles logged"),
        losses: vec![vec![0.0, 50.0, 60.0], vec![40.0, 0.0, 1.0], vec![70.0, 2.0, 0.0]],
        times: 1.0,
    };
    assert_eq!(three.groups(), vec![vec![0], vec![1, 2]]);
    assert!(words(&three).contains("tells all of them apart"), "{}", words(&three));
    // 1 for the first, 1/2 for each of the others
    assert!((three.certainty(&[1.0, 1.0, 1.0]) - 2.0 / 3.0).abs() < 0.05);
}

#[test]
fn law_what_the_data_at_hand_did_not_give_is_discounted() {
    let mut one = pair("swing", 100.0);
    one.discount(&vec![vec![0.0, 45.0], vec![2.0, 0.0]], 4.5);
    // the first direction predicted ten times too much, the second was within what chance does
    assert_eq!(one.losses, vec![vec![0.0, 10.0], vec![100.0, 0.0]]);
}

#[test]
fn law_longer_records_are_asked_for_where_they_tell() {
    let longer = |loss: f64| {
        let mut one = pair("swing", loss);
        one.lengthen();
        (one.times, one.pair(0, 1))
    };
    assert_eq!(longer(18.0), (1.0, 18.0));
    assert_eq!(longer(17.9).0, 2.0);
    assert_eq!(longer(5.0), (4.0, 20.0));
    assert_eq!(longer(3.0), (1.0, 3.0), "five times as long is not enough");
    let mut three = Tried {
        entry: entry("swing"),
        losses: vec![vec![0.0, 50.0, 10.0], vec![50.0, 0.0, 0.0], vec![9.0, 0.0, 0.0]],
        times: 1.0,
    };
    three.lengthen();
    assert_eq!(
        (three.times, three.pair(0, 2), three.pair(1, 2)),
        (2.0, 18.0, 0.0),
        "by the pair that it helps"
    );
    assert!(words(&three).ends_with("Record 2 times as long as before, in more runs."), "{}", words(&three));
    assert_eq!(three.name(), "swing, 2 times as long");
    // at equal certainty the shorter record is cheaper
    assert_eq!(first(vec![three_times("swing", 90.0), pair("faster steps", 90.0)]), "faster steps");
}

fn three_times(name: &str, loss: f64) -> Tried {
    Tried { times: 3.0, ..pair(name, loss) }
}

#[test]
fn every_entry_says_in_its_words_what_it_changes() {
    for entry in CATALOGUE {
        let says = |word: &str| entry.what.to_lowercase().contains(word);
        for change in entry.changes {
            let named = match change {
                Change::Log(super::catalogue::Log::Encoders) => says("joint angles") && says("encoders"),
                Change::Log(super::catalogue::Log::Torque) => says("torque") && says("tau_applied"),
                Change::Rate(often) => says(&format!("{often} times a second")),
                Change::Desired(_) => says("z_desired"),
                Change::Turned(_) => says("degrees") && says("camera.mount"),
                Change::Hang => says("hang"),
                Change::Times("camera.E_t", _) => says("exposure"),
                Change::Times("camera.omega_cam", _) => says("frames a second"),
                Change::Times(..) => says("nearer") || says("farther"),
                Change::Plus(..) => says("refocus"),
            };
            assert!(named, "{}: {change:?} is not said in {:?}", entry.name, entry.what);
        }
        assert!(!entry.changes.is_empty() && entry.name != AGAIN.name);
    }
}

/// A data set of the shipped machine without a run.
pub(super) fn nothing_logged() -> DataSet {
    let manifest = Manifest {
        stated: crate::rigs::acrobot::dataset::stated_log::Stated::default(),
        scenario: "visual-servo".into(),
        set: BTreeMap::new(),
        noise: BTreeMap::new(),
        runs: Vec::new(),
    };
    DataSet {
        path: ".".into(),
        manifest,
        runs: Vec::new(),
        notices: Vec::new(),
        clocks_apart: false,
        late_by_hand: 0.0,
        frames_apart: false,
        blind: std::collections::BTreeMap::new(),
    }
}

/// A rehearsal of 15 s with an effect, logged as told, without noise.
fn rehearsed(hidden: (&str, &str), encoders: bool) -> (DataSet, Model) {
    let empty = nothing_logged();
    let units = scenarios::unit_path();
    let model = Model::load(&empty, &units).expect("cargo xtask pack was run");
    let mut scenario = model.scenario.clone();
    scenario.set_stop("15").expect("a time");
    let logs = Logs { images: true, encoders, torque: false, rate: None };
    let prepared = Prepared { scenario, set: Vec::new(), logs, repeats: 1.0, moves: Vec::new() };
    let hidden = [(hidden.0.to_owned(), hidden.1.to_owned())];
    let trial = simulate(&prepared, &hidden, &empty, &units, &mut Simulated::default());
    (trial.expect("it runs").data, model)
}

/// What is proposed for a class whose members have these values.
fn proposed(data: &DataSet, model: &Model, class: &[(&str, f64)]) -> NextExperiment {
    let list = candidates(model, &[], &|_| Vec::new());
    let place = |name: &str| list.iter().position(|candidate| candidate.name == name).expect("a candidate");
    let members: Vec<Member> =
        class.iter().map(|(name, x)| Member { candidate: place(name), x: *x, weight: 1.0 }).collect();
    let mut point: Vec<f64> = list.iter().map(|candidate| candidate.off).collect();
    point[members[0].candidate] = members[0].x;
    let noise = Noise { stated: BTreeMap::new(), seen: BTreeMap::new(), encoders: Logs::of(data).encoders };
    let units = scenarios::unit_path();
    let question = Question {
        data,
        model,
        list: &list,
        point: &point,
        members,
        noise,
        discrepancy_sd: 0.0,
        units: &units,
    };
    let (next, text) = choice(&question);
    let text = text.expect("its scenario");
    orchestrator::Scenario::parse(&text, "next_experiment.toml").expect("a scenario that loads");
    next.expect("something can be done")
}

#[test]
fn value_delays_without_encoders_ask_for_the_joint_angles() {
    let (data, model) = rehearsed(("plant.tau_delay", "0.004"), false);
    let class = [("plant.tau_delay", 0.004), ("camera.T_delay", 0.004), ("plant.T_act", 0.004)];
    let next = proposed(&data, &model, &class);
    assert!(next.what.contains("joint angles"), "{next:?}");
    // a camera that is late and an actuator that is late look the same in any image of any motion
    let of = |name: &str| next.separation.iter().find(|line| line.experiment == name).expect("simulated");
    assert!(of("faster steps").loss.is_some_and(|loss| loss < super::policy::DESIGN.told), "{next:?}");
    assert!(next.leaves_open.iter().flatten().all(|name| name != "camera.T_delay"), "{next:?}");
}

#[test]
fn every_turned_mount_is_simulated_for_a_lens_in_question() {
    let (data, model) = rehearsed(("camera.p1", "0.002"), true);
    let next = proposed(&data, &model, &[("camera.p1", 0.002), ("camera.s1", 0.006)]);
    for turned in ["mount turned by 90 degrees", "mount turned by 40 degrees"] {
        let line = next.separation.iter().find(|line| line.experiment == turned).expect("in the catalogue");
        assert!(line.loss.is_some() && line.problem.is_none(), "{line:?}");
    }
    assert!(next.separation.iter().filter(|line| line.loss.is_some()).count() > 8, "{next:?}");
}
