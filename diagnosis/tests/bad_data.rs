//! Bad data gets a message with file and line, and what is usable is used.

use crate::common;

use crate::common::{Folder, manifest, notice, plant, torque};
use diagnosis::Error;
use diagnosis::rigs::acrobot::dataset::DataSet;
use std::fmt::Write as _;

fn load(plant: &str, name: &str) -> Result<DataSet, Error> {
    let folder = Folder::new(name);
    folder.put("dataset.toml", &manifest(1));
    folder.put("run-01/plant.csv", plant);
    folder.put("run-01/controller.csv", &torque(60));
    DataSet::load(folder.path())
}

#[test]
fn every_good_row_is_kept() {
    let set = load(&plant(60, 1.0), "good").expect("it is good");
    assert_eq!(set.notices, []);
    assert_eq!(set.runs[0].plant.as_ref().map(|log| log.len()), Some(60));
}

#[test]
fn every_row_that_runs_back_is_named_and_ignored() {
    let mut lines: Vec<String> = plant(60, 1.0).lines().map(str::to_owned).collect();
    lines.swap(20, 21);
    let set = load(&lines.join("\n"), "back").expect("the rest is usable");
    assert_eq!(notice(&set.notices, "runs back").line, 22);
    assert_eq!(set.runs[0].plant.as_ref().map(|log| log.len()), Some(59));
}

#[test]
fn every_stamp_that_leaps_ahead_is_named_and_ignored() {
    let mut lines: Vec<String> = plant(60, 1.0).lines().map(str::to_owned).collect();
    lines[30] = format!("1.7e9,{}", lines[30].split_once(',').map_or("", |(_, rest)| rest));
    let set = load(&lines.join("\n"), "leap").expect("the rest is usable");
    assert_eq!(notice(&set.notices, "leaps ahead").line, 31);
    assert_eq!(set.runs[0].plant.as_ref().map(|log| log.len()), Some(59));
    // a clock that was set when the log had begun
    let set: Vec<String> = (lines.iter().enumerate())
        .filter(|(line, _)| *line != 30)
        .map(|(line, text)| match text.split_once(',') {
            Some((time, rest)) if line > 1 => {
                format!("{},{rest}", 1.7e9 + time.parse::<f64>().unwrap_or(f64::NAN))
            }
            _ => text.clone(),
        })
        .collect();
    let folder = Folder::new("set");
    folder.put("dataset.toml", &manifest(1));
    folder.put("run-01/plant.csv", &set.join("\n"));
    let set = DataSet::load(folder.path()).expect("the rest is usable");
    assert_eq!(notice(&set.notices, "leaps ahead").line, 2);
    assert_eq!(set.runs[0].plant.as_ref().map(|log| log.len()), Some(58));
}

#[test]
fn every_torque_that_is_not_known_leaves_out_what_it_drives() {
    let head = |bad: &dyn Fn(usize) -> Option<&'static str>| {
        let mut text = "time,tau\n".to_owned();
        for row in 0..60 {
            let good = format!("{},0.1\n", row as f64 / 30.0);
            text.push_str(bad(row).unwrap_or(&good));
        }
        text
    };
    let set = |torques: &str| {
        let folder = Folder::new("unknown-torque");
        folder.put("dataset.toml", &manifest(1));
        folder.put("run-01/plant.csv", &plant(60, 1.0));
        folder.put("run-01/controller.csv", torques);
        DataSet::load(folder.path()).expect("the rest is usable")
    };
    let near = |spans: Vec<(f64, f64)>, from: f64, to: f64| {
        spans.len() == 1 && (spans[0].0 - from).abs() < 1e-9 && (spans[0].1 - to).abs() < 1e-9
    };
    // no number, and one that no motor gives, are unknown until the next row; gravity pulls with 6.7 N·m
    for (cell, words) in [("1,NaN\n", "not a finite number"), ("1,\n", ""), ("1,-1e9\n", "tau = -1e9 N·m")] {
        let set = set(&head(&|row| (row == 30).then_some(cell)));
        assert!(words.is_empty() || notice(&set.notices, words).line == 32, "{cell}");
        assert!(near(set.runs[0].undriven(), 1.0, 31.0 / 30.0), "{cell}: {:?}", set.runs[0].undriven());
    }
    // a row that was ignored was somewhere between its neighbours
    for line in ["0.1,0.1\n", "1,0.1,3\n", "now,0.1\n", "1e9,0.1\n"] {
        let set = set(&head(&|row| (row == 30).then_some(line)));
        assert!(
            near(set.runs[0].undriven(), 29.0 / 30.0, 31.0 / 30.0),
            "{line}: {:?}",
            set.runs[0].undriven()
        );
    }
    // another column is logged ten times as often: a torque is held between its own rows
    let mut often = "time,tau,z_desired\n".to_owned();
    for row in 0..600 {
        let _ = writeln!(often, "{},{},0.2", row as f64 / 300.0, if row % 10 == 0 { "0.1" } else { "" });
    }
    let set = set(&often);
    assert_eq!(set.runs[0].undriven(), []);
}

