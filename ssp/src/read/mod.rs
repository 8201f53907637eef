//! From a package to a scenario.

mod bindings;
mod document;
mod signals;
mod source;
mod timing;
mod tree;
mod values;
mod wires;

use crate::Error;
use document::Document;
use orchestrator::package::Package;
use orchestrator::scenario::{Channel, ConnectionEntry, Placed, Transform, UnitEntry};
use orchestrator::time::Rational;
use orchestrator::{Place, Scenario};
use std::collections::BTreeSet;
use std::path::Path;
use std::rc::Rc;
use tree::Tree;
use wires::{Scale, Wires, shown};

/// The document that is run.
pub(crate) const MAIN: &str = "SystemStructure.ssd";

/// Reads a package. Its units stay where they are: the scenario names them as `package.ssp#resources/unit.fmu`, and a
/// simulation unpacks them for as long as it lives.
///
/// # Errors
/// If it can't be read, breaks the standard, leads outside of itself, or says what a scenario can't express.
pub fn read(path: &Path) -> Result<Scenario, Error> {
    let mut package = Package::open(path)?;
    let document = Rc::new(Document::open(&mut package, MAIN, "SystemStructureDescription")?);
    let mut notes = Vec::new();
    let others = package.names().into_iter().filter(|name| name.ends_with(".ssd") && name != MAIN);
    let others: Vec<String> = others.filter(|name| !name.contains('/')).collect();
    if !others.is_empty() {
        notes.push(format!("{}: {MAIN} is run; it also holds {}", path.display(), others.join(", ")));
    }
    // Scenarios name files from their own folder on.
    let name = path.file_name().unwrap_or_default();
    let mut tree = Tree::read(package, Path::new(name), path, document.clone())?;
    let wires = Wires::read(&tree)?;
    let span = timing::span(&tree, &mut notes)?;
    let place = Place::Line { file: document.file.clone(), line: document.root.line };
    let mut scenario = Scenario::new(path, span.start, span.stop, place);
    let described = document.root.attribute("description").or_else(|| document.root.attribute("name"));
    scenario.description = described.unwrap_or_default().to_owned();
    let intervals = timing::intervals(&tree, &span, &mut notes)?;
    let starts = bindings::read(&mut tree, &wires)?;
    notes.extend(starts.notes);
    let names = names(&tree, &mut notes);
    notes.extend(other_implementations(&tree));
    if tree.components.is_empty() {
        let what = "no component";
        return Err(document.wrong(&document.root, what, "one at least: there is nothing to run"));
    }
    for ((at, component), set) in tree.components.iter().enumerate().zip(starts.of) {
        let place = component.part.document.place(&component.part.element);
        scenario.units.push(UnitEntry {
            name: names[at].clone(),
            fmu: Placed { value: component.fmu.clone(), place: place.clone() },
            interval: intervals[at],
            offset: timing::offset(component)?,
            isolation: timing::isolation(component)?,
            retry: timing::retry(component)?,
            set,
            place,
        });
    }
    connect(&mut scenario, &tree, &wires, &names)?;
    signals::read(&mut scenario, &mut tree)?;
    notes.into_iter().for_each(|note| scenario.note(note));
    Ok(scenario)
}

/// The name of each component's unit: its path, without what a scenario gives a meaning to.
fn names(tree: &Tree, notes: &mut Vec<String>) -> Vec<String> {
    let mut taken: BTreeSet<String> = BTreeSet::new();
    let mut names = Vec::with_capacity(tree.components.len());
    for component in &tree.components {
        let path = &tree.nodes[component.node].path;
        let plain: String =
            path.chars().map(|c| if ".*=#".contains(c) || c.is_whitespace() { '_' } else { c }).collect();
        let numbered = (2..).map(|number| format!("{plain}_{number}"));
        let mut free = std::iter::once(plain.clone()).chain(numbered).filter(|name| !taken.contains(name));
        let name = free.next().unwrap_or_default(); // there is always a number left
        if name != *path {
            notes.push(format!("component {path:?} is the unit {name}"));
        }
        taken.insert(name.clone());
        names.push(name);
    }
    names
}

