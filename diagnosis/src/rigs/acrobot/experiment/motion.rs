//! How the machine moves in an experiment: as in the runs that were made, or otherwise.

use super::catalogue::{LENGTH, Rig};
use super::scenario::{feed, refused};
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Attribute, name};
use crate::rigs::acrobot::dataset::{DataSet, Run, Table};
use crate::rigs::acrobot::experiment::policy::DESIGN;
use crate::rigs::acrobot::model::Model;
use orchestrator::Scenario;
use orchestrator::scenario::Shape;
use std::f64::consts::{PI, TAU};

/// What the inputs get over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Tables {
    /// z_desired; kept as it is in the scenario where `None`.
    desired: Option<(Shape, Vec<(f64, f64)>)>,
    /// Torques at the joint and at link 1, without a controller.
    torques: Option<[Vec<(f64, f64)>; 2]>,
    /// q1, q2, dq1, dq2.
    start: Option<[f64; 4]>,
    length: f64,
    /// Share of the data set's excitation that the repeated run had; `None` for another motion.
    share: Option<f64>,
}

impl Tables {
    /// Another z_desired, from where the first run began.
    pub fn desired(data: &DataSet, points: Vec<(f64, f64)>) -> Self {
        let desired = Some((Shape::Smooth, points));
        let start = data.runs.iter().find_map(|run| start(run, false));
        Self { desired, torques: None, start, length: LENGTH, share: None }
    }

    /// How many times the simulated run a lab would record: as much as it did.
    pub fn repeats(&self, data: &DataSet) -> f64 {
        if let Some(share) = self.share.filter(|share| *share > 0.0) {
            return (1.0 / share).min(data.runs.len() as f64);
        }
        let total: f64 = data.runs.iter().map(|run| run.span().1 - run.span().0).sum();
        (total / self.length).max(1.0)
    }

    /// Puts them into a scenario.
    ///
    /// # Errors
    /// The scenario has no plant.
    pub fn put(&self, scenario: &mut Scenario, images: bool) -> Result<(), Error> {
        if let Some((shape, points)) = &self.desired {
            feed(scenario, "controller.z_desired", *shape, points.clone());
        }
        if let Some([joint, link]) = &self.torques {
            // driven from outside: nothing is in the loop, and nobody looks unless there is a camera
            let kept = |name: &str| name == "plant" || (images && name == "camera");
            let unit = |variable: &str| variable.split('.').next().unwrap_or_default().to_owned();
            scenario.units.retain(|entry| kept(&entry.name));
            scenario.connections.retain(|entry| kept(&unit(&entry.from)) && kept(&unit(&entry.to)));
            scenario.sources.retain(|entry| kept(&unit(&entry.to)));
            scenario.report = Default::default();
            feed(scenario, "plant.tau", Shape::Hold, joint.clone());
            if !link.is_empty() {
                feed(scenario, "plant.tau_1", Shape::Hold, link.clone());
            }
        }
        for (name, value) in ["q1_0", "q2_0", "dq1_0", "dq2_0"].iter().zip(self.start.iter().flatten()) {
            scenario.set(&format!("plant.{name}"), &format!("{value:?}")).map_err(refused)?;
        }
        scenario.set_stop(&format!("{}", self.length)).map_err(refused)
    }
}

/// The run that moved most, once more.
pub fn repeated(data: &DataSet, rig: Rig) -> Tables {
    let column = if hangs(data) { "tau" } else { "z_desired" };
    let sizes: Vec<f64> = data.runs.iter().map(|run| moved(run.controller.as_ref(), column)).collect();
    let best = (0..sizes.len()).max_by(|a, b| sizes[*a].total_cmp(&sizes[*b])).unwrap_or(0);
    let share = Some(sizes[best] / sizes.iter().sum::<f64>()).filter(|share| share.is_finite());
    let longest = if rig == Rig::Pinned { DESIGN.short } else { LENGTH };
    let mut tables =
        Tables { desired: None, torques: None, start: None, length: longest, share: share.or(Some(1.0)) };
    let Some((run, log)) = data.runs.get(best).and_then(|run| Some((run, run.controller.as_ref()?))) else {
        return tables;
    };
    let begin = log.time.first().copied().unwrap_or(0.0);
    let span = log.time.last().copied().unwrap_or(begin) - begin;
    tables.length = longest.min((span * 10.0).floor() / 10.0).max(2.0);
    if hangs(data) {
        let table = |name: &str, every: f64| {
            log.column(name).map_or(Vec::new(), |_| sampled(log, name, begin, tables.length, every))
        };
        tables.torques = Some([table("tau", DESIGN.held), table("tau_1", DESIGN.held)]);
        tables.start = start(run, true);
        return tables;
    }
    tables.start = start(run, false);
    if log.column("z_desired").is_some_and(|z| z.iter().any(|z| z.is_finite() && *z != 0.0)) {
        tables.desired =
            Some((Shape::Linear, sampled(log, "z_desired", begin, tables.length, DESIGN.thinned)));
    }
    tables
}

