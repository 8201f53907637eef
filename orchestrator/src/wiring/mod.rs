//! From a scenario and its units to a system that runs: names become places, everything is checked once.

mod check;
mod layout;
mod lines;
mod names;
mod order;
mod overwritten;
mod record;
mod signals;
mod ticks;

pub(crate) use check::{expected, item, start_value};
pub(crate) use names::{Names, Variable};
pub(crate) use overwritten::overwriting;
pub use signals::table;
pub(crate) use ticks::clock;

use crate::algorithm::Needs;
use crate::error::{Error, Place};
use crate::fmu::{Fmu, Instance};
use crate::graph;
use crate::initialise::Plan;
use crate::link::{Conversion, Feed};
use crate::package::Unpacked;
use crate::recorder::{Column, Slot};
use crate::scenario::{Channel, Given, Hold, Scenario, SignalEntry};
use crate::source::Signal;
use crate::system::{Point, System, Unit, Values};
use crate::time::{Clock, Rational};
use crate::unit_path::UnitPath;
use crate::value::{Kind, Value};
use layout::{Layout, UnitBlocks};
use record::Recorded;
use std::collections::{HashMap, HashSet};
use std::path::PathBuf;
use std::sync::Arc;
use ticks::Ticks;

/// Everything that a simulation needs.
pub(crate) struct Wiring {
    pub(crate) system: System,
    pub(crate) clock: Clock,
    pub(crate) start: Point,
    pub(crate) stop: f64,
    /// The stop that the units are told.
    pub(crate) told_stop: Option<f64>,
    pub(crate) plan: Plan,
    pub(crate) names: Names,
    pub(crate) slots: HashMap<Variable, Slot>,
    /// Recorded values that no unit has, by name.
    pub(crate) derived: HashMap<String, Slot>,
    pub(crate) driven: HashMap<Variable, Place>,
    /// Driven inputs that keep their start value until the first value arrives.
    late: HashSet<Variable>,
    /// Start values that differ from the description's, unit by unit.
    pub(crate) sets: Vec<Vec<(usize, Value)>>,
    pub(crate) columns: Vec<Column>,
    pub(crate) recorded: Vec<Slot>,
    pub(crate) notices: Vec<String>,
    /// What a person should know of the stop.
    pub(crate) last_points: Vec<String>,
    pub(crate) files: Vec<PathBuf>,
    /// Units that were taken out of packages: these files vanish with it.
    pub(crate) _unpacked: Vec<Arc<Unpacked>>,
}

/// A connection with its ends found.
pub(crate) struct Connection {
    pub(crate) from: Variable,
    pub(crate) to: Variable,
    pub(crate) conversion: Conversion,
    pub(crate) delay: Rational,
    /// A value is there as soon as it was sent, also at the start.
    pub(crate) direct: bool,
    channel: Channel,
}

/// A source with its end found.
pub(crate) struct Source {
    pub(crate) to: Variable,
    pub(crate) signal: Signal,
}

/// What a scenario names, found in its units and checked.
struct Found {
    names: Names,
    connections: Vec<Connection>,
    sources: Vec<Source>,
    recorded: Vec<Recorded>,
    driven: HashMap<Variable, Place>,
    sets: Vec<Vec<(usize, Value)>>,
    notices: Vec<String>,
}

