//! An experiment of the catalogue as a scenario: the nominal one with what the experiment changes.

use super::catalogue::{Change, Experiment, LENGTH, Log, Profile, Rig};
use super::motion::{self, Tables};
use super::simulate::rate;
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Attribute, Entry, LIST, Motion, name};
use crate::rigs::acrobot::dataset::DataSet;
use crate::rigs::acrobot::experiment::policy::DESIGN;
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::parameters;
use orchestrator::scenario::{Placed, Shape, SignalEntry, SourceEntry};
use orchestrator::{Place, Scenario};

/// Which logs there are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Logs {
    /// Centroids and areas.
    pub images: bool,
    /// Joint angles.
    pub encoders: bool,
    /// `tau_applied`.
    pub torque: bool,
    /// Rows of angles and torque a second; `None`: as in the runs that were made.
    pub rate: Option<f64>,
}

impl Logs {
    /// What a data set holds.
    pub fn of(data: &DataSet) -> Self {
        let plant = |name: &str| {
            data.runs.iter().any(|run| run.plant.as_ref().is_some_and(|log| log.column(name).is_some()))
        };
        let images = data.runs.iter().any(|run| run.camera.is_some());
        Self { images, encoders: plant("q1"), torque: plant("tau_applied"), rate: None }
    }

    fn place(&mut self, log: Log) -> &mut bool {
        match log {
            Log::Encoders => &mut self.encoders,
            Log::Torque => &mut self.torque,
        }
    }
}

/// An experiment made ready.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// The nominal scenario, changed.
    pub scenario: Scenario,
    /// Parameters of the nominal model that are others now.
    pub set: Vec<(String, f64)>,
    /// What is logged.
    pub logs: Logs,
    /// How much more than the simulated run a lab would record.
    pub repeats: f64,
    /// What the machine does otherwise, whatever is logged of it.
    pub moves: Vec<Change>,
}

/// Joint and first link of a pinned arm have no drum: R = 0 makes these vanish.
pub fn rig(model: &Model) -> Rig {
    match model.number(name(Attribute::Rolls)) {
        Some(0.0) => Rig::Pinned,
        _ => Rig::Rolling,
    }
}

/// Makes an experiment ready; `None` where this machine and these logs leave nothing to do.
///
/// # Errors
/// The nominal scenario lacks what the experiment changes.
pub fn prepare(data: &DataSet, model: &Model, entry: &Experiment) -> Result<Option<Prepared>, Error> {
    let (logs, rig) = (Logs::of(data), rig(model));
    let mut now = logs;
    let (mut scenario, mut set) = (model.scenario.clone(), Vec::new());
    let mut moved = None;
    for change in entry.changes {
        match *change {
            Change::Log(log) => *now.place(log) = true,
            Change::Rate(often) => now.rate = Some(often).filter(|often| *often > rate(data)),
            Change::Desired(profile) => moved = Some(Tables::desired(data, points(profile))),
            Change::Hang => moved = Some(motion::hanging(data, model)),
            Change::Turned(by) => {
                for name in [name(Attribute::CameraRoll), parameters::MOUNT] {
                    set.push((name, number(model, name)? + by));
                }
            }
            Change::Times(name, factor) => set.push((name, number(model, name)? * factor)),
            Change::Plus(name, by) => set.push((name, number(model, name)? + by)),
        }
    }
    let of_logs = |change: &Change| matches!(change, Change::Log(_) | Change::Rate(_) | Change::Desired(_));
    let only_logs = entry.changes.iter().all(of_logs);
    let more = entry.changes.iter().any(|change| matches!(change, Change::Log(_)));
    // who logs no angles can't log them often, and who logs them needs no encoders
    let asks = |log| entry.changes.contains(&Change::Log(log));
    let there = logs.encoders && asks(Log::Encoders) && !asks(Log::Torque);
    let blind = now.rate.is_some() && (!now.encoders || there);
    let filmed = set.iter().any(|(name, _)| name.starts_with("camera."));
    let idle = (entry.rig != Rig::Any && entry.rig != rig) || (only_logs && more && now == logs);
    if idle || blind || (filmed && !now.images) {
        return Ok(None);
    }
    let tables = moved.unwrap_or_else(|| motion::repeated(data, rig));
    let repeats = tables.repeats(data);
    tables.put(&mut scenario, now.images)?;
    let set: Vec<(String, f64)> = set.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
    for (name, value) in &set {
        let counted = |entry: &Entry| entry.name == name && matches!(entry.motion, Motion::Count { .. });
        let text = if LIST.iter().any(counted) { format!("{value:.0}") } else { format!("{value:?}") };
        scenario.set(name, &text).map_err(refused)?;
    }
    scenario.description = entry.what.to_owned();
    let logged = |change: &Change| matches!(change, Change::Log(_) | Change::Rate(_));
    let moves = entry.changes.iter().filter(|change| !logged(change)).copied().collect();
    Ok(Some(Prepared { scenario, set, logs: now, repeats, moves }))
}

fn number(model: &Model, name: &str) -> Result<f64, Error> {
    model.number(name).ok_or_else(|| Error::Model(format!("it has no {name}")))
}

/// An error of the orchestrator, as one of the model.
pub fn refused(error: orchestrator::Error) -> Error {
    Error::Model(error.to_string())
}

fn here() -> Place {
    Place::Override("the next experiment".into())
}

/// A profile as times, s, and values.
fn points(profile: Profile) -> Vec<(f64, f64)> {
    match profile {
        Profile::Points(points) => points.to_vec(),
        Profile::Sweep { size, from, to } => (0..=(LENGTH / DESIGN.sweep_step) as usize)
            .map(|k| {
                let t = k as f64 * DESIGN.sweep_step;
                let phase = std::f64::consts::TAU * (from * t + 0.5 * (to - from) * t * t / LENGTH);
                (t, size * libm::sin(phase))
            })
            .collect(),
    }
}

/// Feeds an input from outside, in the place of whatever fed it.
pub fn feed(scenario: &mut Scenario, to: &str, shape: Shape, points: Vec<(f64, f64)>) {
    scenario.connections.retain(|connection| connection.to != to);
    scenario.sources.retain(|source| source.to != to);
    scenario.sources.push(SourceEntry {
        to: to.to_owned(),
        signal: SignalEntry::Table { shape, points },
        place: here(),
    });
}

/// Records these only.
pub fn record(scenario: &mut Scenario, names: &[&str]) {
    let placed = |name: &&str| Placed { value: (*name).to_owned(), place: here() };
    scenario.record = Some(names.iter().map(placed).collect());
}
