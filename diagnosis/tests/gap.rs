//! What is told of the gap is true: its floor is that of noise, and the runs on which it is judged were never seen.

use crate::common::{found, manifest, names, options, recorded, units};
use diagnosis::{Budget, Options, Verdict};

/// All that could stand in the place of a radial distortion, more or less.
const LENS: [&str; 11] = ["k1", "k2", "scale", "p2", "beta", "tilt", "v0", "u0", "pan", "p1", "s1"];

#[test]
fn law_no_model_sets_the_floor_that_it_is_measured_by() {
    let folder = recorded("withheld-lens", &[("camera.k1", "0.05")]);
    let right = found(&folder);
    assert_eq!(names(&right), ["camera.k1"]);
    assert_eq!(right.gap.held_out_runs, ["run-01", "run-02"]);
    assert!(right.gap.closed.is_some_and(|closed| closed > 0.95), "{:?}", right.gap);
    let without = LENS.iter().map(|name| format!("camera.{name}")).collect();
    let options = Options { without, ..options() };
    let wrong =
        diagnosis::diagnose(folder.path(), &units(), &options, &mut |_| {}).expect("the data is good");
    // 1.99 px go to 1.79 on a set like this, where 98 % was told
    assert_eq!(wrong.verdict, Verdict::Unknown);
    assert!(wrong.gap.closed.is_none_or(|closed| closed < 0.5), "{:?}", wrong.gap);
    // the same data have the same noise: what a model leaves that knows the lens from the start
    folder.put("dataset.toml", &manifest(2).replace("[set]", "[set]\n\"camera.k1\" = 0.05"));
    let known = found(&folder);
    assert_eq!(known.verdict, Verdict::None);
    let picture = |gaps: &[diagnosis::Gap]| gaps.iter().find(|gap| gap.unit == "px").map(|gap| gap.floor);
    let noise = picture(&known.gaps).expect("pictures were compared");
    let floors = (picture(&right.cross_validation), picture(&wrong.cross_validation));
    let (Some(one), Some(other)) = floors else { panic!("pictures were compared: {floors:?}") };
    // a model's own motion moves frames by what encoders leave open, a hundredth of it
    assert!((one / noise - 1.0).abs() < 0.02, "{one} {noise}");
    // what is seen elsewhere on the pixel lattice than a model draws it has the lattice's error of both places, 0.03 px each, beside the noise
    let most = noise.hypot(0.03 * 2f64.sqrt());
    assert!((0.98 * noise..1.02 * most).contains(&other), "{other} {noise} {most}");
    // and beside what has no name no name is sure
    assert!(wrong.effects.iter().all(|effect| effect.probability < 0.9), "{:?}", wrong.effects);
    assert!(wrong.amended.starts_with("# The amended model, fed with the logged torque of run-01"));
}

#[test]
fn recovers_a_defocus_beyond_what_is_tried_first() {
    let diagnosis = found(&recorded("defocus-6", &[("camera.N", "6")]));
    assert_eq!(names(&diagnosis), ["camera.N"], "{:?}", diagnosis.story);
    assert_eq!((diagnosis.effects[0].value, diagnosis.effects[0].at_end), (6.0, false));
}

#[test]
fn every_search_ends_when_time_is_up() {
    let folder = recorded("no-time", &[("camera.k1", "0.05")]);
    let options = Options { budget: Budget::All(0.0), ..options() };
    let ended =
        diagnosis::diagnose(folder.path(), &units(), &options, &mut |_| {}).expect("the data is good");
    assert!(
        ended.ended_early.iter().any(|what| what.contains("search for effects")),
        "{:?}",
        ended.ended_early
    );
    assert!(ended.story.iter().any(|line| line.contains("Time was up")));
}
