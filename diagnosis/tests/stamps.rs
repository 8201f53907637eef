//! Logs stamped by clocks that have nothing to do with each other are set to one time, or put aside; stamps that scatter are put to
//! the ticks of their clock, unless rows were taken so unevenly.

#[allow(dead_code)] // each test file uses a part of it
mod common;

use common::{Folder, manifest, notice, plant};
use diagnosis::Error;
use diagnosis::dataset::DataSet;
use diagnosis::statistics::random::Random;
use diagnosis::{Diagnosis, diagnose};
use std::fmt::Write as _;

/// A log of the angles, and what a camera sees of them, stamped later by `late`.
fn filmed(
    name: &str,
    turn: &dyn Fn(f64) -> [f64; 2],
    other: &dyn Fn(f64) -> [f64; 2],
    late: f64,
) -> Result<DataSet, Error> {
    let (mut logged, mut seen) = ("time,q1,q2\n".to_owned(), "time,u1,v1,u2,v2,u3,v3\n".to_owned());
    for row in 0..600 {
        let time = f64::from(row) / 60.0;
        let [q1, q2] = turn(time);
        let _ = writeln!(logged, "{time},{q1},{q2}");
        let [q1, q2] = other(time);
        let (u2, v2) = (200.0 + 80.0 * q1.sin(), 200.0 + 80.0 * q1.cos());
        let (u3, v3) = (u2 + 60.0 * q2.sin(), v2 + 60.0 * q2.cos());
        let _ = writeln!(seen, "{},200,200,{u2},{v2},{u3},{v3}", time + late);
    }
    let folder = Folder::new(name);
    folder.put("dataset.toml", &manifest(1));
    folder.put("run-01/plant.csv", &logged);
    folder.put("run-01/camera.csv", &seen);
    DataSet::load(folder.path())
}

fn wander(time: f64) -> [f64; 2] {
    [
        0.1 * (1.3 * time).sin() + 0.05 * (2.9 * time).cos(),
        0.4 * (0.7 * time).cos() + 0.2 * (2.2 * time).sin(),
    ]
}

#[test]
fn every_log_stamped_by_another_clock_is_set_right_by_the_motion() {
    for late in [1.7e9 + 0.1234, -30.0, 2.5] {
        let set = filmed("epoch", &wander, &wander, late).expect("both logs are good");
        let found = notice(&set.notices, "set right by the motion");
        assert_eq!(found.file, "run-01/plant.csv");
        let first = set.runs[0].plant.as_ref().map_or(f64::NAN, |log| log.time[0]);
        // straight lines between rows 17 ms apart, and doubles of 1.7e9 s
        assert!((first - late).abs() < 1e-3, "{first} {late}");
        assert!(set.pictures_apart);
    }
    // a camera may be as late as that
    for late in [0.0, 0.3] {
        let set = filmed("late", &wander, &wander, late).expect("both logs are good");
        assert!(!set.pictures_apart && set.notices.len() == 1, "{:?}", set.notices);
    }
}

#[test]
fn every_log_of_another_motion_or_one_that_repeats_itself_is_left_as_it_is() {
    let other = |time: f64| wander(17.0 - 1.7 * time);
    let set = filmed("strangers", &wander, &other, 1.7e9).expect("pictures alone are usable");
    assert!(set.runs[0].plant.is_none() && set.runs[0].camera.is_some());
    assert!(notice(&set.notices, "agree at no shift").message.contains("File put aside"));
    let blind = filmed("blind", &wander, &|_| [f64::NAN; 2], 1.7e9).expect("angles alone are usable");
    assert!(blind.runs[0].plant.is_some() && !blind.pictures_apart, "{:?}", blind.notices);
    // every 2.1 s the same: 3.5 s late, or 1.4?
    let sway = |time: f64| [0.1 * (3.0 * time).sin(), 0.4 * (6.0 * time).cos()];
    let set = filmed("again", &sway, &sway, 3.5).expect("both logs are good");
    assert!(!set.notices.iter().any(|notice| notice.message.contains("set right")), "{:?}", set.notices);
}

#[test]
fn every_stranger_among_the_torques_is_put_aside() {
    let folder = Folder::new("torques");
    folder.put("dataset.toml", &manifest(1));
    folder.put("run-01/plant.csv", &plant(60, 1.0));
    let mut later = "time,tau\n".to_owned();
    for row in 0..60 {
        let _ = writeln!(later, "{},0.1", 1.7e9 + f64::from(row) / 30.0);
    }
    folder.put("run-01/controller.csv", &later);
    let set = DataSet::load(folder.path()).expect("the angles are there");
    assert_eq!(notice(&set.notices, "stamped by another clock").file, "run-01/controller.csv");
    assert!(set.runs[0].controller.is_none());
}

/// Every seventh row of the encoders (200 a second), or one beside it; `stamp` gives it a time for its own.
fn unevenly(name: &str, beside: &mut dyn FnMut() -> isize, stamp: &mut dyn FnMut(f64) -> f64) -> Diagnosis {
    let folder = common::logged_along(name, LIVELY, &[("plant.b_joint", "0.02")], true);
    for run in ["run-01", "run-02"] {
        std::fs::remove_file(folder.path().join(run).join("camera.csv")).expect("it was recorded");
        let path = folder.path().join(run).join("plant.csv");
        let text = std::fs::read_to_string(&path).expect("it was recorded");
        let rows: Vec<&str> = text.lines().collect();
        let mut kept = format!("{}\n", rows[0]);
        for place in (8..rows.len() - 1).step_by(7) {
            let row = rows[(place as isize + beside()) as usize];
            let (time, rest) = row.split_once(',').expect("it has cells");
            let _ = writeln!(kept, "{},{rest}", stamp(time.parse().expect("a time")));
        }
        std::fs::write(&path, kept).expect("it can be written");
    }
    diagnose(folder.path(), &common::units(), &common::options(), &mut |_| {}).expect("the data is good")
}

/// Steps and ramps: fast enough for 2 ms to matter.
const LIVELY: &str =
    "[[0, 0], [1, 0], [1.5, 0.4], [3, 0.4], [3.5, -0.2], [5, -0.2], [5.5, 0.4], [7, 0.4], [8, 0], [30, 0]]";

fn is_evened(found: &Diagnosis) -> bool {
    let names: Vec<&str> = found.effects.iter().map(|effect| effect.name.as_str()).collect();
    assert_eq!(names, ["plant.b_joint"], "{:#?} {:?}", found.story, found.notices);
    // three of the standard errors seen, 1 %
    assert!((found.effects[0].value - 0.02).abs() < 6e-4, "{:?}", found.effects);
    let evened = found.notices.iter().filter(|notice| notice.message.contains("about an even clock"));
    let files: Vec<&str> = evened.map(|notice| notice.file.as_str()).collect();
    assert!(files.is_empty() || files == ["run-01/plant.csv", "run-02/plant.csv"], "{files:?}");
    !files.is_empty()
}

#[test]
fn every_stamp_that_scatters_is_put_to_a_tick() {
    let mut random = Random::new(7);
    assert!(is_evened(&unevenly("scatter", &mut || 0, &mut |time| time + 2e-3 * random.normal())));
}

#[test]
fn every_row_that_was_taken_unevenly_keeps_its_time() {
    let mut random = Random::new(8);
    let mut beside = || (3.0 * random.uniform()).floor() as isize - 1;
    assert!(!is_evened(&unevenly("uneven", &mut beside, &mut |time| time)));
}
