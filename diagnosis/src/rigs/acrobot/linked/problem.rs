//! The plant's logs as a problem of any unit: `plant.fmu` alone, torque fed, angles and rates compared.
//!
//! The actuator's parameters are the effects at the port `tau`, which come in the unit's own order; so the unit keeps a torque with no
//! past, and its states are the angles and rates alone. The applied torque isn't compared: it jumps with the command.

use crate::dynamics::build::Span;
use crate::error::Error;
use crate::observe::{
    Affine, Candidate as Listed, Channel, Hold, InputEffect, Nominal, OutputEffect, Ports, Problem, Reading,
    Role, Run as Logged, Scale, Series, State, VariableId,
};
use crate::rigs::acrobot::candidates::{Candidate, Motion, Side, actuator};
use crate::rigs::acrobot::dataset::{DataSet, Run, Table};
use crate::rigs::acrobot::linked::policy::LINKED;
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::parameters;
use crate::rigs::acrobot::residual::policy::RESIDUAL;
use crate::statistics::median::median;
use orchestrator::Value;
use orchestrator::time::Rational;
use std::borrow::Cow;

/// What plants log and states are, and how a state is started.
pub(super) const MOTION: [(&str, &str); 4] =
    [("q1", "q1_0"), ("q2", "q2_0"), ("dq1", "dq1_0"), ("dq2", "dq2_0")];
/// What drives a plant; the second is nothing where no log has it, and there for laws of a torque on the first link.
pub(super) const TORQUES: [&str; 2] = ["tau", "tau_1"];
/// A data set's plant logs, and the stretches of them in which the torque is known.
pub(super) struct Stretches {
    pub(super) problem: Problem,
    /// Runs, by their place, and times, s.
    pub(super) spans: Vec<(usize, Span)>,
}

/// The stretches of the runs that hold a torque and both angles. `sigma` is the standard deviation of a logged motion, where a comparison found it.
pub(super) fn stretches(
    data: &DataSet,
    model: &Model,
    list: &[Candidate],
    point: &[f64],
    sigma: &dyn Fn(&str) -> Option<f64>,
) -> Result<Option<Stretches>, Error> {
    let late = list.iter().zip(point).find(|(one, _)| one.side == Side::Clock).map_or(0.0, |(_, x)| *x);
    let data = &on_time(data, late);
    let contact = data.contact(model.number(parameters::LIMIT).unwrap_or(f64::INFINITY));
    let used: Vec<&Run> = data.runs.iter().filter(|run| both_angles(run)).collect();
    let logs = || used.iter().filter_map(|run| run.plant.as_ref().zip(run.controller.as_ref()));
    let motion: Vec<usize> = (0..MOTION.len())
        .filter(|place| logs().any(|(plant, _)| plant.column(MOTION[*place].0).is_some()))
        .collect();
    let nominal = nominal(model)?;
    let find = |name: &str| id(&nominal, name);
    let channels = channels(data, &motion, sigma, &find)?;
    let states = states(&motion, &find)?;
    let (runs, spans) = logged_runs(&used, &motion, contact);
    if spans.is_empty() {
        return Ok(None);
    }
    let problem = Problem {
        path: data.path.clone(),
        channels,
        unlogged: Vec::new(),
        states,
        candidates: listed(list, model, &find)?,
        ports: Ports {
            inputs: InputEffect::ALL.to_vec(),
            outputs: vec![OutputEffect::Offset],
            unknown_inputs: false,
        },
        runs,
        reading: Reading::Before,
        deadline: None,
        budget: None,
        late: false,
        whole: false,
        notices: Vec::new(),
        model: nominal,
    };
    Ok(Some(Stretches { problem, spans }))
}

/// The data with the plants' logs stamped so much earlier, s.
fn on_time(data: &DataSet, late: f64) -> Cow<'_, DataSet> {
    if late == 0.0 {
        return Cow::Borrowed(data);
    }
    let mut data = data.clone();
    let logs = data.runs.iter_mut().filter_map(|run| run.plant.as_mut());
    logs.flat_map(|log| &mut log.time).for_each(|time| *time -= late);
    Cow::Owned(data)
}

