//! Reads `modelDescription.xml` into a [`Description`]; what is wrong is said with its line.

use crate::fmu::description::{
    BaseUnit, Causality, CoSimulation, DefaultExperiment, Description, Initial, UnitDefinition, Unknown,
    Variability, Variable,
};

use crate::value::{Kind, Value};
use crate::xml::Element;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// The elements that are read; all others are passed over with what is in them.
const KNOWN: &[&str] = &[
    "fmiModelDescription",
    "CoSimulation",
    "UnitDefinitions",
    "Unit",
    "BaseUnit",
    "DisplayUnit",
    "TypeDefinitions",
    "SimpleType",
    "Real",
    "Integer",
    "Boolean",
    "String",
    "Enumeration",
    "Item",
    "LogCategories",
    "Category",
    "DefaultExperiment",
    "ModelVariables",
    "ScalarVariable",
    "ModelStructure",
    "Outputs",
    "InitialUnknowns",
    "Unknown",
];

/// Line, what is wrong.
type Fault = (usize, String);

/// Reads a description; an error is the line and what is wrong there.
pub(super) fn description(text: &str) -> Result<Description, Fault> {
    let root = Element::parse_known(text, KNOWN)?;
    if root.name != "fmiModelDescription" {
        return Err((root.line, format!("the root is <{}>, not <fmiModelDescription>", root.name)));
    }
    let version = required(&root, "fmiVersion")?;
    if version != "2.0" {
        return Err((root.line, format!("fmiVersion is \"{version}\"; this master runs FMI \"2.0\"")));
    }
    let Some(slave) = root.child("CoSimulation") else {
        return Err((
            root.line,
            "there is no <CoSimulation>; a unit for model exchange can't be stepped".into(),
        ));
    };
    let types = root.list("TypeDefinitions");
    let mut variables = Vec::new();
    for element in root.list("ModelVariables").iter().filter(|e| e.name == "ScalarVariable") {
        variables.push(variable(element, types)?);
    }
    let mut names = HashMap::with_capacity(variables.len());
    let mut repeated = HashSet::new();
    for (place, variable) in variables.iter().enumerate() {
        if names.insert(variable.name.clone(), place).is_some() {
            repeated.insert(variable.name.clone());
        }
    }
    let structure = |list: &str| -> Result<Vec<Unknown>, Fault> {
        let Some(structure) = root.child("ModelStructure") else { return Ok(Vec::new()) };
        structure.list(list).iter().map(|element| unknown(element, variables.len())).collect()
    };
    let (outputs, initial_unknowns) = (structure("Outputs")?, structure("InitialUnknowns")?);
    let text = |name: &str| root.attribute(name).unwrap_or_default().to_owned();
    Ok(Description {
        model_name: required(&root, "modelName")?.to_owned(),
        guid: required(&root, "guid")?.to_owned(),
        description: text("description"),
        version: text("version"),
        generation_tool: text("generationTool"),
        co_simulation: co_simulation(slave)?,
        units: root.list("UnitDefinitions").iter().map(unit_definition).collect::<Result<_, _>>()?,
        default_experiment: default_experiment(&root)?,
        log_categories: root
            .list("LogCategories")
            .iter()
            .filter_map(|category| category.attribute("name").map(str::to_owned))
            .collect(),
        variables,
        outputs,
        initial_unknowns,
        names,
        repeated,
    })
}

fn required<'a>(element: &'a Element, name: &str) -> Result<&'a str, Fault> {
    element
        .attribute(name)
        .ok_or_else(|| (element.line, format!("<{}> lacks the attribute {name}", element.name)))
}

fn parsed<T: std::str::FromStr>(element: &Element, name: &str, what: &str) -> Result<Option<T>, Fault> {
    let Some(text) = element.attribute(name) else { return Ok(None) };
    let wrong = || (element.line, format!("{name}=\"{text}\" in <{}> is not {what}", element.name));
    text.trim().parse().map(Some).map_err(|_| wrong())
}

fn flag(element: &Element, name: &str) -> Result<Option<bool>, Fault> {
    match element.attribute(name).map(str::trim) {
        None => Ok(None),
        Some("true" | "1") => Ok(Some(true)),
        Some("false" | "0") => Ok(Some(false)),
        Some(text) => {
            Err((element.line, format!("{name}=\"{text}\" in <{}> is neither true nor false", element.name)))
        }
    }
}

const NUMBER: &str = "a number";
const INTEGER: &str = "an integer";

