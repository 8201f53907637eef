//! The start: parameters, then initialisation mode, in which values go along the dependencies that the units
//! declare (`InitialUnknowns`), variable by variable; loops are solved by fixed-point iteration, and where that does not
//! converge by Newton's method.

use crate::error::Error;
use crate::fmu::Begin;
use crate::graph;
use crate::link::{Link, feed_into};
use crate::newton;
use crate::recorder::Slot;
use crate::system::{Point, System};
use crate::value::{Kind, Value};
use crate::wiring::{Connection, Names, Variable};
use std::collections::{HashMap, HashSet};

/// Iterations after which a loop is given up. A contraction by 0.75 a round gets from 1 to 1e-12 in these.
const ITERATIONS: u32 = 100;

/// Rounds in a row that change the values more than the one before, after which Newton's method takes over.
const RISING: u32 = 3;

/// A loop is solved when no value changes by more than this, relative to the larger of it and one: some thousand
/// rounding errors, so that a loop of many units still settles.
const SETTLED: f64 = 1e-12;

/// In what order connected variables get their start values.
pub(crate) struct Plan {
    groups: Vec<Group>,
    /// What lies in a loop.
    looped: HashSet<Variable>,
}

struct Group {
    nodes: Vec<Node>,
    /// The loop by its names, if it is one.
    path: Option<String>,
}

struct Node {
    unit: usize,
    name: String,
    reference: u32,
    kind: Kind,
    slot: Slot,
    /// For an input: where its value comes from.
    link: Option<Link>,
}

impl Plan {
    pub(crate) fn new(names: &Names, connections: &[Connection], slots: &HashMap<Variable, Slot>) -> Self {
        let graph =
            names.dependencies(connections, |fmu, output| fmu.description().initial_dependencies(output));
        let links: HashMap<Variable, Link> = (connections.iter())
            .filter(|connection| connection.direct)
            .map(|c| {
                (c.to, Link { from: slots[&c.from], to: slots[&c.to], conversion: c.conversion.clone() })
            })
            .collect();
        let node = |variable: Variable| {
            let description = names.variable(variable);
            Node {
                unit: variable.0,
                name: names.full(variable),
                reference: description.reference,
                kind: description.kind,
                slot: slots[&variable],
                link: links.get(&variable).cloned(),
            }
        };
        let mut looped = HashSet::new();
        let groups = graph::ordered(&graph.edges).into_iter().map(|component| {
            looped.extend(graph.variables(&component).filter(|_| component.is_loop));
            Group {
                nodes: graph.variables(&component).map(node).collect(),
                path: component.is_loop.then(|| names.path(&graph, &component)),
            }
        });
        Self { groups: groups.collect(), looped }
    }

    /// The solution of a loop is looked for from the start value of this one.
    pub(crate) fn begins_with(&self, variable: Variable) -> bool {
        self.looped.contains(&variable)
    }
}

/// Initialises all units; the system is then at its start with all values read. Adds what a person should know, and
/// which inputs' start values gave way to a connected output.
pub(crate) fn initialise(
    system: &mut System,
    plan: &Plan,
    sets: &[Vec<(u32, Value)>],
    start: Point,
    stop: Option<f64>,
    notices: &mut Vec<String>,
    replaced: &mut Vec<String>,
) -> Result<(), Error> {
    for (unit, sets) in system.units.iter_mut().zip(sets) {
        unit.forget();
        let instance = &mut unit.instance;
        instance.reset()?;
        unit.not_finite.clear();
        unit.rollback.retried = 0;
        instance.begin(start.time, stop, Begin { settings: sets, ..Begin::default() })?;
        // The buffers begin with the start values, whatever an earlier run left there.
        unit.inputs.get(instance, &mut system.values).map_err(|error| *error)?;
        for feed in &mut unit.feeds {
            let before = system.values.get(feed.to);
            feed_into(feed, &mut system.values, start.time);
            let now = system.values.get(feed.to);
            if now != before {
                instance.set(reference_of(&unit.inputs, feed.to), &now)?;
            }
        }
    }
    for group in &plan.groups {
        match &group.path {
            None => {
                group.nodes.iter().try_for_each(|node| pass(system, node, start, replaced).map(|_| ()))?
            }
            Some(path) => notices.extend(solve(system, group, path, start, replaced)?),
        }
    }
    for unit in &mut system.units {
        unit.instance.exit_initialization()?;
    }
    for unit in &mut system.units {
        let mut finite = true;
        for blocks in [&unit.inputs, &unit.outputs, &unit.fixed] {
            finite &= blocks.read(&mut unit.instance, &mut system.values).map_err(|error| *error)?;
        }
        if !finite {
            unit.not_finite(&system.values, start.time).map_err(|error| *error)?;
        }
    }
    system.rewind(start);
    Ok(())
}

