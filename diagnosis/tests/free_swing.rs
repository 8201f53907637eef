//! Free swings of a pinned arm, as a video or encoders without a motor give them: what is missing is found, how the log was
//! made is cleared, and nothing is named that such an arm doesn't have.

use crate::common::{Folder, options, root, units};
use diagnosis::testing::Random;
use diagnosis::{Diagnosis, diagnose};
use orchestrator::{MemoryRecorder, Quiet, Scenario, Simulation};
use std::fmt::Write as _;

type Values<'a> = &'a [(&'a str, &'a str)];

/// A small arm (links of some 30 cm).
const ARM: [(&str, &str); 9] = [
    ("plant.theta_1", "0.108"),
    ("plant.theta_2", "0.0"),
    ("plant.theta_5", "0.024"),
    ("plant.theta_7", "0.0"),
    ("plant.theta_8", "0.033"),
    ("plant.theta_9", "3.42"),
    ("plant.theta_10", "1.09"),
    ("plant.q2_max", "1e9"),
    ("plant.velocity_terms", "true"),
];
/// Standard deviation of an angle, rad: a video's.
const NOISE: f64 = 1e-3;

/// A light and small one (links of 9 and 7 cm, 20 and 15 g), whose second link turns at 20 to 70 rad/s.
const TOY: [(&str, &str); 9] = [
    ("plant.theta_1", "1.794e-4"),
    ("plant.theta_2", "0.0"),
    ("plant.theta_5", "2.45e-5"),
    ("plant.theta_7", "0.0"),
    ("plant.theta_8", "4.7775e-5"),
    ("plant.theta_9", "0.022318"),
    ("plant.theta_10", "0.0051503"),
    ("plant.q2_max", "1e9"),
    ("plant.velocity_terms", "true"),
];

/// Two swings of 6 s of the arm with `set`, at 100 Hz, angles only; `log` makes a row of what was measured, or none.
fn swings(name: &str, set: &[(&str, &str)], log: &dyn Fn(usize, f64, f64) -> Option<(f64, f64)>) -> Folder {
    recorded(name, (&ARM, set), [["4.3", "3.4"], ["2.2", "4.5"]], 100, log)
}

/// Two swings of 6 s of an arm with more set, from two starts, at a rate in Hz.
fn recorded(
    name: &str,
    (arm, set): (Values<'_>, Values<'_>),
    starts: [[&str; 2]; 2],
    rate: usize,
    log: &dyn Fn(usize, f64, f64) -> Option<(f64, f64)>,
) -> Folder {
    let folder = Folder::new(name);
    let mut head = "format = 1\nscenario = \"visual-servo\"\n[set]\n".to_owned();
    for (name, value) in arm {
        let _ = writeln!(head, "\"{name}\" = {value}");
    }
    for (run, start) in (1_u64..).zip(starts) {
        let _ = writeln!(head, "[[run]]\ndir = \"run-{run:02}\"");
        let mut scenario = Scenario::load(root().join("scenarios/visual-servo.toml")).expect("it is shipped");
        // nobody looks and nobody steers
        scenario.units.retain(|unit| unit.name == "plant");
        scenario.connections.clear();
        scenario.sources.clear();
        let starts = [("plant.q1_0", start[0]), ("plant.q2_0", start[1])];
        for (name, value) in arm.iter().chain(&starts).chain(set) {
            scenario.set(name, value).expect("the names are right");
        }
        scenario.set_stop("6").expect("a time");
        let mut simulation = Simulation::new(&scenario, &units()).expect("cargo xtask pack was run");
        let mut memory = MemoryRecorder::new();
        simulation.run(&mut memory, &mut Quiet).expect("it runs");
        let series = |name: &str| memory.series(name).expect("outputs are recorded").to_vec();
        let (q1, q2) = (series("plant.q1"), series("plant.q2"));
        let mut random = Random::new(run);
        let mut text = "time,q1,q2\n".to_owned();
        let every = (memory.times().len() - 1) / (6 * rate);
        for (row, time) in memory.times().iter().enumerate().step_by(every) {
            let (a, b) = (q1[row] + NOISE * random.normal(), q2[row] + NOISE * random.normal());
            if let Some((a, b)) = log(row / every, a, b) {
                let _ = writeln!(text, "{time},{a},{b}");
            }
        }
        folder.put(&format!("run-{run:02}/plant.csv"), &text);
    }
    folder.put("dataset.toml", &head);
    folder
}

fn said(folder: &Folder) -> Diagnosis {
    diagnose(folder.path(), &units(), &options(), &mut |_| {}).expect("it is usable")
}

fn names(diagnosis: &Diagnosis) -> Vec<&str> {
    diagnosis.effects.iter().map(|effect| effect.name.as_str()).collect()
}

const FRICTION: [(&str, &str); 2] = [("plant.b_roll", "0.01"), ("plant.fc_joint", "0.02")];

