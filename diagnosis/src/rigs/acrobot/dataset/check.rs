//! Checks of one run after its files were read: length, units, what the rows are good for.

use super::angles::{far_apart, glitches, unwrapped};
use super::images::{self, tells_poses};
use super::impossible_cells;
use super::row_times::typical_gap;
use super::timestamps::{self, Moved};
use super::{Nominal, Run, Table};
use super::{held_over, quantised, rates, rounded, still, uncovered};
use crate::error::Notice;
use crate::rigs::acrobot::channels::{CHANNELS, Channel, File, Measures};
use crate::rigs::acrobot::dataset::policy::LOGS;
use crate::rigs::acrobot::policy::POLICY;
use crate::text::brief;

/// Takes out what is no measurement, whatever the logs mean by it.
pub fn clean(run: &mut Run, nominal: &Nominal, notices: &mut Vec<Notice>) {
    mask_invalid(run);
    for (angle, falling) in ["q1", "q2"].into_iter().zip(nominal.falling) {
        let Some(plant) = &mut run.plant else { continue };
        let time = plant.time.clone();
        let found = plant.column_mut(angle).and_then(|values| glitches(&time, values, falling));
        let Some((row, found)) = found else { continue };
        let message = format!(
            "{angle} jumps by {:.1e} rad and back ({} such rows, this is the first): taken as not measured",
            found.0, found.1
        );
        let file = format!("{}/plant.csv", run.name);
        notices.push(Notice { file, line: plant.line[row], message });
    }
    still::exclude(run, notices);
    held_over::exclude(run, notices);
    impossible_cells::exclude(run, nominal, notices);
    rounded::unround(run, notices);
    quantised::tell(run, notices);
}

/// Excludes what can't be used. `falling` are the rates (rad/s) that gravity gives each link of the nominal model. Answers which
/// clock is known from the motion alone.
pub fn exclude(run: &mut Run, falling: [f64; 2], notices: &mut Vec<Notice>) -> Option<Moved> {
    let commanded = run.controller.is_some();
    exclude_tables(run, notices);
    let moved = timestamps::joined(run, notices);
    check_torque(run, notices);
    if let Some(plant) = &run.plant {
        let file = format!("{}/plant.csv", run.name);
        if let Some((line, message)) = unusable_plant(plant, falling) {
            notices.push(Notice { file, line, message });
            run.plant = None;
        } else if run.controller.is_none() {
            find_torque(run, commanded, notices);
        }
    }
    unwrap_angles(run, notices);
    rates::exclude(run, notices);
    images::exclude(run, notices);
    uncovered::tell(run, notices);
    moved
}

/// Excludes tables that can't be used whatever they hold.
fn exclude_tables(run: &mut Run, notices: &mut Vec<Notice>) {
    for (table, file, fewest) in [
        (&mut run.camera, "camera.csv", POLICY.rows),
        (&mut run.controller, "controller.csv", LOGS.fewest_torques),
        (&mut run.plant, "plant.csv", POLICY.rows),
    ] {
        if let Some((line, why)) = table.as_ref().and_then(|table| unusable(table, fewest)) {
            let message = format!("{why}; file excluded");
            notices.push(Notice { file: format!("{}/{file}", run.name), line, message });
            *table = None;
        }
    }
}

/// Excludes a log of torques in which none of the joint is known. Where link 1 alone is driven, the joint's is 0.
fn check_torque(run: &mut Run, notices: &mut Vec<Notice>) {
    let Some(controller) = &mut run.controller else { return };
    let mut notice = |message: &str| {
        let file = format!("{}/controller.csv", run.name);
        notices.push(Notice { file, line: 1, message: message.to_owned() });
    };
    match controller.column("tau") {
        None if controller.column("tau_1").is_some() => {
            notice("column `tau` is missing: link 1 is driven by tau_1 alone, the joint is free");
            controller.push("tau", 0.0);
        }
        None => {
            notice("column `tau` is missing; the plant can't be driven, file excluded");
            run.controller = None;
        }
        Some(tau) if tau.iter().all(|torque| torque.is_nan()) => {
            notice("column `tau` holds no number; the plant can't be driven, file excluded");
            run.controller = None;
        }
        Some(_) => {}
    }
}

