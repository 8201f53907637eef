//! Logs stamped by clocks that have nothing to do with each other are set to one time, or put aside; stamps that scatter are put to
//! the ticks of their clock, unless rows were taken so unevenly.

use crate::common;

use crate::common::{Folder, manifest, notice, plant};
use diagnosis::Error;
use diagnosis::rigs::acrobot::dataset::DataSet;
use diagnosis::testing::Random;
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
        // circle 1 where the nominal camera sees it, 7 of 20 world units below the middle of 512 px
        let (u1, v1) = (0.0, -179.2);
        let (u2, v2) = (u1 + 80.0 * q1.sin(), v1 + 80.0 * q1.cos());
        let (u3, v3) = (u2 + 60.0 * q2.sin(), v2 + 60.0 * q2.cos());
        let _ = writeln!(seen, "{},{u1},{v1},{u2},{v2},{u3},{v3}", time + late);
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
        let found = notice(&set.notices, "corrected by the motion");
        assert_eq!(found.file, "run-01/plant.csv");
        let first = set.runs[0].plant.as_ref().map_or(f64::NAN, |log| log.time[0]);
        // straight lines between rows 17 ms apart, and doubles of 1.7e9 s
        assert!((first - late).abs() < 1e-3, "{first} {late}");
        assert!(set.frames_apart);
    }
    // a camera may be as late as that
    for late in [0.0, 0.3] {
        let set = filmed("late", &wander, &wander, late).expect("both logs are good");
        assert!(!set.frames_apart && set.notices.len() == 1, "{:?}", set.notices);
    }
}

#[test]
fn every_log_of_another_motion_or_one_that_repeats_itself_is_left_as_it_is() {
    let other = |time: f64| wander(17.0 - 1.7 * time);
    let set = filmed("strangers", &wander, &other, 1.7e9).expect("pictures alone are usable");
    assert!(set.runs[0].plant.is_none() && set.runs[0].camera.is_some());
    assert!(notice(&set.notices, "agree at no shift").message.contains("File excluded"));
    let blind = filmed("blind", &wander, &|_| [f64::NAN; 2], 1.7e9).expect("angles alone are usable");
    assert!(blind.runs[0].plant.is_some() && !blind.frames_apart, "{:?}", blind.notices);
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
    assert_eq!(notice(&set.notices, "are they of another clock").file, "run-01/controller.csv");
    assert!(set.runs[0].controller.is_none());
}

/// Rows of the encoders (200 a second), taken a share of a row's interval later and stamped by `stamp`.
fn unevenly(name: &str, late: &mut dyn FnMut() -> f64, stamp: &mut dyn FnMut(f64) -> f64) -> Diagnosis {
    let folder = common::logged_along(name, LIVELY, &[("plant.b_joint", "0.02")], true);
    folder.put("dataset.toml", &manifest(2));
    for run in ["run-01", "run-02"] {
        std::fs::remove_file(folder.path().join(run).join("camera.csv")).expect("it was recorded");
        let path = folder.path().join(run).join("plant.csv");
        let text = std::fs::read_to_string(&path).expect("it was recorded");
        let cells = |line: &str| -> Vec<f64> {
            line.split(',').take(3).map(|cell| cell.parse().expect("a number")).collect()
        };
        let rows: Vec<Vec<f64>> = text.lines().skip(1).map(cells).collect();
        let mut kept = "time,q1,q2\n".to_owned();
        for pair in rows.windows(2) {
            let share = late();
            let at = |place: usize| pair[0][place] + share * (pair[1][place] - pair[0][place]);
            let _ = writeln!(kept, "{},{},{}", stamp(at(0)), at(1), at(2));
        }
        std::fs::write(&path, kept).expect("it can be written");
    }
    diagnose(folder.path(), &common::units(), &common::options(), &mut |_| {}).expect("the data is good")
}

/// Ramps as fast as the arm follows: half a millisecond matters.
const LIVELY: &str = "[[0, 0], [1, 0], [2.5, 0.3], [4, 0.3], [6, -0.2], [7.5, -0.2], [9, 0.3], [30, 0.3]]";

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
    let mut stamp = |time| time + 5e-4 * random.normal();
    assert!(is_evened(&unevenly("scatter", &mut || 0.0, &mut stamp)));
}

#[test]
fn every_row_that_was_taken_unevenly_keeps_its_time() {
    let mut random = Random::new(8);
    // up to 2 ms late, which is what the stamps say
    assert!(!is_evened(&unevenly("uneven", &mut || 0.4 * random.uniform(), &mut |time| time)));
}

/// Rows of the encoders (30 a second), each stamped late by what a computer took to get there: up to 4 ms.
fn stamped_by_hand(name: &str, set: &[(&str, &str)], pictures: bool) -> Diagnosis {
    let folder = common::recorded(name, set);
    let mut random = Random::new(9);
    for run in ["run-01", "run-02"] {
        let path = folder.path().join(run).join("plant.csv");
        let text = std::fs::read_to_string(&path).expect("it was recorded");
        let mut late = |line: &str| {
            let (time, cells) = line.split_once(',').expect("three cells");
            let time: f64 = time.parse().expect("a number");
            format!("{},{cells}\n", time + 4e-3 * random.uniform())
        };
        let rows: String = text.lines().skip(1).map(&mut late).collect();
        std::fs::write(&path, format!("time,q1,q2\n{rows}")).expect("it can be written");
        if !pictures {
            std::fs::remove_file(folder.path().join(run).join("camera.csv")).expect("it was recorded");
        }
    }
    diagnose(folder.path(), &common::units(), &common::options(), &mut |_| {}).expect("the data is good")
}

#[test]
fn every_log_late_by_what_its_stamps_scatter_is_no_actuator_that_lags() {
    let names = |found: &Diagnosis| -> Vec<String> {
        found.effects.iter().map(|effect| effect.name.clone()).collect()
    };
    for (set, pictures) in [(("plant.b_joint", "0.02"), false), (("camera.T_delay", "0.0267"), true)] {
        let found = stamped_by_hand("by-hand", &[set], pictures);
        assert_eq!(names(&found), [set.0], "{:#?}", found.story);
        notice(&found.notices, "taken as its clock, not as an effect");
    }
    // pictures that are late by as much say that the log isn't
    let found = stamped_by_hand("by-hand-lags", &[("plant.tau_delay", "0.004")], true);
    assert!(["plant.tau_delay", "plant.T_act"].contains(&names(&found)[0].as_str()), "{:#?}", found.story);
    assert_eq!(found.effects.len(), 1, "{:?}", found.effects);
}

#[test]
fn every_stamp_of_a_frame_that_scatters_says_nothing_of_the_machine() {
    let folder = common::logged_along("frames-scatter", LIVELY, &[], false);
    let mut random = Random::new(11);
    for run in ["run-01", "run-02"] {
        std::fs::remove_file(folder.path().join(run).join("plant.csv")).expect("it was recorded");
        let path = folder.path().join(run).join("camera.csv");
        let text = std::fs::read_to_string(&path).expect("it was recorded");
        let (head, rows) = text.split_once('\n').expect("a head");
        let mut kept = format!("{head}\n");
        for (time, cells) in rows.lines().filter_map(|line| line.split_once(',')) {
            let time = time.parse::<f64>().expect("a number") + 2e-3 * random.normal();
            let _ = writeln!(kept, "{time},{cells}");
        }
        std::fs::write(&path, kept).expect("it can be written");
    }
    let found = common::found(&folder);
    assert_eq!(
        (found.verdict, common::names(&found)),
        (diagnosis::Verdict::None, vec![]),
        "{:?}",
        found.unknown
    );
}