fn co_simulation(element: &Element) -> Result<CoSimulation, Fault> {
    let flag = |name| flag(element, name).map(Option::unwrap_or_default);
    let identifier = required(element, "modelIdentifier")?;
    // It becomes the name of a file, which nobody shall lead out of the archive.
    let begins = identifier.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_');
    if !begins || !identifier.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_') {
        let expected = "letters, digits and underscores, a digit not first";
        let what = format!("modelIdentifier=\"{identifier}\" is no C identifier: {expected}");
        return Err((element.line, what));
    }
    Ok(CoSimulation {
        model_identifier: identifier.to_owned(),
        needs_execution_tool: flag("needsExecutionTool")?,
        can_handle_variable_step: flag("canHandleVariableCommunicationStepSize")?,
        can_interpolate_inputs: flag("canInterpolateInputs")?,
        max_output_derivative_order: parsed(element, "maxOutputDerivativeOrder", INTEGER)?.unwrap_or(0),
        can_run_asynchronously: flag("canRunAsynchronuously")?,
        only_one_instance: flag("canBeInstantiatedOnlyOncePerProcess")?,
        can_not_use_memory_functions: flag("canNotUseMemoryManagementFunctions")?,
        can_get_and_set_state: flag("canGetAndSetFMUstate")?,
        can_serialize_state: flag("canSerializeFMUstate")?,
        provides_directional_derivative: flag("providesDirectionalDerivative")?,
    })
}

fn default_experiment(root: &Element) -> Result<DefaultExperiment, Fault> {
    let Some(element) = root.child("DefaultExperiment") else { return Ok(DefaultExperiment::default()) };
    Ok(DefaultExperiment {
        start: parsed(element, "startTime", NUMBER)?,
        stop: parsed(element, "stopTime", NUMBER)?,
        tolerance: parsed(element, "tolerance", NUMBER)?,
        step_size: parsed(element, "stepSize", NUMBER)?,
    })
}

fn unit_definition(element: &Element) -> Result<UnitDefinition, Fault> {
    let base = match element.child("BaseUnit") {
        None => None,
        Some(base) => {
            let mut exponents = [0; 8];
            for (exponent, name) in exponents.iter_mut().zip(["kg", "m", "s", "A", "K", "mol", "cd", "rad"]) {
                *exponent = parsed(base, name, INTEGER)?.unwrap_or(0);
            }
            let factor = parsed(base, "factor", NUMBER)?.unwrap_or(1.0);
            if factor == 0.0 {
                return Err((
                    base.line,
                    "factor=\"0\" in <BaseUnit>: nothing could be converted back".into(),
                ));
            }
            Some(BaseUnit { exponents, factor, offset: parsed(base, "offset", NUMBER)?.unwrap_or(0.0) })
        }
    };
    let mut display = Vec::new();
    for shown in element.children.iter().filter(|child| child.name == "DisplayUnit") {
        let factor = parsed(shown, "factor", NUMBER)?.unwrap_or(1.0);
        let offset = parsed(shown, "offset", NUMBER)?.unwrap_or(0.0);
        display.push((required(shown, "name")?.to_owned(), factor, offset));
    }
    Ok(UnitDefinition { name: required(element, "name")?.to_owned(), base, display })
}

fn unknown(element: &Element, count: usize) -> Result<Unknown, Fault> {
    let place = |text: &str| -> Result<usize, Fault> {
        match text.parse::<usize>() {
            Ok(index) if (1..=count).contains(&index) => Ok(index - 1),
            _ => Err((element.line, format!("index {text} in ModelStructure is not within 1..{count}"))),
        }
    };
    let variable = place(required(element, "index")?)?;
    let dependencies = element
        .attribute("dependencies")
        .map(|list| list.split_whitespace().map(place).collect::<Result<_, _>>())
        .transpose()?;
    Ok(Unknown { variable, dependencies })
}

