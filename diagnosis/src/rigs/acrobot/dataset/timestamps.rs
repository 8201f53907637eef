//! Logs of a run whose timestamps have nothing to do with each other: an epoch here, a stopwatch there.
//!
//! Encoders and images show the same motion. Where their timestamps disagree by more than any camera is late, the shift at which both
//! motions agree sets them to one time, to some milliseconds; what is left is a matter of the residuals.

use super::angles::unwrapped;
use super::{Run, Table};
use crate::error::Notice;
use crate::rigs::acrobot::dataset::policy::LOGS;
use crate::rigs::acrobot::policy::POLICY;
use crate::statistics::levels::SMALL;

/// What was set right by the motion, and is known by it alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Moved {
    /// The plant's log: a torque that is stamped as images are can still tell.
    Angles,
    /// The images.
    Frames,
}

/// Sets the logs of a run to one time, or puts aside what has none in common with the others.
pub fn joined(run: &mut Run, notices: &mut Vec<Notice>) -> Option<Moved> {
    let moved = frames(run, notices);
    let others = [("plant.csv", &run.plant), ("camera.csv", &run.camera)];
    let other = others.into_iter().find_map(|(file, log)| log.as_ref().map(|log| (file, span(log))));
    if let (Some(torque), Some((file, (from, to)))) = (&run.controller, other) {
        let (first, last) = span(torque);
        if torque.len() >= POLICY.rows && (last < from || first > to) {
            let message = format!(
                "time runs from {first} to {last} s, in {file} from {from} to {to} s: are they of another clock? Nothing shows \
                 by how much it is off; file excluded"
            );
            notices.push(Notice { file: format!("{}/controller.csv", run.name), line: 0, message });
            run.controller = None;
        }
    }
    moved
}

/// Corrects the timestamps of images and encoders that are off against each other, by the motion that both show; where no shift makes them
/// agree, puts one log aside.
fn frames(run: &mut Run, notices: &mut Vec<Notice>) -> Option<Moved> {
    let (plant, camera) = (run.plant.as_ref()?, run.camera.as_ref()?);
    if plant.is_empty() || camera.is_empty() {
        return None;
    }
    let (logged, seen) = (span(plant), span(camera));
    let apart = logged.1 < seen.0 - LOGS.late.1 || logged.0 > seen.1 - LOGS.late.0;
    // a torque goes with the log that it began and ended with
    let torque = run.controller.as_ref().filter(|log| log.len() >= POLICY.rows).map(span);
    let beside = |log: (f64, f64), torque: (f64, f64)| (log.0 - torque.0).abs() + (log.1 - torque.1).abs();
    let keeps_plant = torque.is_some_and(|torque| beside(logged, torque) < beside(seen, torque));
    let file = if keeps_plant { "camera.csv" } else { "plant.csv" };
    let mut tell = |message| notices.push(Notice { file: format!("{}/{file}", run.name), line: 0, message });
    let Some(late) = shift(plant, camera, apart) else {
        if apart {
            tell(format!(
                "timestamps of images run from {} to {} s, of angles from {} to {} s, and their motions agree at no shift in between: two clocks, \
                 or two runs? File excluded",
                seen.0, seen.1, logged.0, logged.1
            ));
            *(if keeps_plant { &mut run.camera } else { &mut run.plant }) = None;
        }
        return None;
    };
    if late == 0.0 {
        return None;
    }
    let (by, log) = if keeps_plant { (late, &mut run.camera) } else { (-late, &mut run.plant) };
    tell(format!(
        "timestamps are {:.2} s {} against {}: corrected by the motion that both show",
        by.abs(),
        if by > 0.0 { "late" } else { "early" },
        if keeps_plant { "plant.csv" } else { "camera.csv" }
    ));
    log.iter_mut().flat_map(|log| &mut log.time).for_each(|time| *time -= by);
    // without a torque there is no third clock, and it is the same which one is moved
    Some(if keeps_plant || torque.is_none() { Moved::Frames } else { Moved::Angles })
}

/// First and last time of a log, s.
fn span(log: &Table) -> (f64, f64) {
    let end = |time: Option<&f64>| time.copied().unwrap_or(f64::NAN);
    (end(log.time.first()), end(log.time.last()))
}