/// The logs of the runs, and the stretches of them that are linked: each a run and its times, s.
fn logged_runs(used: &[&Run], motion: &[usize], contact: f64) -> (Vec<Logged>, Vec<(usize, Span)>) {
    let (mut runs, mut spans) = (Vec::new(), Vec::new());
    for run in used {
        let (Some(plant), Some(torque)) = (&run.plant, &run.controller) else { continue };
        let rows = usable(run, plant, contact);
        pieces(&rows, plant, &run.undriven(), runs.len(), &mut spans);
        let mut series: Vec<Series> =
            motion.iter().map(|place| course(plant, MOTION[*place].0, rows.iter().copied())).collect();
        series.extend(TORQUES.iter().map(|name| driven(torque, name)));
        runs.push(Logged { name: run.name.clone(), line: 0, seconds: 1.0, series });
    }
    shortened(&mut spans, &runs);
    (runs, spans)
}

/// What was logged: the places of `MOTION` that are compared, and the torques that are fed.
fn channels(
    data: &DataSet,
    motion: &[usize],
    sigma: &dyn Fn(&str) -> Option<f64>,
    find: &dyn Fn(&str) -> Result<VariableId, Error>,
) -> Result<Vec<Channel>, Error> {
    let channel = |name: &str, role: Role, noise: Option<f64>| {
        Ok::<_, Error>(Channel {
            name: format!("plant.{name}"),
            variable: find(name)?,
            role,
            noise,
            column: name.to_owned(),
            conversion: Affine::SAME,
            line: 0,
            hold_is_said: true,
        })
    };
    let compared = motion.iter().map(|place| {
        let name = MOTION[*place].0;
        let noise = sigma(name).or(data.known_noise(&format!("plant.{name}")));
        channel(name, Role::Compared, noise)
    });
    compared.chain(TORQUES.iter().map(|name| channel(name, Role::Fed(Hold::Zero), None))).collect()
}

/// The plant's states: angles and rates. `motion` are the places of those that were logged.
fn states(motion: &[usize], find: &dyn Fn(&str) -> Result<VariableId, Error>) -> Result<Vec<State>, Error> {
    let state = |(place, (shows, start)): (usize, (&str, &str))| {
        Ok(State {
            name: format!("plant.{start}"),
            start: find(start)?,
            shows: Some(find(shows)?),
            channel: motion.iter().position(|logged| *logged == place),
        })
    };
    MOTION.into_iter().enumerate().map(state).collect()
}

/// Whether a run holds a torque and both angles.
fn both_angles(run: &Run) -> bool {
    let angle = |name| run.plant.as_ref().is_some_and(|log| log.column(name).is_some());
    run.controller.is_some() && angle("q1") && angle("q2")
}

/// Where the plant's unit has a variable.
fn id(nominal: &Nominal, name: &str) -> Result<VariableId, Error> {
    let place = nominal.description(0).place(name);
    let none = || Error::Model(format!("{} has no variable `{name}`", nominal.fmus[0].path().display()));
    place.map(|place| VariableId { instance: 0, place }).ok_or_else(none)
}

/// The plant alone, without an actuator and without a mechanical limit.
fn nominal(model: &Model) -> Result<Nominal, Error> {
    let mut scenario = model.scenario.clone();
    scenario.units.retain(|unit| unit.name == "plant");
    scenario.connections.clear();
    scenario.sources.clear();
    // no longer than a gap: the unit steps from one change of the torque to the next
    scenario.units.iter_mut().for_each(|unit| unit.interval = Rational::new(1, 1).unwrap_or(unit.interval));
    let set = model
        .plant
        .given()
        .map(|(place, value)| (VariableId { instance: 0, place }, value.clone()))
        .collect();
    let mut nominal = Nominal { scenario, fmus: vec![model.plant.fmu().clone()], set };
    let off = actuator().map(|(name, effect)| (name, if effect == InputEffect::Gain { 1.0 } else { 0.0 }));
    for (name, value) in off.chain([(parameters::LIMIT, 1e9), ("plant.tolerance", RESIDUAL.integrator)]) {
        let own = name.split_once('.').map_or(name, |(_, own)| own);
        if let Some(place) = nominal.description(0).place(own) {
            nominal.set.push((VariableId { instance: 0, place }, Value::Real(value)));
        }
    }
    Ok(nominal)
}

