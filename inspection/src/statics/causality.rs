//! Which causality, variability and initial go together (the tables of FMI 2.0.4 section 2.2.7).

use crate::finding::Found;
use crate::model::{self, Model, Variable};
use orchestrator::Kind;
use orchestrator::fmu::{Causality, Initial, Variability};

/// The legal initials of a combination; `None`: the combination itself is not legal.
fn initials(causality: Causality, variability: Variability) -> Option<&'static [Initial]> {
    use Causality::{CalculatedParameter, Independent, Input, Local, Output, Parameter};
    use Variability::{Constant, Continuous, Discrete, Fixed, Tunable};
    Some(match (causality, variability) {
        (Parameter, Fixed | Tunable) | (Output | Local, Constant) => &[Initial::Exact],
        (CalculatedParameter | Local, Fixed | Tunable) => &[Initial::Calculated, Initial::Approx],
        (Output | Local, Discrete | Continuous) => &[Initial::Calculated, Initial::Exact, Initial::Approx],
        (Input, Discrete | Continuous) | (Independent, Continuous) => &[],
        _ => return None,
    })
}

/// The variabilities that go with a causality.
fn variabilities(causality: Causality) -> String {
    let all = [
        Variability::Constant,
        Variability::Fixed,
        Variability::Tunable,
        Variability::Discrete,
        Variability::Continuous,
    ];
    let legal = all.into_iter().filter(|variability| initials(causality, *variability).is_some());
    legal.map(model::variability).collect::<Vec<_>>().join(", ")
}

pub(super) fn variability(model: &Model<'_>, found: &mut Found) {
    for variable in &model.variables {
        let (causality, variability) = (variable.causality, variable.variability);
        if variability == Variability::Continuous && variable.kind != Kind::Real {
            let sort = &variable.typed.name;
            found.error_of(variable, format!("it is of type {sort} and continuous: only a Real is"));
        } else if initials(causality, variability).is_none() {
            let what = format!(
                "causality=\"{}\" with variability=\"{}\": legal are {}",
                model::causality(causality),
                model::variability(variability),
                variabilities(causality)
            );
            found.error_of(variable, what);
        }
    }
}

pub(super) fn initial(model: &Model<'_>, found: &mut Found) {
    for variable in &model.variables {
        let Some(given) = variable.initial else { continue };
        let Some(legal) = initials(variable.causality, variable.variability) else { continue };
        if legal.contains(&given) {
            continue;
        }
        let names: Vec<&str> = legal.iter().map(|initial| model::initial(*initial)).collect();
        let expected = if names.is_empty() {
            "none is to be given".into()
        } else {
            format!("legal are {}", names.join(", "))
        };
        let what = format!(
            "initial=\"{}\" with causality=\"{}\" and variability=\"{}\": {expected}",
            model::initial(given),
            model::causality(variable.causality),
            model::variability(variable.variability)
        );
        found.error_of(variable, what);
    }
}

pub(super) fn independent(model: &Model<'_>, found: &mut Found) {
    let mut times = model.variables.iter().filter(|variable| variable.causality == Causality::Independent);
    let Some(first) = times.next() else { return };
    if first.kind != Kind::Real {
        found.error_of(first, format!("the independent variable is of type {}, not Real", first.typed.name));
    }
    for other in times {
        found.error_of(other, format!("a second independent variable; the first is {}", first.name));
    }
}

pub(super) fn derivative(model: &Model<'_>, found: &mut Found) {
    for variable in &model.variables {
        let Some(index) = variable.typed.attribute("derivative") else { continue };
        if !model.has(index) {
            let count = model.count();
            found.error_of(
                variable,
                format!("derivative=\"{index}\" is no index of a variable: 1 to {count}"),
            );
            continue;
        }
        let Some(state) = model.state_of(variable) else { continue };
        let state = &model.variables[state];
        if std::ptr::eq(state, variable) {
            found.error_of(variable, "it is said to be its own derivative");
        }
        for (one, what) in [(variable, "a derivative"), (state, "a state")] {
            if one.variability != Variability::Continuous && one.kind == Kind::Real {
                let variability = model::variability(one.variability);
                report(found, one, &format!("{what} is continuous, not {variability}"));
            }
        }
        if state.kind != Kind::Real {
            found.error_of(variable, format!("it is the derivative of {}, which is no Real", state.name));
        }
    }
}

/// A state has as many derivatives as orders; it is told once.
fn report(found: &mut Found, variable: &Variable<'_>, text: &str) {
    let before = found.findings.len();
    found.error_of(variable, text);
    let (said, last) = found.findings.split_at(before);
    if said.contains(&last[0]) {
        found.findings.truncate(before);
    }
}
