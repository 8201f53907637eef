//! What the outside sees: the scenario's free inputs, what it records, and its parameters, each called `unit.variable`.

use orchestrator::fmu::{self, Causality, Description, Initial, Variability};
use orchestrator::{Column, Kind, Simulation, Value};
use std::collections::{BTreeMap, BTreeSet};

/// One variable. Its place in the list is its value reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// `unit.variable`, or `unit.variable:age`.
    pub name: String,
    /// Type.
    pub kind: Kind,
    /// Input, output, parameter or local.
    pub causality: Causality,
    /// As the unit inside has it.
    pub variability: Variability,
    /// Of inputs and parameters.
    pub start: Option<Value>,
    /// Name of the physical unit.
    pub unit: Option<String>,
    /// Smallest legal value.
    pub min: Option<f64>,
    /// Largest legal value.
    pub max: Option<f64>,
    /// One sentence.
    pub description: String,
}

/// All that the outside sees.
#[derive(Debug, Clone, PartialEq)]
pub struct Interface {
    /// In the order of their value references.
    pub variables: Vec<Variable>,
    /// Physical units.
    pub(crate) units: BTreeMap<String, Option<fmu::BaseUnit>>,
    /// Every unit inside can save its state.
    pub(crate) saves: bool,
}

impl Interface {
    /// That of a built scenario.
    pub fn of(simulation: &Simulation) -> Self {
        let described: Vec<(&str, &Description)> = simulation.units().collect();
        let given = simulation.used();
        let mut interface = Self { variables: Vec::new(), units: BTreeMap::new(), saves: true };
        let mut names = BTreeSet::new();
        for ((unit, description), given) in described.iter().zip(&given) {
            let flags = &description.co_simulation;
            interface.saves &= flags.can_get_and_set_state && flags.can_serialize_state;
            for variable in &description.variables {
                let name = format!("{unit}.{}", variable.name);
                if !is_offered(simulation, variable, &name)
                    || description.is_ambiguous(&variable.name)
                    || !names.insert(name.clone())
                {
                    continue;
                }
                let used = given.iter().find(|(known, _)| *known == variable.name);
                let start = used.map(|(_, value)| value.clone()).or_else(|| variable.start.clone());
                let unit = interface.unit(description, variable);
                interface.variables.push(Variable { start, ..of(variable, name, unit) });
            }
        }
        for column in simulation.columns() {
            if names.insert(column.name.clone()) {
                let variable = interface.recorded(&described, column);
                interface.variables.push(variable);
            }
        }
        interface
    }

    /// A recorded value as an output, or as a local variable where the unit inside has it as such.
    fn recorded(&mut self, described: &[(&str, &Description)], column: &Column) -> Variable {
        let found = described.iter().find_map(|(unit, description)| {
            let variable = column.name.strip_prefix(unit)?.strip_prefix('.')?;
            Some((*description, description.variable(variable)?))
        });
        match found {
            Some((description, variable)) => {
                let unit = self.unit(description, variable);
                let causality = match variable.causality {
                    Causality::Output => Causality::Output,
                    _ => Causality::Local,
                };
                Variable { causality, ..of(variable, column.name.clone(), unit) }
            }
            // No unit's own: the age of a connected value.
            None => Variable {
                name: column.name.clone(),
                kind: column.kind,
                causality: Causality::Output,
                variability: Variability::Continuous,
                start: None,
                unit: None,
                min: None,
                max: None,
                description: "How old the connected value is, in s.".to_owned(),
            },
        }
    }

    /// The name of a variable's physical unit; none where two units mean different things by it.
    fn unit(&mut self, description: &Description, variable: &fmu::Variable) -> Option<String> {
        let name = variable.unit.as_deref().filter(|name| !name.is_empty())?;
        let base = description.unit(name)?.base;
        let known = self.units.entry(name.to_owned()).or_insert(base);
        (*known == base).then(|| name.to_owned())
    }
}

/// Whether the outside may set a variable: an input that nothing drives, or a parameter with a start value of its own.
fn is_offered(simulation: &Simulation, variable: &fmu::Variable, name: &str) -> bool {
    match variable.causality {
        Causality::Input => !simulation.is_driven(name),
        Causality::Parameter => {
            variable.initial == Some(Initial::Exact) && variable.variability != Variability::Constant
        }
        _ => false,
    }
}

fn of(variable: &fmu::Variable, name: String, unit: Option<String>) -> Variable {
    Variable {
        name,
        kind: variable.kind,
        causality: variable.causality,
        variability: variable.variability,
        start: None,
        unit,
        min: variable.min,
        max: variable.max,
        description: variable.description.clone(),
    }
}
