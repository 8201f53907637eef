//! `acroscope params`: what can be set in a scenario, from the units' own descriptions.

use crate::cli::Params;
use crate::error::Error;
use orchestrator::fmu::{Causality, Description, Initial, Variability, Variable};
use orchestrator::scenario::{Given, UnitEntry};
use orchestrator::{Scenario, Simulation};
use serde::Serialize;

/// One thing that can be set.
#[derive(Debug, Serialize)]
struct Parameter {
    /// `unit.variable`
    name: String,
    /// Its value in the scenario.
    value: String,
    /// The unit's own start value: for an effect the one at which it vanishes.
    neutral: String,
    /// Physical unit; empty: none.
    unit: String,
    /// Smallest and largest legal value.
    min: Option<f64>,
    max: Option<f64>,
    /// One sentence.
    description: String,
}

/// Prints the list.
pub fn params(arguments: &Params) -> Result<(), Error> {
    let mut scenario = scenarios::load(&arguments.scenario)?;
    arguments.called.look_out();
    for unit in &mut scenario.units {
        unit.isolation = unit.isolation.take().or_else(|| arguments.called.isolation());
    }
    let simulation = Simulation::new(&scenario, &scenarios::unit_path())?;
    let mut found: Vec<Parameter> = (simulation.units().zip(&scenario.units))
        .flat_map(|((_, description), entry)| of_unit(&scenario, entry, description))
        .collect();
    let beginnings = &arguments.beginnings;
    let is_known = |beginning: &str| found.iter().any(|parameter| parameter.name.starts_with(beginning));
    if let Some(unknown) = beginnings.iter().find(|beginning| !is_known(beginning)) {
        let units = scenario.units.iter().map(|unit| unit.name.as_str());
        let names = units.chain(found.iter().map(|parameter| parameter.name.as_str()));
        let hint = orchestrator::suggest::nearest(unknown, names);
        return Err(Error::words(format!("nothing that can be set begins with {unknown:?}: {hint}")));
    }
    found.retain(|parameter| {
        beginnings.is_empty() || beginnings.iter().any(|beginning| parameter.name.starts_with(beginning))
    });
    if arguments.json {
        // Texts and numbers only: nothing can fail.
        tell!("{}", serde_json::to_string_pretty(&found).unwrap_or_default());
        return Ok(());
    }
    let rows = found.iter().map(|parameter| {
        let range = range(parameter.min, parameter.max);
        [
            &parameter.name,
            &parameter.value,
            &parameter.unit,
            &range,
            &parameter.neutral,
            &parameter.description,
        ]
        .map(ToOwned::to_owned)
    });
    let head = ["NAME", "VALUE", "UNIT", "RANGE", "NEUTRAL", "MEANING"].map(str::to_owned);
    table(std::iter::once(head).chain(rows).collect());
    Ok(())
}

fn of_unit(scenario: &Scenario, entry: &UnitEntry, description: &Description) -> Vec<Parameter> {
    let driven = |variable: &Variable| {
        let name = format!("{}.{}", entry.name, variable.name);
        let by_connection = scenario.connections.iter().any(|connection| connection.to == name);
        by_connection || scenario.sources.iter().any(|source| source.to == name)
    };
    let settable = description.variables.iter().filter(|variable| match variable.causality {
        Causality::Parameter => variable.variability != Variability::Constant,
        Causality::Input => !driven(variable),
        Causality::Local | Causality::Output => {
            variable.initial == Some(Initial::Exact) && variable.variability != Variability::Constant
        }
        _ => false,
    });
    settable
        .map(|variable| {
            let neutral = variable.start.as_ref().map(ToString::to_string).unwrap_or_default();
            let set = entry.set.iter().find(|(name, _)| *name == variable.name);
            let value = set.map(|(_, given)| match &given.value {
                Given::Toml(value) => value.to_string(),
                Given::Text(text) => text.clone(),
            });
            Parameter {
                name: format!("{}.{}", entry.name, variable.name),
                value: value.unwrap_or_else(|| neutral.clone()),
                neutral,
                unit: variable.unit.clone().filter(|unit| unit != "1").unwrap_or_default(),
                min: variable.min,
                max: variable.max,
                description: variable.description.clone(),
            }
        })
        .collect()
}

fn range(min: Option<f64>, max: Option<f64>) -> String {
    match (min, max) {
        (None, None) => "any".to_owned(),
        (Some(min), None) => format!("{min} or more"),
        (None, Some(max)) => format!("{max} or less"),
        (Some(min), Some(max)) => format!("{min} to {max}"),
    }
}

/// Prints columns as wide as their widest cell; the last one as it is.
fn table(rows: Vec<[String; 6]>) {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths = [0, 1, 2, 3, 4].map(width);
    for row in &rows {
        let cells = row.iter().zip(widths).map(|(cell, width)| format!("{cell:width$}"));
        let line = cells.chain([row[5].clone()]).collect::<Vec<_>>().join("  ");
        tell!("{}", line.trim_end());
    }
}