/// The plant's candidates that are no part of its actuator.
fn listed(
    list: &[Candidate],
    model: &Model,
    find: &dyn Fn(&str) -> Result<VariableId, Error>,
) -> Result<Vec<Listed>, Error> {
    let own = |candidate: &&Candidate| candidate.side == Side::Plant && candidate.at_port().is_none();
    let mut all = Vec::new();
    for candidate in list.iter().filter(own) {
        all.push(Listed {
            name: candidate.name.to_owned(),
            variable: find(candidate.name.split_once('.').map_or(candidate.name, |(_, own)| own))?,
            neutral: model.number(candidate.name).unwrap_or(candidate.off),
            range: candidate.range,
            phrase: candidate.phrase.to_owned(),
            scale: match candidate.motion {
                Motion::Switch => Scale::Switch,
                Motion::Count { .. } => Scale::Count,
                Motion::Saturation { .. } => Scale::Saturation,
                Motion::Share { .. } => Scale::Relative,
                Motion::Real { .. } | Motion::Load { .. } => Scale::Absolute,
            },
            line: 0,
        });
    }
    Ok(all)
}

/// Rows with an angle before the links touch, while the torque is known; of a dense log every so many.
fn usable(run: &Run, plant: &Table, contact: f64) -> Vec<usize> {
    let (begin, end) = run.driven();
    let limit = run.touches(contact).unwrap_or(plant.len());
    let angle = |row: usize, name| plant.column(name).is_some_and(|values| values[row].is_finite());
    let told = |row: &usize| angle(*row, "q1") || angle(*row, "q2");
    let within = |row: &usize| (begin..=end).contains(&plant.time[*row]);
    let rows: Vec<usize> = (0..limit).filter(told).filter(within).collect();
    let every = (RESIDUAL.step / usual(&rows, plant) - 1e-9).ceil().max(1.0);
    rows.into_iter().step_by(every as usize).collect()
}

/// Usual distance of rows, s.
fn usual(rows: &[usize], plant: &Table) -> f64 {
    median(rows.windows(2).map(|pair| plant.time[pair[1]] - plant.time[pair[0]])).unwrap_or(RESIDUAL.step)
}

/// Stretches without a gap in which the torque is known.
fn pieces(rows: &[usize], plant: &Table, undriven: &[(f64, f64)], run: usize, into: &mut Vec<(usize, Span)>) {
    let torn = LINKED.torn * usual(rows, plant);
    let apart = |pair: &[usize]| {
        let (from, to) = (plant.time[pair[0]], plant.time[pair[1]]);
        to - from > torn || undriven.iter().any(|gap| gap.0 < to && from < gap.1)
    };
    let mut first = 0;
    for last in 0..rows.len() {
        if last + 1 == rows.len() || apart(&rows[last..last + 2]) {
            if last + 1 - first >= LINKED.fewest {
                into.push((run, (plant.time[rows[first]], plant.time[rows[last]])));
            }
            first = last + 1;
        }
    }
}

/// The first part of each stretch, so long that no more than `LINKED.most` rows are linked.
fn shortened(spans: &mut [(usize, Span)], runs: &[Logged]) {
    let rows: usize = (spans.iter())
        .map(|(run, (from, to))| {
            let time = runs[*run].series.first().map_or(&[][..], |series| &series.time);
            time.iter().filter(|time| (from..=to).contains(time)).count()
        })
        .sum();
    let share = LINKED.most as f64 / rows.max(1) as f64;
    for (_, (from, to)) in spans.iter_mut().filter(|_| share < 1.0) {
        *to = *from + share * (*to - *from);
    }
}

/// What a column measured in these rows.
fn course(log: &Table, name: &str, rows: impl Iterator<Item = usize>) -> Series {
    let Some(values) = log.column(name) else { return Series::default() };
    let known = rows.filter(|row| values[*row].is_finite());
    let (time, values) = known.map(|row| (log.time[row], values[row])).unzip();
    Series { time, values }
}

/// A torque that was fed: none where no log has it.
fn driven(log: &Table, name: &str) -> Series {
    match log.column(name) {
        Some(_) => course(log, name, 0..log.len()),
        None => Series { time: log.time.clone(), values: vec![0.0; log.len()] },
    }
}
