//! From connections between connectors, through systems and dictionaries, to those between variables of units.
//!
//! SSP lets a connection be written in either direction: which end gives and which takes comes from the kinds of the
//! connectors. A system's own connectors look the other way from inside.

use super::document::{Document, ours};
use super::tree::{Kind, Part, Tree, Way};
use crate::{Error, annotation};
use orchestrator::fmu::BaseUnit;
use orchestrator::suggest::nearest;
use orchestrator::xml::Element;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;
use toml::Value as Toml;

/// A connector: the place of its element, and its name.
pub(super) type End = (usize, String);

/// What leads into a connector.
#[derive(Clone)]
pub(super) struct Wire {
    pub(super) from: End,
    pub(super) factor: f64,
    pub(super) offset: f64,
    /// What becomes of single values.
    pub(super) map: Vec<(Toml, Toml)>,
    /// Physical units are left alone.
    pub(super) suppress: bool,
    /// Our annotation, if there is one.
    pub(super) own: Option<Element>,
    pub(super) document: Rc<Document>,
    pub(super) element: Element,
    order: usize,
}

/// All wires by where they lead.
pub(super) struct Wires {
    into: BTreeMap<End, Wire>,
}

/// A value on its way: number in the unit = gain · what it was + bias.
#[derive(Clone)]
pub(super) struct Scale {
    pub(super) gain: f64,
    pub(super) bias: f64,
    pub(super) unit: (Option<String>, Option<BaseUnit>),
}

/// A connection between variables of units.
pub(super) struct Path {
    pub(super) from: End,
    pub(super) to: End,
    /// From the source on.
    pub(super) wires: Vec<Wire>,
    order: usize,
}

impl Wires {
    pub(super) fn read(tree: &Tree) -> Result<Self, Error> {
        let mut wires = Self { into: BTreeMap::new() };
        let mut order = 0;
        for node in 0..tree.nodes.len() {
            if !matches!(tree.nodes[node].kind, Kind::System) {
                continue;
            }
            for part in &tree.nodes[node].parts {
                for element in part.element.list("Connections").iter().filter(|e| e.name == "Connection") {
                    order += 1;
                    let (to, wire) = wire(tree, node, part, element, order)?;
                    if let Some(first) = wires.into.get(&to) {
                        let what = format!("a second connection into {}", shown(tree, &to));
                        let expected =
                            format!("the first one is at {}", first.document.place(&first.element));
                        return Err(part.document.wrong(element, what, expected));
                    }
                    wires.into.insert(to, wire);
                }
            }
        }
        Ok(wires)
    }

    /// The connections of units, in the order of the documents.
    pub(super) fn paths(&self, tree: &Tree) -> Result<Vec<Path>, Error> {
        let mut paths = Vec::new();
        for (to, wire) in &self.into {
            if !matches!(tree.nodes[to.0].kind, Kind::Component(_)) {
                continue;
            }
            let mut passed = BTreeSet::new();
            let mut back = vec![wire.clone()];
            let mut from = wire.from.clone();
            while !matches!(tree.nodes[from.0].kind, Kind::Component(_)) {
                if !passed.insert(from.clone()) {
                    let what = format!("{} is connected to itself", shown(tree, &from));
                    return Err(wire.document.wrong(
                        &wire.element,
                        what,
                        "a unit's output that gives the value",
                    ));
                }
                let Some(next) = self.into.get(&from) else { break };
                back.push(next.clone());
                from = next.from.clone();
            }
            // One that ends at an open connector is no connection: its start value goes there, as a parameter's does.
            if matches!(tree.nodes[from.0].kind, Kind::Component(_)) {
                back.reverse();
                paths.push(Path { from, to: to.clone(), wires: back, order: wire.order });
            }
        }
        paths.sort_by_key(|path| path.order);
        Ok(paths)
    }

    /// The wires that lead out of a connector.
    pub(super) fn out_of<'a>(&'a self, from: &'a End) -> impl Iterator<Item = (&'a End, &'a Wire)> {
        self.into.iter().filter(move |(_, wire)| wire.from == *from)
    }
}

