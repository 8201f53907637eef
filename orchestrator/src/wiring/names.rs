//! Names of units and variables, found in the descriptions.

use super::Connection;
use crate::error::Error;
use crate::fmu::{self, Causality, Fmu, Initial, Variability};
use crate::graph::{self, Component};
use crate::recorder::Column;
use crate::scenario::Scenario;
use crate::suggest::nearest;
use std::collections::{BTreeMap, HashMap};

/// So many names of a loop are told.
const SHOWN: usize = 20;

/// A variable: its unit, and its place in the description.
pub(crate) type Variable = (usize, usize);

/// What is wrong and what would be right.
pub(crate) type Wrong = (String, String);

/// The units of a scenario by name.
pub(crate) struct Names {
    pub(crate) units: Vec<(String, Fmu)>,
    places: HashMap<String, usize>,
}

/// Which connected variable depends directly on which. The nodes after those of the variables stand for all driven inputs
/// of a unit each: an output of which nothing is said depends on these, which would otherwise be a list for each output.
pub(crate) struct Dependencies {
    nodes: Vec<Variable>,
    pub(crate) edges: Vec<Vec<usize>>,
}

impl Dependencies {
    /// The variables of a component.
    pub(crate) fn variables(&self, component: &Component) -> impl Iterator<Item = Variable> {
        component.nodes.iter().filter_map(|&node| self.nodes.get(node).copied())
    }
}

impl Names {
    pub(crate) fn new(scenario: &Scenario, fmus: &[Fmu]) -> Self {
        let units = scenario.units.iter().zip(fmus).map(|(unit, fmu)| (unit.name.clone(), fmu.clone()));
        let places = scenario.units.iter().enumerate().map(|(place, unit)| (unit.name.clone(), place));
        Self { units: units.collect(), places: places.collect() }
    }

    pub(crate) fn variable(&self, (unit, place): Variable) -> &fmu::Variable {
        &self.units[unit].1.description().variables[place]
    }

    /// `unit.variable`
    pub(crate) fn full(&self, variable: Variable) -> String {
        format!("{}.{}", self.units[variable.0].0, self.variable(variable).name)
    }

    pub(crate) fn column(&self, variable: Variable) -> Column {
        let description = self.variable(variable);
        Column { name: self.full(variable), kind: description.kind, unit: description.unit.clone() }
    }

    /// Name of the age of a connected value.
    pub(crate) fn age(&self, connection: &Connection) -> String {
        format!("{}:age", self.full(connection.to))
    }

    /// Name of the estimated error of an output.
    pub(crate) fn error(&self, output: Variable) -> String {
        format!("{}:error", self.full(output))
    }

    pub(crate) fn unit(&self, name: &str) -> Result<usize, Wrong> {
        self.places.get(name).copied().ok_or_else(|| {
            (
                format!("there is no unit {name:?}"),
                nearest(name, self.units.iter().map(|(name, _)| name.as_str())),
            )
        })
    }

    /// A variable by its full name.
    pub(crate) fn find(&self, full: &str) -> Result<Variable, Wrong> {
        self.find_among(full, |_| true)
    }

    /// As [`Names::find`]; suggestions come from those that are `likely`.
    fn find_among(&self, full: &str, likely: impl Fn(&fmu::Variable) -> bool) -> Result<Variable, Wrong> {
        let Some((unit, name)) = full.split_once('.') else {
            return Err((format!("{full:?} names no variable"), "write unit.variable, e.g. plant.q1".into()));
        };
        let unit = self.unit(unit)?;
        self.place(unit, name, likely).map(|place| (unit, place))
    }

    fn place(
        &self,
        unit: usize,
        name: &str,
        likely: impl Fn(&fmu::Variable) -> bool,
    ) -> Result<usize, Wrong> {
        let (unit, fmu) = &self.units[unit];
        let description = fmu.description();
        if description.is_ambiguous(name) && description.place(name).is_some() {
            return Err(ambiguous(unit, name));
        }
        description.place(name).ok_or_else(|| {
            let known = description.variables.iter().filter(|v| likely(v)).map(|v| v.name.as_str());
            (format!("unit {unit} has no variable {name:?}"), nearest(name, known))
        })
    }

    pub(crate) fn output(&self, full: &str) -> Result<Variable, Wrong> {
        let is_output = |v: &fmu::Variable| v.causality == Causality::Output;
        let found = self.find_among(full, is_output)?;
        self.expect(found, is_output, "a connection begins at an output")
    }

    pub(crate) fn input(&self, full: &str) -> Result<Variable, Wrong> {
        let is_input = |v: &fmu::Variable| v.causality == Causality::Input;
        let found = self.find_among(full, is_input)?;
        let tip = match self.variable(found).causality {
            Causality::Parameter => {
                "only an input can be driven; give parameters their values in [units.set]"
            }
            _ => "only an input can be driven",
        };
        self.expect(found, is_input, tip)
    }

