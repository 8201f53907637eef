//! What images show and no listed effect gives: a camera that shakes, frames that show another moment, with encoders and without.

use crate::common::{Folder, found, recorded};
use diagnosis::{Diagnosis, Verdict};
use std::f64::consts::TAU;

/// What is found where rows of `camera.csv` (without the head) were changed in all runs.
fn changed(name: &str, encoders: bool, change: impl Fn(&mut Vec<Vec<String>>)) -> Diagnosis {
    let folder = recorded(name, &[]);
    for run in ["run-01", "run-02"] {
        let file = format!("{run}/camera.csv");
        let text = std::fs::read_to_string(folder.path().join(&file)).expect("it was written");
        let (head, rest) = text.split_once('\n').expect("it has a head");
        let mut rows: Vec<Vec<String>> =
            rest.lines().map(|line| line.split(',').map(String::from).collect()).collect();
        change(&mut rows);
        let lines: Vec<String> = rows.iter().map(|row| row.join(",")).collect();
        folder.put(&file, &format!("{head}\n{}\n", lines.join("\n")));
        if !encoders {
            without_encoders(&folder, run);
        }
    }
    found(&folder)
}

fn without_encoders(folder: &Folder, run: &str) {
    std::fs::remove_file(folder.path().join(run).join("plant.csv")).expect("it is there");
    let head = std::fs::read_to_string(folder.path().join("dataset.toml")).expect("it was written");
    let kept: Vec<&str> =
        head.lines().filter(|line| !line.contains("plant.q") && *line != "[noise]").collect();
    folder.put("dataset.toml", &(kept.join("\n") + "\n"));
}

/// To half the resolution of 12 s, 0.04 times a second.
const SWINGS: &str = "swinging 1.7";

/// Shape of what has no name.
fn shape(found: &Diagnosis) -> &str {
    assert_eq!(found.verdict, Verdict::Unknown, "{:?}", found.effects);
    found.unknown.as_ref().map_or("", |left| left.shape.as_str())
}

/// The camera shakes by 0.3 px along u, 1.7 times a second.
fn shaken(rows: &mut Vec<Vec<String>>) {
    for row in rows {
        let number = |cell: &String| cell.parse::<f64>().expect("a number");
        let by = 0.3 * (TAU * 1.7 * number(&row[0])).sin();
        for u in [1, 3, 5] {
            row[u] = (number(&row[u]) + by).to_string();
        }
    }
}

#[test]
fn a_camera_that_shakes_is_no_noise_of_its_sensor() {
    let found = changed("shaken", true, shaken);
    assert!(shape(&found).starts_with(SWINGS), "{}", shape(&found));
    assert!(found.effects.iter().all(|effect| effect.name != "camera.sigma"), "{:?}", found.effects);
}

#[test]
fn a_camera_that_shakes_before_unlogged_angles_is_no_torque() {
    let found = changed("shaken-alone", false, shaken);
    assert!(shape(&found).starts_with(SWINGS), "{}", shape(&found));
}

#[test]
fn frames_that_were_repeated_are_told_by_their_number() {
    let repeated = |rows: &mut Vec<Vec<String>>| {
        for row in (40..rows.len()).step_by(60) {
            let before = rows[row - 1][1..].to_vec();
            rows[row].splice(1.., before);
        }
    };
    let found = changed("repeated", true, repeated);
    assert!(
        shape(&found).contains("they show another moment than their timestamp says"),
        "{}",
        shape(&found)
    );
}

#[test]
fn angles_that_a_vision_read_are_blamed_and_no_circle_that_nobody_logged() {
    let folder = recorded("repeated-angles", &[]);
    for run in ["run-01", "run-02"] {
        let file = format!("{run}/camera.csv");
        let text = std::fs::read_to_string(folder.path().join(&file)).expect("it was written");
        let rows = text.lines().enumerate().map(|(row, line)| {
            let cells: Vec<&str> = line.split(',').collect();
            // time, q1_est, q2_est; the last one jumps by 0.05 rad now and then
            let jumps = row % 60 == 40;
            let last = cells[12]
                .parse::<f64>()
                .map_or(cells[12].to_owned(), |q2| (q2 + if jumps { 0.05 } else { 0.0 }).to_string());
            format!("{},{},{last}", cells[0], cells[11])
        });
        folder.put(&file, &(rows.collect::<Vec<_>>().join("\n") + "\n"));
    }
    let found = found(&folder);
    let left = found.unknown.as_ref().expect("frames jump");
    assert_eq!(left.signal, "camera.q2_est", "{}", left.shape);
}