pub(crate) fn wire(scenario: &Scenario, path: &UnitPath, needs: Needs) -> Result<Wiring, Error> {
    let (fmus, files, unpacked) = open(scenario, path)?;
    let mut found = Found::new(scenario, &fmus)?;
    let (clock, ticks) = clock(scenario)?;
    let Layout { blocks, slots, values } = found.layout();
    let instances = fmus.iter().zip(&scenario.units).map(|(fmu, unit)| fmu.instantiate(&unit.name));
    let instances = instances.collect::<Result<Vec<_>, _>>()?;
    let mut system = empty_system(values, ticks.stop, found.order(needs));
    let units = instances.into_iter().zip(blocks);
    let last_points = add_units(&mut system, scenario, units, &clock, &ticks)?;
    let derived = found.lay_lines(&mut system, scenario, &slots, &clock);
    let recorded = found.recorded_slots(&slots, &derived);
    for Source { to, signal } in std::mem::take(&mut found.sources) {
        system.units[to.0].feeds.push(Feed { signal, to: slots[&to] });
    }
    system.units.iter_mut().for_each(find_plain);
    found.add_notices(scenario, needs);
    let Found { names, connections, recorded: chosen, driven, sets, notices, .. } = found;
    let late = connections.iter().filter(|connection| !connection.direct).map(|connection| connection.to);
    let wiring = Wiring {
        late: late.collect(),
        plan: Plan::new(&names, &connections, &slots),
        start: Point { ticks: ticks.start, time: scenario.start.to_f64() },
        stop: scenario.stop.to_f64(),
        told_stop: Some(scenario.stop.to_f64()),
        columns: chosen.iter().map(|recorded| recorded.column(&names, &connections)).collect(),
        recorded,
        derived,
        system,
        clock,
        names,
        slots,
        driven,
        sets,
        notices,
        last_points,
        files,
        _unpacked: unpacked,
    };
    overwritten::refuse(scenario, &wiring)?;
    Ok(wiring)
}

impl Found {
    fn new(scenario: &Scenario, fmus: &[Fmu]) -> Result<Self, Error> {
        let names = Names::new(scenario, fmus);
        let (mut notices, mut driven) = (Vec::new(), HashMap::new());
        let mut sets = start_values(scenario, &names)?;
        let connections = connections(scenario, &names, &mut driven, &mut notices)?;
        let sources = sources(scenario, &names, &mut driven, &mut sets, &mut notices)?;
        let recorded = record::chosen(scenario, &names, &connections)?;
        Ok(Self { names, connections, sources, recorded, driven, sets, notices })
    }

    fn layout(&self) -> Layout {
        let variables: Vec<Variable> = self.recorded.iter().filter_map(Recorded::shown).collect();
        Layout::new(&self.names, &self.connections, &self.sources, &variables)
    }

    /// The order in which the units step: that of the scenario, unless the algorithm wants the derived one.
    fn order(&self, needs: Needs) -> Vec<usize> {
        match needs.order {
            true => order::derived(&self.names, &self.connections),
            false => (0..self.names.units.len()).collect(),
        }
    }

    /// Lays the connections, and what is recorded of them; the slots of what no unit has, by name.
    fn lay_lines(
        &self,
        system: &mut System,
        scenario: &Scenario,
        slots: &HashMap<Variable, Slot>,
        clock: &Clock,
    ) -> HashMap<String, Slot> {
        let Self { names, connections, recorded, .. } = self;
        let lines = lines::lay_connections(system, scenario, connections, slots, clock, recorded);
        let mut derived = lines::lay_ages(system, names, connections, recorded, &lines);
        lines::lay_errors(system, names, recorded, slots, &mut derived);
        derived
    }

    fn recorded_slots(&self, slots: &HashMap<Variable, Slot>, derived: &HashMap<String, Slot>) -> Vec<Slot> {
        let slot = |recorded: &Recorded| match recorded {
            Recorded::Variable(variable) => slots[variable],
            Recorded::Age(connection) => derived[&self.names.age(&self.connections[*connection])],
            Recorded::Error(variable) => derived[&self.names.error(*variable)],
        };
        self.recorded.iter().map(slot).collect()
    }

    /// What a person should know, after what the connections told.
    fn add_notices(&mut self, scenario: &Scenario, needs: Needs) {
        self.notices.extend(scenario.notes.iter().cloned());
        for (name, fmu) in &self.names.units {
            self.notices.extend(fmu.doubts().into_iter().map(|doubt| format!("unit {name}: {doubt}")));
        }
        if !needs.settles {
            self.notices.extend(loops_while_stepping(&self.names, &self.connections));
        }
    }
}

