//! Encoders that read seldom, or in turn: what rows hold is used, and a start state is guessed from rows that hold an angle.

use crate::common;

use diagnosis::diagnose;

/// Ramps as fast as the arm follows, so that friction shows in seconds.
const LIVELY: &str = "[[0, 0], [1, 0], [2.5, 0.3], [4, 0.3], [6, -0.2], [7.5, -0.2], [9, 0.3], [30, 0.3]]";

/// Too steep: the arm falls after 2.2 s.
const FALLEN: &str =
    "[[0, 0], [1, 0], [1.5, 0.4], [3, 0.4], [3.5, -0.2], [5, -0.2], [5.5, 0.4], [7, 0.4], [8, 0], [30, 0]]";

/// The friction found where `keeps` says which angles each row of the encoders (30 a second) holds.
fn friction(
    name: &str,
    (points, set): (&str, (&str, &str)),
    keeps: &dyn Fn(usize) -> [bool; 2],
) -> (String, f64, [f64; 2]) {
    let folder = common::recorded_along(name, points, &[set]);
    for run in ["run-01", "run-02"] {
        std::fs::remove_file(folder.path().join(run).join("camera.csv")).expect("it was recorded");
        let path = folder.path().join(run).join("plant.csv");
        let text = std::fs::read_to_string(&path).expect("it was recorded");
        let mut kept = "time,q1,q2\n".to_owned();
        for (row, line) in text.lines().skip(1).enumerate() {
            let cells: Vec<&str> = line.split(',').collect();
            let [one, two] = keeps(row);
            if one || two {
                let cell = |place: usize, keep: bool| if keep { cells[place] } else { "" };
                kept += &format!("{},{},{}\n", cells[0], cell(1, one), cell(2, two));
            }
        }
        std::fs::write(&path, kept).expect("it can be written");
    }
    let found = diagnose(folder.path(), &common::units(), &common::options(), &mut |_| {});
    let found = found.expect("the data is good");
    assert_eq!(found.effects.len(), 1, "{:?} {:?}", found.effects, found.unknown);
    assert!(found.unknown.is_none(), "{:?}", found.unknown);
    (found.effects[0].name.clone(), found.effects[0].value, found.effects[0].ci95)
}

fn is_found(name: &str, keeps: &dyn Fn(usize) -> [bool; 2]) {
    let (effect, value, [low, high]) = friction(name, (LIVELY, ("plant.b_joint", "0.02")), keeps);
    assert_eq!(effect, "plant.b_joint");
    // three standard errors, and these no more than a tenth of the value
    let error = (high - low) / (2.0 * 1.96);
    assert!((value - 0.02).abs() < 3.0 * error && error < 0.002, "{value} of {low} to {high}");
}

#[test]
fn recovers_friction_from_encoders_that_are_logged_in_turn() {
    is_found("turns", &|row| [row % 2 == 0, row % 2 == 1]);
}

#[test]
fn recovers_friction_from_ten_rows_a_second() {
    is_found("ten", &|row| [row % 3 == 0; 2]);
}

#[test]
fn recovers_friction_where_one_angle_is_logged_less_often() {
    is_found("rates", &|row| [true, row % 3 == 0]);
}

#[test]
fn recovers_friction_from_two_falls() {
    // 60 rows each, of which the nominal model leaves most windows
    for (set, value) in [(("plant.b_joint", "0.02"), 0.02), (("plant.fc_joint", "0.05"), 0.05)] {
        let (effect, found, [low, high]) = friction("falls", (FALLEN, set), &|_| [true; 2]);
        assert_eq!(effect, set.0);
        // a fiftieth: some three standard errors
        assert!((found / value - 1.0).abs() < 0.02 && low < high, "{found} of {low} to {high}");
    }
}