    fn expect(
        &self,
        found: Variable,
        is: impl Fn(&fmu::Variable) -> bool,
        tip: &str,
    ) -> Result<Variable, Wrong> {
        let variable = self.variable(found);
        if is(variable) {
            return Ok(found);
        }
        let what = match variable.causality {
            Causality::Parameter | Causality::CalculatedParameter => "a parameter",
            Causality::Input => "an input",
            Causality::Output => "an output",
            Causality::Local => "local",
            Causality::Independent => "the time",
        };
        let likely =
            self.units[found.0].1.description().variables.iter().filter(|v| is(v)).map(|v| v.name.as_str());
        let names = nearest(&variable.name, likely);
        Err((format!("{} is {what}", self.full(found)), format!("{tip} ({names})")))
    }

    /// A variable that a user may give a start value.
    pub(crate) fn settable(&self, unit: usize, name: &str) -> Result<usize, Wrong> {
        let place = self.place(unit, name, may_be_set)?;
        let variable = self.variable((unit, place));
        if may_be_set(variable) {
            return Ok(place);
        }
        let tip = "only parameters, inputs and start values can be set";
        Err((format!("{} is computed by the unit", self.full((unit, place))), tip.into()))
    }

    /// The dependencies of connected variables: inputs on the outputs that drive them without delay, outputs on
    /// what their unit says.
    pub(crate) fn dependencies<'a>(
        &'a self,
        connections: &[Connection],
        inside: impl Fn(&'a Fmu, usize) -> Option<&'a [usize]>,
    ) -> Dependencies {
        let direct = || connections.iter().filter(|connection| connection.direct);
        // In order, so that the same scenario is always initialised in the same order.
        let mut numbers: BTreeMap<Variable, usize> = BTreeMap::new();
        for connection in direct() {
            numbers.insert(connection.from, 0);
            numbers.insert(connection.to, 0);
        }
        let nodes: Vec<Variable> = numbers.keys().copied().collect();
        numbers.values_mut().enumerate().for_each(|(number, value)| *value = number);
        let drivers: HashMap<Variable, Variable> =
            direct().map(|connection| (connection.to, connection.from)).collect();
        let mut together: HashMap<usize, usize> = HashMap::new();
        let mut edges: Vec<Vec<usize>> = Vec::with_capacity(nodes.len());
        for &node in &nodes {
            edges.push(match (drivers.get(&node), inside(&self.units[node.0].1, node.1)) {
                (Some(from), _) => vec![numbers[from]],
                (None, Some(said)) => {
                    let inputs = said.iter().map(|&place| (node.0, place));
                    let inputs = inputs.filter(|input| drivers.contains_key(input));
                    let mut on: Vec<usize> = inputs.map(|input| numbers[&input]).collect();
                    on.sort_unstable();
                    on.dedup();
                    on
                }
                (None, None) => {
                    let next = nodes.len() + together.len();
                    vec![*together.entry(node.0).or_insert(next)]
                }
            });
        }
        let mut of_units: Vec<(usize, usize)> = together.into_iter().collect();
        of_units.sort_unstable_by_key(|(_, node)| *node);
        for (unit, _) in of_units {
            let of_unit = numbers.range((unit, 0)..(unit + 1, 0));
            edges.push(of_unit.filter(|(v, _)| drivers.contains_key(v)).map(|(_, node)| *node).collect());
        }
        Dependencies { nodes, edges }
    }

    /// A loop by its names.
    pub(crate) fn path(&self, graph: &Dependencies, component: &Component) -> String {
        let nodes = graph::loop_through(&graph.edges, component);
        let variables = nodes.into_iter().filter_map(|node| graph.nodes.get(node));
        let mut names: Vec<String> = variables.map(|variable| self.full(*variable)).collect();
        if names.first() != names.last() {
            // It began with the inputs of a unit all together.
            names.extend(names.first().cloned());
        }
        if names.len() > SHOWN {
            let more = format!("({} more)", names.len() - SHOWN);
            names.splice(SHOWN - 1..names.len() - 1, [more]);
        }
        names.join(" -> ")
    }

    /// For calls of the library.
    pub(crate) fn named(&self, full: &str) -> Result<Variable, Error> {
        self.find(full).map_err(|(_, expected)| Error::Name { what: "variable", name: full.into(), expected })
    }
}

/// A name that several variables have, or an empty one.
pub(super) fn ambiguous(unit: &str, name: &str) -> Wrong {
    let what = match name.is_empty() {
        true => format!("unit {unit} has a variable without a name"),
        false => format!("unit {unit} has several variables called {name:?}"),
    };
    (
        what,
        "mend its modelDescription.xml, or record and connect others: it is not clear which is meant".into(),
    )
}

fn may_be_set(variable: &fmu::Variable) -> bool {
    let start = matches!(variable.initial, Some(Initial::Exact | Initial::Approx));
    match variable.causality {
        Causality::Input => true,
        Causality::CalculatedParameter | Causality::Independent => false,
        _ => start && variable.variability != Variability::Constant,
    }
}
