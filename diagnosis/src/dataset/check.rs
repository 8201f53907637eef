//! Checks of one run after its files were read: length, units, what the rows are good for.

use super::{Run, Table};
use crate::error::Notice;

/// A log with fewer rows says nothing after four start values were fitted.
const FEWEST_ROWS: usize = 12;
/// Six turns: a free pendulum hardly gets there in radians, and 38 degrees is little motion.
const LARGEST_ANGLE: f64 = 12.0 * std::f64::consts::PI;
/// Degrees are 57 times radians; halfway on a logarithmic scale.
const DEGREE_RATIO: f64 = 7.6;
/// Motion below this (rad) can't tell degrees from radians.
const LEAST_MOTION: f64 = 0.02;

/// Puts aside what can't be used.
pub fn run(run: &mut Run, notices: &mut Vec<Notice>) {
    for (table, file) in [
        (&mut run.camera, "camera.csv"),
        (&mut run.controller, "controller.csv"),
        (&mut run.plant, "plant.csv"),
    ] {
        if let Some(rows) = table.as_ref().map(Table::len).filter(|rows| *rows < FEWEST_ROWS) {
            notices.push(Notice {
                file: format!("{}/{file}", run.name),
                line: 0,
                message: format!(
                    "{rows} rows are too few ({FEWEST_ROWS} or more are needed); file put aside"
                ),
            });
            *table = None;
        }
    }
    mask_invalid(run);
    let name = run.name.clone();
    let file = |file: &str| format!("{name}/{file}");
    if let Some(camera) = &run.camera {
        let centroids = ["u1", "v1", "u2", "v2", "u3", "v3"];
        if let Some(missing) = centroids.iter().find(|name| camera.column(name).is_none()) {
            let message = format!("column `{missing}` is missing; the camera's log is put aside");
            notices.push(Notice { file: file("camera.csv"), line: 1, message });
            run.camera = None;
        }
    }
    if let Some(controller) = &run.controller
        && controller.column("tau").is_none()
    {
        let message = "column `tau` is missing; the plant can't be driven, file put aside".to_owned();
        notices.push(Notice { file: file("controller.csv"), line: 1, message });
        run.controller = None;
    }
    if let Some(plant) = &run.plant {
        let missing = ["q1", "q2"].iter().find(|name| plant.column(name).is_none());
        let degrees = in_degrees(plant, run.camera.as_ref());
        if let Some(name) = missing {
            let message = format!("column `{name}` is missing; the plant's log is put aside");
            notices.push(Notice { file: file("plant.csv"), line: 1, message });
            run.plant = None;
        } else if let Some((line, message)) = degrees {
            notices.push(Notice { file: file("plant.csv"), line, message });
            run.plant = None;
        } else if run.controller.is_none() {
            let message = without_torque(run);
            notices.push(Notice { file: file("plant.csv"), line: 0, message });
        }
    }
}

/// A torque for a run without a command: the one measured at the joint, or none at all for an arm that hangs and swings.
fn without_torque(run: &mut Run) -> String {
    let Some(plant) = &mut run.plant else { return String::new() };
    if let Some(applied) = plant.column("tau_applied").map(<[f64]>::to_vec) {
        let rows: Vec<usize> = (0..plant.len()).filter(|row| applied[*row].is_finite()).collect();
        let pick = |values: &[f64]| rows.iter().map(|row| values[*row]).collect::<Vec<f64>>();
        let tau = vec![("tau".to_owned(), pick(&applied))];
        run.controller = (!rows.is_empty()).then(|| Table::new(pick(&plant.time), tau));
        plant.remove("tau_applied");
        return "no usable controller.csv beside it: tau_applied is taken as the command, so nothing of the actuator can be \
                told"
            .into();
    }
    let hanging = plant.column("q1").is_some_and(|q1| {
        q1.iter().filter(|angle| angle.is_finite()).map(|angle| libm::cos(*angle)).sum::<f64>() < 0.0
    });
    if hanging {
        run.controller = Some(Table::new(vec![plant.time[0]], vec![("tau".to_owned(), vec![0.0])]));
        return "no controller.csv beside it and the arm hangs: taken as a free swing, without torque".into();
    }
    "no usable controller.csv beside it; only the picture can be judged".into()
}

/// CONTRACT: in a row with `valid` = 0 the centroids, empty or held, are not measured.
fn mask_invalid(run: &mut Run) {
    let Some(camera) = run.camera.as_mut() else { return };
    let Some(valid) = camera.column("valid").map(<[f64]>::to_vec) else { return };
    for name in super::CAMERA_COLUMNS.iter().filter(|name| !matches!(**name, "valid" | "frame")) {
        if let Some(values) = camera.column_mut(name) {
            for (value, valid) in values.iter_mut().zip(&valid) {
                if *valid == 0.0 {
                    *value = f64::NAN;
                }
            }
        }
    }
}

/// Angles in degrees show by their range, by rates that don't fit, or by the picture.
fn in_degrees(plant: &Table, camera: Option<&Table>) -> Option<(usize, String)> {
    for name in ["q1", "q2"] {
        let values = plant.column(name)?;
        if let Some(row) = values.iter().position(|value| value.abs() > LARGEST_ANGLE) {
            let value = values[row];
            let message = format!(
                "{name} = {value} rad is {:.1} turns; angles are in radians (are these degrees?); file put aside",
                value.abs() / std::f64::consts::TAU
            );
            return Some((plant.line[row], message));
        }
    }
    let camera = camera?;
    let pairs = [("q1", "u1", "v1", "u2", "v2"), ("q2", "u2", "v2", "u3", "v3")];
    for (name, ua, va, ub, vb) in pairs {
        let seen: Vec<f64> = (0..camera.len())
            .filter_map(|row| {
                let cell = |column| Some(camera.column(column)?[row]);
                let angle = libm::atan2(cell(ub)? - cell(ua)?, cell(vb)? - cell(va)?);
                angle.is_finite().then_some(angle)
            })
            .collect();
        let logged = plant.column(name)?;
        let ratio = spread(logged) / spread(&seen);
        if spread(&seen) > LEAST_MOTION && ratio > DEGREE_RATIO {
            let message = format!(
                "{name} moves {ratio:.0} times as far as the picture shows (are these degrees?); file put aside"
            );
            return Some((plant.line[0], message));
        }
    }
    None
}

fn spread(values: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    if sorted.is_empty() {
        return 0.0;
    }
    let at = |share: f64| sorted[((sorted.len() - 1) as f64 * share) as usize];
    at(0.95) - at(0.05)
}
