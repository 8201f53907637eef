//! Logs of pictures that hold a part of what a camera gives: some circles, or nothing but the angles that its vision read.

use crate::common;

use crate::common::{Folder, found, names};
use diagnosis::Verdict;
use diagnosis::rigs::acrobot::dataset::DataSet;

const RUNS: [&str; 2] = ["run-01", "run-02"];

/// Leaves so many columns of the camera's logs, and of the others none of `without`.
fn part_of(folder: Folder, columns: &[&str], without: &[&str]) -> Folder {
    for run in RUNS {
        let text = std::fs::read_to_string(folder.path().join(run).join("camera.csv")).expect("recorded");
        let head: Vec<&str> = text.lines().next().expect("a head").split(',').collect();
        let places: Vec<usize> =
            (0..head.len()).filter(|place| *place == 0 || columns.contains(&head[*place])).collect();
        let row = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            places.iter().map(|place| cells[*place]).collect::<Vec<_>>().join(",") + "\n"
        };
        folder.put(&format!("{run}/camera.csv"), &text.lines().map(row).collect::<String>());
        for file in without {
            std::fs::remove_file(folder.path().join(run).join(file)).expect("recorded");
        }
    }
    folder
}

#[test]
fn recovers_radial_distortion_from_the_tip_alone_beside_encoders() {
    let whole = common::recorded("tip", &[("camera.k1", "0.05")]);
    let found = found(&part_of(whole, &["u3", "v3"], &[]));
    assert_eq!((found.verdict, names(&found)), (Verdict::Named, vec!["camera.k1"]));
    // some three standard errors
    assert!((found.effects[0].value - 0.05).abs() < 1e-4, "{:?}", found.effects);
    common::notice(&found.notices, "columns `u1`, `v1`, `u2`, `v2` are missing: compared without");
}

#[test]
fn recovers_radial_distortion_from_two_circles_and_a_torque() {
    let whole = common::recorded("two-circles", &[("camera.k1", "0.05")]);
    let found = found(&part_of(whole, &["u2", "v2", "u3", "v3"], &["plant.csv"]));
    assert_eq!((found.verdict, names(&found)), (Verdict::Named, vec!["camera.k1"]));
    // some three standard errors
    assert!((found.effects[0].value - 0.05).abs() < 1e-4, "{:?}", found.effects);
}

#[test]
fn recovers_a_delay_from_angles_that_a_vision_read_beside_encoders() {
    let whole = common::recorded("angles", &[("camera.T_delay", "0.02")]);
    let found = found(&part_of(whole, &["q1_est", "q2_est"], &[]));
    assert_eq!((found.verdict, names(&found)), (Verdict::Named, vec!["camera.T_delay"]));
    // some three standard errors
    assert!((found.effects[0].value - 0.02).abs() < 3e-4, "{:?}", found.effects);
    // what is left is in rad: 0.03 px over links of 160 px
    assert!(found.gap.after < 3e-4 && found.gap.unit == "rad", "{:?}", found.gap);
    common::notice(&found.notices, "are missing: q1_est and q2_est are compared");
}

#[test]
fn recovers_friction_and_a_turned_camera_from_angles_that_a_vision_read_and_a_torque() {
    // (effect, what is hidden, three standard errors)
    for (effect, value, near) in [("plant.b_joint", 0.02, 8e-4), ("camera.roll", 0.02, 4e-4)] {
        let whole = common::recorded("angles-alone", &[(effect, &value.to_string())]);
        let found = found(&part_of(whole, &["q1_est", "q2_est"], &["plant.csv"]));
        assert_eq!((found.verdict, names(&found)), (Verdict::Named, vec![effect]));
        assert!((found.effects[0].value - value).abs() < near, "{:?}", found.effects);
    }
}

