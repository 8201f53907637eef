//! The description against the standard's XML schema (FMI 2.0.4 section 2.2), as tables: which elements stand where, and
//! what their attributes hold.

use super::File;
use crate::finding::Found;
use crate::model;
use crate::xml::Element;
use orchestrator::nearest;

pub(super) fn well_formed(file: &File<'_>, found: &mut Found) {
    if let Some(Err((line, what))) = file.tree {
        found.error_at(*line, what);
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

/// What an attribute holds.
enum Holds {
    Text,
    Double,
    Int,
    Unsigned,
    Boolean,
    DateTime,
    OneOf(&'static [&'static str]),
    Unsigneds,
    Kinds,
}
use Holds::{Boolean, DateTime, Double, Int, Kinds, OneOf, Text, Unsigned, Unsigneds};

struct Attribute {
    name: &'static str,
    holds: Holds,
    needed: bool,
}

const fn may(name: &'static str, holds: Holds) -> Attribute {
    Attribute { name, holds, needed: false }
}

const fn must(name: &'static str, holds: Holds) -> Attribute {
    Attribute { name, holds, needed: true }
}

/// Elements of which so many stand at one place.
struct Group {
    of: &'static [&'static Shape],
    least: usize,
    most: usize,
}

const MANY: usize = usize::MAX;

const fn group(of: &'static [&'static Shape], least: usize, most: usize) -> Group {
    Group { of, least, most }
}

/// An element.
struct Shape {
    name: &'static str,
    attributes: &'static [Attribute],
    /// In the order in which they stand.
    children: &'static [Group],
}

const fn leaf(name: &'static str, attributes: &'static [Attribute]) -> Shape {
    Shape { name, attributes, children: &[] }
}

static ROOT: Shape = Shape {
    name: "fmiModelDescription",
    attributes: &[
        must("fmiVersion", Text),
        must("modelName", Text),
        must("guid", Text),
        may("description", Text),
        may("author", Text),
        may("version", Text),
        may("copyright", Text),
        may("license", Text),
        may("generationTool", Text),
        may("generationDateAndTime", DateTime),
        may("variableNamingConvention", OneOf(&["flat", "structured"])),
        may("numberOfEventIndicators", Unsigned),
    ],
    children: &[
        group(&[&MODEL_EXCHANGE, &CO_SIMULATION], 1, 2),
        group(&[&UNIT_DEFINITIONS], 0, 1),
        group(&[&TYPE_DEFINITIONS], 0, 1),
        group(&[&LOG_CATEGORIES], 0, 1),
        group(&[&DEFAULT_EXPERIMENT], 0, 1),
        group(&[&VENDOR_ANNOTATIONS], 0, 1),
        group(&[&MODEL_VARIABLES], 1, 1),
        group(&[&MODEL_STRUCTURE], 1, 1),
    ],
};
static MODEL_EXCHANGE: Shape = Shape {
    name: "ModelExchange",
    attributes: &[
        must("modelIdentifier", Text),
        may("needsExecutionTool", Boolean),
        may("completedIntegratorStepNotNeeded", Boolean),
        may("canBeInstantiatedOnlyOncePerProcess", Boolean),
        may("canNotUseMemoryManagementFunctions", Boolean),
        may("canGetAndSetFMUstate", Boolean),
        may("canSerializeFMUstate", Boolean),
        may("providesDirectionalDerivative", Boolean),
    ],
    children: &[group(&[&SOURCE_FILES], 0, 1)],
};
static CO_SIMULATION: Shape = Shape {
    name: "CoSimulation",
    attributes: &[
        must("modelIdentifier", Text),
        may("needsExecutionTool", Boolean),
        may("canHandleVariableCommunicationStepSize", Boolean),
        may("canInterpolateInputs", Boolean),
        may("maxOutputDerivativeOrder", Unsigned),
        may("canRunAsynchronuously", Boolean),
        may("canBeInstantiatedOnlyOncePerProcess", Boolean),
        may("canNotUseMemoryManagementFunctions", Boolean),
        may("canGetAndSetFMUstate", Boolean),
        may("canSerializeFMUstate", Boolean),
        may("providesDirectionalDerivative", Boolean),
    ],
    children: &[group(&[&SOURCE_FILES], 0, 1)],
};
static SOURCE_FILES: Shape =
    Shape { name: "SourceFiles", attributes: &[], children: &[group(&[&FILE], 1, MANY)] };
