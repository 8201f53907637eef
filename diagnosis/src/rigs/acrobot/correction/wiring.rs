//! The residual unit in a scenario: put between the plant's state and its external torques, or taken out again.

use super::Correction;
use super::dictionary::UNIT;
use orchestrator::Place;
use orchestrator::scenario::{Channel, ConnectionEntry, Given, Placed, Scenario, Transform, UnitEntry};
use orchestrator::time::Rational;

/// Name of the unit in a scenario, if no other has it.
const NAME: &str = "residual";
const STATE: [&str; 4] = ["q1", "q2", "dq1", "dq2"];
const TORQUES: [&str; 2] = ["tau_1", "tau_2"];

/// A name that no unit of the scenario has.
pub fn free_name(scenario: &Scenario) -> String {
    let taken = |name: &String| scenario.units.iter().any(|unit| unit.name == *name);
    let numbered = (2..).map(|number| format!("{NAME}_{number}"));
    std::iter::once(NAME.to_owned()).chain(numbered).find(|name| !taken(name)).unwrap_or_default()
}

/// Puts the residual unit behind the plant. What drove the plant's external torques before passes through it.
pub fn insert(scenario: &mut Scenario, correction: &Correction) {
    let here = || Place::Override("the correction".into());
    let name = &correction.unit;
    let Some(at) = scenario.units.iter().position(|unit| unit.name == "plant") else { return };
    let set = correction.parameters.iter().map(|(name, value)| {
        let value = Given::Toml(toml::Value::Float(*value));
        (name.clone(), Placed { value, place: here() })
    });
    let unit = UnitEntry {
        name: name.clone(),
        fmu: Placed { value: UNIT.into(), place: here() },
        // the plant's own: torques are held for one of its steps
        interval: scenario.units[at].interval,
        offset: scenario.units[at].offset.clone(),
        retry: false,
        isolation: None,
        set: set.collect(),
        place: here(),
    };
    scenario.units.insert(at + 1, unit);
    for torque in TORQUES {
        let (to, through) = (format!("plant.{torque}"), format!("{name}.{torque}_in"));
        let driven = scenario.connections.iter_mut().map(|entry| &mut entry.to);
        driven.chain(scenario.sources.iter_mut().map(|entry| &mut entry.to)).for_each(|target| {
            if *target == to {
                target.clone_from(&through);
            }
        });
    }
    let mut connect = |from: String, to: String| {
        let (delay, channel, transform) = (Rational::ZERO, Channel::default(), Transform::default());
        scenario.connections.push(ConnectionEntry {
            from,
            to,
            delay,
            channel,
            transform,
            map: Vec::new(),
            place: here(),
        });
    };
    STATE.iter().for_each(|variable| connect(format!("plant.{variable}"), format!("{name}.{variable}")));
    TORQUES.iter().for_each(|variable| connect(format!("{name}.{variable}"), format!("plant.{variable}")));
    draw(scenario, name);
}

/// A graph of the correction for the run's report.
fn draw(scenario: &mut Scenario, name: &str) {
    let Some(toml::Value::Array(graphs)) = scenario.report.get_mut("graphs") else { return };
    let line = |signal: &str, label: &str, style: &str| {
        let pairs =
            [("signal", format!("{name}.{signal}")), ("label", label.into()), ("style", style.into())];
        toml::Value::Table(
            pairs.map(|(key, text)| (key.to_owned(), toml::Value::String(text))).into_iter().collect(),
        )
    };
    let mut graph = toml::Table::new();
    graph.insert("title".into(), toml::Value::String("Correction of a residual without a name".into()));
    graph.insert("y".into(), toml::Value::String("τ in N·m".into()));
    let lines = vec![line("roll", "on link 1", "dashed"), line("joint", "at the joint", "solid")];
    graph.insert("lines".into(), toml::Value::Array(lines));
    graphs.push(toml::Value::Table(graph));
}

/// Takes residual units out, with their connections: a diagnosis compares the plant alone, and fits a correction anew.
/// Answers the names of the units.
pub fn strip(scenario: &mut Scenario) -> Vec<String> {
    let is_residual = |unit: &UnitEntry| unit.fmu.value.ends_with(UNIT);
    let names: Vec<String> =
        scenario.units.iter().filter(|unit| is_residual(unit)).map(|unit| unit.name.clone()).collect();
    for name in &names {
        let own = |variable: &str| variable.split_once('.').is_some_and(|(unit, _)| unit == name);
        for torque in TORQUES {
            let (from, through) = (format!("{name}.{torque}"), format!("{name}.{torque}_in"));
            let fed: Option<String> =
                scenario.connections.iter().find(|entry| entry.from == from).map(|entry| entry.to.clone());
            let Some(fed) = fed else { continue };
            let driven = scenario.connections.iter_mut().map(|entry| &mut entry.to);
            driven.chain(scenario.sources.iter_mut().map(|entry| &mut entry.to)).for_each(|target| {
                if *target == through {
                    target.clone_from(&fed);
                }
            });
        }
        scenario.connections.retain(|entry| !own(&entry.from) && !own(&entry.to));
        scenario.sources.retain(|entry| !own(&entry.to));
        scenario.units.retain(|unit| unit.name != *name);
        if let Some(record) = &mut scenario.record {
            record.retain(|pattern| !own(&pattern.value));
        }
        if let Some(toml::Value::Array(graphs)) = scenario.report.get_mut("graphs") {
            graphs.retain(|graph| !graph.to_string().contains(&format!("\"{name}.")));
        }
    }
    names
}
