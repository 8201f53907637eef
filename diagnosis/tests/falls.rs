//! Falls within half a second: a window or two are all there is.

#[allow(dead_code)] // each test file uses a part of it
mod common;

use diagnosis::{Verdict, diagnose};

#[test]
fn recovers_a_wrong_gravity_torque_from_falls() {
    let folder = common::recorded("falls", &[("plant.theta_10", "5.0")]);
    let found = diagnose(folder.path(), &common::units(), &common::options(), &mut |_| {});
    let found = found.expect("the data is good");
    assert_eq!(found.verdict, Verdict::Named, "{:?} {:?}", found.effects, found.unknown);
    let names: Vec<&str> = found.effects.iter().map(|effect| effect.name.as_str()).collect();
    assert_eq!(names, ["plant.theta_10"]);
    // one window has no scatter between windows, but rows that say how well they know it
    let [low, high] = found.effects[0].ci95;
    let error = (high - low) / (2.0 * 1.96);
    assert!((found.effects[0].value - 5.0).abs() < 3.0 * error && error < 0.02, "{:?}", found.effects);
    let json = found.to_json();
    assert!(!json.contains("[\n        null"), "{json}");
}
