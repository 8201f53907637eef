//! What a log of images is good for: any of the camera's outputs beside a measured motion; without one, what tells a pose.

use super::angles::{as_far, degrees};
use super::{Run, Table};
use crate::error::Notice;
use crate::rigs::acrobot::channels::{CHANNELS, Channel, File, Measures, measuring};
use crate::rigs::acrobot::dataset::policy::LOGS;
use crate::statistics::median::median;

/// Circles 2 and 3 tell a pose: where circle 1 is then, the angles say.
const JOINT_AND_TIP: [&str; 4] = ["u2", "v2", "u3", "v3"];

/// Angles that the rig's own vision read tell one, too.
fn vision_angles() -> Vec<&'static str> {
    measuring(File::Camera, Measures::VisionAngle)
}

/// All that is compared of an image.
fn compared() -> impl Iterator<Item = &'static str> {
    let own = |channel: &&Channel| channel.file == File::Camera && channel.noise.is_some();
    CHANNELS.iter().filter(own).map(|channel| channel.column)
}

/// Tells what a log lacks, and excludes what says nothing beside the run's other logs.
pub(super) fn exclude(run: &mut Run, notices: &mut Vec<Notice>) {
    let file = format!("{}/camera.csv", run.name);
    let Some(camera) = &mut run.camera else { return };
    if let Some((row, count)) = taken_for_another(camera) {
        let message = format!(
            "circle 1 is more than {:.0} px off the line that it rolls on, and another is on it ({count} such rows, this is the first): \
             taken as not measured",
            LOGS.off_line
        );
        notices.push(Notice { file: file.clone(), line: camera.line[row], message });
    }
    let (line, message) = (1, lacking(camera, run.plant.is_some(), run.controller.is_some()));
    let Some((usable, message)) = message else { return };
    notices.push(Notice { file, line, message });
    if !usable {
        run.camera = None;
    }
}

/// Makes rows not measured in which another circle was taken for circle 1: the first of them, and how many there are. A tip that
/// left the image and comes back confuses a vision that follows circles from frame to frame.
fn taken_for_another(camera: &mut Table) -> Option<(usize, usize)> {
    let heights = ["v1", "v2", "v3"].map(|name| camera.column(name).map(<[f64]>::to_vec));
    let [Some(first), Some(second), Some(third)] = heights else { return None };
    // before anything is confused: it stays so, where the arm then lies
    let line = median(first.iter().copied().filter(|height| height.is_finite()).take(LOGS.first))?;
    let on_line = |height: f64| (height - line).abs() < LOGS.on_line;
    let wrong = |row: &usize| {
        (first[*row] - line).abs() > LOGS.off_line && (on_line(second[*row]) || on_line(third[*row]))
    };
    let rows: Vec<usize> = (0..camera.len()).filter(wrong).collect();
    for name in compared() {
        if let Some(values) = camera.column_mut(name) {
            rows.iter().for_each(|row| values[*row] = f64::NAN);
        }
    }
    rows.first().map(|row| (*row, rows.len()))
}

/// Whether a pose can be read off a log's images.
pub(super) fn tells_poses(camera: &Table) -> bool {
    holds(camera, &JOINT_AND_TIP) || holds(camera, &vision_angles())
}

/// Times of the frames of a log, s, in none of which the camera found its circles.
pub(super) fn sees_nothing(run: &Run) -> Option<Vec<f64>> {
    let camera = run.camera.as_ref().filter(|camera| !camera.is_empty())?;
    let valid = camera.column("valid")?;
    valid.iter().all(|valid| *valid == 0.0).then(|| camera.time.clone())
}

/// Whether the log is usable beside others, and what it lacks, if anything.
fn lacking(camera: &Table, motion: bool, torque: bool) -> Option<(bool, String)> {
    let centroids = measuring(File::Camera, Measures::Centroid);
    let missing: Vec<&str> = centroids.into_iter().filter(|name| !holds(camera, &[name])).collect();
    if missing.is_empty() {
        return None;
    }
    if camera.column("valid").is_some_and(|valid| valid.iter().all(|valid| *valid == 0.0)) {
        let message =
            "the camera found its circles in no frame (`valid` = 0 in all rows): its log is excluded";
        return Some((false, message.into()));
    }
    let aside = |why: &str| Some((false, format!("{}; the camera's log is excluded", lack(&missing, why))));
    let circles = holds(camera, &JOINT_AND_TIP);
    if !motion && !tells_poses(camera) {
        return aside("without encoders, circles 2 and 3 or q1_est and q2_est must tell the pose");
    }
    if !motion && !torque && !circles {
        return aside("q1_est and q2_est alone have nothing that they could be compared with");
    }
    if !circles && holds(camera, &vision_angles()) {
        return Some((true, lack(&missing, "q1_est and q2_est are compared")));
    }
    if compared().all(|name| !holds(camera, &[name])) {
        return aside("no centroid, area or angle is measured");
    }
    Some((true, lack(&missing, "compared without")))
}

fn lack(missing: &[&str], why: &str) -> String {
    let names: Vec<String> = missing.iter().map(|name| format!("`{name}`")).collect();
    match names.len() {
        1 => format!("column {} is missing: {why}", names[0]),
        _ => format!("columns {} are missing: {why}", names.join(", ")),
    }
}

/// Whether all columns are there, with numbers.
fn holds(table: &Table, names: &[&str]) -> bool {
    let measured =
        |name: &&str| table.column(name).is_some_and(|values| values.iter().any(|x| x.is_finite()));
    names.iter().all(measured)
}

/// Angles that the vision gave in degrees show by their speed, or beside encoders.
pub fn angle_in_degrees(
    camera: &Table,
    plant: Option<&Table>,
    place: usize,
    falling: f64,
) -> Option<(usize, String)> {
    let (name, logged) = (*vision_angles().get(place)?, *measuring(File::Plant, Measures::Angle).get(place)?);
    if let Some((row, message)) = degrees(camera, name, falling) {
        return Some((camera.line[row], message));
    }
    let times = as_far(camera.column(name)?, plant?.column(logged)?)?;
    let message =
        format!("{name} moves {times:.0} times as far as {logged} in plant.csv (are these degrees?)");
    Some((camera.line[0], message))
}
