//! Parameter bindings: which value each variable of a unit begins with.
//!
//! A binding on a system names variables of its elements with dots; one on an element farther out counts more, and of two
//! on one element the later one. A name that nothing has is passed over, as the standard wants, and told.

use super::document::Document;
use super::source::resolve;
use super::tree::{Kind, Part, Tree};
use super::values::{self, Mapped, Parameter, Written};
use super::wires::{End, Scale, Wires, shown};
use crate::Error;
use orchestrator::Kind as Type;
use orchestrator::Place;
use orchestrator::fmu::Variable;
use orchestrator::scenario::{Given, Placed};
use orchestrator::suggest::nearest;
use orchestrator::xml::Element;
use std::collections::BTreeSet;
use std::rc::Rc;
use toml::Value as Toml;

/// Names of a binding that nothing has are told up to this number.
const TOLD: usize = 3;

/// Start values of each component, each name once.
pub(super) struct Starts {
    pub(super) of: Vec<Vec<(String, Placed<Given>)>>,
    pub(super) notes: Vec<String>,
}

/// A parameter on its way to a variable.
struct Bound {
    parameter: Parameter,
    target: String,
    mapped: Option<Mapped>,
}

pub(super) fn read(tree: &mut Tree, wires: &Wires) -> Result<Starts, Error> {
    let mut starts = Starts { of: tree.components.iter().map(|_| Vec::new()).collect(), notes: Vec::new() };
    // Those farther in first, so that those farther out come after them and count.
    let mut order: Vec<usize> = (0..tree.nodes.len()).collect();
    order.sort_by_key(|node| std::cmp::Reverse(tree.nodes[*node].depth));
    for node in order {
        for part in tree.nodes[node].parts.clone() {
            for binding in
                part.element.list("ParameterBindings").iter().filter(|e| e.name == "ParameterBinding")
            {
                let bound = bound(tree, &part, binding)?;
                let all = bound.len();
                let mut unknown = BTreeSet::new();
                for bound in bound {
                    let mut reached = BTreeSet::new();
                    match find(tree, node, &bound.target) {
                        Some(end) => set(tree, wires, &mut starts, &end, &bound, &mut reached)?,
                        None => drop(unknown.insert(bound.target)),
                    }
                }
                starts.notes.extend(passed_over(tree, node, &part, binding, &unknown, all));
            }
        }
    }
    Ok(starts)
}

fn passed_over(
    tree: &Tree,
    node: usize,
    part: &Part,
    binding: &Element,
    unknown: &BTreeSet<String>,
    all: usize,
) -> Option<String> {
    let first = unknown.first()?;
    let shown: Vec<&str> = unknown.iter().take(TOLD).map(String::as_str).collect();
    let more = if unknown.len() > TOLD { ", ..." } else { "" };
    let near = match tree.nodes[node].kind {
        Kind::Component(component) if unknown.len() == 1 => {
            let description = &tree.components[component].description;
            format!(
                " ({})",
                nearest(first, description.variables.iter().map(|variable| variable.name.as_str()))
            )
        }
        _ => String::new(),
    };
    Some(format!(
        "{}: {} of {all} parameters name nothing that is there and are passed over: {}{more}{near}",
        part.document.place(binding),
        unknown.len(),
        shown.join(", ")
    ))
}

/// The parameters of a binding with their targets.
fn bound(tree: &mut Tree, part: &Part, binding: &Element) -> Result<Vec<Bound>, Error> {
    let prefix = binding.attribute("prefix").unwrap_or_default();
    let named = parameters(tree, part, binding)?.into_iter().map(|parameter| {
        let target = format!("{prefix}{}", parameter.name);
        Bound { parameter, target, mapped: None }
    });
    let named: Vec<Bound> = named.collect();
    let Some(element) = binding.child("ParameterMapping") else { return Ok(named) };
    let entries = match (element.attribute("source"), element.child("ParameterMapping")) {
        (Some(source), _) => {
            let mapping = open(tree, part, element, source, "ParameterMapping")?;
            values::mapping(&mapping, &mapping.root)?
        }
        (None, Some(inline)) => values::mapping(&part.document, inline)?,
        (None, None) => return Ok(named),
    };
    let mut all = Vec::new();
    for bound in named {
        let mine = entries.iter().filter(|entry| entry.source == bound.target);
        all.extend(mine.map(|entry| Bound {
            parameter: bound.parameter.clone(),
            target: entry.target.clone(),
            mapped: Some(entry.clone()),
        }));
    }
    Ok(all)
}

