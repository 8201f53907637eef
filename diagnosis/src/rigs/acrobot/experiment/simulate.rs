//! A prepared experiment, run through the orchestrator and turned into the data set that a lab would log, without
//! noise: noise is counted where the data are compared.

use super::catalogue::Change;
use super::scenario::{Logs, Prepared, record, refused};
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Attribute, name};
use crate::rigs::acrobot::dataset::{self, DataSet, Manifest, Table};
use crate::rigs::acrobot::experiment::policy::DESIGN;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::studio::COLUMNS;
use crate::rigs::acrobot::residual::trajectory::Motion;
use orchestrator::time::Rational;
use orchestrator::{MemoryRecorder, Quiet, Simulation, UnitPath};
use std::rc::Rc;

/// One simulated run.
pub struct Trial {
    /// What a lab would have.
    pub data: DataSet,
    /// How the arm really moved.
    pub motion: Motion,
}

/// What the machine does otherwise, for how long, and values of the units.
type Run = (Vec<Change>, Rational, Vec<(String, String)>);

/// Runs that were simulated already: experiments may differ in what is logged alone.
#[derive(Default)]
pub struct Simulated(Vec<(Run, Rc<Recorded>)>);

impl Simulated {
    /// Runs an experiment with some values set, unless the very same was run before.
    fn run(
        &mut self,
        prepared: &Prepared,
        values: &[(String, String)],
        units: &UnitPath,
    ) -> Result<Rc<Recorded>, Error> {
        let run = (prepared.moves.clone(), prepared.scenario.stop, values.to_vec());
        if let Some((_, known)) = self.0.iter().find(|known| known.0 == run) {
            return Ok(known.clone());
        }
        let made = Rc::new(recorded(prepared, values, units)?);
        self.0.push((run, made.clone()));
        Ok(made)
    }
}

/// Runs an experiment with some values set, without the sensor's noise, and records what a lab could log.
fn recorded(prepared: &Prepared, values: &[(String, String)], units: &UnitPath) -> Result<Recorded, Error> {
    let mut scenario = prepared.scenario.clone();
    let has = |name: &str| prepared.scenario.units.iter().any(|unit| unit.name == name);
    let (filmed, controlled) = (has("camera"), has("controller"));
    for (name, value) in values {
        if name.split('.').next().is_some_and(has) {
            scenario.set(name, value).map_err(refused)?;
        }
    }
    let mut names: Vec<String> = ["q1", "q2", "dq1", "dq2", "tau", "tau_1", "tau_applied", "contact"]
        .map(|name| format!("plant.{name}"))
        .to_vec();
    if filmed {
        scenario.set(name(Attribute::SensorNoise), "0.0").map_err(refused)?;
        names.extend(COLUMNS.iter().chain(&["valid", "frame"]).map(|name| format!("camera.{name}")));
    }
    if controlled {
        names.push("controller.tau".into());
    }
    record(&mut scenario, &names.iter().map(String::as_str).collect::<Vec<_>>());
    let mut simulation = Simulation::new(&scenario, units).map_err(refused)?;
    let mut memory = MemoryRecorder::new();
    simulation.run(&mut memory, &mut Quiet).map_err(refused)?;
    Ok(Recorded { memory, filmed, controlled })
}

/// Runs an experiment with some parameters of the units set, unless it was `simulated` already.
///
/// # Errors
/// A unit refuses a value or fails, or the arm loses its balance.
pub fn simulate(
    prepared: &Prepared,
    values: &[(String, String)],
    like: &DataSet,
    units: &UnitPath,
    simulated: &mut Simulated,
) -> Result<Trial, Error> {
    let log = simulated.run(prepared, values, units)?;
    if let Some(row) = log.series("plant.contact")?.iter().position(|contact| *contact > 0.5) {
        return Err(Error::Model(format!(
            "the arm loses its balance after {:.1} s",
            log.memory.times()[row]
        )));
    }
    if let Some(time) = log.goes_round()?.filter(|_| !log.controlled) {
        return Err(Error::Model(format!("a link goes round after {time:.1} s")));
    }
    let camera = if log.filmed && prepared.logs.images { Some(log.camera()?) } else { None };
    if camera.as_ref().is_some_and(Table::is_empty) {
        return Err(Error::Model("the camera unit finds its circles in none of the frames".into()));
    }
    let often = prepared.logs.rate.unwrap_or_else(|| rate(like));
    let run = dataset::Run {
        name: "simulated".into(),
        camera,
        controller: Some(log.controller()?),
        plant: if prepared.logs.encoders { Some(log.plant(&prepared.logs, often)?) } else { None },
    };
    let manifest =
        Manifest { runs: vec![run.name.clone()], noise: Default::default(), ..like.manifest.clone() };
    let data = DataSet {
        path: like.path.clone(),
        manifest,
        runs: vec![run],
        notices: Vec::new(),
        clocks_apart: false,
        late_by_hand: 0.0,
        frames_apart: false,
        blind: std::collections::BTreeMap::new(),
    };
    Ok(Trial { data, motion: log.motion()? })
}