static FILE: Shape = leaf("File", &[must("name", Text)]);
static UNIT_DEFINITIONS: Shape =
    Shape { name: "UnitDefinitions", attributes: &[], children: &[group(&[&UNIT], 1, MANY)] };
static UNIT: Shape = Shape {
    name: "Unit",
    attributes: &[must("name", Text)],
    children: &[group(&[&BASE_UNIT], 0, 1), group(&[&DISPLAY_UNIT], 0, MANY)],
};
static BASE_UNIT: Shape = leaf(
    "BaseUnit",
    &[
        may("kg", Int),
        may("m", Int),
        may("s", Int),
        may("A", Int),
        may("K", Int),
        may("mol", Int),
        may("cd", Int),
        may("rad", Int),
        may("factor", Double),
        may("offset", Double),
    ],
);
static DISPLAY_UNIT: Shape =
    leaf("DisplayUnit", &[must("name", Text), may("factor", Double), may("offset", Double)]);
static TYPE_DEFINITIONS: Shape =
    Shape { name: "TypeDefinitions", attributes: &[], children: &[group(&[&SIMPLE_TYPE], 1, MANY)] };
static SIMPLE_TYPE: Shape = Shape {
    name: "SimpleType",
    attributes: &[must("name", Text), may("description", Text)],
    children: &[group(&[&TYPE_REAL, &TYPE_INTEGER, &TYPE_BOOLEAN, &TYPE_STRING, &TYPE_ENUMERATION], 1, 1)],
};
static TYPE_REAL: Shape = leaf(
    "Real",
    &[
        may("quantity", Text),
        may("unit", Text),
        may("displayUnit", Text),
        may("relativeQuantity", Boolean),
        may("min", Double),
        may("max", Double),
        may("nominal", Double),
        may("unbounded", Boolean),
    ],
);
static TYPE_INTEGER: Shape = leaf("Integer", &[may("quantity", Text), may("min", Int), may("max", Int)]);
static TYPE_BOOLEAN: Shape = leaf("Boolean", &[]);
static TYPE_STRING: Shape = leaf("String", &[]);
static TYPE_ENUMERATION: Shape = Shape {
    name: "Enumeration",
    attributes: &[may("quantity", Text)],
    children: &[group(&[&ITEM], 1, MANY)],
};
static ITEM: Shape = leaf("Item", &[must("name", Text), must("value", Int), may("description", Text)]);
static LOG_CATEGORIES: Shape =
    Shape { name: "LogCategories", attributes: &[], children: &[group(&[&CATEGORY], 1, MANY)] };
static CATEGORY: Shape = leaf("Category", &[must("name", Text), may("description", Text)]);
static DEFAULT_EXPERIMENT: Shape = leaf(
    "DefaultExperiment",
    &[may("startTime", Double), may("stopTime", Double), may("tolerance", Double), may("stepSize", Double)],
);
static VENDOR_ANNOTATIONS: Shape =
    Shape { name: "VendorAnnotations", attributes: &[], children: &[group(&[&TOOL], 1, MANY)] };
static ANNOTATIONS: Shape =
    Shape { name: "Annotations", attributes: &[], children: &[group(&[&TOOL], 1, MANY)] };
static TOOL: Shape = leaf("Tool", &[must("name", Text)]);
static MODEL_VARIABLES: Shape =
    Shape { name: "ModelVariables", attributes: &[], children: &[group(&[&SCALAR_VARIABLE], 1, MANY)] };