/// By how much images are stamped late, s: 0 where timestamps agree as they are or motions are too small to tell, `None` where
/// nothing agrees.
fn shift(plant: &Table, camera: &Table, apart: bool) -> Option<f64> {
    let seen = directions(camera);
    let logged = rows_with_both(plant, ["q1", "q2"]);
    if seen.is_empty() || logged.is_empty() {
        return Some(0.0);
    }
    let thin: Vec<_> = seen.iter().step_by(seen.len().div_ceil(LOGS.stamps_rows).max(1)).copied().collect();
    let least = |from: f64, to: f64, step: f64, rows: &[(f64, [f64; 2])]| {
        let tries = (0..=((to - from) / step) as usize).map(|place| from + place as f64 * step);
        tries.map(|late| (left(&logged, rows, late), late)).min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let now = least(LOGS.late.0, LOGS.late.1, LOGS.step, &thin)?.0;
    if now < LOGS.agrees {
        return Some(0.0);
    }
    let (from, to) = (camera.time[0] - span(plant).1, span(camera).1 - plant.time[0]);
    if to - from > LOGS.longest {
        return (!apart).then_some(0.0);
    }
    let best = least(from, to, LOGS.step, &thin)?;
    let near = 10.0 * LOGS.step;
    let others = [least(from, best.1 - near, LOGS.step, &thin), least(best.1 + near, to, LOGS.step, &thin)];
    let second = others.into_iter().flatten().fold(now, |second, other| second.min(other.0));
    let clear = best.0 < LOGS.agrees && best.0 * LOGS.clearly < second;
    let step = SMALL * LOGS.step;
    let (_, fine) = least(best.1 - LOGS.step, best.1 + LOGS.step, step, &seen)?;
    let bottom = [-step, 0.0, step].map(|by| left(&logged, &seen, fine + by).powi(2));
    // of the parabola through three points
    let bend = bottom[0] - 2.0 * bottom[1] + bottom[2];
    let by = if bend > 0.0 { 0.5 * step * (bottom[0] - bottom[2]) / bend } else { 0.0 };
    if clear { Some(fine + by.clamp(-step, step)) } else { (!apart).then_some(0.0) }
}

/// Times, and directions of the links as an image shows them, but for a mount that turns all of them, rad.
pub fn directions(camera: &Table) -> Vec<(f64, [f64; 2])> {
    let cell = |column: &str, row: usize| camera.column(column).map_or(f64::NAN, |values| values[row]);
    let link = |row: usize, [ua, va, ub, vb]: [&str; 4]| {
        libm::atan2(cell(ub, row) - cell(ua, row), cell(vb, row) - cell(va, row))
    };
    let links = [["u1", "v1", "u2", "v2"], ["u2", "v2", "u3", "v3"]];
    let seen = rows(camera, links.map(|names| (0..camera.len()).map(|row| link(row, names)).collect()));
    if seen.is_empty() { rows_with_both(camera, ["q1_est", "q2_est"]) } else { seen }
}

/// Times, s, and angles, rad, of the rows that hold both of two columns.
fn rows_with_both(log: &Table, names: [&str; 2]) -> Vec<(f64, [f64; 2])> {
    rows(log, names.map(|name| log.column(name).map_or_else(|| vec![f64::NAN; log.len()], <[f64]>::to_vec)))
}

/// Times, s, and angles, rad, of the rows in which both are finite, unwrapped.
fn rows(log: &Table, mut pair: [Vec<f64>; 2]) -> Vec<(f64, [f64; 2])> {
    for values in &mut pair {
        unwrapped(values);
    }
    let row = |row: usize| (log.time[row], [pair[0][row], pair[1][row]]);
    (0..log.len()).map(row).filter(|(_, pair)| pair.iter().all(|angle| angle.is_finite())).collect()
}

/// Share of the motion in the image that is left beside the log, were the image so late; infinite where less than half of
/// the shorter log has a counterpart.
fn left(logged: &[(f64, [f64; 2])], seen: &[(f64, [f64; 2])], late: f64) -> f64 {
    let mut both: Vec<[[f64; 2]; 2]> = Vec::with_capacity(seen.len());
    for (time, directions) in seen {
        let next = logged.partition_point(|row| row.0 <= time - late);
        if next == 0 || next == logged.len() {
            continue;
        }
        let (before, after) = (&logged[next - 1], &logged[next]);
        let share = (time - late - before.0) / (after.0 - before.0);
        let angle = |i: usize| before.1[i] + share * (after.1[i] - before.1[i]);
        both.push([*directions, [angle(0), angle(1)]]);
    }
    let length = |rows: &[(f64, [f64; 2])]| rows.last().map_or(0.0, |last| last.0 - rows[0].0);
    let enough = (length(logged) / length(seen)).min(1.0) * 0.5 * seen.len() as f64;
    if both.len() < 12 || (both.len() as f64) < enough {
        return f64::INFINITY;
    }
    let spread = |value: &dyn Fn(&[[f64; 2]; 2]) -> f64| {
        let mean = both.iter().map(value).sum::<f64>() / both.len() as f64;
        both.iter().map(|row| (value(row) - mean).powi(2)).sum::<f64>()
    };
    let (mut residual, mut motion) = (0.0, 0.0);
    for angle in 0..2 {
        residual += spread(&|row| row[0][angle] - row[1][angle]);
        motion += spread(&|row| row[0][angle]);
    }
    (residual / motion).sqrt()
}
