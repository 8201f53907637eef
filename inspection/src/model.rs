//! The description as far as it can be understood, faults and all: what a strict reader would refuse is left out here and
//! said by the rules.

use crate::xml::Element;
use orchestrator::Kind;
use orchestrator::fmu::{Causality, Initial, Variability};
use std::collections::HashMap;

/// One `ScalarVariable`.
pub(crate) struct Variable<'a> {
    pub(crate) name: &'a str,
    pub(crate) line: usize,
    pub(crate) reference: Option<u32>,
    pub(crate) causality: Causality,
    pub(crate) variability: Variability,
    /// As written.
    pub(crate) initial: Option<Initial>,
    /// Type to the calls.
    pub(crate) kind: Kind,
    /// The element that names the type: `Real`, say.
    pub(crate) typed: &'a Element,
    /// Its declared type, where that is defined and of the same sort.
    pub(crate) declared: Option<&'a Element>,
}

impl<'a> Variable<'a> {
    /// An attribute of the variable, or else of its declared type.
    pub(crate) fn attribute(&self, name: &str) -> Option<&'a str> {
        self.typed.attribute(name).or_else(|| self.declared.and_then(|declared| declared.attribute(name)))
    }

    /// As [`Variable::attribute`], as a number.
    pub(crate) fn number(&self, name: &str) -> Option<f64> {
        number(self.attribute(name)?)
    }

    pub(crate) fn start(&self) -> Option<&'a str> {
        self.typed.attribute("start")
    }

    /// `initial` with the defaults of the table in FMI 2.0.4 section 2.2.7; none for inputs and the time.
    pub(crate) fn initial(&self) -> Option<Initial> {
        match (self.initial, self.causality, self.variability) {
            (Some(initial), ..) => Some(initial),
            (None, Causality::Input | Causality::Independent, _) => None,
            (None, Causality::Parameter, _) | (None, _, Variability::Constant) => Some(Initial::Exact),
            (None, ..) => Some(Initial::Calculated),
        }
    }

    /// A master may set it before or while it steps.
    pub(crate) fn is_set_from_outside(&self) -> bool {
        matches!(self.causality, Causality::Input | Causality::Parameter)
    }

    /// The items of an enumeration: names and values.
    pub(crate) fn items(&self) -> Vec<(&'a str, Option<i32>)> {
        let declared = self.declared.filter(|_| self.typed.name == "Enumeration");
        declared.map(items).unwrap_or_default()
    }
}

/// The items of an enumeration: names and values.
pub(crate) fn items(declared: &Element) -> Vec<(&str, Option<i32>)> {
    let items = declared.children.iter().filter(|child| child.name == "Item");
    items.map(|item| (item.attribute("name").unwrap_or_default(), item.number("value"))).collect()
}

/// A number as XML writes it.
pub(crate) fn number(text: &str) -> Option<f64> {
    match text.trim() {
        "INF" | "+INF" => Some(f64::INFINITY),
        "-INF" => Some(f64::NEG_INFINITY),
        "NaN" => Some(f64::NAN),
        text if text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E')) => {
            text.parse().ok()
        }
        _ => None,
    }
}

/// One `Unknown` of `ModelStructure`; places are those in [`Model::variables`].
pub(crate) struct Unknown<'a> {
    pub(crate) line: usize,
    pub(crate) element: &'a Element,
    pub(crate) variable: Option<usize>,
    pub(crate) dependencies: Option<Vec<&'a str>>,
    pub(crate) kinds: Option<Vec<&'a str>>,
}

/// The description.
pub(crate) struct Model<'a> {
    pub(crate) root: &'a Element,
    pub(crate) co_simulation: Option<&'a Element>,
    /// In order; a `ScalarVariable` without a type has no entry, but keeps its place in [`Model::places`].
    pub(crate) variables: Vec<Variable<'a>>,
    /// Where the variable of each `ScalarVariable` stands in [`Model::variables`].
    places: Vec<Option<usize>>,
    pub(crate) units: HashMap<&'a str, &'a Element>,
    pub(crate) types: HashMap<&'a str, &'a Element>,
    pub(crate) outputs: Vec<Unknown<'a>>,
    pub(crate) derivatives: Vec<Unknown<'a>>,
    pub(crate) initial_unknowns: Vec<Unknown<'a>>,
}

