//! The nominal scenario with what was found switched on: parameters in their units, effects at ports in `signal_effects.fmu`
//! between the others. A unit alone gets its inputs from the log of the first run.

use super::study::Studied;
use crate::dynamics::machine::Role;
use crate::error::Error;
use crate::observe::{Hold, InputEffect, OutputEffect, Problem};
use orchestrator::{Scenario, Simulation, UnitPath};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The unit that stands between ports.
const SIGNAL_EFFECTS: &str = "signal_effects.fmu";
/// The file with the inputs of the first run, beside the scenario.
const INPUTS: &str = "inputs.csv";

/// Effects of one port: name of the parameter in the signal unit, and value.
type AtPort = BTreeMap<&'static str, f64>;

fn at_input(effect: InputEffect) -> &'static str {
    match effect {
        InputEffect::Gain => "gain",
        InputEffect::Bias => "bias",
        InputEffect::Delay => "delay",
        InputEffect::Lag => "lag",
        InputEffect::Saturation => "saturation",
        InputEffect::RateLimit => "rate_limit",
    }
}

fn at_output(effect: OutputEffect) -> &'static str {
    match effect {
        OutputEffect::Gain => "gain",
        OutputEffect::Offset => "bias",
        OutputEffect::Delay => "delay",
        OutputEffect::Lag => "lag",
        OutputEffect::Drift => "drift",
    }
}

/// Scenario text, and files that lie beside it.
///
/// # Errors
/// The scenario can't be built with these values.
pub fn amended(
    problem: &Problem,
    studied: &Studied,
    units: &UnitPath,
) -> Result<(String, Vec<(String, String)>), Error> {
    let failed = |error: orchestrator::Error| Error::Model(format!("amended scenario: {error}"));
    let machine = &studied.built.engine.machine;
    let mut scenario = problem.model.scenario.clone();
    let mut inputs: BTreeMap<usize, AtPort> = BTreeMap::new();
    let mut outputs: BTreeMap<usize, AtPort> = BTreeMap::new();
    for (parameter, value) in machine.parameters.iter().zip(&studied.fit.at.theta) {
        if *value == parameter.neutral {
            continue;
        }
        match parameter.role {
            Role::Unit(reference) => {
                let text = match reference.kind {
                    orchestrator::Kind::Boolean => (*value > 0.5).to_string(),
                    orchestrator::Kind::Integer => format!("{value:.0}"),
                    _ => format!("{value:?}"),
                };
                scenario.set(&parameter.name, &text).map_err(failed)?;
            }
            Role::Input(place, effect) => {
                inputs.entry(place).or_default().insert(at_input(effect), *value);
            }
            Role::Output(place, effect) => {
                outputs.entry(place).or_default().insert(at_output(effect), *value);
            }
        }
    }
    let alone = scenario.connections.is_empty() && scenario.sources.is_empty() && scenario.units.len() == 1;
    let mut attachments = Vec::new();
    let mut text = if alone {
        let path = &studied.fit.at.paths[0];
        for (state, value) in problem.states.iter().zip(path) {
            scenario.set(&state.name, &format!("{value:?}")).map_err(failed)?;
        }
        attachments.extend(logged(studied));
        let grid = &studied.built.engine.grids[0];
        scenario.set_stop(&format!("{:.6}", grid.span().max(1e-6))).map_err(failed)?;
        let mut text = Simulation::new(&scenario, units).map_err(failed)?.resolved();
        for (place, input) in machine.inputs.iter().enumerate() {
            let to =
                inputs.get(&place).map_or_else(|| input.name.clone(), |_| format!("{}.u", before(place)));
            let kind = if input.hold == Hold::Linear { "linear" } else { "hold" };
            let name = &input.name;
            let _ = write!(
                text,
                "\n[[sources]]\nto = \"{to}\"\nkind = \"csv\"\nfile = \"{INPUTS}\"\ncolumn = \"{name}\"\ninterpolation = \"{kind}\"\n"
            );
        }
        text
    } else {
        let mut rewired = rewired(scenario, machine, &inputs);
        rewired.origin.clone_from(&problem.model.scenario.origin);
        Simulation::new(&problem.model.scenario, units).map_err(failed)?;
        rewired_text(&rewired, units, &inputs)?
    };
    let interval = problem.model.scenario.units.iter().map(|unit| unit.interval.to_string()).next();
    let interval = interval.unwrap_or_else(|| "1".into());
    for (place, effects) in &inputs {
        let to = &machine.inputs[*place].name;
        let linear = machine.inputs[*place].hold == Hold::Linear;
        unit(&mut text, &before(*place), &interval, effects, linear);
        let _ = write!(text, "\n[[connections]]\nfrom = \"{}.y\"\nto = \"{to}\"\n", before(*place));
    }
    for (place, effects) in &outputs {
        let from = &machine.channels[*place].name;
        unit(&mut text, &behind(*place), &interval, effects, true);
        let _ = write!(text, "\n[[connections]]\nfrom = \"{from}\"\nto = \"{}.u\"\n", behind(*place));
    }
    Ok((text, attachments))
}