/// The reference of a driven input.
fn reference_of(inputs: &crate::blocks::Blocks, slot: Slot) -> u32 {
    let (block, at) = match slot {
        Slot::Real(at) => (&inputs.reals, at),
        Slot::Integer(at) => (&inputs.integers, at),
        Slot::Boolean(at) => (&inputs.booleans, at),
        Slot::String(at) => (&inputs.strings, at),
    };
    block.references[at as usize - block.at]
}

/// Reads an output or sets an input; returns how much the value changed, relative to the larger of it and one.
fn pass(system: &mut System, node: &Node, start: Point, replaced: &mut Vec<String>) -> Result<f64, Error> {
    let before = system.values.get(node.slot);
    let instance = &mut system.units[node.unit].instance;
    let now = match &node.link {
        None => instance.get(node.kind, node.reference)?,
        Some(link) => {
            let value = link.convert(system.values.get(link.from));
            if value != before {
                instance.set(node.reference, &value)?;
            }
            value
        }
    };
    if let Value::Real(value) = now
        && !value.is_finite()
    {
        let (variable, log) = (node.name.clone(), instance.log());
        return Err(Error::NotFinite { variable, value, time: start.time, log });
    }
    system.values.put(node.slot, &now);
    let change = match (&before, &now) {
        (Value::Real(before), Value::Real(now)) => (now - before).abs() / now.abs().max(1.0),
        _ if before == now => 0.0,
        _ => f64::INFINITY,
    };
    if node.link.is_some() && change > 0.0 {
        replaced.push(format!("{} = {before} (now {now})", node.name));
    }
    Ok(change)
}

/// Solves a loop, beginning with what the units answer to their start values; says so if that took more than looking.
fn solve(
    system: &mut System,
    group: &Group,
    path: &str,
    start: Point,
    replaced: &mut Vec<String>,
) -> Result<Option<String>, Error> {
    for output in group.nodes.iter().filter(|node| node.link.is_none()) {
        pass(system, output, start, &mut Vec::new())?;
    }
    let first = group.real_inputs(system);
    let mut worst = (f64::INFINITY, "");
    let mut rising = 0;
    for iteration in 1..=ITERATIONS {
        let before = worst.0;
        worst = (0.0, "");
        // Only the first round replaces start values; later changes are the iteration's own.
        let mut changed = Vec::new();
        for node in &group.nodes {
            let change = pass(system, node, start, &mut changed)?;
            if change > worst.0 || change.is_nan() {
                worst = (change, &node.name);
            }
        }
        if iteration == 1 {
            replaced.append(&mut changed);
        }
        if worst.0 <= SETTLED {
            let solved =
                || format!("algebraic loop {path} at initialisation: solved in {iteration} iterations");
            return Ok((iteration > 2).then(solved));
        }
        rising = if worst.0 >= before { rising + 1 } else { 0 };
        if rising == RISING {
            break;
        }
    }
    let mut found = first;
    if let Some(steps) = newton::solve(&mut found, SETTLED, |x| group.answers(system, start, x))? {
        let solved = format!("solved in {steps} steps of Newton's method, since iterating does not converge");
        return Ok(Some(format!("algebraic loop {path} at initialisation: {solved}")));
    }
    let (change, variable) = (worst.0, worst.1.to_owned());
    Err(Error::Loop { path: path.into(), iterations: ITERATIONS, variable, change })
}

impl Group {
    /// The loop is cut at these for Newton's method.
    fn cuts(&self) -> impl Iterator<Item = (&Node, &Link, usize)> {
        self.nodes.iter().filter_map(|node| match (&node.link, node.slot) {
            (Some(link), Slot::Real(at)) => Some((node, link, at as usize)),
            _ => None,
        })
    }

    fn real_inputs(&self, system: &System) -> Vec<f64> {
        self.cuts().map(|(.., at)| system.values.reals[at]).collect()
    }

    /// What the loop answers to values of its real inputs. Values of other types go round with them.
    fn answers(&self, system: &mut System, start: Point, x: &[f64]) -> Result<Vec<f64>, Error> {
        for ((node, _, at), x) in self.cuts().zip(x) {
            system.units[node.unit].instance.set_real(&[node.reference], &[*x])?;
            system.values.reals[at] = *x;
        }
        let cut = |node: &&Node| node.link.is_none() || !matches!(node.slot, Slot::Real(_));
        for node in self.nodes.iter().filter(cut) {
            pass(system, node, start, &mut Vec::new())?;
        }
        let answer = |link: &Link| link.convert(system.values.get(link.from)).as_f64().unwrap_or(f64::NAN);
        Ok(self.cuts().map(|(_, link, _)| answer(link)).collect())
    }
}
