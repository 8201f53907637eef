//! Names of plant effects that look alike, judged with the states linked from row to row.

use crate::common;

use diagnosis::{Diagnosis, Verdict, diagnose};

/// What is said of two runs in which only torque and encoders are logged.
fn said_without_pictures(name: &str, set: &[(&str, &str)]) -> Diagnosis {
    let folder = common::recorded(name, set);
    for run in ["run-01", "run-02"] {
        std::fs::remove_file(folder.path().join(run).join("camera.csv")).expect("it was recorded");
    }
    diagnose(folder.path(), &common::units(), &common::options(), &mut |_| {}).expect("the data is good")
}

#[test]
fn recovers_which_joint_drags_where_windows_leave_three_open() {
    // five standard errors: of b_roll and fc_roll in its place windows of half a second lose less than 6, linked states 93 and 105
    let found = said_without_pictures("drag", &[("plant.b_joint", "0.0007")]);
    assert_eq!(common::names(&found), ["plant.b_joint"]);
    assert_eq!(found.effects[0].class, ["plant.b_joint"]);
    // three standard errors of windows
    assert!((found.effects[0].value - 0.0007).abs() < 4e-4, "{:?}", found.effects);
}

#[test]
fn recovers_a_gain_that_no_weight_is() {
    let found = said_without_pictures("gain", &[("plant.k_tau", "1.0003")]);
    assert_eq!(common::names(&found), ["plant.k_tau"]);
    assert_eq!(found.effects[0].class, ["plant.k_tau"]);
}

#[test]
fn leaves_open_what_windows_close_in_vain() {
    // windows find theta_1 alone here; linked states differ by less than 6
    let found = said_without_pictures("inertia", &[("plant.theta_2", "0.061")]);
    let mut class = found.effects[0].class.clone();
    class.sort();
    assert_eq!(class, ["plant.theta_1", "plant.theta_2"]);
}

#[test]
fn leaves_open_what_no_row_tells_apart() {
    // a lag of half a millisecond delays a torque that is held for 33 by as much
    let found = said_without_pictures("lag", &[("plant.T_act", "0.0005")]);
    let mut class = found.effects[0].class.clone();
    class.sort();
    assert_eq!(class, ["plant.T_act", "plant.tau_delay"]);
    assert_eq!(found.verdict, Verdict::Ambiguous);
}