/// Those of the set that a binding names or holds.
fn parameters(tree: &mut Tree, part: &Part, binding: &Element) -> Result<Vec<Parameter>, Error> {
    let document = &part.document;
    if let Some(other @ ("component" | "Component")) = binding.attribute("sourceBase") {
        let what = format!("sourceBase=\"{other}\" of <ParameterBinding>");
        let expected = "a parameter set that lies in the package, not in the unit";
        return Err(document.wrong(binding, what, expected));
    }
    let Some(source) = binding.attribute("source") else {
        let held = binding.list("ParameterValues").iter().find(|child| child.name == "ParameterSet");
        return held.map_or(Ok(Vec::new()), |set| values::parameters(document, set));
    };
    let kind = binding.attribute("type").unwrap_or("application/x-ssp-parameter-set");
    if kind != "application/x-ssp-parameter-set" {
        let what = format!("<ParameterBinding> of type {kind:?}");
        return Err(document.wrong(binding, what, "application/x-ssp-parameter-set"));
    }
    let set = open(tree, part, binding, source, "ParameterSet")?;
    values::parameters(&set, &set.root)
}

fn open(
    tree: &mut Tree,
    part: &Part,
    element: &Element,
    source: &str,
    root: &str,
) -> Result<Rc<Document>, Error> {
    let entry = resolve(&part.document, element, &part.base, source)?;
    match tree.packages.get_mut(&part.package) {
        Some(package) => Ok(Rc::new(Document::open(package, &entry, root)?)),
        None => Err(part.document.wrong(element, format!("source=\"{source}\""), "an open package")),
    }
}

/// The connector or variable that a name with dots means, from an element on.
fn find(tree: &Tree, node: usize, name: &str) -> Option<End> {
    let at = &tree.nodes[node];
    match at.kind {
        Kind::Component(component) => {
            tree.components[component].description.variable(name).map(|_| (node, name.to_owned()))
        }
        Kind::System | Kind::Dictionary => {
            if at.connectors.contains_key(name) {
                return Some((node, name.to_owned()));
            }
            // Names of elements may have dots, too.
            at.children.iter().find_map(|(child, inner)| {
                let rest = name.strip_prefix(child.as_str())?.strip_prefix('.')?;
                find(tree, *inner, rest)
            })
        }
    }
}

/// Gives a value to a variable, or through a system's connector to all that are connected to it.
fn set(
    tree: &Tree,
    wires: &Wires,
    starts: &mut Starts,
    end: &End,
    bound: &Bound,
    reached: &mut BTreeSet<End>,
) -> Result<(), Error> {
    let place = || bound.mapped.as_ref().map_or(&bound.parameter.place, |mapped| &mapped.place).clone();
    let wrong = |(what, expected): (String, String)| Error::Document {
        place: place(),
        what: format!("{} for {}: {what}", bound.parameter.name, shown(tree, end)),
        expected,
    };
    // In the target's unit first, then what the mapping makes of it.
    let unit = tree.unit(end.0, &end.1);
    let suppress = bound.mapped.as_ref().is_some_and(|mapped| mapped.suppress);
    let mut value = bound.parameter.value.clone();
    if let (Written::Real(number), false) = (&value, suppress) {
        let written = tree.defined(end.0, bound.parameter.unit.clone());
        let scale = Scale::of(written).into_unit(unit.clone()).map_err(wrong)?;
        value = Written::Real(scaled(*number, &scale));
    }
    if let Some(change) = bound.mapped.as_ref().and_then(|mapped| mapped.change.as_ref()) {
        value = change.apply(value).map_err(wrong)?;
    }
    let mut walk = Walk { tree, wires, starts, place: &bound.parameter.place, reached };
    walk.give(end, value, Scale::of(unit)).map_err(|error| match error {
        Wrong::Here(here) => wrong(here),
        Wrong::There(error) => error,
    })
}

