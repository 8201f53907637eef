//! Effects that are hidden come back: recorded from the product's own units, which flatters the method (the judges
//! of its numbers are the sets of `tests/hidden`), but shows that every part of the workflow is connected.

mod common;

use diagnosis::{Diagnosis, Verdict, diagnose};

fn said(name: &str, set: &[(&str, &str)]) -> Diagnosis {
    let folder = common::recorded(name, set);
    diagnose(folder.path(), &common::units(), &common::options(), &mut |_| {}).expect("the data is good")
}

fn named(found: &Diagnosis, name: &str, value: f64, within: f64) {
    assert_eq!(found.effects.len(), 1, "{:?}", found.effects);
    assert_eq!(found.effects[0].name, name);
    let off = (found.effects[0].value - value).abs();
    assert!(off < within, "{name} = {} instead of {value}", found.effects[0].value);
    assert!(found.gap.closed.is_some_and(|closed| closed > 0.9), "{:?}", found.gap);
}

#[test]
fn recovers_nothing_where_nothing_is_hidden() {
    let found = said("none", &[]);
    assert_eq!(found.verdict, Verdict::None, "{:?} {:?}", found.effects, found.unknown);
    // every effect of the contract that two short runs can show has a size up to which it is not excluded
    for name in ["camera.k1", "camera.T_delay", "plant.b_joint", "plant.tau_bias", "plant.theta_9"] {
        assert!(found.minimum_detectable.contains_key(name), "{name}");
    }
}

#[test]
fn recovers_friction_at_the_joint() {
    let found = said("joint", &[("plant.b_joint", "0.02")]);
    // 24 s of log at 30 Hz: the standard error is about 1e-4
    named(&found, "plant.b_joint", 0.02, 6e-4);
    assert!(found.amended.contains("b_joint"), "the amended scenario switches it on");
}

#[test]
fn recovers_radial_distortion() {
    // the standard error is about 2e-5, and the lattice moves the fit by as much
    named(&said("radial", &[("camera.k1", "0.05")]), "camera.k1", 0.05, 3e-4);
}

#[test]
fn recovers_bias_of_the_torque() {
    // the standard error is about 1e-4 N·m; slope looks much the same, so the class is not looked at
    let found = said("bias", &[("plant.tau_bias", "0.02")]);
    assert_eq!(found.effects.first().map(|effect| effect.name.as_str()), Some("plant.tau_bias"));
    assert!((found.effects[0].value - 0.02).abs() < 6e-4, "{:?}", found.effects);
}

#[test]
fn every_run_of_a_diagnosis_says_the_same() {
    let folder = common::recorded("same", &[("plant.fc_joint", "0.01")]);
    let once = || {
        let found = diagnose(folder.path(), &common::units(), &common::options(), &mut |_| {});
        found.expect("the data is good").to_json()
    };
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool of one").install(once);
    assert_eq!(one, once());
}
