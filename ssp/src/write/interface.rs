//! Connectors of the units, with the physical units and enumerations that they need.

use super::number;
use super::xml::Xml;
use orchestrator::fmu::{BaseUnit, Causality, Description, Variability, Variable};
use orchestrator::{Kind, Simulation};
use std::collections::BTreeMap;

/// Names and values of an enumeration's items.
type Items<'a> = &'a [(String, i32)];

/// What connectors refer to, gathered as they are written.
pub(super) struct Interface<'a> {
    descriptions: Vec<&'a Description>,
    names: Vec<&'a str>,
    /// Physical units by name. Of two definitions under one name the first is kept; connectors in the other have none,
    /// so that their unit's own description counts.
    units: BTreeMap<&'a str, BaseUnit>,
    enumerations: Vec<(String, Items<'a>)>,
}

impl<'a> Interface<'a> {
    pub(super) fn new(simulation: &'a Simulation) -> Self {
        let (names, descriptions) = simulation.units().unzip();
        Self { descriptions, names, units: BTreeMap::new(), enumerations: Vec::new() }
    }

    /// The name of an enumeration's item, if the variable is one.
    pub(super) fn item(&self, unit: usize, variable: &str, value: i32) -> Option<&'a str> {
        let items = self.descriptions[unit].variable(variable)?.items.as_deref()?;
        items.iter().find(|(_, known)| *known == value).map(|(name, _)| name.as_str())
    }

    /// The same for `unit.variable`.
    pub(super) fn named(&self, full: &str, value: i32) -> Option<&'a str> {
        let (unit, variable) = full.split_once('.')?;
        self.item(self.names.iter().position(|name| *name == unit)?, variable, value)
    }

    /// Inputs, outputs and parameters of a unit.
    pub(super) fn connectors(&mut self, xml: &mut Xml, unit: usize) {
        let description = self.descriptions[unit];
        let of_kind = |variable: &'a Variable| {
            let kind = match variable.causality {
                Causality::Input => "input",
                Causality::Output => "output",
                Causality::Parameter if variable.variability != Variability::Constant => "parameter",
                Causality::CalculatedParameter => "calculatedParameter",
                _ => return None,
            };
            // Of several variables of one name none can be meant.
            (!description.is_ambiguous(&variable.name)).then_some((variable, kind))
        };
        let all: Vec<(&Variable, &str)> = description.variables.iter().filter_map(of_kind).collect();
        if all.is_empty() {
            return;
        }
        xml.open("ssd:Connectors", &[]);
        for (variable, kind) in all {
            xml.open("ssd:Connector", &[("name", Some(&variable.name)), ("kind", Some(kind))]);
            self.kind(xml, unit, variable);
            xml.close();
        }
        xml.close();
    }

    fn kind(&mut self, xml: &mut Xml, unit: usize, variable: &'a Variable) {
        match (variable.kind, variable.items.as_deref()) {
            (Kind::Real, _) => xml.empty("ssc:Real", &[("unit", self.unit(unit, variable))]),
            (Kind::Integer, Some(items)) if !items.is_empty() => {
                let name = self.enumeration(unit, variable, items);
                xml.empty("ssc:Enumeration", &[("name", Some(&name))]);
            }
            (Kind::Integer, _) => xml.empty("ssc:Integer", &[]),
            (Kind::Boolean, _) => xml.empty("ssc:Boolean", &[]),
            (Kind::String, _) => xml.empty("ssc:String", &[]),
        }
    }

    fn unit(&mut self, unit: usize, variable: &'a Variable) -> Option<&'a str> {
        let name = variable.unit.as_deref().filter(|name| !name.is_empty())?;
        let base = self.descriptions[unit].unit(name)?.base?;
        let known = self.units.entry(name).or_insert(base);
        (*known == base).then_some(name)
    }

    fn enumeration(&mut self, unit: usize, variable: &Variable, items: Items<'a>) -> String {
        if let Some((name, _)) = self.enumerations.iter().find(|(_, known)| *known == items) {
            return name.clone();
        }
        let name = format!("{}.{}", self.names[unit], variable.name);
        self.enumerations.push((name.clone(), items));
        name
    }

    /// The definitions of all that was referred to.
    pub(super) fn definitions(&self, xml: &mut Xml) {
        if !self.enumerations.is_empty() {
            xml.open("ssd:Enumerations", &[]);
            for (name, items) in &self.enumerations {
                xml.open("ssc:Enumeration", &[("name", Some(name))]);
                for (item, value) in *items {
                    xml.empty("ssc:Item", &[("name", Some(item)), ("value", Some(&value.to_string()))]);
                }
                xml.close();
            }
            xml.close();
        }
        if self.units.is_empty() {
            return;
        }
        xml.open("ssd:Units", &[]);
        for (name, base) in &self.units {
            xml.open("ssc:Unit", &[("name", Some(name))]);
            base_unit(xml, base);
            xml.close();
        }
        xml.close();
    }
}

fn base_unit(xml: &mut Xml, base: &BaseUnit) {
    let names = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];
    let exponents: Vec<String> = base.exponents.iter().map(ToString::to_string).collect();
    let (factor, offset) = (number(base.factor), number(base.offset));
    let mut attributes: Vec<(&str, Option<&str>)> = names
        .into_iter()
        .zip(base.exponents.iter().zip(&exponents))
        .map(|(name, (exponent, text))| (name, (*exponent != 0).then_some(text.as_str())))
        .collect();
    attributes.push(("factor", (base.factor != 1.0).then_some(factor.as_str())));
    attributes.push(("offset", (base.offset != 0.0).then_some(offset.as_str())));
    xml.empty("ssc:BaseUnit", &attributes);
}