/// Tells of runs whose torque has one value in all rows, where that of others changes: a motor that nobody drove, or a column that was not
/// recorded. Which one, nobody but the lab knows. Where link 1 is driven, the joint may well be free.
pub fn tell_constant_torques(runs: &[Run], notices: &mut Vec<Notice>) {
    let constant = |run: &Run| {
        let log = run.controller.as_ref().filter(|log| log.column("tau_1").is_none())?;
        let tau: Vec<f64> = log.column("tau")?.iter().copied().filter(|tau| tau.is_finite()).collect();
        let first = *tau.first()?;
        Some((tau.iter().all(|own| *own == first), first, tau.len()))
    };
    let Some(other) = runs.iter().find(|run| constant(run).is_some_and(|(constant, ..)| !constant)) else {
        return;
    };
    for run in runs {
        let Some((true, torque, rows)) = constant(run).filter(|(.., rows)| *rows >= POLICY.rows) else {
            continue;
        };
        let message = format!(
            "tau is {} N·m in all {rows} rows, while it changes in {}: if the motor was driven in this run, too, the column was not recorded",
            brief(torque),
            other.name
        );
        notices.push(Notice { file: format!("{}/controller.csv", run.name), line: 0, message });
    }
}

/// Why a plant's log can't be used, and in which line that shows.
fn unusable_plant(plant: &Table, falling: [f64; 2]) -> Option<(usize, String)> {
    if let Some(name) = ["q1", "q2"].iter().find(|name| plant.column(name).is_none()) {
        return Some((1, format!("column `{name}` is missing; the plant's log is excluded")));
    }
    if let Some(name) = ["q1", "q2"].iter().find(|name| measured(plant, name) < POLICY.rows) {
        let message = format!(
            "`{name}` is measured in {} rows ({} or more are needed); file excluded",
            measured(plant, name),
            POLICY.rows
        );
        return Some((1, message));
    }
    let apart = far_apart(plant, falling)?;
    let message = format!(
        "rows are {} s apart, and the arm loses its balance in between; time is in seconds (are these milliseconds?); \
         file excluded",
        brief(apart)
    );
    Some((plant.line[0], message))
}

/// Looks elsewhere for the torque of a plant's log that has no usable command beside it. Without any, rows that are far apart are put
/// aside, if images tell poses.
fn find_torque(run: &mut Run, commanded: bool, notices: &mut Vec<Notice>) {
    let file = format!("{}/plant.csv", run.name);
    let apart = run.plant.as_ref().and_then(typical_gap).filter(|apart| *apart > LOGS.torn);
    let message = without_torque(run, commanded);
    notices.push(Notice { file: file.clone(), line: 0, message });
    let posed = run.controller.is_none() && run.camera.as_ref().is_some_and(tells_poses);
    if let Some(apart) = apart.filter(|_| posed) {
        let message = format!(
            "rows are {apart:.3} s apart, and without a torque nothing tells the motion in between ({} s or less \
             are needed); file excluded, poses are read off the image",
            LOGS.torn
        );
        notices.push(Notice { file, line: 0, message });
        run.plant = None;
    }
}

/// Takes whole turns out of angles that were wrapped.
fn unwrap_angles(run: &mut Run, notices: &mut Vec<Notice>) {
    let Some(plant) = &mut run.plant else { return };
    for name in ["q1", "q2"] {
        if let Some((row, turns)) = plant.column_mut(name).and_then(|values| unwrapped(values)) {
            let message = format!(
                "{name} jumps by a whole turn ({turns} such rows, this is the first): taken as an angle that was \
                 wrapped, and unwrapped"
            );
            notices.push(Notice { file: format!("{}/plant.csv", run.name), line: plant.line[row], message });
        }
    }
}

/// Why a table can't be used whatever it holds, and in which line that shows.
fn unusable(table: &Table, fewest: usize) -> Option<(usize, String)> {
    if table.len() < fewest {
        return Some((0, format!("{} rows are too few ({fewest} or more are needed)", table.len())));
    }
    let row = table.time.iter().position(|time| time.abs() > LOGS.latest)?;
    let why = format!("time = {:e} is no time in s (are these milliseconds, or less?)", table.time[row]);
    Some((table.line[row], why))
}

/// How many rows hold a number.
fn measured(table: &Table, name: &str) -> usize {
    table.column(name).unwrap_or(&[]).iter().filter(|value| value.is_finite()).count()
}

