//! Names of variables (FMI 2.0.4 sections 2.2.7 and 2.2.9) and of definitions.

use crate::finding::Found;
use crate::model::{self, Model};
use crate::xml::Element;
use std::collections::HashMap;

pub(super) fn variables(model: &Model<'_>, found: &mut Found) {
    let mut seen: HashMap<&str, usize> = HashMap::new();
    for variable in &model.variables {
        if variable.name.trim().is_empty() {
            found.error_of(variable, "a variable without a name: nobody can set or connect it");
        } else if let Some(line) = seen.insert(variable.name, variable.line) {
            found.error_of(variable, format!("the name is not unique: line {line} has it, too"));
        }
        if variable.name.chars().any(char::is_control) {
            found.error_of(variable, "the name has a tab, a line end or another control character");
        } else if variable.name.trim() != variable.name {
            found.warning_of(variable, "the name begins or ends with a space");
        }
    }
}

pub(super) fn structured(model: &Model<'_>, found: &mut Found) {
    if model.root.attribute("variableNamingConvention") != Some("structured") {
        return;
    }
    for variable in model.variables.iter().filter(|variable| !is_structured(variable.name)) {
        let expected = "such as a.b[2].c, der(a.b) or 'any text'";
        found.error_of(
            variable,
            format!("no name of the convention \"structured\": wanted is one {expected}"),
        );
    }
}

/// Whether a name follows the grammar of section 2.2.9.
fn is_structured(name: &str) -> bool {
    let rest = match name.strip_prefix("der(") {
        None => identifier(name),
        Some(inner) => identifier(inner).and_then(|rest| match rest.strip_prefix(',') {
            None => rest.strip_prefix(')'),
            Some(order) => digits(order.trim_start())?.strip_prefix(')'),
        }),
    };
    rest == Some("")
}

/// What follows `a.b[1,2].'c'`.
fn identifier(text: &str) -> Option<&str> {
    let mut rest = text;
    loop {
        rest = part(rest)?;
        if let Some(indices) = rest.strip_prefix('[') {
            rest = digits(indices)?;
            while let Some(more) = rest.strip_prefix(',') {
                rest = digits(more.trim_start())?;
            }
            rest = rest.strip_prefix(']')?;
        }
        match rest.strip_prefix('.') {
            Some(next) => rest = next,
            None => return Some(rest),
        }
    }
}

/// What follows a plain or a quoted name.
fn part(text: &str) -> Option<&str> {
    if let Some(quoted) = text.strip_prefix('\'') {
        let mut escaped = false;
        for (at, character) in quoted.char_indices() {
            match character {
                _ if escaped => escaped = false,
                '\\' => escaped = true,
                '\'' if at > 0 => return Some(&quoted[at + 1..]),
                '\'' => return None,
                _ => {}
            }
        }
        return None;
    }
    let begins = text.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_');
    let rest = text.trim_start_matches(|c: char| c.is_ascii_alphanumeric() || c == '_');
    begins.then_some(rest)
}

fn digits(text: &str) -> Option<&str> {
    let rest = text.trim_start_matches(|c: char| c.is_ascii_digit());
    (rest.len() < text.len()).then_some(rest)
}

pub(super) fn definitions(model: &Model<'_>, found: &mut Found) {
    let root = model.root;
    unique("unit", root.list("UnitDefinitions", "Unit"), found);
    unique("type", root.list("TypeDefinitions", "SimpleType"), found);
    unique("log category", root.list("LogCategories", "Category"), found);
    for unit in root.list("UnitDefinitions", "Unit") {
        let of = format!("display unit of {}", unit.attribute("name").unwrap_or_default());
        unique(&of, unit.children.iter().filter(|child| child.name == "DisplayUnit"), found);
    }
    let variables: HashMap<&str, usize> =
        model.variables.iter().map(|variable| (variable.name, variable.line)).collect();
    for defined in root.list("TypeDefinitions", "SimpleType") {
        let name = defined.attribute("name").unwrap_or_default();
        if let Some(line) = variables.get(name) {
            found.warning_at(
                defined.line,
                format!("the type {name} is called as the variable of line {line}"),
            );
        }
        let Some(enumeration) = defined.child("Enumeration") else { continue };
        unique(&format!("item of {name}"), enumeration.children.iter(), found);
        let mut values = HashMap::new();
        for (item, value) in model::items(enumeration) {
            if let Some(other) = value.and_then(|value| values.insert(value, item)) {
                let value = value.unwrap_or_default();
                found.error_at(
                    enumeration.line,
                    format!("type {name}: items {other} and {item} have one value, {value}"),
                );
            }
        }
    }
}

fn unique<'a>(what: &str, elements: impl Iterator<Item = &'a Element>, found: &mut Found) {
    let mut seen: HashMap<&str, usize> = HashMap::new();
    for element in elements {
        let Some(name) = element.attribute("name") else { continue };
        if let Some(line) = seen.insert(name, element.line) {
            found.error_at(
                element.line,
                format!("the {what} {name:?} is defined twice: line {line} has it, too"),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::is_structured;

    #[test]
    fn value_structured_names() {
        for name in ["a", "_a1.b", "a[1].b[2,3]", "der(a.b)", "der(a,2)", "'any text!'.b", "'it\\'s'"] {
            assert!(is_structured(name), "{name}");
        }
        for name in ["", "1a", "a.", "a[", "a[]", "a[x]", "der(a", "der()", "a b", "''", "'open", "a-b", "ä"]
        {
            assert!(!is_structured(name), "{name}");
        }
    }
}
