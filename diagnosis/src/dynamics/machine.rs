//! Which variables of which units are states, inputs, channels and parameters, by reference.

use super::grid::usual;
use super::port_parameters::port_parameters;
use crate::error::Error;
use crate::observe::{self, Affine, InputEffect, Nominal, OutputEffect, Problem, Scale, Series, VariableId};
use crate::statistics::levels::FINE;
use crate::step_budget::StepBudget;
use orchestrator::fmu::Causality;
use orchestrator::scenario::Transform;
use orchestrator::{Fmu, Kind, Value};
use std::time::Instant;

/// A variable of a unit, as calls want it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reference {
    /// Place of the unit among the model's.
    pub instance: usize,
    /// Value reference.
    pub reference: u32,
    /// Type.
    pub kind: Kind,
}

/// One unit of the nominal model.
#[derive(Debug, Clone)]
pub struct Unit {
    /// Name of its instances.
    pub name: String,
    /// The unit.
    pub fmu: Fmu,
    /// Values that differ from its start values, one for each variable.
    pub settings: Vec<(u32, Value)>,
}

/// A state: how it is set and how it is read.
#[derive(Debug, Clone)]
pub struct State {
    /// Name of what shows it, or of its start parameter.
    pub name: String,
    /// Its start parameter.
    pub start: Reference,
    /// The variable that shows it, if one does.
    pub shows: Option<Reference>,
    /// Nominal start value, in its own unit.
    pub nominal: f64,
    /// The channel that measures it.
    pub channel: Option<usize>,
}

/// What a parameter is part of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Role {
    /// A unit.
    Unit(Reference),
    /// The way to a fed input (place among [`Machine::inputs`]).
    Input(usize, InputEffect),
    /// The way from a compared output (place among [`Machine::channels`]).
    Output(usize, OutputEffect),
}

/// One θ.
#[derive(Debug, Clone)]
pub struct Parameter {
    /// `instance.variable`, or `instance.variable:effect`.
    pub name: String,
    /// What it is, in words for people.
    pub phrase: String,
    /// Value with which the model is the nominal one, in its own unit.
    pub neutral: f64,
    /// Smallest and largest value, in its own unit.
    pub range: (f64, f64),
    /// How it moves.
    pub scale: Scale,
    /// What it is part of.
    pub role: Role,
}

/// A compared variable.
#[derive(Debug, Clone)]
pub struct Output {
    /// `instance.variable`.
    pub name: String,
    /// The variable.
    pub variable: Reference,
    /// Stated standard deviation of the sensor, in the variable's unit.
    pub noise: Option<f64>,
    /// Place in [`Problem::channels`].
    pub channel: usize,
    /// What it is measured in, for people.
    pub unit: String,
    /// It may follow an input at once, as far as its unit says.
    pub jumps: bool,
}

/// A fed variable.
#[derive(Debug, Clone)]
pub struct Input {
    /// `instance.variable`.
    pub name: String,
    /// The variable.
    pub variable: Reference,
    /// How it runs between rows.
    pub hold: observe::Hold,
    /// Place in [`Problem::channels`]; `None`: nobody logged it.
    pub channel: Option<usize>,
    /// Its course from a run's begin on, where nobody logged it.
    pub given: Series,
    /// Nobody knows what it was.
    pub open: bool,
    /// What it is measured in, for people.
    pub unit: String,
}

/// A connection between units that no channel cuts.
#[derive(Debug, Clone, Copy)]
pub struct Link {
    /// An output.
    pub from: Reference,
    /// An input.
    pub to: Reference,
    /// What becomes of the value.
    pub by: Affine,
}

/// The nominal model as calls want it.
#[derive(Debug, Clone)]
pub struct Machine {
    /// Units in the order they step.
    pub units: Vec<Unit>,
    /// Connections that are simulated through.
    pub links: Vec<Link>,
    /// States that link rows.
    pub states: Vec<State>,
    /// Fed inputs.
    pub inputs: Vec<Input>,
    /// Compared outputs.
    pub channels: Vec<Output>,
    /// All θ: candidates of the problem, then effects at ports.
    pub parameters: Vec<Parameter>,
    /// Longest step of the units, s.
    pub longest: f64,
    /// Steps may differ in size.
    pub any_step: bool,
    /// Rows over which outputs show a state that can't be read back; 0: every state is read.
    pub horizon: usize,
    /// No unit can be started within a run: it is simulated whole, and the states are what channels show beyond it.
    pub whole: bool,
    /// What starts a run that is simulated whole.
    pub begins: Vec<State>,
    /// The units begin at 0 whatever start time they are told: their clock has so many ticks a second, for differences of the logs' times are
    /// rounded and some units make one step more for that.
    pub own_clock: Option<f64>,
    /// Which inputs the outputs of a row see.
    pub reading: observe::Reading,
    /// A unit that computes its outputs in a step only makes one of this length, s, before a row is read; 0: none.
    pub first_step: f64,
    /// From then on no step is made.
    pub deadline: Option<Instant>,
    /// And how many may be made until then.
    pub(crate) budget: Option<StepBudget>,
}

