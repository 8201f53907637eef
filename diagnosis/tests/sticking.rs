//! Friction so strong that the joint sticks: windows begin in a phase in which their start state hardly shows.

use crate::common;

use diagnosis::{Verdict, diagnose};

#[test]
fn recovers_friction_of_a_joint_that_sticks() {
    let folder = common::recorded("sticking", &[("plant.fc_joint", "0.05")]);
    let found = diagnose(folder.path(), &common::units(), &common::options(), &mut |_| {});
    let found = found.expect("the data is good");
    // one window that is lost is a rest in torque and picture that nothing explains
    assert_eq!(found.verdict, Verdict::Named, "{:?} {:?}", found.effects, found.unknown);
    let names: Vec<&str> = found.effects.iter().map(|effect| effect.name.as_str()).collect();
    assert_eq!(names, ["plant.fc_joint"]);
    // some three standard errors
    assert!((found.effects[0].value - 0.05).abs() < 3e-4, "{:?}", found.effects);
    // pictures at the poses of windows that follow: lost ones left 0.09 px
    let picture = found.gaps.iter().find(|gap| gap.unit == "px").expect("pictures were compared");
    assert!(picture.after < 0.06, "{picture:?}");
}