/// A system whose units are still to come.
fn empty_system(values: Values, stop: i64, order: Vec<usize>) -> System {
    System {
        ends: Vec::new(),
        next: i64::MAX,
        units: Vec::new(),
        lines: Vec::new(),
        values,
        errors: Vec::new(),
        ages: Vec::new(),
        stop,
        order,
    }
}

/// Adds the units with their steps; what a person should know of the stop.
fn add_units(
    system: &mut System,
    scenario: &Scenario,
    units: impl Iterator<Item = (Instance, UnitBlocks)>,
    clock: &Clock,
    ticks: &Ticks,
) -> Result<Vec<String>, Error> {
    let mut last_points = Vec::new();
    for (number, (instance, blocks)) in units.enumerate() {
        let (entry, interval) = (&scenario.units[number], ticks.intervals[number]);
        let last = ticks.last(number, instance.fmu().description(), clock);
        last_points.extend(ticks::last_point(scenario, entry, last));
        let last = last.filter(|last| last.reaches_stop).map(|last| (last.ticks, last.size.to_f64()));
        let first = ticks::first_step(entry, instance.fmu().description(), clock)?;
        let mut unit = blocks.unit(instance, interval, entry.interval.to_f64(), [first, last]);
        unit.rollback.retry = entry.retry;
        system.units.push(unit);
    }
    Ok(last_points)
}

/// Tells a unit with nothing but copies to gather, no state to keep before a step, and no line that begins at it.
fn find_plain(unit: &mut Unit) {
    unit.plain = !unit.rollback.retry
        && unit.links.is_empty()
        && unit.lines_in.is_empty()
        && unit.feeds.is_empty()
        && unit.lines_out.is_empty();
}

/// The units, their files, and those of the files that lie in a temporary folder.
type Opened = (Vec<Fmu>, Vec<PathBuf>, Vec<Arc<Unpacked>>);

fn open(scenario: &Scenario, path: &UnitPath) -> Result<Opened, Error> {
    let mut fmus: Vec<Fmu> = Vec::new();
    let mut files: Vec<PathBuf> = Vec::new();
    let mut unpacked: Vec<Arc<Unpacked>> = Vec::new();
    for unit in &scenario.units {
        let (file, packed) = path.find(&unit.fmu.value, scenario.folder(), &unit.fmu.place)?;
        unpacked.extend(packed);
        let fmu = path.open(&file)?;
        fmus.push(
            unit.isolation.as_ref().map_or_else(|| fmu.clone(), |isolation| fmu.isolated(isolation.clone())),
        );
        files.push(file);
    }
    Ok((fmus, files, unpacked))
}

fn start_values(scenario: &Scenario, names: &Names) -> Result<Vec<Vec<(usize, Value)>>, Error> {
    let mut all = Vec::with_capacity(scenario.units.len());
    for (unit, entry) in scenario.units.iter().enumerate() {
        let mut sets: Vec<(usize, Value)> = Vec::new();
        for (name, given) in &entry.set {
            let wrong = |what: String, expected: String| Error::Scenario {
                place: given.place.clone(),
                what,
                expected,
            };
            let place = names.settable(unit, name).map_err(|(what, expected)| wrong(what, expected))?;
            let variable = names.variable((unit, place));
            let (value, shown) = match &given.value {
                Given::Toml(value) => (check::from_toml(variable, value), value.to_string()),
                Given::Text(text) => (check::from_text(variable, text), text.clone()),
            };
            let named = || format!("{}.{name} = {shown}", entry.name);
            let value = value.ok_or_else(|| wrong(named(), check::expected(variable)))?;
            start_value(variable, &value).map_err(|expected| wrong(named(), expected))?;
            // Each name is there once (`scenario::UnitEntry::set`), and each name has one place.
            sets.push((place, value));
        }
        all.push(sets);
    }
    Ok(all)
}

fn drive(
    driven: &mut HashMap<Variable, Place>,
    names: &Names,
    to: Variable,
    place: &Place,
) -> Result<(), Error> {
    match driven.insert(to, place.clone()) {
        None => Ok(()),
        Some(first) => Err(Error::Scenario {
            place: place.clone(),
            what: format!("a second signal for the input {}", names.full(to)),
            expected: format!("the first one is at {first}; keep one of them"),
        }),
    }
}