/// What went wrong with the value itself, or on a wire.
enum Wrong {
    Here((String, String)),
    There(Error),
}

/// The way of one value from a connector to all variables that it reaches.
struct Walk<'a> {
    tree: &'a Tree,
    wires: &'a Wires,
    starts: &'a mut Starts,
    /// Where the value is written.
    place: &'a Place,
    reached: &'a mut BTreeSet<End>,
}

impl Walk<'_> {
    fn give(&mut self, end: &End, value: Written, scale: Scale) -> Result<(), Wrong> {
        if let Kind::Component(component) = self.tree.nodes[end.0].kind {
            return self.start(component, &end.1, value, &scale).map_err(Wrong::Here);
        }
        if !self.reached.insert(end.clone()) {
            return Ok(());
        }
        let Self { tree, wires, .. } = *self;
        for (to, wire) in wires.out_of(end) {
            let scale = wire.pass(tree, to, scale.clone()).map_err(Wrong::There)?;
            self.give(to, value.clone(), scale)?;
        }
        Ok(())
    }

    /// The value is the start value of a unit's variable, in place of one that it was given before.
    fn start(
        &mut self,
        component: usize,
        name: &str,
        value: Written,
        scale: &Scale,
    ) -> Result<(), (String, String)> {
        let Some(variable) = self.tree.components[component].description.variable(name) else {
            return Ok(()); // the connection that leads here is refused by the scenario, with its place
        };
        let value = match value {
            Written::Real(number) => Written::Real(scaled(number, scale)),
            Written::Integer(number) if scale.gain != 1.0 || scale.bias != 0.0 => {
                Written::Real(scaled(number as f64, scale))
            }
            other => other,
        };
        let value = toml(value, variable)?;
        let known = &mut self.starts.of[component];
        known.retain(|(known, _)| *known != *name);
        known.push((name.to_owned(), Placed { value: Given::Toml(value), place: self.place.clone() }));
        Ok(())
    }
}

fn scaled(number: f64, scale: &Scale) -> f64 {
    if scale.gain == 1.0 && scale.bias == 0.0 { number } else { scale.gain * number + scale.bias }
}

/// A value as a scenario has it. What doesn't fit the variable's type stays as it is: the scenario tells it.
fn toml(value: Written, variable: &Variable) -> Result<Toml, (String, String)> {
    Ok(match (value, variable.kind) {
        (Written::Integer(value), Type::Real) => Toml::Float(value as f64),
        (Written::Real(value), Type::Integer) if value.fract() == 0.0 && value.abs() < 1e15 => {
            Toml::Integer(value as i64)
        }
        (Written::Integer(value @ (0 | 1)), Type::Boolean) => Toml::Boolean(value == 1),
        // An enumeration's item by its number, as some tools write it.
        (Written::Item(text), Type::Integer) => match text.trim().parse() {
            Ok(number) if !named(variable, &text) => Toml::Integer(number),
            _ => Toml::String(text),
        },
        (Written::Real(value), _) => Toml::Float(value),
        (Written::Integer(value), _) => Toml::Integer(value),
        (Written::Boolean(value), _) => Toml::Boolean(value),
        (Written::Text(value) | Written::Item(value), _) => Toml::String(value),
        (Written::Other(what), kind) => {
            return Err((format!("{what}, for a variable of type {kind}"), "one value of that type".into()));
        }
    })
}

fn named(variable: &Variable, text: &str) -> bool {
    variable.items.as_deref().is_some_and(|items| items.iter().any(|(name, _)| name == text))
}
