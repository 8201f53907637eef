//! The description against the standard's XML schema (FMI 2.0.4 section 2.2), as tables: which elements stand where, and
//! what their attributes hold.

mod holds;
mod tables;

use super::File;
use crate::finding::Found;
use crate::xml::Element;
use orchestrator::nearest;
use tables::{Group, ROOT, Shape};

/// Elements and texts of a description, at most, of which a second tree is made: a few hundred MB.
const MOST_NODES: u32 = 1 << 23;

/// Whether it is XML. Our own reader goes on where it can; one that goes by the letter says what other readers refuse. It is not asked of what
/// defines entities, which a few bytes blow up to any size, nor of more than it may hold.
pub(super) fn well_formed(file: &File<'_>, found: &mut Found) {
    if let Some(Err((line, what))) = file.tree {
        return found.error_at(*line, what);
    }
    let Ok(Ok(text)) = &file.archive.description else { return };
    let options = roxmltree::ParsingOptions { nodes_limit: MOST_NODES, ..Default::default() };
    match roxmltree::Document::parse_with_options(text, options) {
        Ok(_) | Err(roxmltree::Error::NodesLimitReached) => {}
        Err(roxmltree::Error::DtdDetected) => {
            let before = text.find("<!DOCTYPE").map_or("", |place| &text[..place]);
            let what = "a document type definition: FMI knows none, and readers refuse it or put in whatever it says";
            found.warning_at(1 + before.matches('\n').count(), what);
        }
        Err(error) => found.error_at(error.pos().row as usize, error),
    }
}

/// Whether it is a description of FMI 2.0.
pub(super) fn is_ours(root: &Element) -> bool {
    root.name == ROOT.name && root.attribute("fmiVersion") == Some("2.0")
}

pub(super) fn schema(file: &File<'_>, found: &mut Found) {
    let Some(root) = file.root() else { return };
    if root.name != ROOT.name {
        return found.error_at(root.line, format!("the root is <{}>, not <{}>", root.name, ROOT.name));
    }
    if let Some(version) = root.attribute("fmiVersion").filter(|version| *version != "2.0") {
        return found.error_at(root.line, format!("fmiVersion=\"{version}\": only \"2.0\" is checked"));
    }
    check(root, &ROOT, found);
}

fn check(element: &Element, shape: &'static Shape, found: &mut Found) {
    attributes(element, shape, found);
    no_text(element, shape, found);
    let mut counts = vec![0usize; shape.children.len()];
    let mut reached = 0;
    for child in &element.children {
        let place = |group: &Group| group.of.iter().find(|shape| shape.name == child.name);
        let at = (reached..shape.children.len())
            .chain(0..reached)
            .find(|at| place(&shape.children[*at]).is_some());
        let Some(at) = at else {
            let known = shape.children.iter().flat_map(|group| group.of).map(|shape| shape.name);
            let hint = nearest(&child.name, known);
            found.error_at(
                child.line,
                format!("<{}> does not belong in <{}>: {hint}", child.name, shape.name),
            );
            continue;
        };
        if at < reached {
            let after = shape.children[reached].of[0].name;
            found.error_at(child.line, format!("<{}> must stand before <{after}>", child.name));
        }
        reached = reached.max(at);
        counts[at] += 1;
        if let Some(shape) = place(&shape.children[at]) {
            check(child, shape, found);
        }
    }
    for (group, count) in shape.children.iter().zip(counts) {
        let names: Vec<String> = group.of.iter().map(|shape| format!("<{}>", shape.name)).collect();
        let names = names.join(" or ");
        if count < group.least {
            found.error_at(element.line, format!("<{}>{} lacks {names}", shape.name, named(element)));
        }
        if count > group.most {
            let most = group.most;
            found.error_at(
                element.line,
                format!(
                    "<{}>{} has {count} of {names}; at most {most} may stand there",
                    shape.name,
                    named(element)
                ),
            );
        }
    }
}

/// No element of a description has text between its elements.
fn no_text(element: &Element, shape: &Shape, found: &mut Found) {
    let Some((line, text)) = &element.text else { return };
    let told: String = text.chars().take(40).collect();
    let (shape, name) = (shape.name, named(element));
    let what = format!("<{shape}>{name} holds the text {told:?}: elements only, or nothing, may stand there");
    found.error_at(*line, what);
}

/// Which one of many elements.
fn named(element: &Element) -> String {
    element.attribute("name").map_or_else(String::new, |name| format!(" {name}"))
}

fn attributes(element: &Element, shape: &Shape, found: &mut Found) {
    for (name, value) in &element.attributes {
        match shape.attributes.iter().find(|attribute| attribute.name == name) {
            None => {
                let hint = nearest(name, shape.attributes.iter().map(|attribute| attribute.name));
                let what =
                    format!("<{}>{} has an unknown attribute {name}: {hint}", shape.name, named(element));
                found.error_at(element.line, what);
            }
            Some(attribute) => {
                if let Some(right) = attribute.holds.wrong(value) {
                    let what = format!("{name}=\"{value}\" in <{}>{}: {right}", shape.name, named(element));
                    found.error_at(element.line, what);
                }
            }
        }
    }
    for attribute in shape.attributes.iter().filter(|attribute| attribute.needed) {
        if element.attribute(attribute.name).is_none() {
            let what = format!("<{}>{} lacks the attribute {}", shape.name, named(element), attribute.name);
            found.error_at(element.line, what);
        }
    }
}