impl Machine {
    /// A step, s, after which outputs are what they are at rows so far apart, and states have hardly moved.
    pub fn short_step(&self, rows: &[f64]) -> f64 {
        FINE * usual(rows).min(self.longest)
    }

    /// Of a problem. States that no variable shows are read through the outputs: `read_through.rs`.
    ///
    /// # Errors
    /// The scenario has what this way can't follow.
    pub fn new(problem: &Problem) -> Result<Self, Error> {
        let model = &problem.model;
        let units = instances(model);
        let (inputs, channels) = ports_of(problem);
        let longest = model.scenario.units.iter().map(|unit| unit.interval.to_f64());
        let mut machine = Self {
            links: links(problem, &inputs)?,
            states: states(problem, &channels),
            parameters: unit_parameters(problem),
            longest: longest.fold(f64::INFINITY, f64::min),
            any_step: units.iter().all(|u| u.fmu.description().co_simulation.can_handle_variable_step),
            units,
            inputs,
            channels,
            horizon: 0,
            whole: false,
            begins: Vec::new(),
            own_clock: None,
            reading: problem.reading,
            first_step: 0.0,
            deadline: problem.deadline,
            budget: problem.budget.clone(),
        };
        let at_ports = port_parameters(&machine, problem);
        machine.parameters.extend(at_ports);
        Ok(machine)
    }

    /// Number of states.
    pub fn order(&self) -> usize {
        self.states.len()
    }

    /// All parameters where the model is the nominal one.
    pub fn neutral(&self) -> Vec<f64> {
        self.parameters.iter().map(|parameter| parameter.neutral).collect()
    }
}

/// A variable as calls want it.
fn reference(model: &Nominal, id: VariableId) -> Reference {
    let variable = model.variable(id);
    Reference { instance: id.instance, reference: variable.reference, kind: variable.kind }
}

/// The units of the nominal model, each with the values that the scenario sets.
fn instances(model: &Nominal) -> Vec<Unit> {
    let of = |(instance, fmu): (usize, &Fmu)| {
        let own = model.set.iter().filter(|(id, _)| id.instance == instance);
        let settings = last_of_each(own.map(|(id, value)| (model.variable(*id).reference, value)));
        let name = model.scenario.units[instance].name.clone();
        Unit { name, fmu: fmu.clone(), settings }
    };
    model.fmus.iter().enumerate().map(of).collect()
}

/// The last value that is given for each variable; those of different types may have the same reference.
fn last_of_each<'a>(given: impl Iterator<Item = (u32, &'a Value)>) -> Vec<(u32, Value)> {
    let mut last: Vec<(u32, Value)> = Vec::new();
    for (reference, value) in given {
        last.retain(|(known, before)| (*known, before.kind()) != (reference, value.kind()));
        last.push((reference, value.clone()));
    }
    last
}

/// Fed inputs, those last that nobody logged, and compared outputs.
fn ports_of(problem: &Problem) -> (Vec<Input>, Vec<Output>) {
    let model = &problem.model;
    let measured_in = |id: VariableId| model.variable(id).unit.clone().unwrap_or_default();
    let (mut inputs, mut outputs) = (Vec::new(), Vec::new());
    for (place, channel) in problem.channels.iter().enumerate() {
        let variable = reference(model, channel.variable);
        let (name, unit) = (channel.name.clone(), measured_in(channel.variable));
        match channel.role {
            observe::Role::Fed(hold) => {
                let (channel, given) = (Some(place), Series::default());
                inputs.push(Input { name, variable, hold, channel, given, open: false, unit });
            }
            observe::Role::Compared => {
                let jumps = follows_inputs(model, channel.variable);
                outputs.push(Output { name, variable, noise: channel.noise, channel: place, unit, jumps });
            }
        }
    }
    inputs.extend(problem.unlogged.iter().map(|own| Input {
        name: model.name(own.variable),
        variable: reference(model, own.variable),
        hold: own.hold,
        channel: None,
        given: own.series.clone(),
        open: own.open,
        unit: measured_in(own.variable),
    }));
    (inputs, outputs)
}