/// A torque for a run without a command: the one measured at the joint, or none at all for an arm that swings. Where there
/// was a command (`commanded`) that can't be used, the arm did not swing freely.
fn without_torque(run: &mut Run, commanded: bool) -> String {
    let Some(plant) = &mut run.plant else { return String::new() };
    if let Some(applied) = plant.column("tau_applied").map(<[f64]>::to_vec) {
        let rows: Vec<usize> = (0..plant.len()).filter(|row| applied[*row].is_finite()).collect();
        let pick = |values: &[f64]| rows.iter().map(|row| values[*row]).collect::<Vec<f64>>();
        let tau = vec![("tau".to_owned(), pick(&applied))];
        let line = rows.iter().map(|row| plant.line[*row]).collect();
        run.controller = (!rows.is_empty()).then(|| {
            let mut log = Table::new(pick(&plant.time), tau);
            log.line = line;
            log
        });
        plant.remove("tau_applied");
        return "no usable controller.csv beside it: tau_applied is taken as the command, so nothing of the actuator can be \
                told"
            .into();
    }
    let below = plant.column("q1").map_or(0.0, |q1| {
        let rows: Vec<f64> = q1.iter().copied().filter(|angle| angle.is_finite()).collect();
        let below = rows.iter().filter(|angle| libm::cos(**angle) < 0.0).count();
        below as f64 / rows.len().max(1) as f64
    });
    if below >= LOGS.below && !commanded {
        run.controller = Some(Table::new(vec![plant.time[0]], vec![("tau".to_owned(), vec![0.0])]));
        return "no controller.csv beside it and the arm isn't held up: taken as a free swing, without torque".into();
    }
    let seen = match run.camera {
        Some(_) => {
            "only the image can be judged, and a clock of this log that is off would pass for the camera's delay"
        }
        None => "the run says nothing",
    };
    if commanded {
        return format!("no usable controller.csv beside it; {seen}");
    }
    format!(
        "no controller.csv beside it, and link 1 stays above the horizontal, so that something holds it: without its torque \
         {seen} (angles are counted from the upright: does this arm hang?)"
    )
}

/// docs/data-set.md: in a row with `valid` = 0 the centroids, empty or held, are not measured.
fn mask_invalid(run: &mut Run) {
    let Some(camera) = run.camera.as_mut() else { return };
    let Some(valid) = camera.column("valid").map(<[f64]>::to_vec) else { return };
    let masked = |channel: &&Channel| channel.file == File::Camera && channel.measures != Measures::Frame;
    for channel in CHANNELS.iter().filter(masked) {
        if let Some(values) = camera.column_mut(channel.column) {
            for (value, valid) in values.iter_mut().zip(&valid) {
                if *valid == 0.0 {
                    *value = f64::NAN;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_measured_torque_keeps_the_line_it_stands_on() {
        let plant = Table::new(
            vec![0.0, 0.1, 0.2, 0.3],
            vec![("q1".into(), vec![0.0; 4]), ("tau_applied".into(), vec![f64::NAN, 0.1, f64::NAN, 0.3])],
        );
        let mut run = Run { name: String::new(), camera: None, controller: None, plant: Some(plant) };
        without_torque(&mut run, false);
        let torque = run.controller.map(|log| (log.time, log.line));
        assert_eq!(torque, Some((vec![0.1, 0.3], vec![3, 5])));
    }

    #[test]
    fn every_torque_of_one_value_is_told_where_others_change() {
        let run = |name: &str, tau: &dyn Fn(usize) -> f64, rows: usize| Run {
            name: name.into(),
            camera: None,
            controller: Some(Table::new(
                (0..rows).map(|row| row as f64).collect(),
                vec![("tau".into(), (0..rows).map(tau).collect())],
            )),
            plant: None,
        };
        let told = |runs: &[Run]| {
            let mut notices = Vec::new();
            tell_constant_torques(runs, &mut notices);
            notices.into_iter().map(|notice| (notice.file, notice.message)).collect::<Vec<_>>()
        };
        let (still, driven) = (run("run-01", &|_| 0.0, 300), run("run-02", &|row| row as f64, 300));
        let both = told(&[still.clone(), driven.clone()]);
        assert_eq!(both.len(), 1);
        assert_eq!(both[0].0, "run-01/controller.csv");
        assert!(
            both[0].1.starts_with("tau is 0 N·m in all 300 rows, while it changes in run-02"),
            "{both:?}"
        );
        // link 1 is driven, an arm that nobody drives at all, and two rows
        let mut pinned = still.clone();
        pinned.controller.iter_mut().for_each(|log| log.push("tau_1", 0.3));
        let quiet = [[pinned, driven.clone()], [still.clone(), still], [run("run-03", &|_| 0.0, 2), driven]];
        assert!(quiet.iter().all(|runs| told(runs).is_empty()));
    }
}