#[test]
fn every_line_is_counted_alike_however_it_ends() {
    let text = plant(60, 1.0);
    let mut lines: Vec<&str> = text.lines().collect();
    lines[7] = "0.2,here,0.1";
    for (end, name) in [("\n", "unix"), ("\r\n", "windows")] {
        let set = load(&lines.join(end), name).expect("the rest is usable");
        assert_eq!(notice(&set.notices, "not a finite number").line, 8, "{name}");
    }
}

#[test]
fn every_torque_is_held_until_the_next_row() {
    let folder = Folder::new("held");
    folder.put("dataset.toml", &manifest(1));
    folder.put("run-01/plant.csv", &plant(60, 1.0));
    folder.put("run-01/controller.csv", "time,tau\n0,0.1\n1,0.2\n");
    let set = DataSet::load(folder.path()).expect("two rows are a log of a torque");
    assert_eq!(set.notices, []);
    assert_eq!(set.runs[0].controller.as_ref().map(|log| log.held("tau", 1.5, 0.0)), Some(0.2));
    folder.put("run-01/controller.csv", "time,tau\n0,\n1,\n");
    let set = DataSet::load(folder.path()).expect("the angles are usable");
    assert_eq!(notice(&set.notices, "`tau` holds no number").file, "run-01/controller.csv");
    assert!(set.runs[0].controller.is_none());
}

#[test]
fn every_log_without_angles_or_with_times_of_another_unit_is_put_aside() {
    let bare: String = plant(60, 1.0)
        .lines()
        .enumerate()
        .map(|(row, line)| if row == 0 { format!("{line}\n") } else { format!("{row},,\n") })
        .collect();
    let said = load(&bare, "bare").expect_err("no angle was measured").to_string();
    assert!(said.contains("plant.csv:1") && said.contains("`q1` is measured in 0 rows"), "{said}");
    // a clock's microseconds
    let late: String = plant(60, 1.0)
        .lines()
        .enumerate()
        .map(|(row, line)| match line.split_once(',') {
            Some((_, rest)) if row > 0 => format!("{}e15,{rest}\n", 1.7 + 1e-9 * row as f64),
            _ => format!("{line}\n"),
        })
        .collect();
    let said = load(&late, "late").expect_err("that is no time in s").to_string();
    assert!(said.contains("plant.csv") && said.contains("time = \"us\""), "{said}");
}

#[test]
fn every_cell_that_is_no_number_counts_as_not_measured() {
    let good = plant(60, 1.0);
    let text = good
        .lines()
        .enumerate()
        .map(|(line, text)| if line == 10 { "0.3,NaN,0.5".to_owned() } else { text.to_owned() });
    let set = load(&text.collect::<Vec<_>>().join("\n"), "nan").expect("the rest is usable");
    let found = notice(&set.notices, "not a finite number");
    assert_eq!((found.file.as_str(), found.line), ("run-01/plant.csv", 11));
}

#[test]
fn every_log_in_degrees_is_put_aside() {
    let error = load(&plant(60, 57.3), "degrees").expect_err("nothing else is there");
    assert!(error.is_input());
    assert!(error.to_string().contains("degrees") && error.to_string().contains("plant.csv:"), "{error}");
}

#[test]
fn every_missing_column_and_short_run_is_named() {
    let renamed = plant(60, 1.0).replacen("q2", "angle", 1);
    let error = load(&renamed, "column").expect_err("a plant without q2 says nothing").to_string();
    assert!(error.contains("run-01/plant.csv:1: column `q2` is missing"), "{error}");
    let error = load(&plant(3, 1.0), "short").expect_err("three rows say nothing").to_string();
    assert!(error.contains("3 rows are too few"), "{error}");
}

#[test]
fn every_run_with_nothing_to_compare_is_told() {
    let folder = Folder::new("nothing-to-compare");
    folder.put("dataset.toml", &manifest(2));
    folder.put("run-01/controller.csv", &torque(60));
    folder.put("run-02/plant.csv", &plant(60, 1.0));
    folder.put("run-02/controller.csv", &torque(60));
    let set = DataSet::load(folder.path()).expect("the other run is usable");
    let told = notice(&set.notices, "excluded: neither camera.csv nor plant.csv");
    assert!(told.file == "run-01" && told.message.ends_with("holds controller.csv"), "{told}");
    assert!(set.notices.iter().all(|notice| !notice.message.contains("inf")), "{:?}", set.notices);
    folder.put("dataset.toml", &manifest(1));
    let error = DataSet::load(folder.path()).expect_err("nothing is left").to_string();
    assert!(error.contains("run-01: excluded: neither camera.csv nor plant.csv"), "{error}");
}

