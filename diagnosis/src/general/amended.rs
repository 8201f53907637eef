//! The nominal scenario with what was found switched on: parameters in their units, effects at ports in `signal_effects.fmu`
//! between the others. What the logs fed, and no unit or source of the scenario does, comes from a table of the first run.
//!
//! Masters step units in the order of the file and hand on the newest values. So a unit before an input stands before the
//! unit that it feeds, one behind an output after it. Between its steps a value is held: a line, a delay or lag at an input gets
//! a finer interval, of which the delay is as nearly as can be a multiple.

use super::equivalent::equivalent;
use super::policy::GENERAL;
use super::study::Studied;
use super::table::{self, Feed};
use crate::dynamics::machine::{Machine, Role};
use crate::error::Error;
use crate::infer::smooth;
use crate::observe::{Hold, InputEffect, OutputEffect, Problem};
use crate::ports::Kind;
use orchestrator::fmu::Causality;
use orchestrator::scenario::UnitEntry;
use orchestrator::time::Rational;
use orchestrator::{Scenario, Simulation, UnitPath};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The unit that stands between ports.
const SIGNAL_EFFECTS: &str = "signal_effects.fmu";

/// Effects of one port: name of the parameter in the signal unit, and value.
type AtPort = BTreeMap<&'static str, f64>;
/// Those of all ports, by place.
type AtPorts = BTreeMap<usize, AtPort>;

/// An effect at an output as the signal unit's parameter; those at inputs have its names.
fn at_output(effect: OutputEffect) -> &'static str {
    match effect {
        OutputEffect::Offset => InputEffect::Bias.name(),
        other => other.name(),
    }
}

/// An amended scenario.
pub struct Amended {
    /// As TOML.
    pub text: String,
    /// Files that lie beside it.
    pub attachments: Vec<(String, String)>,
    /// What a reader should know of it.
    pub told: Option<String>,
}

/// The scenario with what was found.
///
/// # Errors
/// The scenario can't be built with these values.
pub fn amended(problem: &Problem, studied: &Studied, units: &UnitPath) -> Result<Amended, Error> {
    let failed = |error: orchestrator::Error| Error::Model(format!("amended scenario: {error}"));
    let machine = &studied.built.engine.machine;
    let mut scenario = problem.model.scenario.clone();
    let (inputs, mut outputs) = switched_on(&mut scenario, machine, &studied.fit.at.theta)?;
    let inside = kept_out(problem, machine, &mut outputs);
    let fed = |input: &str| {
        scenario.connections.iter().any(|link| link.to == input)
            || scenario.sources.iter().any(|source| source.to == input)
    };
    let (carried, told) = equivalent(studied, &|name| fed(name))?;
    let wanted = |place: &usize| {
        let input = &machine.inputs[*place];
        let carries = carried.as_ref().is_some_and(|own| own.input == *place);
        !fed(&input.name) && (input.channel.is_some() || inputs.contains_key(place) || carries)
    };
    let logged: Vec<usize> = (0..machine.inputs.len()).filter(wanted).collect();
    if !logged.is_empty() {
        let start = carried.as_ref().map_or(&studied.fit.at.paths[0], |own| &own.start);
        as_logged(&mut scenario, problem, studied, start)?;
    }
    if scenario.units.len() == 1 {
        let is_line = |place: &usize| machine.inputs[*place].hold == Hold::Linear;
        let lines = machine.any_step && logged.iter().any(is_line);
        scenario.units[0].interval = fine(problem, scenario.units[0].interval, &inputs, lines);
    }
    rewire(&mut scenario, machine, &inputs);
    let feeds: Vec<Feed> = logged.iter().map(|place| feed(machine, &inputs, *place)).collect();
    let added = between_ports(&mut scenario, machine, &inputs, &outputs)?;
    scenario.units = ordered(std::mem::take(&mut scenario.units), added);
    let step = scenario.units.first().map_or(0.0, |unit| unit.interval.to_f64());
    let mut text = Simulation::new(&scenario, units).map_err(failed)?.resolved();
    let mut sources = String::new();
    let grid = carried.as_ref().map_or(&studied.built.engine.grids[0], |own| &own.grid);
    let attachments = table::written(studied, grid, &feeds, step, &mut sources);
    text += &sources;
    let told = [told, inside].into_iter().flatten().reduce(|one, other| format!("{one}; {other}"));
    Ok(Amended { text, attachments, told })
}

/// Where the table of the first run feeds an input: past the effects before it.
fn feed(machine: &Machine, inputs: &AtPorts, place: usize) -> Feed {
    let (input, through) = (&machine.inputs[place], inputs.contains_key(&place));
    let to = if through { format!("{}.u", before(place)) } else { input.name.clone() };
    Feed { place, to, line: through && input.hold == Hold::Linear }
}