fn variable(element: &Element, types: &[Element]) -> Result<Variable, Fault> {
    let name = required(element, "name")?.to_owned();
    let typed = element.children.iter().find_map(|child| kind_of(&child.name).map(|kind| (child, kind)));
    let Some((typed, kind)) = typed else {
        return Err((
            element.line,
            format!("variable {name} has no type: Real, Integer, Boolean, String or Enumeration"),
        ));
    };
    // Attributes that the variable leaves out come from its declared type.
    let declared = typed
        .attribute("declaredType")
        .and_then(|wanted| types.iter().find(|simple| simple.attribute("name") == Some(wanted)))
        .and_then(|simple| simple.children.iter().find(|child| child.name == typed.name));
    let text = |name: &str| {
        let inherited = || declared.and_then(|declared| declared.attribute(name));
        typed.attribute(name).or_else(inherited).map(str::to_owned)
    };
    let number = |name: &str| -> Result<Option<f64>, Fault> {
        match (parsed(typed, name, NUMBER)?, declared) {
            (None, Some(declared)) => parsed(declared, name, NUMBER),
            (own, _) => Ok(own),
        }
    };
    let relative = match (flag(typed, "relativeQuantity")?, declared) {
        (None, Some(declared)) => flag(declared, "relativeQuantity")?,
        (own, _) => own,
    };
    let causality = causality(element)?;
    let variability = variability(element, kind)?;
    let start = match kind {
        Kind::Real => parsed(typed, "start", NUMBER)?.map(Value::Real),
        Kind::Integer => parsed(typed, "start", INTEGER)?.map(Value::Integer),
        Kind::Boolean => flag(typed, "start")?.map(Value::Boolean),
        Kind::String => typed.attribute("start").map(|text| Value::String(text.to_owned())),
    };
    Ok(Variable {
        reference: parsed(element, "valueReference", "a value reference")?
            .ok_or_else(|| (element.line, format!("variable {name} lacks a valueReference")))?,
        description: element.attribute("description").unwrap_or_default().to_owned(),
        causality,
        variability,
        initial: initial(element, causality, variability)?,
        kind,
        items: declared.filter(|declared| declared.name == "Enumeration").map(items).transpose()?,
        start,
        unit: text("unit"),
        display_unit: text("displayUnit"),
        relative_quantity: relative.unwrap_or(false),
        min: number("min")?,
        max: number("max")?,
        derivative_of: parsed::<usize>(typed, "derivative", INTEGER)?.and_then(|index| index.checked_sub(1)),
        name,
    })
}

/// The names and values of an enumeration.
fn items(declared: &Element) -> Result<Arc<[(String, i32)]>, Fault> {
    let items = declared.children.iter().filter(|child| child.name == "Item");
    items
        .map(|item| {
            let value = parsed(item, "value", INTEGER)?;
            let missing = || (item.line, "<Item> lacks the attribute value".to_owned());
            Ok((required(item, "name")?.to_owned(), value.ok_or_else(missing)?))
        })
        .collect()
}

fn kind_of(element: &str) -> Option<Kind> {
    match element {
        "Real" => Some(Kind::Real),
        "Integer" | "Enumeration" => Some(Kind::Integer),
        "Boolean" => Some(Kind::Boolean),
        "String" => Some(Kind::String),
        _ => None,
    }
}

fn causality(element: &Element) -> Result<Causality, Fault> {
    Ok(match element.attribute("causality").unwrap_or("local") {
        "parameter" => Causality::Parameter,
        "calculatedParameter" => Causality::CalculatedParameter,
        "input" => Causality::Input,
        "output" => Causality::Output,
        "local" => Causality::Local,
        "independent" => Causality::Independent,
        other => return Err((element.line, format!("causality=\"{other}\" does not exist in FMI 2.0"))),
    })
}

fn variability(element: &Element, kind: Kind) -> Result<Variability, Fault> {
    Ok(match element.attribute("variability") {
        Some("constant") => Variability::Constant,
        Some("fixed") => Variability::Fixed,
        Some("tunable") => Variability::Tunable,
        Some("discrete") => Variability::Discrete,
        Some("continuous") => Variability::Continuous,
        None if kind == Kind::Real => Variability::Continuous,
        None => Variability::Discrete,
        Some(other) => {
            return Err((element.line, format!("variability=\"{other}\" does not exist in FMI 2.0")));
        }
    })
}

/// `initial` with the defaults of the table in FMI 2.0 section 2.2.7.
fn initial(
    element: &Element,
    causality: Causality,
    variability: Variability,
) -> Result<Option<Initial>, Fault> {
    Ok(match (element.attribute("initial"), causality, variability) {
        (Some("exact"), ..) => Some(Initial::Exact),
        (Some("approx"), ..) => Some(Initial::Approx),
        (Some("calculated"), ..) => Some(Initial::Calculated),
        (Some(other), ..) => {
            return Err((element.line, format!("initial=\"{other}\" does not exist in FMI 2.0")));
        }
        (None, Causality::Input | Causality::Independent, _) => None,
        (None, Causality::Parameter, _) | (None, _, Variability::Constant) => Some(Initial::Exact),
        (None, ..) => Some(Initial::Calculated),
    })
}