/// Whether an output may depend on an input of its unit, as the unit is begun or while it steps: where it says nothing, on all of them.
fn follows_inputs(model: &Nominal, id: VariableId) -> bool {
    let description = model.description(id.instance);
    let on_input = |known: Option<&[usize]>| {
        let is_input = |place: &usize| description.variables[*place].causality == Causality::Input;
        known.is_none_or(|known| known.iter().any(is_input))
    };
    on_input(description.step_dependencies(id.place)) || on_input(description.initial_dependencies(id.place))
}

/// The states, each with the output that measures it, if one does.
fn states(problem: &Problem, outputs: &[Output]) -> Vec<State> {
    let model = &problem.model;
    let measured_by = |channel: usize| outputs.iter().position(|output| output.channel == channel);
    let of = |state: &observe::State| State {
        name: model.name(state.shows.unwrap_or(state.start)),
        start: reference(model, state.start),
        shows: state.shows.map(|id| reference(model, id)),
        nominal: model.number(state.start).unwrap_or(0.0),
        channel: state.channel.and_then(measured_by),
    };
    problem.states.iter().map(of).collect()
}

/// Candidates of the problem: parameters of the units.
fn unit_parameters(problem: &Problem) -> Vec<Parameter> {
    let of = |candidate: &observe::Candidate| Parameter {
        name: candidate.name.clone(),
        phrase: candidate.phrase.clone(),
        neutral: candidate.neutral,
        range: candidate.range,
        scale: candidate.scale,
        role: Role::Unit(reference(&problem.model, candidate.variable)),
    };
    problem.candidates.iter().map(of).collect()
}

/// Connections of the scenario that end at no fed input.
fn links(problem: &Problem, inputs: &[Input]) -> Result<Vec<Link>, Error> {
    let model = &problem.model;
    let find = |full: &str| {
        (0..model.fmus.len()).find_map(|instance| {
            let name = full.strip_prefix(model.scenario.units[instance].name.as_str())?.strip_prefix('.')?;
            Some(VariableId { instance, place: model.description(instance).place(name)? })
        })
    };
    let open =
        model.scenario.connections.iter().filter(|link| inputs.iter().all(|input| input.name != link.to));
    open.map(|link| match (find(&link.from), find(&link.to)) {
        (Some(from), Some(to)) => {
            let by = converted(model, from, to, link.transform);
            Ok(Link { from: reference(model, from), to: reference(model, to), by })
        }
        _ => Err(Error::Model(format!("connection {} to {}: no such variables", link.from, link.to))),
    })
    .collect()
}

/// input = gain · (value in the input's unit) + bias, as the master has it.
fn converted(model: &Nominal, from: VariableId, to: VariableId, transform: Transform) -> Affine {
    let Transform { gain, bias, convert_units } = transform;
    let base = |id: VariableId| {
        let variable = model.variable(id);
        let unit = variable.unit.as_deref().filter(|_| variable.kind == Kind::Real)?;
        model.description(id.instance).unit(unit)?.base
    };
    let units = base(from).zip(base(to)).filter(|(a, b)| convert_units && a.exponents == b.exponents);
    let by = units.map_or(Affine::SAME, |(a, b)| {
        let difference = model.variable(from).relative_quantity && model.variable(to).relative_quantity;
        let offset = if difference { 0.0 } else { (a.offset - b.offset) / b.factor };
        Affine { scale: a.factor / b.factor, offset }
    });
    Affine { scale: gain * by.scale, offset: gain * by.offset + bias }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_a_variable_starts_at_the_last_value_that_was_said() {
        let given =
            [(1, Value::Real(1.0)), (2, Value::Real(2.0)), (1, Value::Integer(3)), (1, Value::Real(4.0))];
        let last = last_of_each(given.iter().map(|(reference, value)| (*reference, value)));
        assert_eq!(last, [(2, Value::Real(2.0)), (1, Value::Integer(3)), (1, Value::Real(4.0))]);
    }
}
