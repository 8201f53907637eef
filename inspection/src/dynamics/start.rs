//! The start: values of the description are those of the unit (FMI 2.0.4 section 2.2.7), values that are set are in force whenever they
//! were set, and time begins where the unit is told (4.2.2).

use super::bench::{Bench, Halt, Subject, moved};
use super::steps::{is_start, started_exactly};
use crate::Severity;
use crate::finding::Found;
use orchestrator::fmu::{Causality, Instance, Variability, Variable};
use orchestrator::{Kind, Value};

/// Steps after the begin at which a run is begun late.
const LATE: f64 = 3.0;

pub(super) fn values(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    let mut unit = bench.initialising("unit")?;
    compare(bench, &mut unit, "", found)?;
    Ok(())
}

/// Says which start values are not in force; `when` is put behind.
pub(super) fn compare(
    bench: &Bench,
    unit: &mut Subject<'_>,
    when: &str,
    found: &mut Found,
) -> Result<(), Halt> {
    let variables = started_exactly(bench);
    let values = unit.read(&variables)?;
    for (variable, value) in
        variables.iter().zip(&values).filter(|(variable, value)| !is_start(variable, value))
    {
        let start = variable.start.as_ref().map(ToString::to_string).unwrap_or_default();
        let text = format!("its start value is {start} in the description and {value} in the unit{when}");
        found.say(Severity::Error, Some(&variable.name), text);
    }
    Ok(())
}

/// Values may be set as soon as there is an instance; telling it of the experiment must not take them back.
pub(super) fn early(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    let moved = parameters_moved(bench);
    // what a unit refuses, all of them together perhaps, says nothing
    let Ok(values) = kept(bench, &moved) else { return Ok(()) };
    let lost: Vec<&Variable> = (moved.iter().zip(&values))
        .filter(|((variable, set), value)| *value != set && is_start(variable, value))
        .map(|((variable, _), _)| *variable)
        .collect();
    if let Some(first) = lost.first() {
        let text = format!(
            "set before fmi2SetupExperiment it is back at its start value afterwards, as {} of {} that were set: a master that sets values \
             first runs another model",
            lost.len(),
            moved.len()
        );
        found.say(Severity::Error, Some(&first.name), text);
    }
    Ok(())
}

/// Numbers that are parameters, each a little off its start value.
fn parameters_moved(bench: &Bench) -> Vec<(&Variable, Value)> {
    let parameters = bench.variables(Causality::Parameter).into_iter().filter(|variable| {
        variable.variability != Variability::Constant && matches!(variable.kind, Kind::Real | Kind::Integer)
    });
    parameters.filter_map(|variable| Some((variable, moved(variable, variable.start.as_ref()?)?))).collect()
}

/// Parameters may be set before initialization mode and in it; the model must be the same.
pub(super) fn late(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    let moved = parameters_moved(bench);
    // what a unit refuses before the mode, all of them together perhaps, says nothing
    let (Ok(before), false) = (begun(bench, &moved, false), moved.is_empty()) else { return Ok(()) };
    let within = match begun(bench, &moved, true) {
        Ok(within) => within,
        Err(Halt::Call(error)) => {
            let text = format!("a parameter can't be set in initialization mode: {error}");
            found.say(Severity::Warning, None, text);
            return Ok(());
        }
        Err(other) => return Err(other),
    };
    let outputs = bench.outputs();
    let differs = outputs.iter().zip(before.iter().zip(&within)).find(|(_, (one, other))| one != other);
    if let Some((output, (one, other))) = differs {
        let text = format!(
            "it is {one} where parameters are set before fmi2EnterInitializationMode, and {other} where they are set in that mode: masters \
             that do the one and the other run two models"
        );
        found.say(Severity::Error, Some(&output.name), text);
    }
    Ok(())
}

/// Outputs after a step, with values that are set before initialization mode or in it.
fn begun(bench: &Bench, moved: &[(&Variable, Value)], within: bool) -> Result<Vec<Value>, Halt> {
    let mut unit = bench.instance("unit")?;
    unit.call("fmi2SetupExperiment", |instance| instance.setup_experiment(bench.start, None))?;
    if within {
        unit.call("fmi2EnterInitializationMode", Instance::enter_initialization)?;
    }
    for (variable, value) in moved {
        unit.set(variable, value)?;
    }
    if !within {
        unit.call("fmi2EnterInitializationMode", Instance::enter_initialization)?;
    }
    unit.exit_initialization()?;
    unit.step(bench.start, bench.step)?;
    unit.read(&bench.outputs())
}

/// What is in force of values that were set before the experiment.
fn kept(bench: &Bench, moved: &[(&Variable, Value)]) -> Result<Vec<Value>, Halt> {
    let mut unit = bench.instance("unit")?;
    for (variable, value) in moved {
        unit.set(variable, value)?;
    }
    unit.set_up()?;
    let variables: Vec<&Variable> = moved.iter().map(|(variable, _)| *variable).collect();
    unit.read(&variables)
}

/// One step of a new instance, begun at a time: outputs before and after.
fn stepped(bench: &Bench, from: f64, size: f64) -> Result<[Vec<Value>; 2], Halt> {
    let mut unit = bench.instance("unit")?;
    unit.call("fmi2SetupExperiment", |instance| instance.setup_experiment(from, None))?;
    unit.call("fmi2EnterInitializationMode", Instance::enter_initialization)?;
    unit.exit_initialization()?;
    let begin = unit.read(&bench.outputs())?;
    unit.excite(0)?;
    unit.step(from, size)?;
    Ok([begin, unit.read(&bench.outputs())?])
}

/// A unit that begins at 0 whatever it is told goes the whole way from there in its first step. One that follows the time itself shows it once
/// it is initialised.
pub(super) fn time(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    let (begin, step) = (bench.start, bench.step);
    let late = begin + LATE * step;
    let (told, short) = (stepped(bench, late, step)?, stepped(bench, begin, step)?);
    // a long step that is refused says nothing
    let Ok(long) = stepped(bench, begin, late - begin + step) else { return Ok(()) };
    if told[0] == short[0] && told[1] == long[1] && told[1] != short[1] {
        found.warning(format!(
            "told to begin at {late} s, its first step goes the whole way from {begin} s: it does not listen to the start time of \
             fmi2SetupExperiment"
        ));
    }
    Ok(())
}
