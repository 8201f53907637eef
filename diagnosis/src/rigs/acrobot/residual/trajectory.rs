//! Windows of a run in which the plant unit is driven by the logged torque from a state of its own.
//!
//! The plant is unstable (about 7 1/s), so a replay of a whole run leaves the data even with the exact model. A
//! window of half a second doesn't, once its four start values are free: multiple shooting, Bock 1983. Each window
//! begins a little before its scored rows, so that the actuator's delay line has filled up by then, from what a slow actuator
//! holds (`settled_actuator.rs`).

use crate::error::Error;
use crate::rigs::acrobot::bench::{Bench, Setting, step};
use crate::rigs::acrobot::channels::{Channel, File, Measures, compared, count, names, places};
use crate::rigs::acrobot::dataset::{Run, Table};
use crate::rigs::acrobot::residual::policy::RESIDUAL;
use crate::rigs::acrobot::residual::settled_actuator::{Past, Settling};
use orchestrator::fmu::Instance;
use std::sync::Arc;

/// Time before the scored rows of a window, s: an actuator's delay line fills up in it, so that it is the longest delay that can be told.
pub const PREROLL: f64 = 0.1;

/// q1, q2, dq1, dq2.
pub type State = [f64; 4];

/// Columns of `plant.csv` that are compared: outputs of the plant.
pub const CHANNELS: [Channel; count(File::Plant)] = compared(File::Plant);
/// Their names.
pub const COLUMNS: [&str; CHANNELS.len()] = names(&CHANNELS);
/// Number of them that are motion; the torque that arrives follows.
pub const MOTION: usize = places(&CHANNELS, Measures::AppliedTorque).start;

/// What the plant gives at a time, in that order.
pub type Row = [f64; CHANNELS.len()];

/// The state in it.
pub fn state_of(row: &Row) -> State {
    std::array::from_fn(|place| row[place])
}

/// What happens in a window at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// s
    pub time: f64,
    /// Commanded torque from here on, N·m.
    pub tau: f64,
    /// External torque on link 1 from here on, N·m.
    pub tau_1: f64,
    /// How both change until the next event, N·m/s.
    pub rates: [f64; 2],
    /// The state is wanted here.
    pub wanted: bool,
}

/// A stretch of a run, as the plant unit is driven through it.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// In order; the first one is the start, and the last one is wanted.
    pub events: Vec<Event>,
    /// Commanded torque just before the start, N·m.
    pub before: f64,
    /// Commands of the time before: a slow actuator remembers them.
    pub past: Arc<Past>,
}

impl Drive {
    /// From `start`, with the run's logged torque, to the last of `wanted` (increasing, not before `start`). Something
    /// may change at each of `edges`. A torque logged faster than 1/`RESIDUAL.step` is a line between wanted times, which keeps its impulse and
    /// the way that this makes.
    pub fn new(run: &Run, start: f64, wanted: &[f64], edges: &[f64]) -> Self {
        let end = wanted.last().copied().unwrap_or(start);
        let mut times: Vec<(f64, bool)> = vec![(start, wanted.first() == Some(&start))];
        times.extend(wanted.iter().filter(|time| **time > start).map(|time| (*time, true)));
        times.extend(edges.iter().filter(|time| **time > start && **time < end).map(|time| (*time, false)));
        let mut dense = false;
        if let Some(controller) = &run.controller {
            let from = controller.time.partition_point(|time| *time <= start);
            let to = controller.time.partition_point(|time| *time < end);
            dense = to > from + 4 && (end - start) / ((to - from) as f64) < RESIDUAL.step;
            if !dense {
                times.extend(controller.time[from..to.max(from)].iter().map(|time| (*time, false)));
            }
        }
        times.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut events: Vec<Event> = Vec::with_capacity(times.len());
        for (time, wanted) in times {
            match events.last_mut() {
                Some(last) if time - last.time < 1e-9 => last.wanted |= wanted,
                _ => {
                    // a row's torque is held from its own time, also when a wanted time is a rounding away from it
                    let held =
                        |name| run.controller.as_ref().map_or(0.0, |log| log.held(name, time + 1e-9, 0.0));
                    let (tau, tau_1) = (held("tau"), held("tau_1"));
                    events.push(Event { time, tau, tau_1, rates: [0.0; 2], wanted });
                }
            }
        }
        if dense && let Some(controller) = &run.controller {
            for place in 0..events.len() - 1 {
                let (from, to) = (events[place].time, events[place + 1].time);
                let (tau, rate) = line(controller, "tau", from, to);
                let (tau_1, rate_1) = line(controller, "tau_1", from, to);
                events[place] = Event { tau, tau_1, rates: [rate, rate_1], ..events[place] };
            }
        }
        let before = run.controller.as_ref().map_or(0.0, |log| log.held("tau", start - 1e-9, 0.0));
        let past = run.controller.as_ref().map_or_else(Vec::new, |log| history(log, start));
        Self { events, before, past: Arc::new(Past::of(past)) }
    }

    /// The state is wanted where it begins, with nothing driven before.
    pub fn begins_wanted(&self) -> bool {
        self.events[0].wanted
    }

