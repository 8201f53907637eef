//! What the user mistyped, and logs that count otherwise than the model does: told with place, and with what would be right.

use crate::common;

use crate::common::{Folder, manifest, options, plant, recorded, torque, units};
use diagnosis::Options;

fn refused(folder: &Folder, options: &Options) -> String {
    let outcome = diagnosis::diagnose(folder.path(), &units(), options, &mut |_| {});
    let error = outcome.expect_err("it must be refused");
    assert!(error.is_input(), "{error}");
    error.to_string()
}

fn small(name: &str, head: &str) -> Folder {
    let folder = Folder::new(name);
    folder.put("dataset.toml", head);
    folder.put("run-01/plant.csv", &plant(60, 1.0));
    folder.put("run-01/controller.csv", &torque(60));
    folder
}

#[test]
fn every_withheld_name_that_is_none_is_refused_with_the_nearest() {
    let folder = small("withheld", &manifest(1));
    let options = Options { without: vec!["camera.k1".into(), "camera.thilt".into()], ..options() };
    let said = refused(&folder, &options);
    assert!(said.contains("--without camera.thilt") && said.contains("did you mean camera.tilt"), "{said}");
}

#[test]
fn every_name_that_two_columns_have_is_refused_with_their_places() {
    let folder = small("named-twice", &manifest(1));
    folder.put("run-01/plant.csv", &plant(60, 1.0).replacen("time,q1,q2", "time,q1,q1", 1));
    let said = refused(&folder, &options());
    assert!(said.contains("plant.csv:1: columns 2 and 3 are both called \"q1\""), "{said}");
}

#[test]
fn every_key_that_nobody_reads_is_refused_with_its_line() {
    let head = manifest(1).replace("[noise]", "[noize]");
    let said = refused(&small("noize", &head), &options());
    assert!(said.contains("dataset.toml:5: `noize`") && said.contains("did you mean noise?"), "{said}");
    let head = manifest(1).replace("plant.q2\" = 2e-4", "plant.q3\" = 2e-4");
    let said = refused(&small("noise-name", &head), &options());
    assert!(said.contains("dataset.toml:7: [noise] plant.q3") && said.contains("plant.q1"), "{said}");
    let head = manifest(1).replace("[noise]", "[log]\ntme = \"ms\"\n[noise]");
    let said = refused(&small("log-key", &head), &options());
    assert!(said.contains("dataset.toml:6: [log] `tme`") && said.contains("did you mean time?"), "{said}");
}

#[test]
fn every_run_that_is_not_there_is_refused_with_its_line() {
    let head = manifest(1).replace("\"run-01\"", "\"run-1\"");
    let said = refused(&small("missing-run", &head), &options());
    assert!(
        said.contains("dataset.toml:9: dir = \"run-1\"") && said.contains("did you mean run-01?"),
        "{said}"
    );
    // notes of other kinds are the lab's own
    let head = manifest(1) + "excitation = \"steps\"\n";
    assert!(diagnosis::rigs::acrobot::dataset::DataSet::load(small("noted-run", &head).path()).is_ok());
}

#[test]
fn every_log_with_other_separators_is_refused_with_its_line() {
    for (name, sign, separators) in [("semicolons", ";", "semicolons"), ("tabs", "\t", "tabs")] {
        let folder = small(name, &manifest(1));
        folder.put("run-01/plant.csv", &plant(60, 1.0).replace(',', sign));
        let said = refused(&folder, &options());
        let wanted = format!("plant.csv:1: columns are separated by {separators}; wanted are commas");
        assert!(said.contains(&wanted), "{said}");
    }
}

#[cfg(unix)]
#[test]
fn every_pipe_in_the_place_of_a_log_or_head_is_refused_without_waiting() {
    for file in ["run-01/plant.csv", "dataset.toml"] {
        let folder = small("pipe", &manifest(1));
        let path = folder.path().join(file);
        std::fs::remove_file(&path).expect("it was put there");
        assert!(std::process::Command::new("mkfifo").arg(&path).status().expect("of POSIX").success());
        let said = refused(&folder, &options());
        assert!(said.contains(file) && said.contains("it is a pipe, not a file"), "{said}");
    }
}

/// Which rows stay, by name of their file and time.
type Keep = fn(&str, f64) -> bool;

/// What a lab may do to the cells of a row, by the names of their columns.
type Habit = fn(&str, f64) -> f64;

/// The same data in another habit: each cell of some files changed, and rows kept that `keep` says.
fn in_habit(from: &Folder, name: &str, habit: Habit, keep: fn(&str, f64) -> bool) -> Folder {
    let folder = Folder::new(name);
    folder.put("dataset.toml", &manifest(2));
    for run in ["run-01", "run-02"] {
        for file in ["camera.csv", "controller.csv", "plant.csv"] {
            let text = std::fs::read_to_string(from.path().join(run).join(file)).expect("it was recorded");
            let mut lines = text.lines();
            let head: Vec<&str> = lines.next().expect("a head").split(',').collect();
            let mut all = head.join(",") + "\n";
            for line in lines {
                let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
                if keep(file, cells[0]) {
                    let told = head.iter().zip(&cells).map(|(name, cell)| habit(name, *cell).to_string());
                    all += &(told.collect::<Vec<_>>().join(",") + "\n");
                }
            }
            folder.put(&format!("{run}/{file}"), &exchanged(&all, name, file));
        }
    }
    folder
}