/// Units for the effects at ports, connected: each with the place of the unit that it belongs to, and whether it stands before that.
fn between_ports(
    scenario: &mut Scenario,
    machine: &Machine,
    inputs: &AtPorts,
    outputs: &AtPorts,
) -> Result<Vec<(usize, bool, UnitEntry)>, Error> {
    let mut added: Vec<(usize, bool, UnitEntry)> = Vec::new();
    for (place, effects) in inputs {
        let (input, name) = (&machine.inputs[*place], before(*place));
        let instance = input.variable.instance;
        let linear = input.hold == Hold::Linear;
        added.push((instance, true, entry(&name, scenario.units[instance].interval, effects, linear)?));
        connect(scenario, &format!("{name}.y"), &input.name)?;
    }
    for (place, effects) in outputs {
        let (output, name) = (&machine.channels[*place], behind(*place));
        let instance = output.variable.instance;
        added.push((instance, false, entry(&name, scenario.units[instance].interval, effects, true)?));
        connect(scenario, &output.name, &format!("{name}.u"))?;
    }
    Ok(added)
}

/// Takes away the effects of sensors of local variables: a connection begins at an output.
fn kept_out(problem: &Problem, machine: &Machine, outputs: &mut AtPorts) -> Option<String> {
    let is_output = |place: &usize| {
        let channel = &problem.channels[machine.channels[*place].channel];
        problem.model.variable(channel.variable).causality == Causality::Output
    };
    let inside: Vec<usize> = outputs.keys().copied().filter(|place| !is_output(place)).collect();
    let names: Vec<&str> = inside.iter().map(|place| machine.channels[*place].name.as_str()).collect();
    outputs.retain(|place, _| !inside.contains(place));
    (!names.is_empty()).then(|| {
        format!("no output shows {}: the amended scenario leaves out what its sensor does", names.join(", "))
    })
}

/// Sets the units' parameters; effects at ports, by the place of the port.
fn switched_on(
    scenario: &mut Scenario,
    machine: &Machine,
    theta: &[f64],
) -> Result<(AtPorts, AtPorts), Error> {
    let failed = |error: orchestrator::Error| Error::Model(format!("amended scenario: {error}"));
    let (mut inputs, mut outputs) = (AtPorts::new(), AtPorts::new());
    for (parameter, value) in machine.parameters.iter().zip(theta) {
        if *value == parameter.neutral {
            continue;
        }
        match parameter.role {
            Role::Unit(reference) => {
                let text = match reference.kind {
                    orchestrator::Kind::Boolean => (*value > 0.5).to_string(),
                    orchestrator::Kind::Integer => format!("{value:.0}"),
                    _ => format!("{value:?}"),
                };
                scenario.set(&parameter.name, &text).map_err(failed)?;
            }
            Role::Input(place, effect) => {
                inputs.entry(place).or_default().insert(effect.name(), *value);
            }
            Role::Output(place, effect) => {
                outputs.entry(place).or_default().insert(at_output(effect), *value);
            }
        }
    }
    Ok((inputs, outputs))
}

/// Start states and length of the first run.
fn as_logged(
    scenario: &mut Scenario,
    problem: &Problem,
    studied: &Studied,
    start: &[f64],
) -> Result<(), Error> {
    let failed = |error: orchestrator::Error| Error::Model(format!("amended scenario: {error}"));
    let engine = &studied.built.engine;
    let begun = engine.machine.whole.then(|| begun(studied));
    let start = begun.as_deref().unwrap_or(start);
    for (state, value) in problem.states.iter().zip(start) {
        scenario.set(&state.name, &format!("{value:?}")).map_err(failed)?;
    }
    let span = engine.grids[0].span();
    scenario.set_stop(&format!("{:.6}", span.max(1e-6))).map_err(failed)
}

/// Where the first run begins that is simulated whole: its own start values, as far off as its rows say.
fn begun(studied: &Studied) -> Vec<f64> {
    let run = &studied.fit.runs[0];
    let states = smooth(run, &studied.fit.at.noise).state;
    let off = &states[studied.built.engine.machine.order()..];
    let begin = &studied.built.engine.grids[0].begin;
    begin.iter().zip(off).map(|((value, size), off)| value + off * size).collect()
}

/// The interval at which a delay or lag at an input is followed, and `lines` are, of which a unit between two steps sees the middle.
fn fine(problem: &Problem, interval: Rational, inputs: &AtPorts, lines: bool) -> Rational {
    let takes_time = |effects: &&AtPort| {
        let at = InputEffect::ALL.iter().filter(|effect| effects.contains_key(effect.name()));
        at.into_iter().any(|effect| Kind::of_input(*effect).over_time)
    };
    if !lines && inputs.values().filter(takes_time).count() == 0 {
        return interval;
    }
    let delays: Vec<f64> =
        inputs.values().filter_map(|effects| effects.get(InputEffect::Delay.name()).copied()).collect();
    let parts = parts(interval.to_f64(), problem.row(), &delays);
    Rational::new(i128::from(interval.numerator()), i128::from(interval.denominator()) * i128::from(parts))
        .unwrap_or(interval)
}