fn connections(
    scenario: &Scenario,
    names: &Names,
    driven: &mut HashMap<Variable, Place>,
    notices: &mut Vec<String>,
) -> Result<Vec<Connection>, Error> {
    let mut all = Vec::with_capacity(scenario.connections.len());
    for entry in &scenario.connections {
        let wrong = |(what, expected)| Error::Scenario { place: entry.place.clone(), what, expected };
        let from = names.output(&entry.from).map_err(wrong)?;
        let to = names.input(&entry.to).map_err(wrong)?;
        drive(driven, names, to, &entry.place)?;
        let conversion = match entry.map.is_empty() {
            true => check::conversion(names, from, to, entry.transform, notices),
            false => check::table_of(names, from, to, entry),
        };
        let conversion = conversion.map_err(wrong)?;
        let channel = entry.channel.clone();
        let real = |variable| names.variable(variable).kind == Kind::Real;
        if channel.hold == Hold::Linear && !(real(from) && real(to)) {
            let what = format!("hold = \"linear\" from {} to {}", names.full(from), names.full(to));
            return Err(wrong((
                what,
                "only a Real lies on a line; both ends have to be of that type".into(),
            )));
        }
        all.push(Connection { from, to, conversion, delay: entry.delay, direct: entry.is_direct(), channel });
    }
    Ok(all)
}

fn sources(
    scenario: &Scenario,
    names: &Names,
    driven: &mut HashMap<Variable, Place>,
    sets: &mut [Vec<(usize, Value)>],
    notices: &mut Vec<String>,
) -> Result<Vec<Source>, Error> {
    let mut all = Vec::new();
    for entry in &scenario.sources {
        let wrong = |(what, expected)| Error::Scenario { place: entry.place.clone(), what, expected };
        let to = names.input(&entry.to).map_err(wrong)?;
        drive(driven, names, to, &entry.place)?;
        let variable = names.variable(to);
        let kind = variable.kind;
        let written = sets[to.0].iter().find(|(known, _)| *known == to.1).map(|(_, start)| start.clone());
        let mut constant = None;
        if let SignalEntry::Constant(value) = &entry.signal {
            let expected = || match variable.items {
                Some(_) => check::expected(variable),
                None => format!("{} is of type {kind}", entry.to),
            };
            let typed = check::from_toml(variable, value)
                .ok_or_else(|| wrong((format!("value = {value}"), expected())))?;
            check::start_value(variable, &typed)
                .map_err(|expected| wrong((format!("value = {value}"), expected)))?;
            // The start value holds for ever, since nothing else drives the input.
            sets[to.0].retain(|(known, _)| *known != to.1);
            constant = Some(typed.clone());
            sets[to.0].push((to.1, typed));
        }
        // A resolved scenario repeats what a constant gives.
        if let Some(start) = written.filter(|start| constant.as_ref() != Some(start)) {
            notices.push(format!("{} = {start} gives way to its signal at {}", entry.to, entry.place));
        }
        if constant.is_some() && kind == Kind::String {
            continue;
        }
        let signal = signals::signal(&entry.signal, variable, constant.as_ref(), scenario.folder());
        let signal = signal.map_err(wrong)?;
        notices.extend(signals::beyond(&signal, &entry.to, variable).filter(|_| constant.is_none()));
        all.push(Source { to, signal });
    }
    Ok(all)
}

/// Loops of direct feedthrough between communication points. The order of the units cuts them; a person should know.
fn loops_while_stepping(names: &Names, connections: &[Connection]) -> Vec<String> {
    let graph = names.dependencies(connections, |fmu, output| fmu.description().step_dependencies(output));
    (graph::ordered(&graph.edges).iter())
        .filter(|component| component.is_loop)
        .map(|component| {
            let path = names.path(&graph, component);
            format!("algebraic loop {path}: while stepping it is cut where a value is still that of the point before")
        })
        .collect()
}