impl<'a> Model<'a> {
    pub(crate) fn of(root: &'a Element) -> Self {
        let named = |list: &'a str, item: &'a str| -> HashMap<&'a str, &'a Element> {
            let all = root.list(list, item);
            all.filter_map(|element| Some((element.attribute("name")?, element))).collect()
        };
        let types = named("TypeDefinitions", "SimpleType");
        let (mut variables, mut places) = (Vec::new(), Vec::new());
        for element in root.list("ModelVariables", "ScalarVariable") {
            let variable = variable(element, &types);
            places.push(variable.is_some().then_some(variables.len()));
            variables.extend(variable);
        }
        let mut model = Self {
            root,
            co_simulation: root.child("CoSimulation"),
            units: named("UnitDefinitions", "Unit"),
            types,
            variables,
            places,
            outputs: Vec::new(),
            derivatives: Vec::new(),
            initial_unknowns: Vec::new(),
        };
        model.outputs = model.unknowns("Outputs");
        model.derivatives = model.unknowns("Derivatives");
        model.initial_unknowns = model.unknowns("InitialUnknowns");
        model
    }

    /// Number of `ScalarVariable` elements.
    pub(crate) fn count(&self) -> usize {
        self.places.len()
    }

    /// The place of the variable with an index of the description, from 1.
    pub(crate) fn place(&self, index: &str) -> Option<usize> {
        let index = index.trim().parse::<usize>().ok()?.checked_sub(1)?;
        *self.places.get(index)?
    }

    /// Whether an index is one of the description.
    pub(crate) fn has(&self, index: &str) -> bool {
        index.trim().parse::<usize>().is_ok_and(|index| (1..=self.count()).contains(&index))
    }

    fn unknowns(&self, list: &'a str) -> Vec<Unknown<'a>> {
        let structure = self.root.child("ModelStructure");
        let elements = structure.into_iter().flat_map(|structure| structure.list(list, "Unknown"));
        let words = |text: &'a str| text.split_whitespace().collect();
        elements
            .map(|element| Unknown {
                line: element.line,
                element,
                variable: element.attribute("index").and_then(|index| self.place(index)),
                dependencies: element.attribute("dependencies").map(words),
                kinds: element.attribute("dependenciesKind").map(words),
            })
            .collect()
    }

    /// The variable of which another is the derivative.
    pub(crate) fn state_of(&self, derivative: &Variable<'_>) -> Option<usize> {
        self.place(derivative.typed.attribute("derivative")?)
    }
}

fn variable<'a>(element: &'a Element, types: &HashMap<&'a str, &'a Element>) -> Option<Variable<'a>> {
    let (typed, kind) = element.children.iter().find_map(|child| Some((child, kind(&child.name)?)))?;
    let declared = typed.attribute("declaredType").and_then(|name| types.get(name));
    let declared = declared.and_then(|declared| declared.child(&typed.name));
    let by_default = if kind == Kind::Real { Variability::Continuous } else { Variability::Discrete };
    Some(Variable {
        name: element.attribute("name").unwrap_or_default(),
        line: element.line,
        reference: element.number("valueReference"),
        causality: match element.attribute("causality") {
            Some("parameter") => Causality::Parameter,
            Some("calculatedParameter") => Causality::CalculatedParameter,
            Some("input") => Causality::Input,
            Some("output") => Causality::Output,
            Some("independent") => Causality::Independent,
            _ => Causality::Local,
        },
        variability: match element.attribute("variability") {
            Some("constant") => Variability::Constant,
            Some("fixed") => Variability::Fixed,
            Some("tunable") => Variability::Tunable,
            Some("discrete") => Variability::Discrete,
            Some("continuous") => Variability::Continuous,
            _ => by_default,
        },
        initial: match element.attribute("initial") {
            Some("exact") => Some(Initial::Exact),
            Some("approx") => Some(Initial::Approx),
            Some("calculated") => Some(Initial::Calculated),
            _ => None,
        },
        kind,
        typed,
        declared,
    })
}

fn kind(element: &str) -> Option<Kind> {
    match element {
        "Real" => Some(Kind::Real),
        "Integer" | "Enumeration" => Some(Kind::Integer),
        "Boolean" => Some(Kind::Boolean),
        "String" => Some(Kind::String),
        _ => None,
    }
}

/// How the standard writes a causality.
pub(crate) fn causality(causality: Causality) -> &'static str {
    match causality {
        Causality::Parameter => "parameter",
        Causality::CalculatedParameter => "calculatedParameter",
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Local => "local",
        Causality::Independent => "independent",
    }
}

/// How the standard writes a variability.
pub(crate) fn variability(variability: Variability) -> &'static str {
    match variability {
        Variability::Constant => "constant",
        Variability::Fixed => "fixed",
        Variability::Tunable => "tunable",
        Variability::Discrete => "discrete",
        Variability::Continuous => "continuous",
    }
}

/// How the standard writes an initial.
pub(crate) fn initial(initial: Initial) -> &'static str {
    match initial {
        Initial::Exact => "exact",
        Initial::Approx => "approx",
        Initial::Calculated => "calculated",
    }
}
