//! A torque whose log lost rows: what the motor was told then is not known, and nothing is made of it.

use crate::common;

use crate::common::{Folder, found, names, notice};
use diagnosis::Verdict;

/// Two runs with every 47th row of the torque lost, and without this log of the motion.
fn without_rows(name: &str, file: &str, set: &[(&str, &str)]) -> Folder {
    let folder = common::recorded(name, set);
    for run in ["run-01", "run-02"] {
        std::fs::remove_file(folder.path().join(run).join(file)).expect("it was recorded");
        let path = folder.path().join(run).join("controller.csv");
        let text = std::fs::read_to_string(&path).expect("it was recorded");
        let kept = text.lines().enumerate().filter(|(row, _)| row % 47 != 46);
        let kept: String = kept.map(|(_, line)| format!("{line}\n")).collect();
        std::fs::write(&path, kept).expect("it can be written");
    }
    folder
}

#[test]
fn every_command_that_was_lost_says_nothing_of_the_machine() {
    for file in ["camera.csv", "plant.csv"] {
        let found = found(&without_rows("lost", file, &[]));
        assert_eq!(
            (found.verdict, names(&found)),
            (Verdict::None, vec![]),
            "without {file}: {:?}",
            found.unknown
        );
        // 361 rows and the head
        let told = notice(&found.notices, "7 of 361 rows are missing");
        assert_eq!((told.file.as_str(), told.line), ("run-01/controller.csv", 46));
    }
}

#[test]
fn recovers_friction_beside_commands_that_were_lost() {
    let found = found(&without_rows("lost-friction", "camera.csv", &[("plant.b_joint", "0.02")]));
    assert_eq!((found.verdict, names(&found)), (Verdict::Named, vec!["plant.b_joint"]));
    let [low, high] = found.effects[0].ci95;
    // three standard errors
    assert!((found.effects[0].value - 0.02).abs() < 3.0 * (high - low) / (2.0 * 1.96), "{:?}", found.effects);
}
