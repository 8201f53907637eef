//! Latencies as units, for masters that know none: each connection with a latency leads through a `signal_effects` that does
//! nothing but delay. What is left to chance, and what is no Real, stays in our annotation alone.

use orchestrator::fmu::BaseUnit;
use orchestrator::scenario::{Channel, ConnectionEntry, Given, Placed, Scenario, Transform, UnitEntry};
use orchestrator::{Kind, Place, Simulation};
use std::collections::BTreeMap;

/// The unit that delays.
pub const DELAY_UNIT: &str = "signal_effects.fmu";

/// The scenario with units in place of latencies, and what could not be replaced, a line each. A unit takes the value of its
/// sender at the start for what came before; here an input keeps its start value instead.
pub fn with_delay_units(simulation: &Simulation) -> (Scenario, Vec<String>) {
    let mut scenario = simulation.scenario().clone();
    let mut notes = Vec::new();
    let connections = std::mem::take(&mut scenario.connections);
    for entry in connections {
        if !entry.delay.is_positive() {
            scenario.connections.push(entry);
            continue;
        }
        match ends(simulation, &entry) {
            Ok(ends) => insert(&mut scenario, entry, ends),
            Err(why) => {
                let (from, to) = (&entry.from, &entry.to);
                notes.push(format!("{from} -> {to}: its latency stays an annotation of ours, since {why}"));
                scenario.connections.push(entry);
            }
        }
    }
    (scenario, notes)
}

/// Both units' places, and what makes a number of the output one of the input by their physical units.
struct Ends {
    from: usize,
    to: usize,
    gain: f64,
    bias: f64,
}

fn ends(simulation: &Simulation, entry: &ConnectionEntry) -> Result<Ends, &'static str> {
    if entry.channel != Channel::default() {
        return Err("jitter, losses and holds are no unit's business");
    }
    let units: Vec<_> = simulation.units().collect();
    let end = |full: &str| {
        let (unit, variable) = full.split_once('.')?;
        let place = units.iter().position(|(name, _)| *name == unit)?;
        let description = units[place].1;
        let variable = description.variable(variable)?;
        let base = variable.unit.as_deref().and_then(|unit| description.unit(unit)?.base);
        Some((place, variable.kind, base, variable.relative_quantity))
    };
    // A name that there is not could not have been built.
    let (Some(from), Some(to)) = (end(&entry.from), end(&entry.to)) else { return Err("it has no ends") };
    if (from.1, to.1) != (Kind::Real, Kind::Real) {
        return Err("only Reals are delayed by a unit");
    }
    let (gain, bias) = match (entry.transform.convert_units, from.2, to.2) {
        (true, Some(of), Some(into)) => converted(of, into, from.3 && to.3),
        _ => (1.0, 0.0),
    };
    Ok(Ends { from: from.0, to: to.0, gain, bias })
}

fn converted(from: BaseUnit, to: BaseUnit, difference: bool) -> (f64, f64) {
    (from.factor / to.factor, if difference { 0.0 } else { (from.offset - to.offset) / to.factor })
}

fn insert(scenario: &mut Scenario, entry: ConnectionEntry, ends: Ends) {
    let taken: BTreeMap<&str, usize> =
        scenario.units.iter().enumerate().map(|(at, unit)| (unit.name.as_str(), at)).collect();
    let mut names = (1..).map(|number| format!("delay_{number}"));
    let name = names.find(|name| !taken.contains_key(name.as_str())).unwrap_or_default();
    let here = || Place::Override("a unit in place of a latency".into());
    // Its steps are as fine as the finer of both ends: what it hands on is then no older than it must be.
    let interval = scenario.units[ends.from].interval.min(scenario.units[ends.to].interval);
    let delay = Given::Toml(toml::Value::Float(entry.delay.to_f64()));
    scenario.units.push(UnitEntry {
        name: name.clone(),
        fmu: Placed { value: DELAY_UNIT.into(), place: here() },
        interval,
        offset: None,
        retry: false,
        isolation: None,
        set: vec![("delay".into(), Placed { value: delay, place: here() })],
        place: here(),
    });
    let Transform { gain, bias, .. } = entry.transform;
    // The unit has no physical unit: numbers are those of the input by then.
    let transform = Transform { gain: gain * ends.gain, bias: gain * ends.bias + bias, convert_units: false };
    let zero = orchestrator::time::Rational::ZERO;
    let plain = |from: String, to: String, transform: Transform, place: Place| ConnectionEntry {
        from,
        to,
        delay: zero,
        channel: Channel::default(),
        transform,
        map: Vec::new(),
        place,
    };
    let place = entry.place.clone();
    scenario.connections.push(plain(entry.from, format!("{name}.u"), transform, place.clone()));
    let untouched = Transform { convert_units: false, ..Transform::default() };
    scenario.connections.push(plain(format!("{name}.y"), entry.to, untouched, place));
}
