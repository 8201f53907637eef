//! The graphs of a scenario that asks for none: the outputs of each unit of the scenario, those of one physical unit
//! together, so that each graph has a scale.

use super::layout::{GraphEntry, LineEntry, LineStyle};
use orchestrator::fmu::Causality;
use orchestrator::{Kind, Simulation};
use std::collections::BTreeSet;

/// Lines of a graph, and graphs of a page, at most: beyond, nobody tells the lines apart or finds the graph.
const LINES: usize = 6;
const GRAPHS: usize = 24;

/// The graphs, and how many more there would be.
pub fn graphs(simulation: &Simulation) -> (Vec<GraphEntry>, usize) {
    let recorded: BTreeSet<&str> = simulation.columns().iter().map(|column| column.name.as_str()).collect();
    let mut graphs = Vec::new();
    for (unit, description) in simulation.units() {
        // In the order in which the description names the first of each.
        let mut groups: Vec<(String, Vec<String>)> = Vec::new();
        let outputs = description.variables.iter().filter(|variable| {
            variable.causality == Causality::Output
                && variable.kind != Kind::String
                && recorded.contains(format!("{unit}.{}", variable.name).as_str())
        });
        for variable in outputs {
            let group = match (variable.kind, &variable.unit) {
                (Kind::Real, Some(unit)) => unit.clone(),
                (Kind::Real, None) => "no unit".to_owned(),
                (kind, _) => kind.to_string(),
            };
            match groups.iter_mut().find(|(known, _)| *known == group) {
                Some((_, names)) => names.push(variable.name.clone()),
                None => groups.push((group, vec![variable.name.clone()])),
            }
        }
        for (group, names) in groups {
            graphs.extend(names.chunks(LINES).map(|names| graph(unit, &group, names)));
        }
    }
    let more = graphs.len().saturating_sub(GRAPHS);
    graphs.truncate(GRAPHS);
    (graphs, more)
}

fn graph(unit: &str, group: &str, names: &[String]) -> GraphEntry {
    let line = |name: &String| LineEntry {
        signal: format!("{unit}.{name}"),
        minus: None,
        label: name.clone(),
        style: LineStyle::Solid,
    };
    GraphEntry {
        title: format!("Outputs of {unit}, {}", if group == "1" { "no unit" } else { group }),
        y: if group == "1" { String::new() } else { group.to_owned() },
        lines: names.iter().map(line).collect(),
    }
}
