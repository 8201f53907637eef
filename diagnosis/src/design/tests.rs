//! How much is simulated for an experiment, and when members count as told apart.

use super::*;
use crate::dynamics::tests::{built, pendulum, place, units};

#[test]
fn value_members_are_told_apart_by_three_deviations() {
    // squared; one of the two for the other is enough to be found out, if that one is true
    assert_eq!(pairs_left_open(&vec![vec![0.0, 9.5], vec![9.3, 0.0]]), []);
    assert_eq!(pairs_left_open(&vec![vec![0.0, 8.6], vec![50.0, 0.0]]), [(0, 1)]);
    assert_eq!(pairs_left_open(&vec![vec![0.0, 50.0], vec![8.6, 0.0]]), [(0, 1)]);
}

#[test]
fn value_who_is_told_from_nobody_is_not_told_apart() {
    // two that no experiment parts, then with a third that parts from both
    let two = vec![vec![0.0, 4e-10], vec![4e-10, 0.0]];
    assert_eq!((told_apart(&two), pairs_left_open(&two)), (vec![], vec![(0, 1)]));
    let three = vec![vec![0.0, 0.1, 20.0], vec![0.1, 0.0, 30.0], vec![20.0, 30.0, 0.0]];
    assert_eq!((told_apart(&three), pairs_left_open(&three)), (vec![0, 1, 2], vec![(0, 1)]));
}

#[test]
fn value_what_an_experiment_is_worth_in_words() {
    let [a, b] = ["box.C", "box.k"].map(str::to_owned);
    let told = |loss: f64, worth: bool| words("drive box.u", loss, [&a, &b], worth);
    let nothing = told(4.16e-10, false);
    assert!(nothing.starts_with("nothing that can be driven here tells box.C and box.k apart."), "{nothing}");
    assert!(
        nothing.ends_with("one name does as well as the other") && !nothing.contains("start it"),
        "{nothing}"
    );
    assert_eq!(
        told(50.0, true),
        "drive box.u; start it at rest. One name for another would lose 50 of deviance there"
    );
    let little = told(2.0, true);
    assert!(little.contains("too little to tell box.C and box.k apart: record so many runs"), "{little}");
    // a third one is told from both: the experiment is worth its day, and these two stay together
    let some = told(0.0, true);
    assert!(
        some.starts_with("drive box.u; start it at rest.") && some.contains("nothing that can be driven"),
        "{some}"
    );
}

#[test]
fn value_how_much_is_simulated_for_a_next_experiment() {
    let problem = pendulum("next", 600);
    let built = built(&problem);
    let members =
        [("tau:gain", 1.1), ("tau:bias", 0.002), ("q1:gain", 1.02), ("q1:offset", 0.01), ("q2:offset", 0.01)];
    let class: Vec<Alternative> = members
        .iter()
        .map(|(name, value)| Alternative {
            parameter: place(&built, name),
            loss: 0.0,
            value: *value,
            deviation: f64::INFINITY,
        })
        .collect();
    let theta = built.engine.machine.neutral();
    let (own, effects) = (class[0].parameter, [class[0].parameter]);
    let question =
        Question { engine: &built.engine, theta: &theta, noise: &built.noise, own, effects: &effects, class };
    let (next, scenario) = next(&problem, &question, &units()).expect("its torque can be driven");
    // a fit for each beside each: of four, twelve
    let names = ["tau:gain", "tau:bias", "q1:gain", "q1:offset"].map(|name| format!("acrobot_plant.{name}"));
    let simulated = &next.planned.as_ref().expect("it was simulated").outputs[0].members;
    assert_eq!(simulated.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), names);
    // told apart is who is told from another one: a gain of the torque stays together with all three
    assert_eq!(next.separates, names[1..]);
    let with_gain = next.leaves_open.iter().filter(|pair| pair.contains(&names[0])).count();
    assert_eq!(with_gain, 3, "{:?}", next.leaves_open);
    // of each length the one that screens best, and another: the screening is about the nominal model only
    assert_eq!(next.separation.len(), 4);
    // what is listed was simulated, the best first, and the best is what is proposed
    assert!(next.separation.iter().all(|one| one.pair.len() == 2), "{:?}", next.separation);
    assert!(next.separation.is_sorted_by(|a, b| a.loss >= b.loss), "{:?}", next.separation);
    assert!(next.what.starts_with(&next.separation[0].experiment), "{}", next.what);
    // some four hundred rows, of whatever log: each is in every fit
    let longest = &built.engine.grids[0].time;
    let rows = times(longest).iter().map(Vec::len).max();
    assert!(rows.is_some_and(|rows| (360..=440).contains(&rows)), "{rows:?}");
    let planned = next.planned.expect("it was simulated").inputs[0].points.len();
    assert!(times(longest).iter().any(|time| time.len() == planned), "{planned}");
    assert!(scenario.is_some(), "one unit alone");
    // as far as the logs have seen the input, but not to its very ends: an amplifier that is set a little otherwise would clip
    let tau = &built.engine.grids[0].inputs[0].values;
    let size =
        |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |most: f64, value| most.max(value.abs()));
    let waves = waves(&problem, &built.engine, &longest[..400]);
    let driven = waves.iter().map(|wave| size(&mut wave.values[0].iter().copied())).fold(0.0, f64::max);
    let share = driven / size(&mut tau.iter().copied());
    assert!((0.9..0.99).contains(&share), "{share}");
}

#[test]
fn law_rows_of_an_experiment_last_as_long_as_the_log_or_are_as_near() {
    let log = |rows: usize| -> Vec<f64> { (0..rows).map(|row| row as f64 * 0.01).collect() };
    assert_eq!(times(&log(300)), [log(300)]);
    let both = times(&log(5000));
    let [spread, begin] = both.as_slice() else { panic!("{}", both.len()) };
    assert!(spread[spread.len() - 1] > 0.98 * 49.99, "{spread:?}");
    assert!((begin[1] - begin[0] - 0.01).abs() < 1e-12);
    // a second of simulation: not the log's 5000 rows
    assert!(spread.len().max(begin.len()) <= 1000 && spread.len().min(begin.len()) >= 100);
}