fn both_are_found(diagnosis: &Diagnosis) {
    let mut found = names(diagnosis);
    found.sort_unstable();
    assert_eq!(found, ["plant.b_roll", "plant.fc_joint"], "{:?}", diagnosis.story);
    for (name, truth) in FRICTION {
        let value =
            diagnosis.effects.iter().find(|effect| effect.name == name).map_or(0.0, |effect| effect.value);
        let truth: f64 = truth.parse().expect("a number");
        // a tenth: four times the interval's half width at this noise
        assert!((value / truth - 1.0).abs() < 0.1, "{name} = {value}");
    }
}

#[test]
fn recovers_friction_from_a_free_swing_and_no_clock() {
    let diagnosis = said(&swings("swing", &FRICTION, &|_, a, b| Some((a, b))));
    // nor is there a motor that could push
    assert!(
        !diagnosis.minimum_detectable.contains_key("plant.tau_bias"),
        "{:?}",
        diagnosis.minimum_detectable
    );
    both_are_found(&diagnosis);
    assert!(
        !diagnosis.notices.iter().any(|notice| notice.message.contains("late")),
        "{:?}",
        diagnosis.notices
    );
}

#[test]
fn recovers_friction_where_rows_are_lost() {
    // up to 0.2 s at a time, three times in two seconds
    let lost = |row: usize| matches!(row % 200, 30..50 | 90..97 | 150..153);
    let diagnosis = said(&swings("lost", &FRICTION, &|row, a, b| (!lost(row)).then_some((a, b))));
    both_are_found(&diagnosis);
}

#[test]
fn every_zero_that_is_off_is_told_and_not_named() {
    // a camera that is rolled by 0.03 rad turns both angles
    let diagnosis = said(&swings("zero", &FRICTION, &|_, a, b| Some((a + 0.03, b + 0.03))));
    both_are_found(&diagnosis);
    for angle in ["q1 reads 0.0", "q2 reads 0.0"] {
        let told = diagnosis.notices.iter().any(|notice| notice.message.starts_with(angle));
        assert!(told, "{angle}: {:?}", diagnosis.notices);
    }
    assert!(diagnosis.amended.contains("b_roll") && !diagnosis.amended.contains("zero"));
}

#[test]
fn every_other_way_of_counting_angles_is_told() {
    let folder = swings("joint", &FRICTION, &|_, a, b| Some((a, b - a)));
    let refused = diagnosis::diagnose(folder.path(), &units(), &options(), &mut |_| {});
    let said = refused.expect_err("friction has no such name").to_string();
    assert!(said.contains("at the joint") && said.contains("q2 = \"relative\""), "{said}");
}

#[test]
fn recovers_friction_with_a_scenario_that_has_no_camera() {
    let folder = swings("unseen", &FRICTION, &|_, a, b| Some((a, b)));
    let manifest = std::fs::read_to_string(folder.path().join("dataset.toml")).expect("it was written");
    folder.put("dataset.toml", &manifest.replace("visual-servo", "full-state"));
    // a motor that was logged, and never pushed
    folder.put("run-01/controller.csv", "time,tau\n0,0\n3,0\n6,0\n");
    let rows: String = (0..20).map(|row| format!("{},0,0,0,0,0,0\n", 0.3 * f64::from(row))).collect();
    folder.put("run-02/camera.csv", &format!("time,u1,v1,u2,v2,u3,v3\n{rows}"));
    let diagnosis = said(&folder);
    both_are_found(&diagnosis);
    // what it was told isn't all that it may have done
    assert!(diagnosis.minimum_detectable.contains_key("plant.tau_bias"), "its motor may have pushed");
    let told = |notice: &&diagnosis::Notice| notice.file == "run-02/camera.csv";
    let notice = diagnosis.notices.iter().find(told).expect("pictures were put aside");
    assert!(notice.message.contains("`full-state` has no unit `camera`"), "{notice}");
}

/// Both frictions of the toy are found, and nothing else.
fn friction_of_the_toy(name: &str, starts: [[&str; 2]; 2], rate: usize) {
    let friction = [("plant.b_roll", "4e-6"), ("plant.b_joint", "1e-6")];
    let folder = recorded(name, (&TOY, &friction), starts, rate, &|_, a, b| Some((a, b)));
    let diagnosis = said(&folder);
    let mut found = names(&diagnosis);
    found.sort_unstable();
    assert_eq!(found, ["plant.b_joint", "plant.b_roll"], "{:?}", diagnosis.story);
    assert!(diagnosis.unknown.is_none(), "{:?}", diagnosis.unknown);
    for (name, truth) in friction {
        let effect = diagnosis.effects.iter().find(|effect| effect.name == name).expect("it was found");
        let truth: f64 = truth.parse().expect("a number");
        // three of its standard errors, and these a twelfth of the value at most
        let error = (effect.ci95[1] - effect.ci95[0]) / (2.0 * 1.96);
        assert!((effect.value - truth).abs() < 3.0 * error && error < truth / 12.0, "{effect:?}");
    }
}

#[test]
fn recovers_friction_of_a_light_arm_that_tumbles() {
    friction_of_the_toy("toy", [["5.5", "1.0"], ["0.6", "5.2"]], 300);
}

#[test]
fn recovers_friction_of_a_quick_arm() {
    // what is off at a start grows by e^(25 t): four thousandfold in the time of a usual window
    friction_of_the_toy("quick", [["4.6", "3.1"], ["1.6", "3.3"]], 100);
}
