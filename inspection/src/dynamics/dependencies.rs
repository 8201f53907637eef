//! Dependencies that a description denies (FMI 2.0.4 section 2.2.8): an input is moved, an output must not move with it.

use super::bench::{Bench, Halt, Subject, moved, same};
use crate::Severity;
use crate::finding::Found;
use orchestrator::fmu::{Causality, Variable};
use orchestrator::{Kind, Value};

/// Not more inputs than these are moved.
const INPUTS: usize = 50;

pub(super) fn dependencies(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    let inputs: Vec<&Variable> = bench.variables(Causality::Input).into_iter().take(INPUTS).collect();
    let mut unit = bench.initialising("unit")?;
    at_once(bench, &mut unit, &inputs, "InitialUnknowns", found)?;
    drop(unit);
    let mut unit = bench.started("unit")?;
    for k in 0..3 {
        unit.advance(k)?;
    }
    at_once(bench, &mut unit, &inputs, "Outputs", found)?;
    drop(unit);
    if bench.description().co_simulation.can_handle_variable_step {
        short_step(bench, &inputs, found)?;
    }
    Ok(())
}

/// On what a list says that an output depends; `None`: on everything.
fn declared<'b>(bench: &'b Bench, list: &str, output: &Variable) -> Option<&'b [usize]> {
    let description = bench.description();
    let place = description.place(&output.name)?;
    match list {
        "Outputs" => description.step_dependencies(place),
        _ => description.initial_dependencies(place),
    }
}

/// Moves one input after the other and looks at the outputs at the same time.
fn at_once(
    bench: &Bench,
    unit: &mut Subject<'_>,
    inputs: &[&Variable],
    list: &str,
    found: &mut Found,
) -> Result<(), Halt> {
    let outputs = bench.outputs();
    for input in inputs {
        let now = unit.read(&[input])?.remove(0);
        let Some(other) = moved(input, &now) else { continue };
        // Set to what it is: from here on only its value changes.
        unit.set(input, &now)?;
        let before = unit.read(&outputs)?;
        unit.set(input, &other)?;
        let after = unit.read(&outputs)?;
        unit.set(input, &now)?;
        let back = unit.read(&outputs)?;
        for (place, output) in outputs.iter().enumerate() {
            // What does not come back with the input has other reasons.
            let changed = !same(&before[place], &after[place]) && same(&before[place], &back[place]);
            let denied = declared(bench, list, output).is_some_and(|listed| !bench.lists(listed, input));
            if changed && denied {
                let text = format!(
                    "it goes from {} to {} as {} goes from {now} to {other}, but its dependencies in {list} do not list that input",
                    before[place], after[place], input.name
                );
                found.say(Severity::Error, Some(&output.name), text);
            }
        }
    }
    Ok(())
}

/// What an input does by way of a state vanishes with the step; what stays in a thousandth of it goes the direct way.
fn short_step(bench: &Bench, inputs: &[&Variable], found: &mut Found) -> Result<(), Halt> {
    let outputs: Vec<&Variable> =
        bench.outputs().into_iter().filter(|output| output.kind == Kind::Real).collect();
    for input in inputs {
        let denied: Vec<&&Variable> = (outputs.iter())
            .filter(|output| {
                declared(bench, "Outputs", output).is_some_and(|listed| !bench.lists(listed, input))
            })
            .collect();
        if denied.is_empty() {
            continue;
        }
        let effect = |size: f64| -> Result<Option<Vec<f64>>, Halt> {
            let mut values = Vec::new();
            for is_moved in [false, true] {
                let mut unit = bench.started("unit")?;
                unit.advance(0)?;
                unit.advance(1)?;
                let now = unit.read(&[input])?.remove(0);
                let Some(other) = moved(input, &now).filter(|_| matches!(now, Value::Real(_))) else {
                    return Ok(None);
                };
                unit.set(input, if is_moved { &other } else { &now })?;
                unit.step(bench.start + 2.0 * bench.step, size)?;
                let read: Vec<&Variable> = denied.iter().map(|output| **output).collect();
                values.push(unit.read(&read)?);
            }
            let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
            Ok(Some(values[0].iter().zip(&values[1]).map(|(a, b)| (number(a) - number(b)).abs()).collect()))
        };
        let (Some(whole), Some(short)) = (effect(bench.step)?, effect(bench.step / 1000.0)?) else {
            continue;
        };
        for ((output, whole), short) in denied.iter().zip(whole).zip(short) {
            if short > 0.5 * whole && whole > 1e-12 {
                let text = format!(
                    "in a step of {} s it moves by {short} with {}, in one of {} s by {whole}: it depends directly on that input, which its dependencies in Outputs do not list",
                    bench.step / 1000.0,
                    input.name,
                    bench.step
                );
                found.say(Severity::Warning, Some(&output.name), text);
            }
        }
    }
    Ok(())
}