fn before(place: usize) -> String {
    format!("input_effects_{}", place + 1)
}

fn behind(place: usize) -> String {
    format!("output_effects_{}", place + 1)
}

fn unit(text: &mut String, name: &str, interval: &str, effects: &AtPort, linear: bool) {
    let _ = write!(
        text,
        "\n[[units]]\nname = \"{name}\"\nfmu = \"{SIGNAL_EFFECTS}\"\ninterval = \"{interval}\"\n[units.set]\nlinear = {linear}\n"
    );
    for (effect, value) in effects {
        let _ = writeln!(text, "{effect} = {value:?}");
    }
}

/// What fed an input with effects now feeds the unit before it.
fn rewired(
    mut scenario: Scenario,
    machine: &crate::dynamics::Machine,
    inputs: &BTreeMap<usize, AtPort>,
) -> Scenario {
    for place in inputs.keys() {
        let to = format!("{}.u", before(*place));
        let name = &machine.inputs[*place].name;
        scenario
            .connections
            .iter_mut()
            .filter(|link| link.to == *name)
            .for_each(|link| link.to.clone_from(&to));
        scenario
            .sources
            .iter_mut()
            .filter(|source| source.to == *name)
            .for_each(|source| source.to.clone_from(&to));
    }
    scenario
}

/// Text of a scenario whose rewired ports lead to units that are still to come.
fn rewired_text(
    scenario: &Scenario,
    units: &UnitPath,
    inputs: &BTreeMap<usize, AtPort>,
) -> Result<String, Error> {
    let failed = |error: orchestrator::Error| Error::Model(format!("amended scenario: {error}"));
    if inputs.is_empty() {
        return Ok(Simulation::new(scenario, units).map_err(failed)?.resolved());
    }
    let mut bare = scenario.clone();
    let is_new = |to: &str| inputs.keys().any(|place| to == format!("{}.u", before(*place)));
    let (links, sources): (Vec<_>, Vec<_>) = (
        bare.connections.iter().filter(|link| is_new(&link.to)).cloned().collect(),
        bare.sources.iter().filter(|source| is_new(&source.to)).cloned().collect(),
    );
    bare.connections.retain(|link| !is_new(&link.to));
    bare.sources.retain(|source| !is_new(&source.to));
    let mut text = Simulation::new(&bare, units).map_err(failed)?.resolved();
    for link in links {
        let _ = write!(text, "\n[[connections]]\nfrom = \"{}\"\nto = \"{}\"\n", link.from, link.to);
    }
    if let Some(source) = sources.first() {
        return Err(Error::Model(format!(
            "amended scenario: {} is fed by a source and has effects at its port",
            source.to
        )));
    }
    Ok(text)
}

/// The inputs of the first run as a table, time from its begin.
fn logged(studied: &Studied) -> Option<(String, String)> {
    let engine = &studied.built.engine;
    let grid = &engine.grids[0];
    if grid.inputs.is_empty() {
        return None;
    }
    let mut times: Vec<f64> = grid.inputs.iter().flat_map(|course| course.time.iter().copied()).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let mut text = String::from("time");
    engine.machine.inputs.iter().for_each(|input| text += &format!(",{}", input.name));
    for time in times {
        let _ = write!(text, "\n{:?}", time - grid.time[0]);
        for course in &grid.inputs {
            let place = course.time.partition_point(|t| *t <= time).saturating_sub(1);
            let _ = write!(text, ",{:?}", course.values[place]);
        }
    }
    text.push('\n');
    Some((INPUTS.into(), text))
}