#[test]
fn every_mistake_in_the_manifest_has_a_line() {
    let folder = Folder::new("manifest");
    for (text, line) in [
        ("format = 2\nscenario = \"a\"", 1),
        ("format = 1\nscenario = 3", 2),
        ("format = 1\nscenario = \"a\"\n[noise]\n\"plant.q1\" = -1.0\n[[run]]\ndir = \"r\"", 4),
        ("format = 1\nscenario = \"a\"\n[[run]]\n", 3),
        ("scenario = \"a\"\nformat = \"2\"", 2),
        ("format = 1\nscenario = \"visual-srvo\"\n[[run]]\ndir = \"r\"", 2),
        ("format = 1\nscenario = \"visual-servo\"\n[[run]]\ndir = \"../r\"", 4),
        ("format = 1\nscenario = \"visual-servo\"\n[[run]]\ndir = \"/tmp\"", 4),
        ("format = 1\nscenario = \"visual-servo\"\n[[run]]\ndir = \"r\"\ndirr = 3.0", 5),
    ] {
        folder.put("r/plant.csv", &plant(60, 1.0));
        folder.put("dataset.toml", text);
        match DataSet::load(folder.path()) {
            Err(Error::Manifest { line: found, .. }) => assert_eq!(found, line, "{text}"),
            other => panic!("{text}: {other:?}"),
        }
    }
}

#[test]
fn every_value_of_the_nominal_model_that_no_unit_takes_is_told_with_its_file() {
    let folder = common::recorded("refused", &[]);
    for value in ["nan", "99.0"] {
        let head = common::manifest(2).replace("[set]\n", &format!("[set]\n\"camera.roll\" = {value}\n"));
        folder.put("dataset.toml", &head);
        let said = diagnosis::diagnose(folder.path(), &common::units(), &common::options(), &mut |_| {});
        let error = said.expect_err("no mount is turned by that");
        assert!(error.is_input(), "the user's to mend: {error}");
        let text = error.to_string();
        for word in ["[set] camera.roll", value, "3.2"] {
            assert!(text.contains(word), "{word} is missing in {text:?}");
        }
        assert!(!text.contains("--set"), "the file says it, not the command line: {text:?}");
    }
    // a value that only the unit itself refuses, when it begins
    folder.put("dataset.toml", &common::manifest(2).replace("[set]\n", "[set]\n\"plant.theta_1\" = 0.0\n"));
    let said = diagnosis::diagnose(folder.path(), &common::units(), &common::options(), &mut |_| {});
    let error = said.expect_err("no link is without inertia");
    let text = error.to_string();
    assert!(error.is_input() && text.contains("dataset.toml:3: [set] plant: "), "{text}");
    assert!(text.contains("theta_1 = 0: must be finite and > 0"), "{text}");
}

#[test]
fn every_option_that_is_of_other_data_sets_is_refused() {
    let folder = Folder::new("options");
    folder.put("dataset.toml", &manifest(1));
    let usual = common::options();
    let fit = diagnosis::Options { fit: vec!["plant.b_joint".into()], ..usual.clone() };
    let isolated = diagnosis::Options { isolation: Some(orchestrator::Isolation::default()), ..usual };
    for (options, option) in [(fit, "--fit plant.b_joint"), (isolated, "--isolate (30 s a call)")] {
        let said = diagnosis::diagnose(folder.path(), &common::units(), &options, &mut |_| {});
        let error = said.expect_err("it would be passed over");
        let text = error.to_string();
        assert!(error.is_input() && text.starts_with(option) && text.contains("format = 2"), "{text}");
    }
}

/// A pinned arm's log: link 1 swings by `reach` about `middle`, link 2 beside it, at 100 Hz.
fn swing(middle: f64, reach: f64, turn: &dyn Fn(f64) -> f64) -> String {
    let mut text = "time,q1,q2\n".to_owned();
    for row in 0..300 {
        let time = f64::from(row) / 100.0;
        let angle = |size: f64, rate: f64| turn(middle + size * (rate * time).sin());
        let _ = writeln!(text, "{time},{},{}", angle(reach, 5.0), angle(1.5 * reach, 7.0));
    }
    text
}

fn alone(plant: &str, name: &str) -> Result<DataSet, Error> {
    let folder = Folder::new(name);
    folder.put("dataset.toml", &manifest(1));
    folder.put("run-01/plant.csv", plant);
    DataSet::load(folder.path())
}

const HANGING: f64 = std::f64::consts::PI;