/// An arm at rest, driven by a sum of sines; at link 1 only if the lab has a motor there.
pub fn hanging(data: &DataSet, model: &Model) -> Tables {
    let weight = model.number(name(Attribute::JointWeight)).unwrap_or(1.0).abs();
    let shoulder = data.runs.iter().any(|run| moved(run.controller.as_ref(), "tau_1") > 0.0);
    // frequencies without a common divisor, phases that keep the begin gentle
    let sines = |size: f64, lines: [f64; 5]| -> Vec<(f64, f64)> {
        (0..=(DESIGN.short / DESIGN.held) as usize)
            .map(|k| {
                let t = k as f64 * DESIGN.held;
                let sum: f64 =
                    lines.iter().enumerate().map(|(i, f)| libm::sin(TAU * f * t + i as f64 * PI * 0.4)).sum();
                (t, size * (t / 0.5).min(1.0) * sum / (0.5 * lines.len() as f64).sqrt())
            })
            .collect()
    };
    let joint = sines(DESIGN.swings[0] * weight, [0.23, 0.61, 1.13, 1.87, 2.9]);
    let link =
        if shoulder { sines(DESIGN.swings[1] * weight, [0.31, 0.53, 0.97, 1.49, 2.1]) } else { Vec::new() };
    let start = Some([PI, PI, 0.0, 0.0]);
    Tables { desired: None, torques: Some([joint, link]), start, length: DESIGN.short, share: None }
}

/// Whether link 1 hangs in the logs, in the mean.
fn hangs(data: &DataSet) -> bool {
    let angles = || data.runs.iter().filter_map(|run| run.plant.as_ref()?.column("q1")).flatten();
    let known = || angles().filter(|angle| angle.is_finite());
    let count = known().count();
    count > 0 && known().map(|angle| angle.abs()).sum::<f64>() > DESIGN.hanging * count as f64
}

/// Sum of squared changes of a column, in units that cancel.
fn moved(log: Option<&Table>, name: &str) -> f64 {
    let Some(values) = log.and_then(|log| log.column(name)) else { return 0.0 };
    values.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).filter(|square| square.is_finite()).sum()
}

/// Times from 0 on, s, `every` so often for a `length`, and what a column held then, `begin` s later in its log.
fn sampled(log: &Table, name: &str, begin: f64, length: f64, every: f64) -> Vec<(f64, f64)> {
    let count = (length / every).round() as usize;
    (0..=count)
        .map(|k| {
            let time = k as f64 * every;
            // twelve digits: what a log's sum of times leaves beyond that is rounding
            ((time * 1e12).round() / 1e12, log.held(name, begin + time + 1e-9, 0.0))
        })
        .collect()
}

/// State at the begin of a run: the first pose that a log shows. A hanging arm may swing then; a balanced one is let
/// go at rest.
fn start(run: &Run, swings: bool) -> Option<[f64; 4]> {
    let poses: Vec<[f64; 3]> = match (&run.plant, &run.camera) {
        (Some(log), _) => {
            let (q1, q2) = (log.column("q1")?, log.column("q2")?);
            (0..log.len()).map(|row| [log.time[row], q1[row], q2[row]]).collect()
        }
        (None, Some(log)) => {
            let [u1, v1, u2, v2, u3, v3] = ["u1", "v1", "u2", "v2", "u3", "v3"].map(|name| log.column(name));
            let (u1, v1, u2, v2, u3, v3) = (u1?, v1?, u2?, v2?, u3?, v3?);
            let link = |du: f64, dv: f64| libm::atan2(du, dv);
            let angles = |row: usize| {
                [link(u2[row] - u1[row], v2[row] - v1[row]), link(u3[row] - u2[row], v3[row] - v2[row])]
            };
            (0..log.len()).map(|row| [log.time[row], angles(row)[0], angles(row)[1]]).collect()
        }
        _ => return None,
    };
    let seen: Vec<[f64; 3]> =
        poses.into_iter().filter(|pose| pose.iter().all(|x| x.is_finite())).take(8).collect();
    let (first, last) = (seen.first()?, seen.last()?);
    let span = last[0] - first[0];
    let rate = |angle: usize| if swings && span > 0.0 { (last[angle] - first[angle]) / span } else { 0.0 };
    Some([first[1], first[2], rate(1), rate(2)])
}