impl Wire {
    /// Takes a value over the wire to `to`.
    pub(super) fn pass(&self, tree: &Tree, to: &End, scale: Scale) -> Result<Scale, Error> {
        let target = tree.unit(to.0, &to.1);
        let scale = match self.suppress {
            true => Scale { unit: target, ..scale },
            false => scale.into_unit(target).map_err(|(what, expected)| {
                self.document.wrong(&self.element, format!("{}: {what}", shown(tree, to)), expected)
            })?,
        };
        if self.factor == 1.0 && self.offset == 0.0 {
            return Ok(scale);
        }
        Ok(Scale {
            gain: self.factor * scale.gain,
            bias: self.factor * scale.bias + self.offset,
            unit: scale.unit,
        })
    }
}

impl Scale {
    /// The number of a value in a unit.
    pub(super) fn of(unit: (Option<String>, Option<BaseUnit>)) -> Self {
        Self { gain: 1.0, bias: 0.0, unit }
    }

    /// Converts to a unit, by FMI's rule: base = factor · value + offset. What has no unit is left alone; what has one that nobody
    /// defines can't be.
    pub(super) fn into_unit(
        self,
        unit: (Option<String>, Option<BaseUnit>),
    ) -> Result<Self, (String, String)> {
        let ((_, Some(from)), (Some(name), Some(to))) = (&self.unit, &unit) else {
            if let (Some(from), Some(to)) = (&self.unit.0, &unit.0)
                && from != to
            {
                let what = format!("a value in {from} for one in {to}");
                let unknown = if self.unit.1.is_none() { from } else { to };
                let expected = format!(
                    "a Unit {unknown} among the package's Units or the UnitDefinitions of the FMU, or suppressUnitConversion"
                );
                return Err((what, expected));
            }
            // One name is one unit; where only one has a name, the number passes and takes it along.
            let unit = if unit.0.is_some() { unit } else { self.unit };
            return Ok(Self { unit, ..self });
        };
        if self.unit.0.as_ref() == Some(name) {
            // One name is one unit, though two documents may define it unlike each other.
            return Ok(self);
        }
        if from.exponents != to.exponents {
            let was = self.unit.0.clone().unwrap_or_default();
            let what = format!("a value in {was} for one in {name}");
            return Err((what, "these units don't measure the same quantity".into()));
        }
        if from.factor == to.factor && from.offset == to.offset {
            return Ok(Self { unit, ..self });
        }
        let (gain, bias) = (from.factor / to.factor, (from.offset - to.offset) / to.factor);
        Ok(Self { gain: gain * self.gain, bias: gain * self.bias + bias, unit })
    }
}

/// A connector as a person finds it.
pub(super) fn shown(tree: &Tree, end: &End) -> String {
    match tree.nodes[end.0].path.as_str() {
        "" => format!("the system's connector {}", end.1),
        path => format!("{path}.{}", end.1),
    }
}

fn wire(
    tree: &Tree,
    system: usize,
    part: &Part,
    element: &Element,
    order: usize,
) -> Result<(End, Wire), Error> {
    let document = &part.document;
    let (start, start_way) = end(tree, system, document, element, ["startElement", "startConnector"])?;
    let (stop, stop_way) = end(tree, system, document, element, ["endElement", "endConnector"])?;
    let (from, to) = match (start_way, stop_way) {
        (Way::Source, Way::Sink | Way::Either) | (Way::Either, Way::Sink) => (start, stop),
        (Way::Sink, Way::Source | Way::Either) | (Way::Either, Way::Source) => (stop, start),
        (Way::Either, Way::Either) => (start, stop),
        (same, _) => {
            let (both, lacks) = match same {
                Way::Source => ("give a value", "input or parameter"),
                _ => ("take a value", "output"),
            };
            let what = format!("{} and {} both {both}", shown(tree, &start), shown(tree, &stop));
            return Err(document.wrong(element, what, format!("one of them of kind {lacks}")));
        }
    };
    let Transformation { factor, offset, map } = transformation(tree, document, element, &to)?;
    let wire = Wire {
        from,
        factor,
        offset,
        map,
        suppress: document.flag(element, "suppressUnitConversion")?,
        own: ours(element, annotation::CONNECTION).cloned(),
        document: document.clone(),
        element: element.clone(),
        order,
    };
    Ok((to, wire))
}