#[test]
fn every_arm_that_is_not_held_up_swings_freely() {
    // far enough to be above the horizontal most of the time
    let set = alone(&swing(HANGING, 3.0, &|angle| angle), "free").expect("a free swing");
    assert!(notice(&set.notices, "free swing").message.contains("without torque"));
    assert_eq!(set.runs[0].controller.as_ref().map(|log| log.held("tau", 1.0, 9.0)), Some(0.0));
    let held = alone(&swing(0.0, 0.3, &|angle| angle), "held").expect("the log itself is good");
    assert!(notice(&held.notices, "stays above the horizontal").message.contains("does this arm hang?"));
    assert!(held.runs[0].controller.is_none());
}

#[test]
fn every_angle_that_was_wrapped_is_made_whole_again() {
    use std::f64::consts::TAU;
    let wrapped = |angle: f64| (angle + HANGING).rem_euclid(TAU) - HANGING;
    let set = alone(&swing(HANGING, 1.0, &wrapped), "wrapped").expect("usable");
    assert_eq!(notice(&set.notices, "whole turn").file, "run-01/plant.csv");
    let whole = alone(&swing(HANGING, 1.0, &|angle| angle), "whole").expect("usable");
    for name in ["q1", "q2"] {
        let of =
            |set: &DataSet| set.runs[0].plant.as_ref().and_then(|log| log.column(name)).map(<[f64]>::to_vec);
        let (mended, whole) = (of(&set).expect("measured"), of(&whole).expect("measured"));
        // the same but for whole turns; 1e-9 is rounding of a few turns
        let first = ((mended[0] - whole[0]) / TAU).round() * TAU;
        assert!(mended.iter().zip(&whole).all(|(a, b)| (a - b - first).abs() < 1e-9), "{name}");
    }
}

#[test]
fn every_arm_that_turns_over_many_times_is_in_radians() {
    let tumbling = |angle: f64| 8.0 * angle;
    let set = alone(&swing(HANGING, 1.0, &tumbling), "tumbling").expect("six turns are no degrees");
    assert!(set.runs[0].plant.is_some());
}

#[test]
fn every_log_with_milliseconds_for_seconds_is_refused() {
    let text = swing(HANGING, 1.0, &|angle| angle);
    let scaled: Vec<String> = (text.lines().enumerate())
        .map(|(line, text)| match text.split_once(',') {
            Some((time, rest)) if line > 0 => {
                format!("{},{rest}", 1e3 * time.parse::<f64>().expect("a time"))
            }
            _ => text.to_owned(),
        })
        .collect();
    let error = alone(&scaled.join("\n"), "milliseconds").expect_err("nothing else is there").to_string();
    assert!(error.contains("10 s apart") && error.contains("time = \"ms\""), "{error}");
}

#[test]
fn every_motor_at_the_first_link_alone_drives_it() {
    let folder = Folder::new("shoulder");
    folder.put("dataset.toml", &manifest(1));
    folder.put("run-01/plant.csv", &swing(HANGING, 1.0, &|angle| angle));
    folder.put("run-01/controller.csv", &torque(90).replacen("tau", "tau_1", 1));
    let set = DataSet::load(folder.path()).expect("usable");
    assert!(notice(&set.notices, "driven by tau_1 alone").line == 1);
    let log = set.runs[0].controller.as_ref().expect("it is kept");
    assert_eq!((log.held("tau", 1.0, 9.0), log.held("tau_1", 1.0, 9.0)), (0.0, 0.1));
}

#[test]
fn every_angle_that_jumps_and_comes_back_is_not_measured() {
    let good = plant(60, 1.0);
    let text = good.lines().enumerate().map(|(line, text)| match line {
        10 | 20 => format!("{},0.1,{}", text.split(',').next().unwrap_or(""), ["1e300", "-99"][line / 20]),
        _ => text.to_owned(),
    });
    let set = load(&text.collect::<Vec<_>>().join("\n"), "glitch").expect("the rest is usable");
    let found = notice(&set.notices, "and back");
    assert_eq!((found.line, found.message.contains("2 such rows")), (11, true), "{found:?}");
    let q2 = set.runs[0].plant.as_ref().and_then(|log| log.column("q2")).expect("it was logged");
    assert_eq!(q2.iter().filter(|angle| angle.is_nan()).count(), 2);
}

#[test]
fn every_stated_noise_that_no_encoder_has_is_the_least_that_one_has() {
    let noise = |stated: &str| {
        let folder = Folder::new(&format!("noise-{stated}"));
        let head = manifest(1).replace("\"plant.q1\" = 2e-4", &format!("\"plant.q1\" = {stated}"));
        folder.put("dataset.toml", &head);
        folder.put("run-01/plant.csv", &plant(60, 1.0));
        folder.put("run-01/controller.csv", &torque(60));
        DataSet::load(folder.path()).expect("it is good").known_noise("plant.q1")
    };
    // with 1e-300 deviances left the finite numbers
    assert_eq!(["1e-300", "1e-6", "2e-4"].map(noise), [Some(1e-5), Some(1e-5), Some(2e-4)]);
}
