//! Units of measurement and declared types (FMI 2.0.4 sections 2.2.2 and 2.2.3).

use crate::Severity;
use crate::finding::{Found, at};
use crate::model::Model;
use crate::xml::Element;
use orchestrator::nearest;

pub(super) fn units(model: &Model<'_>, found: &mut Found) {
    for defined in model.root.list("TypeDefinitions", "SimpleType") {
        if let Some(real) = defined.child("Real") {
            let what = format!("type {}: ", defined.attribute("name").unwrap_or_default());
            let (unit, shown) = (real.attribute("unit"), real.attribute("displayUnit"));
            for text in wrong(model, unit, shown) {
                found.error_at(defined.line, format!("{what}{text}"));
            }
        }
    }
    for variable in model.variables.iter().filter(|variable| variable.typed.name == "Real") {
        // What a declared type says wrong is told once, there.
        let own = ["unit", "displayUnit"].map(|name| variable.typed.attribute(name));
        if own == [None, None] {
            continue;
        }
        for text in wrong(model, variable.attribute("unit"), own[1]) {
            found.error_of(variable, text);
        }
    }
}

fn wrong(model: &Model<'_>, unit: Option<&str>, shown: Option<&str>) -> Vec<String> {
    let mut all = Vec::new();
    let definition = unit.and_then(|unit| model.units.get(unit));
    if let (Some(unit), None) = (unit, definition) {
        let hint = nearest(unit, model.units.keys().copied());
        all.push(format!("the unit {unit} is not among UnitDefinitions: {hint}"));
    }
    match (shown, unit, definition) {
        (Some(shown), None, _) => all.push(format!("displayUnit=\"{shown}\" without a unit")),
        (Some(shown), Some(unit), Some(definition)) => {
            let known: Vec<&str> =
                definition.children.iter().filter_map(|child| child.attribute("name")).collect();
            // The unit itself is often named; it needs no conversion.
            if shown != unit && !known.contains(&shown) {
                let hint = nearest(shown, known.into_iter());
                all.push(format!("the unit {unit} has no DisplayUnit {shown}: {hint}"));
            }
        }
        _ => {}
    }
    all
}

pub(super) fn definitions(model: &Model<'_>, found: &mut Found) {
    for unit in model.root.list("UnitDefinitions", "Unit") {
        let name = unit.attribute("name").unwrap_or_default();
        let parts =
            unit.children.iter().filter(|child| ["BaseUnit", "DisplayUnit"].contains(&child.name.as_str()));
        for part in parts {
            factor(name, part, found);
        }
    }
}

fn factor(unit: &str, part: &Element, found: &mut Found) {
    let value = |name: &str| part.attribute(name).and_then(crate::model::number);
    if value("factor").is_some_and(|factor| factor == 0.0 || !factor.is_finite()) {
        let factor = part.attribute("factor").unwrap_or_default();
        found.error_at(
            part.line,
            format!("unit {unit}: factor=\"{factor}\" in <{}>: nothing could be converted back", part.name),
        );
    }
    if value("offset").is_some_and(|offset| !offset.is_finite()) {
        found.error_at(part.line, format!("unit {unit}: the offset of <{}> is not finite", part.name));
    }
}

pub(super) fn types(model: &Model<'_>, found: &mut Found) {
    for variable in &model.variables {
        let Some(name) = variable.typed.attribute("declaredType") else { continue };
        let sort = variable.typed.name.as_str();
        match model.types.get(name) {
            None => {
                let hint = nearest(name, model.types.keys().copied());
                found.error_of(
                    variable,
                    format!("the declaredType {name} is not among TypeDefinitions: {hint}"),
                );
            }
            Some(defined) if variable.declared.is_none() => {
                let is = defined.children.first().map_or("nothing", |child| child.name.as_str());
                found.error_of(variable, format!("it is of type {sort}, its declaredType {name} is {is}"));
            }
            Some(_) => {}
        }
    }
    for defined in model.types.values() {
        let Some(enumeration) = defined.child("Enumeration") else { continue };
        if enumeration.children.is_empty() {
            let name = defined.attribute("name").unwrap_or_default();
            found.say(
                Severity::Error,
                None,
                at(enumeration.line, format!("the enumeration {name} has no items")),
            );
        }
    }
}
