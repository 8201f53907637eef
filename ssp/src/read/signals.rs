//! What our annotation on the whole holds: the algorithm, what is recorded, signals from outside, the report.

use super::document::Document;
use super::source::resolve;
use super::tree::Tree;
use crate::{Error, annotation};
use orchestrator::Scenario;
use orchestrator::scenario::{Placed, Shape, SignalEntry, SourceEntry, table};
use orchestrator::xml::Element;
use toml::Value as Toml;

pub(super) fn read(scenario: &mut Scenario, tree: &mut Tree) -> Result<(), Error> {
    let part = tree.nodes[0].parts[0].clone();
    let document = part.document.clone();
    let Some(own) = super::document::ours(&document.root, annotation::EXPERIMENT) else { return Ok(()) };
    if let Some(name) = own.attribute("algorithm") {
        scenario.algorithm = Placed { value: name.to_owned(), place: document.place(own) };
    }
    scenario.seed = super::timing::seed(&document, own)?.unwrap_or(0);
    let mut patterns = Vec::new();
    for child in &own.children {
        match child.name.as_str() {
            annotation::OPTION => {
                let name = document.required(child, "name")?.to_owned();
                document.required(child, "value")?;
                let value = document.number(child, "value")?.unwrap_or_default();
                scenario.options.push((name, Placed { value, place: document.place(child) }));
            }
            annotation::RECORD => {
                let value = document.required(child, "pattern")?.to_owned();
                patterns.push(Placed { value, place: document.place(child) });
            }
            annotation::SOURCE => {
                let signal = signal(&document, child, |uri| file(tree, &document, child, uri))?;
                let to = document.required(child, "to")?.to_owned();
                scenario.sources.push(SourceEntry { to, signal, place: document.place(child) });
            }
            annotation::REPORT => {
                let (name, text) = file(tree, &document, child, document.required(child, "source")?)?;
                scenario.report = text.parse().map_err(|error: toml::de::Error| {
                    let what = format!("{name}: {}", error.message().replace('\n', " "));
                    document.wrong(child, what, "the table [report] of a scenario")
                })?;
            }
            _ => {}
        }
    }
    if own.attribute("record") == Some("chosen") {
        scenario.record = Some(patterns);
    }
    Ok(())
}

/// Name and text of a file of the package.
fn file(
    tree: &mut Tree,
    document: &Document,
    element: &Element,
    uri: &str,
) -> Result<(String, String), Error> {
    let part = tree.nodes[0].parts[0].clone();
    let name = resolve(document, element, &part.base, uri)?;
    match tree.packages.get_mut(&part.package) {
        Some(package) => Ok((format!("{}/{name}", package.path().display()), package.read_text(&name)?)),
        None => Err(document.wrong(element, format!("source=\"{uri}\""), "an open package")),
    }
}

fn signal(
    document: &Document,
    element: &Element,
    file: impl FnOnce(&str) -> Result<(String, String), Error>,
) -> Result<SignalEntry, Error> {
    let kind = document.required(element, "kind")?;
    let shape = match kind {
        "constant" => return constant(document, element).map(SignalEntry::Constant),
        "hold" => Shape::Hold,
        "linear" => Shape::Linear,
        "smooth" => Shape::Smooth,
        other => {
            let expected = "constant, hold, linear or smooth";
            return Err(document.wrong(element, format!("kind=\"{other}\" of a signal"), expected));
        }
    };
    let (name, text) = file(document.required(element, "file")?)?;
    let column = document.required(element, "column")?;
    let points =
        table(&text, &name, column).map_err(|(what, expected)| document.wrong(element, what, expected))?;
    Ok(SignalEntry::Table { shape, points })
}

fn constant(document: &Document, element: &Element) -> Result<Toml, Error> {
    let text = document.required(element, "value")?;
    let wrong = |expected: &str| document.wrong(element, format!("value=\"{text}\" of a signal"), expected);
    Ok(match document.required(element, "type")? {
        "Real" => Toml::Float(document.number(element, "value")?.unwrap_or_default()),
        "Integer" => Toml::Integer(text.parse().map_err(|_| wrong("an integer"))?),
        "Boolean" => Toml::Boolean(super::values::boolean(text).ok_or_else(|| wrong("true or false"))?),
        "String" => Toml::String(text.to_owned()),
        other => {
            let expected = "Real, Integer, Boolean or String";
            return Err(document.wrong(element, format!("type=\"{other}\" of a signal"), expected));
        }
    })
}