    /// Where it begins, s.
    pub fn start(&self) -> f64 {
        self.events[0].time
    }

    /// Where it ends, s.
    pub fn end(&self) -> f64 {
        self.events[self.events.len() - 1].time
    }
}

/// The commands that an actuator may remember at a time, from the one that was held a while before.
fn history(log: &Table, start: f64) -> Vec<(f64, f64)> {
    let from = start - RESIDUAL.remembered;
    let first = log.time.partition_point(|time| *time <= from).saturating_sub(1);
    let last = log.time.partition_point(|time| *time < start);
    let torques = log.column("tau").unwrap_or(&[]);
    let rows = (first..last.max(first)).filter_map(|row| Some((log.time[row], *torques.get(row)?)));
    rows.filter(|(_, torque)| torque.is_finite()).collect()
}

/// Mean of a held column over a stretch of time.
pub fn average(log: &Table, name: &str, from: f64, to: f64) -> f64 {
    moments(log, name, from, to).0
}

/// The line with the mean and the first moment of a held column over a stretch: its value at the beginning, and its slope.
fn line(log: &Table, name: &str, from: f64, to: f64) -> (f64, f64) {
    let (mean, first) = moments(log, name, from, to);
    let slope = 12.0 * first / (to - from).powi(2);
    (mean - 0.5 * slope * (to - from), slope)
}

/// Mean of a held column over a stretch, and of its product with the time from the stretch's middle.
fn moments(log: &Table, name: &str, from: f64, to: f64) -> (f64, f64) {
    let (first, last) = (log.time.partition_point(|t| *t <= from), log.time.partition_point(|t| *t < to));
    if first == last {
        return (log.held(name, from + 1e-9, 0.0), 0.0);
    }
    let (mut sum, mut turned, mut at) = (0.0, 0.0, from);
    for next in log.time[first..last].iter().copied().chain([to]) {
        let impulse = log.held(name, at + 1e-9, 0.0) * (next - at);
        sum += impulse;
        turned += impulse * 0.5 * ((at - from) + (next - to));
        at = next;
    }
    (sum / (to - from), turned / (to - from))
}

/// An extra torque over part of a window: what the model may lack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Push {
    /// Added to the joint torque if true, to the external torque on link 1 if not.
    pub joint: bool,
    /// From, s.
    pub from: f64,
    /// To, s.
    pub to: f64,
    /// N·m
    pub size: f64,
}

/// The plant's references that a drive needs.
#[derive(Debug, Clone)]
pub struct Ports {
    inputs: [u32; 2],
    outputs: [u32; CHANNELS.len()],
    starts: [u32; 4],
    contact: u32,
    bias: u32,
    before: u32,
    tolerance: Option<u32>,
    /// It takes inputs along lines.
    lines: bool,
    lost: f64,
    settling: Settling,
}

impl Ports {
    /// Looks them up. From the rate `lost` on (rad/s) a link has run away from any log, and its rows stay as they are.
    ///
    /// # Errors
    /// The unit lacks one of them.
    pub fn of(plant: &Bench, lost: f64) -> Result<Self, Error> {
        let reference = |name: &str| plant.reference(name);
        let mut outputs = [0; CHANNELS.len()];
        for (output, name) in outputs.iter_mut().zip(COLUMNS) {
            *output = reference(name)?;
        }
        Ok(Self {
            inputs: [reference("tau")?, reference("tau_1")?],
            outputs,
            starts: [reference("q1_0")?, reference("q2_0")?, reference("dq1_0")?, reference("dq2_0")?],
            contact: reference("q2_max")?,
            bias: reference("tau_bias")?,
            before: reference("tau_0")?,
            tolerance: reference("tolerance").ok(),
            lines: plant.interpolates(),
            lost,
            settling: Settling::of(plant)?,
        })
    }
}

/// The torques over one interval of a drive: what goes through the inputs, and what is lacking at the joint beside that.
#[derive(Clone, Copy)]
struct Torques {
    /// Commanded torque and external torque on link 1, N·m.
    inputs: [f64; 2],
    /// Lacking torque at the joint, N·m: it goes past the actuator, neither delayed nor cut by it.
    joint: f64,
}

impl Torques {
    /// From one event to the next. A unit that doesn't take inputs along lines gets their means.
    fn between(event: &Event, next: &Event, lines: bool, pushes: &[Push]) -> Self {
        let on = if lines { 0.0 } else { 0.5 * (next.time - event.time) };
        let [tau, tau_1] = [event.tau + on * event.rates[0], event.tau_1 + on * event.rates[1]];
        let (mut joint, mut link) = (0.0, tau_1);
        for push in pushes.iter().filter(|push| event.time >= push.from - 1e-9 && event.time < push.to - 1e-9)
        {
            *if push.joint { &mut joint } else { &mut link } += push.size;
        }
        Self { inputs: [tau, link], joint }
    }
}

