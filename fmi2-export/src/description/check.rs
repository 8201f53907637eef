//! Mistakes in a declaration that no compiler sees. The packer refuses a unit that has any.

use super::{Unit, derivative};
use crate::model::Dependencies;
use crate::table::{Causality, Kind};

impl Unit {
    /// One sentence for each mistake.
    pub fn mistakes(&self) -> Vec<String> {
        let mut found = Vec::new();
        self.check_head(&mut found);
        for (at, variable) in self.variables.iter().enumerate() {
            let name = variable.name;
            if self.place(name) != Some(at) {
                found.push(format!("variable {name} is declared twice"));
            }
            if name.is_empty() || name.chars().any(|c| c.is_control()) {
                found.push(format!("variable {name:?}: not a legal name"));
            }
            self.check_start(at, &mut found);
            let measure = &variable.unit;
            let factors = measure.display.iter().map(|(name, factor)| (*name, *factor));
            for (unit, factor) in std::iter::once((measure.name, measure.factor)).chain(factors) {
                if !factor.is_normal() {
                    found.push(format!("variable {name}: unit {unit:?} with factor {factor}: a finite number other than 0 is needed"));
                }
            }
            if let Some(of) = variable.derivative_of {
                let state = self.place(of).map(|place| &self.variables[place].kind);
                if !matches!((&variable.kind, state), (Kind::Real(_), Some(Kind::Real(_)))) {
                    found.push(format!("variable {name}: it or {of}, whose derivative it is, is no Real"));
                }
            }
            if self.is_in_a_circle(name) {
                found.push(format!(
                    "variable {name}: a derivative of its own, whose derivatives go in a circle"
                ));
            }
            if variable.causality == Causality::Output {
                self.check_dependencies(name, (self.dependencies)(name), &mut found);
            }
        }
        found
    }

    /// Whether this variable is a derivative of itself, of whatever order.
    fn is_in_a_circle(&self, name: &str) -> bool {
        let place = self.place(name);
        (1..=self.variables.len())
            .any(|order| derivative(&self.variables, name, order).is_some_and(|of| Some(of) == place))
    }

    fn check_head(&self, found: &mut Vec<String>) {
        let head = &self.head;
        let legal = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let starts_well = head.identifier.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        if !starts_well || !head.identifier.chars().all(legal) {
            found.push(format!("identifier {:?}: a C name is needed", head.identifier));
        }
        if !(head.stop_time > 0.0 && head.step_size > 0.0) {
            found.push("stop_time and step_size: positive numbers are needed".to_owned());
        }
    }

    fn check_start(&self, at: usize, found: &mut Vec<String>) {
        let variable = &self.variables[at];
        let start = match variable.kind {
            Kind::Real(value) => value,
            Kind::Integer(value) => f64::from(value),
            Kind::Boolean(_) | Kind::String(_) => return,
        };
        let below = variable.min.is_some_and(|min| start < min);
        let above = variable.max.is_some_and(|max| start > max);
        if !start.is_finite() {
            found.push(format!("variable {}: start value {start} is not a finite number", variable.name));
        } else if below || above {
            found.push(format!(
                "variable {}: start value {start} is not {}",
                variable.name,
                variable.range()
            ));
        }
    }

    fn check_dependencies(&self, output: &str, dependencies: Dependencies, found: &mut Vec<String>) {
        let names = dependencies.while_stepping.iter().chain(dependencies.at_start.unwrap_or_default());
        for name in names {
            match self.place(name) {
                None => found.push(format!("output {output} depends on {name}, which is not declared")),
                Some(_) if *name == output => found.push(format!("output {output} depends on itself")),
                Some(_) => {}
            }
        }
        for name in dependencies.at_start.unwrap_or_default() {
            let place = self.place(name);
            let causality = place.map(|place| self.variables[place].causality);
            if matches!(causality, Some(Causality::Output | Causality::Local)) {
                found.push(format!(
                    "output {output} depends at the start on {name}, which has no start value"
                ));
            }
        }
    }
}
