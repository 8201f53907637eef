//! Reads `modelDescription.xml` into a [`Description`]; what is wrong is said with its line.

use crate::fmu::attributes::{
    Fault, INTEGER, NUMBER, causality, flag, initial, kind_of, parsed, required, variability,
};
use crate::fmu::description::{
    BaseUnit, CoSimulation, DefaultExperiment, Description, Traits, UnitDefinition, Unknown, Variable,
};
use crate::fmu::places::{Names, Places};
use crate::value::{Kind, Value};
use crate::xml::Element;
use std::collections::HashMap;
use std::io::Read;
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

/// Reads a description as it streams by; an error is the line and what is wrong there.
pub(super) fn description(text: impl Read) -> Result<Description, Fault> {
    let mut reading = Reading::default();
    let root = Element::stream(text, KNOWN, |parent, element| reading.take(parent, element))?;
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
    let Reading { variables, outputs, initial_unknowns, .. } = reading.finished()?;
    let (names, repeated) = Names::of(&variables);
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
        places: [Places::of(&outputs), Places::of(&initial_unknowns)],
        variables,
        outputs,
        initial_unknowns,
        names,
        repeated,
    })
}

/// What can be large and is taken up element by element.
#[derive(Default)]
struct Reading {
    types: HashMap<String, Element>,
    variables: Vec<Variable>,
    outputs: Vec<Unknown>,
    initial_unknowns: Vec<Unknown>,
    traits: Shared,
    /// Variables whose declared type had not come by then, by their places.
    late: Vec<(usize, Element)>,
    /// Likewise indices of variables that had not, with their lines.
    beyond: Vec<(usize, usize)>,
}

impl Reading {
    fn take(&mut self, parent: &str, element: Element) -> Result<Option<Element>, Fault> {
        match (parent, element.name.as_str()) {
            ("TypeDefinitions", "SimpleType") => {
                if let Some(name) = element.attribute("name").map(str::to_owned) {
                    self.types.entry(name).or_insert(element);
                }
            }
            ("ModelVariables", "ScalarVariable") => {
                let known = |typed: &Element| {
                    typed.attribute("declaredType").is_none_or(|wanted| self.types.contains_key(wanted))
                };
                let is_late = !element.children.iter().all(known);
                self.variables.push(variable(&element, &self.types, &mut self.traits)?);
                if is_late {
                    self.late.push((self.variables.len() - 1, element));
                }
            }
            ("Outputs", "Unknown") => {
                self.outputs.push(unknown(&element, self.variables.len(), &mut self.beyond)?);
            }
            ("InitialUnknowns", "Unknown") => {
                self.initial_unknowns.push(unknown(&element, self.variables.len(), &mut self.beyond)?);
            }
            _ => return Ok(Some(element)),
        }
        Ok(None)
    }

    /// Once all has gone by.
    fn finished(mut self) -> Result<Self, Fault> {
        // A type of that name may never have come, which is the description's own business.
        for (place, element) in std::mem::take(&mut self.late) {
            self.variables[place] = variable(&element, &self.types, &mut Shared::default())?;
        }
        let count = self.variables.len();
        match self.beyond.iter().find(|(_, index)| *index > count) {
            Some((line, index)) => {
                Err((*line, format!("index {index} in ModelStructure is not within 1..{count}")))
            }
            None => {
                self.variables.shrink_to_fit();
                Ok(self)
            }
        }
    }
}

/// What variables share, by what it was made of.
#[derive(Default)]
struct Shared {
    known: HashMap<String, Arc<Traits>>,
    key: String,
}

/// More different ones are no longer shared: they would take more than they spare.
const SHARED: usize = 4096;

impl Shared {
    /// What the attributes of an element and of its declared type say.
    fn of(&mut self, typed: &Element, declared: Option<&Element>) -> Result<Arc<Traits>, Fault> {
        self.key.clear();
        self.key.push_str(&typed.name);
        for name in ["declaredType", "unit", "displayUnit", "relativeQuantity", "min", "max"] {
            // No attribute holds the separator, which XML doesn't allow.
            self.key.push('\u{1}');
            if let Some(text) = typed.attribute(name) {
                self.key.push('\u{2}');
                self.key.push_str(text);
            }
        }
        if let Some(known) = self.known.get(&self.key) {
            return Ok(Arc::clone(known));
        }
        let made = Arc::new(traits(typed, declared)?);
        if self.known.len() < SHARED {
            self.known.insert(self.key.clone(), Arc::clone(&made));
        }
        Ok(made)
    }
}

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

fn unknown(element: &Element, count: usize, beyond: &mut Vec<(usize, usize)>) -> Result<Unknown, Fault> {
    let mut place = |text: &str| -> Result<usize, Fault> {
        match text.parse::<usize>() {
            Ok(index) if index > 0 => {
                if index > count {
                    beyond.push((element.line, index));
                }
                Ok(index - 1)
            }
            _ => Err((element.line, format!("index {text} in ModelStructure is no place of a variable"))),
        }
    };
    let variable = place(required(element, "index")?)?;
    let dependencies = element
        .attribute("dependencies")
        .map(|list| list.split_whitespace().map(place).collect::<Result<_, _>>())
        .transpose()?;
    Ok(Unknown { variable, dependencies })
}

fn variable(
    element: &Element,
    types: &HashMap<String, Element>,
    shared: &mut Shared,
) -> Result<Variable, Fault> {
    let name = required(element, "name")?.to_owned();
    let typed = element.children.iter().find_map(|child| kind_of(&child.name).map(|kind| (child, kind)));
    let Some((typed, kind)) = typed else {
        return Err((
            element.line,
            format!("variable {name} has no type: Real, Integer, Boolean, String or Enumeration"),
        ));
    };
    let declared = typed
        .attribute("declaredType")
        .and_then(|wanted| types.get(wanted))
        .and_then(|simple| simple.children.iter().find(|child| child.name == typed.name));
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
        start,
        traits: shared.of(typed, declared)?,
        derivative_of: parsed::<usize>(typed, "derivative", INTEGER)?.and_then(|index| index.checked_sub(1)),
        name,
    })
}

/// Attributes that the variable leaves out come from its declared type.
fn traits(typed: &Element, declared: Option<&Element>) -> Result<Traits, Fault> {
    let text = |name: &str| {
        let inherited = || declared.and_then(|declared| declared.attribute(name));
        typed.attribute(name).or_else(inherited).map(str::to_owned)
    };
    let number = |name: &str| -> Result<Option<f64>, Fault> {
        match (limit(typed, name)?, declared) {
            (None, Some(declared)) => limit(declared, name),
            (own, _) => Ok(own),
        }
    };
    let relative = match (flag(typed, "relativeQuantity")?, declared) {
        (None, Some(declared)) => flag(declared, "relativeQuantity")?,
        (own, _) => own,
    };
    Ok(Traits {
        items: declared.filter(|declared| declared.name == "Enumeration").map(items).transpose()?,
        unit: text("unit"),
        display_unit: text("displayUnit"),
        relative_quantity: relative.unwrap_or(false),
        min: number("min")?,
        max: number("max")?,
    })
}

/// A limit of a variable: a number, and no NaN, which limits nothing.
fn limit(element: &Element, name: &str) -> Result<Option<f64>, Fault> {
    let limit: Option<f64> = parsed(element, name, NUMBER)?;
    match limit {
        Some(limit) if limit.is_nan() => {
            Err((element.line, format!("{name}=\"NaN\" in <{}> is not {NUMBER}", element.name)))
        }
        limit => Ok(limit),
    }
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