/// Parts of a unit's own interval, s, where rows are so far apart, of which these delays are as nearly as can be multiples.
fn parts(own: f64, row: f64, delays: &[f64]) -> i64 {
    let least = (own * GENERAL.steps_a_row / row).ceil().max(1.0) as i64;
    let off = |parts: i64| {
        let step = own / parts as f64;
        delays.iter().map(|delay| (delay / step - (delay / step).round()).abs() * step).sum::<f64>()
    };
    (least..=GENERAL.finest * least).min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(least)
}

/// Name of the unit before an input.
fn before(place: usize) -> String {
    format!("input_effects_{}", place + 1)
}

/// Name of the unit behind an output.
fn behind(place: usize) -> String {
    format!("output_effects_{}", place + 1)
}

/// A unit of ours, written as in a scenario: its reader knows what an entry has beside this.
fn entry(name: &str, interval: Rational, effects: &AtPort, linear: bool) -> Result<UnitEntry, Error> {
    let mut text = format!(
        "format = 1\n[experiment]\nstop = 1\n[[units]]\nname = \"{name}\"\nfmu = \"{SIGNAL_EFFECTS}\"\n\
         interval = \"{interval}\"\n[units.set]\nlinear = {linear}\n"
    );
    effects.iter().for_each(|(name, value)| {
        let _ = writeln!(text, "{name} = {value:?}");
    });
    parsed(&text)?.units.pop().ok_or_else(|| Error::Model(format!("amended scenario: no unit {name}")))
}

fn parsed(text: &str) -> Result<Scenario, Error> {
    Scenario::parse(text, "amended.toml").map_err(|error| Error::Model(format!("amended scenario: {error}")))
}

/// The units with those added, each before or after the unit that it belongs to.
fn ordered(units: Vec<UnitEntry>, added: Vec<(usize, bool, UnitEntry)>) -> Vec<UnitEntry> {
    let mut all = Vec::with_capacity(units.len() + added.len());
    let of = |unit: usize, first: bool| {
        added
            .iter()
            .filter(move |(own, before, _)| *own == unit && *before == first)
            .map(|(.., entry)| entry.clone())
    };
    for (place, unit) in units.into_iter().enumerate() {
        all.extend(of(place, true));
        all.push(unit);
        all.extend(of(place, false));
    }
    all
}

/// What fed an input with effects now feeds the unit before it.
fn rewire(scenario: &mut Scenario, machine: &Machine, inputs: &AtPorts) {
    for place in inputs.keys() {
        let to = format!("{}.u", before(*place));
        let name = &machine.inputs[*place].name;
        let links = scenario.connections.iter_mut().map(|link| &mut link.to);
        let fed = links.chain(scenario.sources.iter_mut().map(|source| &mut source.to));
        fed.filter(|known| *known == name).for_each(|known| known.clone_from(&to));
    }
}

/// A connection without delay.
fn connect(scenario: &mut Scenario, from: &str, to: &str) -> Result<(), Error> {
    // a scenario has a unit, whatever is wanted of it
    let text = format!(
        "format = 1\n[experiment]\nstop = 1\n[[units]]\nname = \"a\"\nfmu = \"{SIGNAL_EFFECTS}\"\ninterval = 1\n\
         [[connections]]\nfrom = \"{from}\"\nto = \"{to}\"\n"
    );
    scenario.connections.extend(parsed(&text)?.connections);
    Ok(())
}

/// Whether the unit between ports is there, which an amended scenario may want: told before the work.
///
/// # Errors
/// It isn't.
pub fn within_reach(problem: &Problem, units: &UnitPath) -> Result<(), Error> {
    if problem.ports.inputs.is_empty() && problem.ports.outputs.is_empty() {
        return Ok(());
    }
    let needed = |error| match error {
        Error::Nominal(why) => Error::Nominal(format!(
            "{why}. It is no part of your model: effects at its ports are added by this unit of ours, which `cargo xtask pack` makes, and which \
             ACROSCOPE_FMUS or a folder `fmus` beside the program may hold; [ports] inputs = [] and outputs = [] do without"
        )),
        other => other,
    };
    crate::opened::open(SIGNAL_EFFECTS, &problem.path, units).map(|_| ()).map_err(needed)
}

#[cfg(test)]
mod tests {
    use super::parts;

    #[test]
    fn value_how_finely_an_input_with_a_delay_is_followed() {
        // a lag: a jump is off by half a step, by a fortieth of a row and not by a twentieth or an eightieth
        let jump = |own: f64, row: f64| 0.5 * own / parts(own, row, &[]) as f64 / row;
        assert!((0.02..0.03).contains(&jump(0.01, 0.01)), "{}", jump(0.01, 0.01));
        assert!((0.02..0.03).contains(&jump(0.01, 0.03)), "a unit that steps more finely than it is logged");
        assert_eq!(parts(0.001, 0.1, &[]), 1, "as fine by itself");
        // a delay of a prime part of a row: met by as many steps, though not by more than thrice as many as without
        let row = 0.01;
        assert_eq!(parts(row, row, &[row / 23.0]), 23);
        assert_eq!(parts(row, row, &[row / 59.0]), 59);
        assert!(parts(row, row, &[row / 61.0]) < 61);
    }
}
