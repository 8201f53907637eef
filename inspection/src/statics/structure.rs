//! `ModelStructure`: which variables it must list, and on what they depend (FMI 2.0.4 section 2.2.8).

use crate::finding::Found;
use crate::model::{Model, Unknown};
use orchestrator::fmu::{Causality, Initial};
use std::collections::{BTreeSet, HashMap};

/// The three lists by their names.
fn lists<'m, 'a>(model: &'m Model<'a>) -> [(&'static str, &'m [Unknown<'a>]); 3] {
    [
        ("Outputs", &model.outputs),
        ("Derivatives", &model.derivatives),
        ("InitialUnknowns", &model.initial_unknowns),
    ]
}

pub(super) fn index(model: &Model<'_>, found: &mut Found) {
    let count = model.count();
    for (list, unknowns) in lists(model) {
        let mut seen = HashMap::new();
        for unknown in unknowns {
            let Some(index) = unknown.element.attribute("index") else { continue };
            if !model.has(index) {
                found.error_at(
                    unknown.line,
                    format!("{list}: index {index} is none of a variable: 1 to {count}"),
                );
            } else if let Some(line) = seen.insert(index.trim(), unknown.line) {
                found.error_at(
                    unknown.line,
                    format!("{list}: index {index} is listed twice: line {line} has it, too"),
                );
            }
            for dependency in unknown.dependencies.iter().flatten().filter(|index| !model.has(index)) {
                found.error_at(
                    unknown.line,
                    format!("{list}: dependencies name index {dependency}, none of a variable: 1 to {count}"),
                );
            }
        }
    }
}

/// The variables that a list names and those that it must name: what is missing, what is too much.
fn compare(
    model: &Model<'_>,
    list: &str,
    named: &[Unknown<'_>],
    wanted: &BTreeSet<usize>,
    why: &str,
    found: &mut Found,
) {
    let held: BTreeSet<usize> = named.iter().filter_map(|unknown| unknown.variable).collect();
    for variable in wanted.difference(&held).map(|place| &model.variables[*place]) {
        found.error_of(variable, format!("ModelStructure/{list} lacks it: it lists {why}"));
    }
    for unknown in named {
        if let Some(place) = unknown.variable.filter(|place| !wanted.contains(place)) {
            let variable = &model.variables[place];
            let text = crate::finding::at(
                unknown.line,
                format!("ModelStructure/{list} must not list it: it lists {why}"),
            );
            found.say(crate::Severity::Error, Some(variable.name), text);
        }
    }
}

pub(super) fn outputs(model: &Model<'_>, found: &mut Found) {
    let all = model.variables.iter().enumerate();
    let wanted =
        all.filter(|(_, variable)| variable.causality == Causality::Output).map(|(place, _)| place).collect();
    compare(
        model,
        "Outputs",
        &model.outputs,
        &wanted,
        "every variable with causality=\"output\", and no other",
        found,
    );
}

pub(super) fn derivatives(model: &Model<'_>, found: &mut Found) {
    for unknown in &model.derivatives {
        let Some(variable) = unknown.variable.map(|place| &model.variables[place]) else { continue };
        if variable.typed.attribute("derivative").is_none() {
            let text = crate::finding::at(
                unknown.line,
                "ModelStructure/Derivatives lists it, but it has no attribute derivative",
            );
            found.say(crate::Severity::Error, Some(variable.name), text);
        }
    }
    if model.root.child("ModelExchange").is_some() {
        let listed: BTreeSet<usize> =
            model.derivatives.iter().filter_map(|unknown| unknown.variable).collect();
        for (place, variable) in model.variables.iter().enumerate() {
            if variable.typed.attribute("derivative").is_some() && !listed.contains(&place) {
                found.warning_of(variable, "it is a derivative that ModelStructure/Derivatives does not list: its state is none to a solver");
            }
        }
    }
}

pub(super) fn initial_unknowns(model: &Model<'_>, found: &mut Found) {
    let computed = |place: &usize| {
        matches!(model.variables[*place].initial(), Some(Initial::Approx | Initial::Calculated))
    };
    let of_variables = (0..model.variables.len()).filter(|place| match model.variables[*place].causality {
        Causality::Output => computed(place),
        Causality::CalculatedParameter => true,
        _ => false,
    });
    let mut wanted: BTreeSet<usize> = of_variables.collect();
    for derivative in model.derivatives.iter().filter_map(|unknown| unknown.variable) {
        let state = model.state_of(&model.variables[derivative]);
        wanted.extend([Some(derivative), state].into_iter().flatten().filter(computed));
    }
    // A list that is left out denies nothing; one that is there must be whole.
    let structure = model.root.child("ModelStructure");
    if structure.is_some_and(|structure| structure.child("InitialUnknowns").is_none()) && !wanted.is_empty() {
        let names: Vec<&str> = wanted.iter().take(5).map(|place| model.variables[*place].name).collect();
        let (more, names) = (if wanted.len() > names.len() { ", …" } else { "" }, names.join(", "));
        return found.warning(format!(
            "ModelStructure has no InitialUnknowns; the standard asks for one that lists {names}{more}"
        ));
    }
    // Under names that share a value, one stands for all.
    let alias = |place: usize| {
        let variable = &model.variables[place];
        variable.reference.map(|reference| (variable.kind, reference))
    };
    let held: Vec<_> = model.initial_unknowns.iter().filter_map(|unknown| alias(unknown.variable?)).collect();
    let listed: BTreeSet<usize> =
        model.initial_unknowns.iter().filter_map(|unknown| unknown.variable).collect();
    wanted
        .retain(|place| listed.contains(place) || !alias(*place).is_some_and(|alias| held.contains(&alias)));
    let why = "every output, calculated parameter, state and derivative that is calculated or approximate at the start, and no other";
    compare(model, "InitialUnknowns", &model.initial_unknowns, &wanted, why, found);
}

pub(super) fn dependencies(model: &Model<'_>, found: &mut Found) {
    for (list, unknowns) in lists(model) {
        for unknown in unknowns {
            let name = unknown.variable.map(|place| model.variables[place].name);
            let mut error = |text: String| {
                found.say(
                    crate::Severity::Error,
                    name,
                    crate::finding::at(unknown.line, format!("{list}: {text}")),
                );
            };
            match (&unknown.dependencies, &unknown.kinds) {
                (None, Some(_)) => error("dependenciesKind without dependencies".into()),
                (Some(dependencies), Some(kinds)) if dependencies.len() != kinds.len() => {
                    error(format!(
                        "{} dependencies and {} kinds: each has its own",
                        dependencies.len(),
                        kinds.len()
                    ));
                }
                _ => {}
            }
            let at_start = list == "InitialUnknowns";
            let mut kinds = unknown.kinds.iter().flatten();
            if let Some(kind) = kinds.find(|kind| at_start && !["dependent", "constant"].contains(*kind)) {
                error(format!("dependenciesKind {kind}: at the start only dependent and constant are"));
            }
            let mut seen = BTreeSet::new();
            for dependency in unknown.dependencies.iter().flatten() {
                if !seen.insert(dependency) {
                    error(format!("dependencies name index {dependency} twice"));
                }
                if model.place(dependency).is_some_and(|place| Some(place) == unknown.variable) {
                    error("it is said to depend on itself".into());
                }
            }
        }
    }
}
