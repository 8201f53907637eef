//! Limits and start values (FMI 2.0.4 sections 2.2.3 and 2.2.7).

use crate::finding::Found;
use crate::model::{self, Model, Variable, number};
use orchestrator::fmu::{Causality, Initial, Variability};

pub(super) fn min_max(model: &Model<'_>, found: &mut Found) {
    for defined in model.root.list("TypeDefinitions", "SimpleType") {
        for typed in &defined.children {
            let limit = |name: &str| typed.attribute(name).and_then(number);
            if let (Some(min), Some(max)) = (limit("min"), limit("max"))
                && min > max
            {
                let name = defined.attribute("name").unwrap_or_default();
                found.error_at(defined.line, format!("type {name}: min {min} is above max {max}"));
            }
        }
    }
    for variable in &model.variables {
        let own = ["min", "max"].map(|name| variable.typed.attribute(name));
        if own == [None, None] {
            continue;
        }
        if let (Some(min), Some(max)) = (variable.number("min"), variable.number("max"))
            && min > max
        {
            found.error_of(variable, format!("min {min} is above max {max}"));
        }
    }
}

pub(super) fn start_range(model: &Model<'_>, found: &mut Found) {
    for variable in &model.variables {
        let numeric = matches!(variable.typed.name.as_str(), "Real" | "Integer" | "Enumeration");
        let Some(start) = variable.start().filter(|_| numeric).and_then(number) else { continue };
        if !start.is_finite() {
            found.warning_of(variable, format!("its start value is {start}: not every master can set that"));
        }
        match (variable.number("min"), variable.number("max")) {
            (Some(min), _) if start < min => {
                found.error_of(variable, format!("its start value {start} is below its min {min}"));
            }
            (_, Some(max)) if start > max => {
                found.error_of(variable, format!("its start value {start} is above its max {max}"));
            }
            _ => {}
        }
        let items = variable.items();
        if !items.is_empty() && !items.iter().any(|(_, value)| value.map(f64::from) == Some(start)) {
            let known: Vec<String> =
                items.iter().map(|(name, value)| format!("{name} ({})", value.unwrap_or_default())).collect();
            found.error_of(
                variable,
                format!("its start value {start} is no item: one of {}", known.join(", ")),
            );
        }
    }
}

pub(super) fn start_missing(model: &Model<'_>, found: &mut Found) {
    for variable in model.variables.iter().filter(|variable| variable.start().is_none()) {
        let by_initial = matches!(variable.initial(), Some(Initial::Exact | Initial::Approx));
        if by_initial || variable.causality == Causality::Input {
            found.error_of(variable, format!("it has no start value, which {} needs", why(variable)));
        }
    }
}

/// What of a variable asks for a start value.
fn why(variable: &Variable<'_>) -> String {
    match (variable.causality, variable.variability, variable.initial) {
        (causality @ (Causality::Input | Causality::Parameter), ..) => {
            format!("causality=\"{}\"", model::causality(causality))
        }
        (_, Variability::Constant, _) => "variability=\"constant\"".to_owned(),
        (_, _, initial) => format!("initial=\"{}\"", initial.map_or("exact", model::initial)),
    }
}

pub(super) fn start_superfluous(model: &Model<'_>, found: &mut Found) {
    for variable in model.variables.iter().filter(|variable| variable.start().is_some()) {
        if variable.causality == Causality::Independent {
            found.error_of(variable, "the independent variable has a start value, which the master gives");
        } else if variable.initial() == Some(Initial::Calculated) {
            let by = match variable.initial {
                Some(_) => "initial=\"calculated\"",
                None => "initial=\"calculated\", the default of its causality and variability,",
            };
            found.error_of(variable, format!("{by} goes with no start value"));
        }
    }
}

pub(super) fn nominal(model: &Model<'_>, found: &mut Found) {
    for variable in &model.variables {
        let Some(nominal) = variable.number("nominal") else { continue };
        if !(nominal > 0.0 && nominal.is_finite()) {
            found.warning_of(
                variable,
                format!("nominal {nominal}: tolerances are scaled by it, so it is above 0"),
            );
        }
    }
}