/// Two habits that no cell alone shows.
fn exchanged(text: &str, name: &str, file: &str) -> String {
    let rows = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let mut rows: Vec<Vec<String>> = rows.collect();
    if file == "plant.csv" {
        for row in rows.iter_mut().skip(1) {
            let angle = |cell: &str| cell.parse::<f64>().expect("a number");
            match name {
                "swapped" => row.swap(1, 2),
                "relative" => row[2] = (angle(&row[2]) - angle(&row[1])).to_string(),
                _ => {}
            }
        }
    }
    rows.iter().map(|row| row.join(",") + "\n").collect()
}

fn as_it_is(_: &str, cell: f64) -> f64 {
    cell
}

fn all(_: &str, _: f64) -> bool {
    true
}

fn is_angle(name: &str) -> bool {
    ["q1", "q2"].contains(&name)
}

fn of_v(name: &str) -> bool {
    ["v1", "v2", "v3"].contains(&name)
}

fn of_u(name: &str) -> bool {
    ["u1", "u2", "u3"].contains(&name)
}

#[test]
fn every_habit_of_a_lab_is_told_with_the_line_that_mends_it() {
    let good = recorded("habits", &[]);
    let cases: [(&str, Habit, Keep, &str); 11] = [
        ("milliseconds", |name, x| if name == "time" { 1e3 * x } else { x }, all, "time = \"ms\""),
        ("millinewtons", |name, x| if name == "tau" { 1e3 * x } else { x }, all, "torque = \"mN·m\""),
        ("torque-sign", |name, x| if name == "tau" { -x } else { x }, all, "torque_sign = -1"),
        ("encoder-signs", |name, x| if is_angle(name) { -x } else { x }, all, "angles_sign = -1"),
        ("sign-of-q1", |name, x| if name == "q1" { -x } else { x }, all, "q1_sign = -1"),
        ("sign-of-q2", |name, x| if name == "q2" { -x } else { x }, all, "q2_sign = -1"),
        ("swapped", as_it_is, all, "links = \"swapped\""),
        ("relative", as_it_is, all, "q2 = \"relative\""),
        ("degrees", |name, x| if is_angle(name) { x.to_degrees() } else { x }, all, "angles = \"deg\""),
        (
            "top-left",
            |name, x| match name {
                _ if of_u(name) => x + 256.0,
                _ if of_v(name) => 256.0 - x,
                _ => x,
            },
            all,
            "pixels = \"top left\"",
        ),
        ("gap", as_it_is, |_, time| !(5.0..7.5).contains(&time), "gaps = \"unknown\""),
    ];
    for (name, habit, keep, line) in cases {
        let folder = in_habit(&good, name, habit, keep);
        let said = refused(&folder, &options());
        assert!(said.contains(line), "{name}: {said}");
        folder.put("dataset.toml", &manifest(2).replace("[noise]", &format!("[log]\n{line}\n[noise]")));
        let mended =
            diagnosis::rigs::acrobot::dataset::DataSet::load(folder.path()).expect("the line mends it");
        assert_eq!(mended.runs.len(), 2, "{name}");
    }
    // the torque's rows are missing while all else goes on
    let folder = in_habit(&good, "hole", as_it_is, |file, time| {
        file != "controller.csv" || !(5.0..6.5).contains(&time)
    });
    let said = refused(&folder, &options());
    assert!(said.contains("run-01/controller.csv:") && said.contains("gaps = \"unknown\""), "{said}");
    folder.put("dataset.toml", &manifest(2).replace("[noise]", "[log]\ngaps = \"unknown\"\n[noise]"));
    let found = common::found(&folder);
    assert_eq!(common::names(&found), [""; 0], "{:?}", found.story);
}

/// Angles that images show are coarser than encoders', and in degrees link 1 would lack nothing at all.
#[test]
fn a_torque_with_the_other_sign_is_told_by_images_alone() {
    let good = recorded("seen", &[]);
    let turned = |name: &str, x: f64| if name == "tau" { -x } else { x };
    let folder = in_habit(&good, "sign-seen", turned, |file, _| file != "plant.csv");
    let said = refused(&folder, &options());
    assert!(said.contains("torque_sign = -1"), "{said}");
}

/// In degrees, a machine hardly moves and lacks hardly more than its torque: less than a nominal model with a wrong weight does.
#[test]
fn a_weight_that_is_far_off_is_no_log_in_degrees() {
    let found = common::found(&recorded("weight", &[("plant.theta_10", "1.6")]));
    assert_eq!(common::names(&found), ["plant.theta_10"], "{:?}", found.story);
}