static SCALAR_VARIABLE: Shape = Shape {
    name: "ScalarVariable",
    attributes: &[
        must("name", Text),
        must("valueReference", Unsigned),
        may("description", Text),
        may(
            "causality",
            OneOf(&["parameter", "calculatedParameter", "input", "output", "local", "independent"]),
        ),
        may("variability", OneOf(&["constant", "fixed", "tunable", "discrete", "continuous"])),
        may("initial", OneOf(&["exact", "approx", "calculated"])),
        may("canHandleMultipleSetPerTimeInstant", Boolean),
    ],
    children: &[
        group(&[&REAL, &INTEGER, &BOOLEAN, &STRING, &ENUMERATION], 1, 1),
        group(&[&ANNOTATIONS], 0, 1),
    ],
};
static REAL: Shape = leaf(
    "Real",
    &[
        may("declaredType", Text),
        may("quantity", Text),
        may("unit", Text),
        may("displayUnit", Text),
        may("relativeQuantity", Boolean),
        may("min", Double),
        may("max", Double),
        may("nominal", Double),
        may("unbounded", Boolean),
        may("start", Double),
        may("derivative", Unsigned),
        may("reinit", Boolean),
    ],
);
static INTEGER: Shape = leaf(
    "Integer",
    &[may("declaredType", Text), may("quantity", Text), may("min", Int), may("max", Int), may("start", Int)],
);
static BOOLEAN: Shape = leaf("Boolean", &[may("declaredType", Text), may("start", Boolean)]);
static STRING: Shape = leaf("String", &[may("declaredType", Text), may("start", Text)]);
static ENUMERATION: Shape = leaf(
    "Enumeration",
    &[must("declaredType", Text), may("quantity", Text), may("min", Int), may("max", Int), may("start", Int)],
);
static MODEL_STRUCTURE: Shape = Shape {
    name: "ModelStructure",
    attributes: &[],
    children: &[group(&[&OUTPUTS], 0, 1), group(&[&DERIVATIVES], 0, 1), group(&[&INITIAL_UNKNOWNS], 0, 1)],
};
static OUTPUTS: Shape = Shape { name: "Outputs", attributes: &[], children: &[group(&[&UNKNOWN], 1, MANY)] };
static DERIVATIVES: Shape =
    Shape { name: "Derivatives", attributes: &[], children: &[group(&[&UNKNOWN], 1, MANY)] };
static INITIAL_UNKNOWNS: Shape =
    Shape { name: "InitialUnknowns", attributes: &[], children: &[group(&[&UNKNOWN], 1, MANY)] };
static UNKNOWN: Shape = leaf(
    "Unknown",
    &[must("index", Unsigned), may("dependencies", Unsigneds), may("dependenciesKind", Kinds)],
);

fn check(element: &Element, shape: &'static Shape, found: &mut Found) {
    attributes(element, shape, found);
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
                if let Some(expected) = attribute.holds.wrong(value) {
                    let what = format!(
                        "{name}=\"{value}\" in <{}>{}: wanted is {expected}",
                        shape.name,
                        named(element)
                    );
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

/// What `dependenciesKind` may hold.
const KINDS: &[&str] = &["dependent", "constant", "fixed", "tunable", "discrete"];

impl Holds {
    /// What would be right, where a value is not.
    fn wrong(&self, value: &str) -> Option<String> {
        let text = value.trim();
        let unsigned = |text: &str| text.parse::<u32>().is_ok();
        let (right, expected) = match self {
            Self::Text => return None,
            Self::Double => (model::number(text).is_some(), "a number"),
            Self::Int => (text.parse::<i32>().is_ok(), "an integer of 32 bits"),
            Self::Unsigned => (unsigned(text), "a whole number of 32 bits, 0 or more"),
            Self::Boolean => (matches!(text, "true" | "false" | "1" | "0"), "true or false"),
            Self::DateTime => (is_date_and_time(text), "a date and time such as 2026-11-24T12:00:00Z"),
            Self::Unsigneds => (text.split_whitespace().all(unsigned), "indices, parted by spaces"),
            Self::OneOf(names) => {
                return (!names.contains(&text)).then(|| nearest(text, names.iter().copied()));
            }
            Self::Kinds => {
                let wrong = text.split_whitespace().find(|word| !KINDS.contains(word))?;
                return Some(format!("one of {} ({wrong} is none)", KINDS.join(", ")));
            }
        };
        (!right).then(|| expected.to_owned())
    }
}

/// `xs:dateTime`: 2026-11-24T12:00:00, with a fraction of the second and a zone if wanted.
fn is_date_and_time(text: &str) -> bool {
    let pattern = |text: &str, pattern: &str| {
        text.len() == pattern.len()
            && text
                .bytes()
                .zip(pattern.bytes())
                .all(|(a, b)| if b == b'0' { a.is_ascii_digit() } else { a == b })
    };
    let Some(rest) = text.get(..19).filter(|head| pattern(head, "0000-00-00T00:00:00")).and(text.get(19..))
    else {
        return false;
    };
    let rest = match rest.strip_prefix('.') {
        Some(fraction) => {
            let zone = fraction.trim_start_matches(|c: char| c.is_ascii_digit());
            if zone.len() == fraction.len() {
                return false;
            }
            zone
        }
        None => rest,
    };
    rest.is_empty() || rest == "Z" || pattern(rest, "+00:00") || pattern(rest, "-00:00")
}
