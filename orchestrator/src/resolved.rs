//! What a run uses, written down so that it can be done again.

use crate::fmu::{Causality, Initial, Variability};
use crate::package;
use crate::scenario::write::ResolvedUnit;
use crate::simulation::Simulation;
use crate::value::Value;
use crate::wiring::Variable;
use std::collections::HashMap;

impl Simulation {
    /// The scenario with every value that a run from here on uses, as TOML: loaded again with the same unit path it
    /// gives the same run.
    pub fn resolved(&self) -> String {
        let unit = |unit: usize| {
            let entry = &self.scenario.units[unit];
            let file = &self.wiring.files[unit];
            // A file of the unit path is found again by its name, another one only by its full path.
            let fmu = match package::split(&entry.fmu.value) {
                Some((package, inside)) => {
                    let package = self.scenario.folder().join(package);
                    format!("{}#{inside}", package.canonicalize().unwrap_or(package).display())
                }
                None if self.from_unit_path[unit] => entry.fmu.value.clone(),
                None => file.canonicalize().unwrap_or_else(|_| file.clone()).to_string_lossy().into_owned(),
            };
            ResolvedUnit { fmu, values: self.used_values(unit) }
        };
        let units: Vec<ResolvedUnit> = (0..self.scenario.units.len()).map(unit).collect();
        crate::scenario::resolved(&self.scenario, &units)
    }

    /// All parameters and everything that was set, in the order of the description.
    pub(crate) fn used_values(&self, unit: usize) -> Vec<(String, Value)> {
        let description = self.wiring.names.units[unit].1.description();
        let sets: HashMap<usize, &Value> =
            self.wiring.sets[unit].iter().map(|(place, value)| (*place, value)).collect();
        let used = |place: usize| -> Option<(String, Value)> {
            let variable: Variable = (unit, place);
            let description = self.wiring.names.variable(variable);
            let is_parameter = description.causality == Causality::Parameter
                && description.initial == Some(Initial::Exact)
                && description.variability != Variability::Constant;
            let is_free_input =
                description.causality == Causality::Input && !self.wiring.driven.contains_key(&variable);
            let start = if is_parameter || is_free_input { description.start.as_ref() } else { None };
            sets.get(&place).copied().or(start).map(|value| (description.name.clone(), value.clone()))
        };
        (0..description.variables.len()).filter_map(used).collect()
    }
}
