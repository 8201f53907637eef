//! Encoders whose zeros are off: found, told, and taken for no effect, with pictures and without.

use crate::common::{Folder, found, names, notice, options, recorded, units};
use diagnosis::{Budget, Doing, Options, diagnose};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// How far the angles are logged too large, rad: a sixth of a degree, as set by eye.
const OFF: [f64; 2] = [0.003, -0.004];

/// As much as gravity is turned by on an inclined table, where (m1+m2)·g·R is 0.956 N·m beside 4.779 N·m of the first link.
const ALIKE: [f64; 2] = [0.006, 0.005];

/// Encoders that read too large by so much.
fn turn(folder: &Folder, off: [f64; 2]) {
    for run in ["run-01", "run-02"] {
        let path = folder.path().join(run).join("plant.csv");
        let log = std::fs::read_to_string(&path).expect("it was recorded");
        let turned = log.lines().map(|line| {
            let cells: Vec<f64> = line.split(',').filter_map(|cell| cell.parse().ok()).collect();
            match cells[..] {
                [time, q1, q2] => format!("{time},{},{}", q1 + off[0], q2 + off[1]),
                _ => line.to_owned(),
            }
        });
        std::fs::write(&path, turned.collect::<Vec<_>>().join("\n")).expect("it can be written");
    }
}

/// Leaves what encoders say, and the torque.
fn without_pictures(folder: &Folder) {
    for run in ["run-01", "run-02"] {
        std::fs::remove_file(folder.path().join(run).join("camera.csv")).expect("it was recorded");
    }
}

fn told(folder: &Folder, off: [f64; 2]) {
    let found = found(folder);
    assert_eq!(names(&found), [""; 0], "{:?} {:?}", found.effects, found.unknown);
    for (angle, off) in ["q1", "q2"].into_iter().zip(off) {
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
    turn(&folder, OFF);
    told(&folder, OFF);
    without_pictures(&folder);
    told(&folder, OFF);
}

#[test]
fn law_zeros_that_do_what_an_inclined_table_does_are_told_as_zeros() {
    let folder = recorded("alike", &[]);
    turn(&folder, ALIKE);
    without_pictures(&folder);
    told(&folder, ALIKE);
}

#[test]
fn law_ground_is_no_sure_name_without_pictures() {
    // 3 mrad of ground and 0.6 mrad of an encoder differ by nothing that angles of 2e-4 rad tell
    let folder = recorded("either", &[("plant.slope", "0.003")]);
    without_pictures(&folder);
    let found = found(&folder);
    assert_eq!(names(&found), ["plant.slope"], "{:?} {:?}", found.unknown, found.notices);
    assert!(found.effects[0].probability < 0.9, "{:?}", found.effects);
    notice(&found.notices, "plant.slope may as well be the zero of the first link's angle, -0.000");
}

/// Time for all searches, s.
const GIVEN: f64 = 20.0;
/// Whether it is over.
static IS_UP: AtomicBool = AtomicBool::new(false);

/// A clock that stands until time is up, and after that.
fn now() -> Instant {
    static BEGAN: OnceLock<Instant> = OnceLock::new();
    let gone = if IS_UP.load(Relaxed) { 2.0 * GIVEN } else { 0.0 };
    *BEGAN.get_or_init(Instant::now) + Duration::from_secs_f64(gone)
}

#[test]
fn law_who_had_no_time_to_doubt_a_name_is_half_as_sure_of_it() {
    let folder = recorded("early", &[("plant.b_joint", "0.02")]);
    without_pictures(&folder);
    let sure = found(&folder);
    assert_eq!((names(&sure), sure.effects[0].probability), (vec!["plant.b_joint"], 0.995));
    // time is up as soon as it has its name, by a clock that stands until then
    let tell = &mut |doing: &Doing<'_>| {
        IS_UP.fetch_or(doing.stage.ends_with("plant.b_joint"), Relaxed);
    };
    let options = Options { budget: Budget::All(GIVEN), now, ..options() };
    let early = diagnose(folder.path(), &units(), &options, tell).expect("the data is good");
    assert!(IS_UP.load(Relaxed) && !early.ended_early.is_empty(), "{:?}", early.ended_early);
    assert_eq!(names(&early), ["plant.b_joint"], "{:?}", early.ended_early);
    assert!(early.effects[0].probability <= 0.5, "{:?}", early.effects);
}

#[test]
fn law_inclined_ground_is_no_zero_with_pictures() {
    let found = found(&recorded("ground", &[("plant.slope", "0.02")]));
    assert_eq!(names(&found), ["plant.slope"], "{:?} {:?}", found.effects, found.unknown);
}