/// What becomes of a value on a connection.
struct Transformation {
    factor: f64,
    offset: f64,
    map: Vec<(Toml, Toml)>,
}

fn transformation(
    tree: &Tree,
    document: &Document,
    element: &Element,
    to: &End,
) -> Result<Transformation, Error> {
    let mut all = Transformation { factor: 1.0, offset: 0.0, map: Vec::new() };
    for child in &element.children {
        match child.name.as_str() {
            "LinearTransformation" => {
                let number =
                    |name, default| document.number(child, name).map(|given| given.unwrap_or(default));
                (all.factor, all.offset) = (number("factor", 1.0)?, number("offset", 0.0)?);
            }
            mapping if mapping.ends_with("MappingTransformation") => {
                for row in child.children.iter().filter(|row| row.name == "MapEntry") {
                    let cell = |key| cell(document, row, mapping, key);
                    all.map.push((cell("source")?, cell("target")?));
                }
                if all.map.is_empty() {
                    let what =
                        format!("<{mapping}> without entries on the connection into {}", shown(tree, to));
                    return Err(document.wrong(child, what, "one MapEntry at least"));
                }
            }
            _ => {}
        }
    }
    Ok(all)
}

/// A value of a mapping, by the mapping's type.
fn cell(document: &Document, row: &Element, mapping: &str, key: &str) -> Result<Toml, Error> {
    let text = document.required(row, key)?;
    let wrong = |expected: &str| document.wrong(row, format!("{key}=\"{text}\" in <{mapping}>"), expected);
    match mapping {
        "BooleanMappingTransformation" => match text.trim() {
            "true" | "1" => Ok(Toml::Boolean(true)),
            "false" | "0" => Ok(Toml::Boolean(false)),
            _ => Err(wrong("true or false")),
        },
        "IntegerMappingTransformation" => {
            text.trim().parse().map(Toml::Integer).map_err(|_| wrong("a whole number"))
        }
        _ => Ok(Toml::String(text.to_owned())),
    }
}

fn end(
    tree: &Tree,
    system: usize,
    document: &Document,
    element: &Element,
    [element_key, connector_key]: [&str; 2],
) -> Result<(End, Way), Error> {
    let connector = document.required(element, connector_key)?.to_owned();
    let name = element.attribute(element_key).filter(|name| !name.is_empty());
    let node = match name {
        None => system,
        Some(name) => *tree.nodes[system].children.get(name).ok_or_else(|| {
            let known = nearest(name, tree.nodes[system].children.keys().map(String::as_str));
            document.wrong(element, format!("{element_key}=\"{name}\": there is no such element"), known)
        })?,
    };
    let connectors = &tree.nodes[node].connectors;
    let found = connectors.get(&connector).ok_or_else(|| {
        let what = format!(
            "{connector_key}=\"{connector}\": {} has no such connector",
            name.unwrap_or("the system")
        );
        let mut known: Vec<&str> = connectors.keys().map(String::as_str).collect();
        known.sort_unstable();
        document.wrong(element, what, nearest(&connector, known.into_iter()))
    })?;
    let way = match (found.way, name.is_none() || matches!(tree.nodes[node].kind, Kind::Dictionary)) {
        (way, false) => way,
        (_, true) if name.is_some() => Way::Either,
        (Way::Source, true) => Way::Sink,
        (Way::Sink, true) => Way::Source,
        (Way::Either, true) => Way::Either,
    };
    Ok(((node, connector), way))
}
