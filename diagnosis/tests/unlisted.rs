//! Laws of a torque, or of what an encoder reads, that nobody lists and that listed effects nearly stand for: told with states linked from
//! row to row.

use crate::common::{Folder, found, recorded_along};
use diagnosis::{Diagnosis, Verdict};
use std::path::Path;

/// The cells of a log.
fn rows(path: &Path) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(path).expect("it was recorded");
    let cells = |line: &str| line.split(',').map(|cell| cell.parse().expect("a number")).collect();
    text.lines().skip(1).map(cells).collect()
}

/// A column of a log between its rows.
fn between(rows: &[Vec<f64>], time: f64, column: usize) -> f64 {
    let after = rows.partition_point(|row| row[0] <= time).clamp(1, rows.len() - 1);
    let (a, b) = (&rows[after - 1], &rows[after]);
    a[column] + (b[column] - a[column]) * (time - a[0]) / (b[0] - a[0])
}

/// Two runs in which what was commanded, or what the encoder of q2 reads, is changed by a law of row time, torque and both angles.
fn changed(name: &str, file: &str, by: impl Fn(f64, [f64; 2]) -> f64) -> Folder {
    // to and fro, as fast as the arm follows
    let points = "[[0, 0], [2, 0.15], [4, -0.15], [6, 0.2], [8, -0.1], [10, 0.15], [12, 0]]";
    let folder = recorded_along(name, points, &[]);
    for run in ["run-01", "run-02"] {
        let (plant, controller) =
            (folder.path().join(run).join("plant.csv"), folder.path().join(run).join("controller.csv"));
        let (angles, torque) = (rows(&plant), rows(&controller));
        let held = |time: f64| torque[torque.partition_point(|row| row[0] < time).saturating_sub(1)][1];
        let (own, column, head) = match file {
            "plant.csv" => (&angles, 2, "time,q1,q2"),
            _ => (&torque, 1, "time,tau"),
        };
        let mut text = format!("{head}\n");
        for row in own {
            let mut row = row.clone();
            let angle = |column| between(&angles, row[0], column);
            row[column] += by(held(row[0]), [angle(1), angle(2)]);
            text += &(row.iter().map(f64::to_string).collect::<Vec<_>>().join(",") + "\n");
        }
        folder.put(&format!("{run}/{file}"), &text);
    }
    folder
}

/// Signal and form of what has no name.
fn unnamed(found: &Diagnosis) -> (String, String) {
    let left = found.unknown.clone().unwrap_or_default();
    (left.signal, left.shape)
}

#[test]
fn law_a_cable_at_the_joint_is_told_where_a_gain_and_a_bias_stand_for_it() {
    // the machine has a spring of 0.006 N·m/rad about 0.3 rad that the log's torque doesn't count
    let folder = changed("cable", "controller.csv", |_, [q1, q2]| 0.006 * (q2 - q1 - 0.3));
    let found = found(&folder);
    is_a_spring_at_the_joint(&found);
}

#[test]
fn law_a_cable_at_the_joint_is_told_by_images_alone() {
    let folder = changed("cable-seen", "controller.csv", |_, [q1, q2]| 0.008 * (q2 - q1 - 0.3));
    for run in ["run-01", "run-02"] {
        std::fs::remove_file(folder.path().join(run).join("plant.csv")).expect("it was recorded");
    }
    is_a_spring_at_the_joint(&found(&folder));
}

fn is_a_spring_at_the_joint(found: &Diagnosis) {
    assert_eq!(found.verdict, Verdict::Unknown, "{:?}", found.effects);
    let (signal, shape) = unnamed(found);
    assert_eq!(signal, "plant torque at the joint", "{shape}");
    assert!(shape.contains("like a spring"), "{shape}");
}

#[test]
fn law_a_shaft_that_bends_is_told_by_the_reading_of_its_encoder() {
    let folder = changed("shaft", "plant.csv", |torque, _| 0.0007 * torque);
    let found = found(&folder);
    assert_eq!(found.verdict, Verdict::Unknown);
    let (signal, shape) = unnamed(&found);
    assert_eq!(signal, "plant.q2");
    assert!(shape.starts_with("with the commanded torque: something bends"), "{shape}");
}
