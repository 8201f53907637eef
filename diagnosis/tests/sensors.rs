//! Sensors other than the usual one: interlaced, and without noise.

use crate::common;

use diagnosis::{Diagnosis, Verdict, diagnose};

/// What is found in runs with `set`, recorded by a sensor that has `nominal`; with encoders, or pictures and torque alone.
fn found(name: &str, nominal: &[(&str, &str)], hidden: &[(&str, &str)], encoders: bool) -> Diagnosis {
    let mut set = nominal.to_vec();
    set.extend(hidden);
    let folder = common::recorded(name, &set);
    let lines: String = nominal.iter().map(|(name, value)| format!("\"{name}\" = {value}\n")).collect();
    let manifest = common::manifest(2).replace("\"camera.sigma\" = 4.0\n", &lines);
    folder.put("dataset.toml", &manifest);
    for run in ["run-01", "run-02"].iter().filter(|_| !encoders) {
        std::fs::remove_file(folder.path().join(run).join("plant.csv")).expect("the log was recorded");
    }
    diagnose(folder.path(), &common::units(), &common::options(), &mut |_| {}).expect("the data is good")
}

#[test]
fn recovers_radial_distortion_from_fields_of_half_the_rows() {
    let sensor = [("camera.sigma", "4.0"), ("camera.interlaced", "true")];
    for encoders in [true, false] {
        let found = found("fields", &sensor, &[("camera.k1", "0.05")], encoders);
        assert_eq!(found.verdict, Verdict::Named, "{:?} {:?}", found.effects, found.unknown);
        let names: Vec<&str> = found.effects.iter().map(|effect| effect.name.as_str()).collect();
        assert_eq!(names, ["camera.k1"]);
        // some three standard errors
        assert!((found.effects[0].value - 0.05).abs() < 1e-4, "{:?}", found.effects);
        // with the rows of the other field 0.16 px are left, with its own 0.03
        assert!(found.gap.after < 0.06, "{:?}", found.gap);
    }
}

#[test]
fn recovers_an_exposure_and_no_noise_where_a_sensor_has_none() {
    let found = found("noiseless", &[("camera.sigma", "0.0")], &[("camera.E_t", "0.3")], false);
    let names: Vec<&str> = found.effects.iter().map(|effect| effect.name.as_str()).collect();
    assert_eq!(names, ["camera.E_t"]);
    assert!((found.effects[0].value - 0.3).abs() < 0.02, "{:?}", found.effects);
}

#[test]
fn counts_the_fields_of_a_camera_that_is_a_little_slower_than_it_is_said_to_be() {
    let sensor = [("camera.sigma", "4.0"), ("camera.interlaced", "true")];
    // NTSC: a field is missing after 17 s, half a field after 8 s
    let found = found("ntsc", &sensor, &[("camera.k1", "0.05"), ("camera.omega_cam", "29.97")], true);
    assert_eq!(found.effects.first().map(|effect| effect.name.as_str()), Some("camera.k1"));
    assert!(found.unknown.is_none(), "{:?}", found.unknown);
    // counted from the start of a run, rows of the other field left 0.13 px
    assert!(found.gap.after < 0.06, "{:?}", found.gap);
}

#[test]
fn recovers_a_sensor_three_times_as_noisy_as_it_is_said_to_be() {
    let found = found("noisy", &[("camera.sigma", "12.0")], &[("camera.sigma", "40.0")], false);
    let names: Vec<&str> = found.effects.iter().map(|effect| effect.name.as_str()).collect();
    assert_eq!(names, ["camera.sigma"], "{:?}", found.effects);
    let [from, to] = found.effects[0].ci95;
    assert!(from < 40.0 && 40.0 < to && to - from < 10.0, "{:?}", found.effects);
}
