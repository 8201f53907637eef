//! Falls within half a second: a window or two are all there is.

use crate::common;

use diagnosis::{Diagnosis, Verdict, diagnose};

/// What is found where one effect makes runs fall: it alone, within three standard errors that are below `known`.
fn named(name: &str, value: f64, known: f64) -> Diagnosis {
    let folder = common::recorded(&format!("falls-{name}"), &[(name, &value.to_string())]);
    let found = diagnose(folder.path(), &common::units(), &common::options(), &mut |_| {});
    let found = found.expect("the data is good");
    assert_eq!(found.verdict, Verdict::Named, "{:?} {:?}", found.effects, found.unknown);
    let names: Vec<&str> = found.effects.iter().map(|effect| effect.name.as_str()).collect();
    assert_eq!(names, [name]);
    let [low, high] = found.effects[0].ci95;
    let error = (high - low) / (2.0 * 1.96);
    assert!((found.effects[0].value - value).abs() < 3.0 * error && error < known, "{:?}", found.effects);
    found
}

#[test]
fn recovers_wrong_gravity_torques_from_falls() {
    named("plant.theta_9", 12.0, 0.02);
    let found = named("plant.theta_10", 5.0, 0.02);
    // one window has no scatter between windows, but rows that say how well they know it
    let json = found.to_json();
    assert!(!json.contains("[\n        null"), "{json}");
}

#[test]
fn recovers_a_ceiling_that_an_arm_falls_for_and_then_lies_under() {
    // of 720 commands 650 are those of an arm that lies in its stop
    let found = named("plant.tau_max", 0.9, 0.01);
    // from windows in which the nominal model ran away, too: some newton metres
    assert!(
        found.gap.before > 1.0 && found.gap.closed.is_some_and(|closed| closed > 0.99),
        "{:?}",
        found.gap
    );
}

#[test]
fn recovers_a_ceiling_between_those_that_commands_suggest() {
    // the arm falls and flails, and is asked for 150 N·m: of all commands few lie between 1 and 100
    named("plant.tau_max", 1.4, 0.01);
}

#[test]
fn recovers_a_ceiling_from_pictures_of_an_arm_that_falls_out_of_them() {
    let folder = common::recorded("falls-seen", &[("plant.tau_max", "0.8")]);
    for run in ["run-01", "run-02"] {
        std::fs::remove_file(folder.path().join(run).join("plant.csv")).expect("the log was recorded");
    }
    let found = diagnose(folder.path(), &common::units(), &common::options(), &mut |_| {});
    let found = found.expect("the data is good");
    assert_eq!(found.verdict, Verdict::Named, "{:?} {:?}", found.effects, found.unknown);
    let names: Vec<&str> = found.effects.iter().map(|effect| effect.name.as_str()).collect();
    assert_eq!(names, ["plant.tau_max"]);
    // some five standard errors
    assert!((found.effects[0].value - 0.8).abs() < 2e-3, "{:?}", found.effects);
}
