//! Logs of a simulation as they are, without any noise, or with that of fine encoders: what is left there, of integrators, of averages
//! and of starts within stiction, is no finding.

use crate::common;

use crate::common::{Folder, found, names};
use diagnosis::Verdict;
use diagnosis::testing::Random;
use orchestrator::{MemoryRecorder, Quiet, Scenario, Simulation};
use std::fmt::Write as _;

/// Rows of the plant's log: every third communication point, 200 a second.
const EVERY: usize = 3;

/// Two runs of a shipped scenario, every value with all its digits; `noise` of the angles in rad.
fn simulated(name: &str, scenario: &str, set: &[(&str, &str)], noise: f64) -> Folder {
    let folder = Folder::new(name);
    let mut manifest = format!("format = 1\nscenario = \"{scenario}\"\n");
    let text = std::fs::read_to_string(common::root().join(format!("scenarios/{scenario}.toml")));
    let text = text.expect("it is shipped");
    for (run, start) in [("run-01", "0.1"), ("run-02", "-0.15")] {
        let mut scenario = Scenario::parse(&text, "shipped.toml").expect("it is shipped");
        for (name, value) in [("plant.q2_0", start)].iter().chain(set) {
            scenario.set(name, value).expect("the names are right");
        }
        scenario.set_stop("10").expect("a time");
        let (mut memory, mut random) = (MemoryRecorder::new(), Random::new(5));
        let mut simulation = Simulation::new(&scenario, &common::units()).expect("cargo xtask pack was run");
        simulation.run(&mut memory, &mut Quiet).expect("it runs");
        let mut log = |unit: &str, columns: &[&str], every: usize| {
            let series: Vec<&[f64]> =
                columns.iter().filter_map(|name| memory.series(&format!("{unit}.{name}")).ok()).collect();
            let noise = if unit == "plant" { noise } else { 0.0 };
            if series.len() < columns.len() {
                return; // nobody looks
            }
            let mut text = format!("time,{}\n", columns.join(","));
            for (row, time) in memory.times().iter().enumerate().step_by(every) {
                let new = |column: &&[f64]| row == 0 || column[row] != column[row - 1];
                if unit == "plant" || series.iter().any(new) {
                    let mut seen = |column: &&[f64]| column[row] + noise * random.normal();
                    let cells: Vec<String> = series.iter().map(|column| seen(column).to_string()).collect();
                    let _ = writeln!(text, "{time},{}", cells.join(","));
                }
            }
            folder.put(&format!("{run}/{unit}.csv"), &text);
        };
        log("plant", &["q1", "q2"], EVERY);
        log("controller", &["tau"], 1);
        log("camera", &["frame", "u1", "v1", "u2", "v2", "u3", "v3", "area1", "area2", "area3", "valid"], 1);
        let _ = writeln!(manifest, "[[run]]\ndir = \"{run}\"");
    }
    folder.put("dataset.toml", &manifest);
    folder
}

#[test]
fn law_a_simulation_with_nothing_hidden_lacks_nothing() {
    for scenario in ["visual-servo", "full-state"] {
        let found = found(&simulated(&format!("clean-{scenario}"), scenario, &[], 0.0));
        assert_eq!((found.verdict, names(&found)), (Verdict::None, vec![]), "{scenario}");
    }
}

#[test]
fn recovers_a_lag_of_a_torque_that_is_logged_thrice_a_row() {
    let found = found(&simulated("clean-lag", "full-state", &[("plant.T_act", "0.002")], 0.0));
    assert_eq!((found.verdict, names(&found)), (Verdict::Named, vec!["plant.T_act"]));
    // three standard errors at the least noise that is believed; means of the torque instead of lines made a delay of it
    assert!((found.effects[0].value - 0.002).abs() < 4e-6, "{:?}", found.effects);
}

#[test]
fn recovers_friction_and_no_noise_of_a_sensor_that_has_none() {
    let found = found(&simulated("clean-friction", "visual-servo", &[("plant.fc_joint", "0.005")], 0.0));
    assert_eq!((found.verdict, names(&found)), (Verdict::Named, vec!["plant.fc_joint"]));
    // three standard errors at the least noise that is believed
    assert!((found.effects[0].value - 0.005).abs() < 2.5e-5, "{:?}", found.effects);
}

#[test]
fn recovers_friction_of_a_drum_that_encoders_see_stick() {
    let found = found(&simulated("clean-sticking", "full-state", &[("plant.fc_roll", "0.005")], 2e-5));
    assert_eq!((found.verdict, names(&found)), (Verdict::Named, vec!["plant.fc_roll"]));
    // starts within stiction leave up to a per cent, which the interval doesn't know of
    assert!((found.effects[0].value / 0.005 - 1.0).abs() < 0.01, "{:?}", found.effects);
}
