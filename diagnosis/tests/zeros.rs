//! Encoders whose zeros are off: found, told, and taken for no effect, with pictures and without.

#[allow(dead_code)] // each test file uses a part of it
mod common;

use common::{Folder, found, names, notice, recorded};

/// How far the angles are logged too large, rad: a sixth of a degree, as set by eye.
const OFF: [f64; 2] = [0.003, -0.004];

/// Encoders that read too large.
fn turn(folder: &Folder) {
    for run in ["run-01", "run-02"] {
        let path = folder.path().join(run).join("plant.csv");
        let log = std::fs::read_to_string(&path).expect("it was recorded");
        let turned = log.lines().map(|line| {
            let cells: Vec<f64> = line.split(',').filter_map(|cell| cell.parse().ok()).collect();
            match cells[..] {
                [time, q1, q2] => format!("{time},{},{}", q1 + OFF[0], q2 + OFF[1]),
                _ => line.to_owned(),
            }
        });
        std::fs::write(&path, turned.collect::<Vec<_>>().join("\n")).expect("it can be written");
    }
}

fn told(folder: &Folder) {
    let found = found(folder);
    assert_eq!(names(&found), [""; 0], "{:?} {:?}", found.effects, found.unknown);
    for (angle, off) in ["q1", "q2"].into_iter().zip(OFF) {
        let message = &notice(&found.notices, &format!("{angle} reads")).message;
        let words: Vec<&str> = message.split(' ').collect();
        let said: f64 = words[2].parse().expect("a number");
        // 24 s of encoders of 2e-4 rad tell a zero to 3e-5
        assert!((said - off).abs() < 3e-4, "{message}");
    }
}

#[test]
fn law_zeros_that_are_off_are_no_ground_no_bias_and_no_camera() {
    let folder = recorded("zeros", &[]);
    turn(&folder);
    told(&folder);
    for run in ["run-01", "run-02"] {
        std::fs::remove_file(folder.path().join(run).join("camera.csv")).expect("it was recorded");
    }
    told(&folder);
}

#[test]
fn law_inclined_ground_is_no_zero_with_pictures() {
    let found = found(&recorded("ground", &[("plant.slope", "0.02")]));
    assert_eq!(names(&found), ["plant.slope"], "{:?} {:?}", found.effects, found.unknown);
}