/// Units that are to be run otherwise than a master of co-simulations can: they run by their own solvers, which they have,
/// or their descriptions would have been refused.
fn other_implementations(tree: &Tree) -> Option<String> {
    let is_other = |component: &&tree::Component| {
        let implementation = component.part.element.attribute("implementation").unwrap_or("any");
        !["any", "CoSimulation"].contains(&implementation)
    };
    let others: Vec<&str> = (tree.components.iter().filter(is_other))
        .map(|component| tree.nodes[component.node].path.as_str())
        .collect();
    let file = &tree.nodes[0].parts[0].document.file;
    (!others.is_empty()).then(|| {
        let others = others.join(", ");
        format!("{file}: implementation=\"ModelExchange\" of {others}: they run as co-simulation units, which they are, too")
    })
}

fn connect(scenario: &mut Scenario, tree: &Tree, wires: &Wires, names: &[String]) -> Result<(), Error> {
    let variable = |end: &wires::End| match tree.nodes[end.0].kind {
        tree::Kind::Component(component) => format!("{}.{}", names[component], end.1),
        _ => shown(tree, end),
    };
    for path in wires.paths(tree)? {
        let (mut delay, mut channel) = (Rational::ZERO, Channel::default());
        let mut map = Vec::new();
        let mut scale = Scale::of(tree.unit(path.from.0, &path.from.1));
        let ends = path.wires.iter().skip(1).map(|wire| &wire.from).chain([&path.to]);
        for (wire, to) in path.wires.iter().zip(ends) {
            scale = wire.pass(tree, to, scale)?;
            if !wire.map.is_empty() {
                if !map.is_empty() {
                    let what = format!("a second mapping on the way to {}", variable(&path.to));
                    return Err(wire.document.wrong(&wire.element, what, "one, on one of the connections"));
                }
                map.clone_from(&wire.map);
            }
            if let Some(own) = &wire.own {
                let (more, way) = timing::channel(&wire.document, own)?;
                delay = timing::sum(delay, more).ok_or_else(|| {
                    wire.document.wrong(
                        own,
                        format!("latency=\"{more}\""),
                        "a sum that fits 64-bit fractions",
                    )
                })?;
                if way != Channel::default() && channel != Channel::default() {
                    let what =
                        format!("jitter, drop or hold a second time on the way to {}", variable(&path.to));
                    return Err(wire.document.wrong(own, what, "once, on one of the connections"));
                }
                channel = if way == Channel::default() { channel } else { way };
            }
        }
        let last = &path.wires[path.wires.len() - 1];
        scenario.connections.push(ConnectionEntry {
            from: variable(&path.from),
            to: variable(&path.to),
            delay,
            channel,
            transform: if map.is_empty() { transform(tree, &path, &scale) } else { Transform::default() },
            map,
            place: last.document.place(&last.element),
        });
    }
    Ok(())
}

/// What the scenario has to do so that the value becomes what the package says: nothing, where the descriptions of both
/// units lead to the same.
fn transform(tree: &Tree, path: &wires::Path, scale: &Scale) -> Transform {
    let described = |end: &wires::End| match tree.nodes[end.0].kind {
        tree::Kind::Component(component) => {
            let description = &tree.components[component].description;
            let variable = description.variable(&end.1)?;
            Some((description.unit(variable.unit.as_deref()?)?.base?, variable.relative_quantity))
        }
        _ => None,
    };
    let own = match (described(&path.from), described(&path.to)) {
        (Some((from, from_difference)), Some((to, to_difference))) if from.exponents == to.exponents => {
            let gain = from.factor / to.factor;
            let difference = from_difference && to_difference;
            Some((gain, if difference { 0.0 } else { (from.offset - to.offset) / to.factor }))
        }
        (Some(_), Some(_)) => None, // the units don't fit, and only the package may say that this is meant
        _ => Some((1.0, 0.0)),
    };
    let plain = path.wires.iter().all(|wire| wire.factor == 1.0 && wire.offset == 0.0 && !wire.suppress);
    let (gain, bias) = (scale.gain, scale.bias);
    match own {
        Some(own) if plain && own == (gain, bias) => Transform::default(),
        Some((1.0, 0.0)) => Transform { gain, bias, convert_units: true },
        _ => Transform { gain, bias, convert_units: false },
    }
}
