//! Parameter sets (`.ssv`) and parameter mappings (`.ssm`): values with their units, and what becomes of them.

use super::document::{Document, units};
use crate::Error;
use orchestrator::Place;
use orchestrator::fmu::BaseUnit;
use orchestrator::xml::Element;
use std::collections::HashMap;

/// A value as it is written.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Written {
    Real(f64),
    Integer(i64),
    Boolean(bool),
    Text(String),
    /// The name of an item.
    Item(String),
    /// What FMI 2.0 has no variable for; told where it is used.
    Other(&'static str),
}

/// One parameter of a set.
#[derive(Debug, Clone)]
pub(super) struct Parameter {
    pub(super) name: String,
    pub(super) value: Written,
    pub(super) unit: (Option<String>, Option<BaseUnit>),
    pub(super) place: Place,
}

/// What a mapping makes of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Change {
    Linear { factor: f64, offset: f64 },
    Table(Vec<(String, String)>),
}

/// One entry of a mapping.
#[derive(Debug, Clone)]
pub(super) struct Mapped {
    pub(super) source: String,
    pub(super) target: String,
    pub(super) suppress: bool,
    pub(super) change: Option<Change>,
    pub(super) place: Place,
}

/// The parameters of a set. Its own units count before those of the document around it.
pub(super) fn parameters(document: &Document, set: &Element) -> Result<Vec<Parameter>, Error> {
    document.check(set, "ParameterSet")?;
    let own = units(document, set)?;
    let mut all = Vec::new();
    for element in set.list("Parameters").iter().filter(|element| element.name == "Parameter") {
        let name = document.required(element, "name")?.to_owned();
        let Some(typed) = element.children.iter().find(|child| is_type(&child.name)) else {
            let what = format!("parameter {name} has no value");
            return Err(document.wrong(element, what, "Real, Integer, Boolean, String or Enumeration"));
        };
        all.push(Parameter {
            value: value(document, &name, typed)?,
            unit: unit(&own, document, typed),
            place: document.place(element),
            name,
        });
    }
    Ok(all)
}

fn unit(
    own: &HashMap<String, BaseUnit>,
    document: &Document,
    typed: &Element,
) -> (Option<String>, Option<BaseUnit>) {
    let Some(name) = typed.attribute("unit").filter(|name| !name.is_empty()) else { return (None, None) };
    let base = own.get(name).or_else(|| document.units.get(name)).copied();
    (Some(name.to_owned()), base)
}