/// Rows of the plant's log per second, as in the runs that were made.
pub fn rate(like: &DataSet) -> f64 {
    let log = like.runs.iter().find_map(|run| run.plant.as_ref());
    let span =
        |log: &Table| log.time.last().copied().unwrap_or(0.0) - log.time.first().copied().unwrap_or(0.0);
    match log {
        Some(log) if span(log) > 0.0 => (log.len() - 1) as f64 / span(log),
        _ => DESIGN.encoder_rate,
    }
}

/// What a simulated experiment gave.
struct Recorded {
    memory: MemoryRecorder,
    filmed: bool,
    controlled: bool,
}

impl Recorded {
    /// All values of a signal, one for each recorded time.
    fn series(&self, name: &str) -> Result<&[f64], Error> {
        self.memory.series(name).map_err(refused)
    }

    /// When a link first is half a turn from where it began: what hangs would go over the top, cables and all.
    fn goes_round(&self) -> Result<Option<f64>, Error> {
        let (q1, q2) = (self.series("plant.q1")?, self.series("plant.q2")?);
        let over =
            |row: &usize| (q1[*row] - q1[0]).abs().max((q2[*row] - q2[0]).abs()) > std::f64::consts::PI;
        Ok((0..q1.len()).find(over).map(|row| self.memory.times()[row]))
    }

    /// A table of some rows.
    fn table(&self, rows: &[usize], unit: &str, names: &[&str]) -> Result<Table, Error> {
        let mut columns = Vec::new();
        for name in names {
            let series = self.series(&format!("{unit}.{name}"))?;
            columns.push(((*name).to_owned(), rows.iter().map(|row| series[*row]).collect()));
        }
        Ok(Table::new(rows.iter().map(|row| self.memory.times()[*row]).collect(), columns))
    }

    /// Rows at which one of some series is not what it was; the first row too.
    fn changes(&self, names: &[&str]) -> Result<Vec<usize>, Error> {
        let series = names.iter().map(|name| self.series(name)).collect::<Result<Vec<_>, _>>()?;
        let rows = 0..self.memory.times().len();
        Ok(rows.filter(|row| *row == 0 || series.iter().any(|s| s[*row] != s[*row - 1])).collect())
    }

    /// The log of delivered frames in which circles were found.
    fn camera(&self) -> Result<Table, Error> {
        let (frame, valid) = (self.series("camera.frame")?, self.series("camera.valid")?);
        let mut rows = self.changes(&["camera.frame"])?;
        rows.retain(|row| frame[*row] > 0.0 && valid[*row] > 0.5);
        self.table(&rows, "camera", &COLUMNS)
    }

    /// The log of commanded torques, a row for each that is another.
    fn controller(&self) -> Result<Table, Error> {
        if self.controlled {
            return self.table(&self.changes(&["controller.tau"])?, "controller", &["tau"]);
        }
        // a row has what its own step was driven with, so that it began to act a step before
        let rows = self.changes(&["plant.tau", "plant.tau_1"])?;
        let mut table = self.table(&rows, "plant", &["tau", "tau_1"])?;
        table.time = rows.iter().map(|row| self.memory.times()[row.saturating_sub(1)]).collect();
        Ok(table)
    }

    /// The log of encoders, `rate` rows a second, with the applied torque if it would be logged.
    fn plant(&self, logs: &Logs, rate: f64) -> Result<Table, Error> {
        let rows = self.every(1.0 / rate);
        if !logs.torque {
            return self.table(&rows, "plant", &["q1", "q2"]);
        }
        let mut log = self.table(&rows, "plant", &["q1", "q2", "tau_applied"])?;
        // a row at the very time of a command may hold the torque before or after it, as a lab's clock will have it
        let commands = self.controller()?.time;
        let sure = |time: &f64| {
            let next = commands.partition_point(|command| *command < time - POLICY.same_time);
            commands.get(next).is_none_or(|command| *command > time + POLICY.same_time)
        };
        let sure: Vec<bool> = log.time.iter().map(sure).collect();
        for (torque, sure) in log.column_mut("tau_applied").into_iter().flatten().zip(sure) {
            *torque = if sure { *torque } else { f64::NAN };
        }
        Ok(log)
    }

    /// Rows that are an interval (s) apart.
    fn every(&self, interval: f64) -> Vec<usize> {
        let times = self.memory.times();
        let begin = times.first().copied().unwrap_or(0.0);
        let mut count = 0.0;
        let due = |row: &usize| {
            let here = times[*row] + POLICY.same_time >= begin + count * interval;
            count += f64::from(u8::from(here));
            here
        };
        (0..times.len()).filter(due).collect()
    }

    /// The motion itself.
    fn motion(&self) -> Result<Motion, Error> {
        let rows = self.every(POLICY.motion_step);
        let names = ["plant.q1", "plant.q2", "plant.dq1", "plant.dq2"];
        let series = names.iter().map(|name| self.series(name)).collect::<Result<Vec<_>, _>>()?;
        let states = rows.iter().map(|row| std::array::from_fn(|i| series[i][*row])).collect();
        let times = rows.iter().map(|row| self.memory.times()[*row]).collect();
        Ok(Motion { stretches: vec![(times, states)] })
    }
}