#[test]
fn every_log_of_pictures_that_says_nothing_beside_the_others_is_put_aside() {
    let whole = || common::recorded("says-nothing", &[]);
    // (columns, logs that aren't there, words of the notice)
    let cases: [(&[&str], &[&str], &str); 3] = [
        (&["u3", "v3"], &["plant.csv"], "without encoders, circles 2 and 3 or q1_est and q2_est must tell"),
        (&["q1_est", "q2_est"], &["plant.csv", "controller.csv"], "nothing that they could be compared with"),
        (&["valid"], &[], "no centroid, area or angle is measured"),
    ];
    for (columns, without, words) in cases {
        let folder = part_of(whole(), columns, without);
        let notices = match DataSet::load(folder.path()) {
            Ok(data) => {
                assert!(data.runs.iter().all(|run| run.camera.is_none()), "{words}");
                data.notices
            }
            Err(diagnosis::Error::NothingUsable { notices, .. }) => notices,
            Err(error) => panic!("{error}"),
        };
        let notice = common::notice(&notices, words);
        assert_eq!((notice.file.as_str(), notice.line), ("run-01/camera.csv", 1));
    }
}

#[test]
fn every_angle_that_a_vision_gave_in_degrees_is_refused() {
    let folder = part_of(common::recorded("vision-degrees", &[]), &["q1_est", "q2_est"], &[]);
    for run in RUNS {
        let text = std::fs::read_to_string(folder.path().join(run).join("camera.csv")).expect("recorded");
        let row = |line: &str| {
            let numbers = line.split(',').map(|cell| cell.parse::<f64>().expect("a number"));
            let cells = numbers.enumerate().map(|(place, x)| if place > 0 { x.to_degrees() } else { x });
            cells.map(|x| x.to_string()).collect::<Vec<_>>().join(",") + "\n"
        };
        let rows: String = text.lines().skip(1).map(row).collect();
        folder.put(&format!("{run}/camera.csv"), &format!("time,q1_est,q2_est\n{rows}"));
    }
    let said = DataSet::load(folder.path()).expect_err("angles are in radians").to_string();
    let told = said.contains("q1_est moves 57 times") && said.contains("run-01/camera.csv");
    assert!(told && said.contains("vision_angles = \"deg\""), "{said}");
}

#[test]
fn every_row_in_which_the_tip_is_taken_for_circle_1_is_put_aside() {
    let folder = common::recorded("confused", &[]);
    let path = folder.path().join("run-02/camera.csv");
    let text = std::fs::read_to_string(&path).expect("recorded");
    let (mut rows, mut lines) = (String::new(), 0);
    for line in text.lines() {
        let mut cells: Vec<&str> = line.split(',').collect();
        // more than half of them
        if lines >= 100 {
            cells.swap(1, 5);
            cells.swap(2, 6);
        }
        rows += &(cells.join(",") + "\n");
        lines += 1;
    }
    folder.put("run-02/camera.csv", &rows);
    let data = DataSet::load(folder.path()).expect("the first half is usable");
    let notice = common::notice(&data.notices, "and another is on it");
    assert_eq!((notice.file.as_str(), notice.line), ("run-02/camera.csv", 101));
    assert!(notice.message.contains(&format!("{} such rows", lines - 100)), "{}", notice.message);
    let camera = data.runs[1].camera.as_ref().and_then(|log| log.column("u1")).expect("it is there");
    assert!(camera[..99].iter().all(|at| at.is_finite()) && camera[99..].iter().all(|at| at.is_nan()));
    let found = found(&folder);
    assert_eq!(found.verdict, Verdict::None, "{:?} {:?}", found.effects, found.unknown);
}

#[test]
fn recovers_an_actuators_lag_that_images_alone_show() {
    // to images it is a delay, nearly; an exposure of 0.2, whose middle comes as late, blurs them: it loses 50 and more where it is compared
    // with the camera's delay, and that loses 10 against the lag
    let lively = common::recorded_along("lag-seen", common::LIVELY, &[("plant.T_act", "0.003")]);
    for run in RUNS {
        std::fs::remove_file(lively.path().join(run).join("plant.csv")).expect("it was recorded");
    }
    let found = found(&lively);
    assert_eq!((found.verdict, names(&found)), (Verdict::Named, vec!["plant.T_act"]), "{:?}", found.effects);
    // some eight standard errors
    assert!((found.effects[0].value - 0.003).abs() < 1e-4, "{:?}", found.effects);
}