/// Drives the plant from `state`; answers a row at each of the wanted times. A machine that spins ever faster would
/// take most of the time there is, and tell nothing.
///
/// # Errors
/// The unit failed, or left the finite numbers.
pub fn simulate(
    plant: &Bench,
    ports: &Ports,
    settings: &[Setting],
    drive: &Drive,
    state: &State,
    pushes: &[Push],
) -> Result<Vec<Row>, Error> {
    let real = |reference: u32, value: f64| (reference, orchestrator::Value::Real(value));
    let bias = settings.iter().rev().find(|(reference, _)| *reference == ports.bias);
    let bias = bias.and_then(|(_, value)| value.as_f64()).unwrap_or_else(|| plant.nominal(ports.bias));
    let second = &drive.events[drive.events.len().min(2) - 1];
    let first = Torques::between(&drive.events[0], second, ports.lines, pushes);
    let mut all = settings.to_vec();
    all.extend(ports.starts.iter().zip(state).map(|(reference, value)| real(*reference, *value)));
    all.extend(ports.inputs.iter().zip(first.inputs).map(|(reference, value)| real(*reference, value)));
    all.push(real(ports.bias, bias + first.joint));
    all.push(real(ports.before, ports.settling.before(plant, settings, drive)?));
    all.extend(ports.tolerance.map(|reference| real(reference, RESIDUAL.integrator)));
    // rows at which the links touch are not scored, and a trial state must not be held
    all.push(real(ports.contact, 1e9));
    plant.run(&all, drive.start(), |instance| {
        let rows = follow_drive(instance, ports, drive, (first, bias), pushes)?;
        if rows.iter().flatten().all(|value: &f64| value.is_finite()) {
            Ok(rows)
        } else {
            Err(Error::Model("the plant left the finite numbers".into()))
        }
    })
}

/// Steps an instance that has its start state and its first torques from event to event; `bias` is the actuator's own, N·m.
fn follow_drive(
    instance: &mut Instance,
    ports: &Ports,
    drive: &Drive,
    (first, bias): (Torques, f64),
    pushes: &[Push],
) -> Result<Vec<Row>, Error> {
    let failed = |error: orchestrator::Error| Error::Model(error.to_string());
    let row = |instance: &mut Instance, joint: f64| {
        let mut outputs: Row = [0.0; CHANNELS.len()];
        instance.get_real(&ports.outputs, &mut outputs).map_err(failed)?;
        outputs[MOTION] -= joint;
        Ok::<_, Error>(outputs)
    };
    let mut rows = Vec::new();
    let mut last = first;
    if drive.begins_wanted() {
        rows.push(row(instance, first.joint)?);
    }
    for pair in drive.events.windows(2) {
        let now = Torques::between(&pair[0], &pair[1], ports.lines, pushes);
        if now.inputs != last.inputs {
            instance.set_real(&ports.inputs, &now.inputs).map_err(failed)?;
        }
        if now.joint != last.joint {
            instance.set_real(&[ports.bias], &[bias + now.joint]).map_err(failed)?;
        }
        if ports.lines && pair[0].rates != [0.0; 2] {
            instance.set_input_derivatives(&ports.inputs, &[1, 1], &pair[0].rates).map_err(failed)?;
        }
        last = now;
        step(instance, pair[0].time, pair[1].time - pair[0].time)?;
        if pair[1].wanted {
            rows.push(row(instance, now.joint)?);
        }
        if rows.last().map(state_of).is_some_and(|[_, _, dq1, dq2]| dq1.abs().max(dq2.abs()) > ports.lost) {
            let wanted = drive.events.iter().filter(|event| event.wanted).count();
            rows.resize(wanted, rows[rows.len() - 1]);
            break;
        }
    }
    Ok(rows)
}

/// A motion on a grid, with cubic Hermite interpolation between.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Motion {
    /// Stretches in order of time, each with its times and states.
    pub stretches: Vec<(Vec<f64>, Vec<State>)>,
}

impl Motion {
    /// State at a time, if a stretch covers it.
    pub fn at(&self, time: f64) -> Option<State> {
        let place =
            self.stretches.partition_point(|(times, _)| times.last().is_some_and(|last| *last < time - 1e-9));
        let (times, states) = self.stretches.get(place)?;
        if times.is_empty() || time < times[0] - 1e-9 {
            return None;
        }
        let next = times.partition_point(|t| *t <= time).clamp(1, times.len().saturating_sub(1).max(1));
        if times.len() == 1 {
            return Some(states[0]);
        }
        Some(hermite(times[next - 1], &states[next - 1], times[next], &states[next], time))
    }
}

/// Cubic Hermite interpolation of angles between two states; the rates are those of the cubic.
fn hermite(t0: f64, a: &State, t1: f64, b: &State, time: f64) -> State {
    let h = t1 - t0;
    let s = (time - t0) / h;
    let mut state = [0.0; 4];
    for i in 0..2 {
        let (x0, x1, v0, v1) = (a[i], b[i], h * a[i + 2], h * b[i + 2]);
        let (c2, c3) = (3.0 * (x1 - x0) - 2.0 * v0 - v1, 2.0 * (x0 - x1) + v0 + v1);
        state[i] = x0 + s * (v0 + s * (c2 + s * c3));
        state[i + 2] = (v0 + s * (2.0 * c2 + s * 3.0 * c3)) / h;
    }
    state
}