const INTEGERS: [&str; 9] =
    ["Integer", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64"];

fn is_type(name: &str) -> bool {
    matches!(name, "Real" | "Float64" | "Float32" | "Boolean" | "String" | "Enumeration" | "Binary")
        || INTEGERS.contains(&name)
}

fn value(document: &Document, name: &str, typed: &Element) -> Result<Written, Error> {
    let kind = typed.name.as_str();
    if kind == "Binary" {
        return Ok(Written::Other("Binary"));
    }
    let Some(text) = typed.attribute("value") else { return Ok(Written::Other("an array of texts")) };
    let wrong = |expected: &str| document.wrong(typed, format!("{name} = {text:?}"), expected);
    if matches!(kind, "String") {
        return Ok(Written::Text(text.to_owned()));
    }
    if kind == "Enumeration" {
        return Ok(Written::Item(text.to_owned()));
    }
    if text.split_whitespace().count() > 1 {
        return Ok(Written::Other("an array"));
    }
    let text = text.trim();
    Ok(match kind {
        "Boolean" => Written::Boolean(boolean(text).ok_or_else(|| wrong("true or false"))?),
        kind if INTEGERS.contains(&kind) => {
            Written::Integer(text.parse().map_err(|_| wrong("an integer of 64 bits"))?)
        }
        _ => {
            let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
            Written::Real(number.ok_or_else(|| wrong("a finite number"))?)
        }
    })
}

pub(super) fn boolean(text: &str) -> Option<bool> {
    match text {
        "true" | "1" => Some(true),
        "false" | "0" => Some(false),
        _ => None,
    }
}

/// The entries of a mapping.
pub(super) fn mapping(document: &Document, element: &Element) -> Result<Vec<Mapped>, Error> {
    document.check(element, "ParameterMapping")?;
    let entries = element.children.iter().filter(|child| child.name == "MappingEntry");
    entries
        .map(|entry| {
            Ok(Mapped {
                source: document.required(entry, "source")?.to_owned(),
                target: document.required(entry, "target")?.to_owned(),
                suppress: document.flag(entry, "suppressUnitConversion")?,
                change: change(document, entry)?,
                place: document.place(entry),
            })
        })
        .collect()
}

fn change(document: &Document, entry: &Element) -> Result<Option<Change>, Error> {
    for child in &entry.children {
        if child.name == "LinearTransformation" {
            let factor = document.number(child, "factor")?.unwrap_or(1.0);
            return Ok(Some(Change::Linear {
                factor,
                offset: document.number(child, "offset")?.unwrap_or(0.0),
            }));
        }
        if child.name.ends_with("MappingTransformation") {
            let mut table = Vec::new();
            for row in child.children.iter().filter(|row| row.name == "MapEntry") {
                let cell = |name| document.required(row, name).map(|text| text.trim().to_owned());
                table.push((cell("source")?, cell("target")?));
            }
            return Ok(Some(Change::Table(table)));
        }
    }
    Ok(None)
}

impl Change {
    /// The value that a mapping makes; an error is what is wrong and what would be right.
    pub(super) fn apply(&self, value: Written) -> Result<Written, (String, String)> {
        match (self, value) {
            (Self::Linear { factor, offset }, Written::Real(value)) => {
                Ok(Written::Real(factor * value + offset))
            }
            (Self::Linear { factor, offset }, Written::Integer(value)) => {
                Ok(Written::Real(factor * value as f64 + offset))
            }
            (Self::Linear { .. }, other) => {
                Err((format!("a linear transformation of {other:?}"), "a number".into()))
            }
            (Self::Table(rows), value) => {
                let is = |cell: &str| match &value {
                    Written::Integer(value) => cell.parse() == Ok(*value),
                    Written::Boolean(value) => boolean(cell) == Some(*value),
                    Written::Item(value) | Written::Text(value) => cell == value,
                    Written::Real(_) | Written::Other(_) => false,
                };
                let Some((_, target)) = rows.iter().find(|(source, _)| is(source)) else {
                    let known: Vec<&str> = rows.iter().map(|(source, _)| source.as_str()).collect();
                    return Err((format!("no entry for {value:?}"), format!("one of {}", known.join(", "))));
                };
                let wrong = || (format!("the entry {target:?}"), "a value of the same type".to_owned());
                Ok(match value {
                    Written::Integer(_) => Written::Integer(target.parse().map_err(|_| wrong())?),
                    Written::Boolean(_) => Written::Boolean(boolean(target).ok_or_else(wrong)?),
                    _ => Written::Item(target.clone()),
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Change, Written};

    #[test]
    fn value_mappings_change_what_they_name() {
        let linear = Change::Linear { factor: 2.0, offset: 3.0 };
        assert_eq!(linear.apply(Written::Real(4.0)), Ok(Written::Real(11.0)));
        assert_eq!(linear.apply(Written::Integer(4)), Ok(Written::Real(11.0)));
        assert!(linear.apply(Written::Boolean(true)).is_err());
        let table = |rows: &[(&str, &str)]| {
            Change::Table(rows.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect())
        };
        let swap = table(&[("true", "false"), ("0", "1")]);
        assert_eq!(swap.apply(Written::Boolean(true)), Ok(Written::Boolean(false)));
        assert_eq!(swap.apply(Written::Boolean(false)), Ok(Written::Boolean(true)));
        assert_eq!(table(&[("1", "7")]).apply(Written::Integer(1)), Ok(Written::Integer(7)));
        assert!(table(&[("1", "7")]).apply(Written::Integer(2)).is_err());
        assert_eq!(
            table(&[("low", "high")]).apply(Written::Item("low".into())),
            Ok(Written::Item("high".into()))
        );
    }
}
