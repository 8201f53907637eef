//! What a master may do wrong, or does at the edge: nothing, value references that no variable has, values that are no numbers.

use super::bench::{Bench, Halt};
use super::worker::say_call;
use crate::finding::Found;
use orchestrator::fmu::Instance;
use orchestrator::{Kind, Value};

pub(super) fn null(bench: &Bench, _: &mut Found) -> Result<(), Halt> {
    say_call("fmi2FreeInstance of a null pointer");
    let mut unit = bench.started("unit")?;
    say_call("fmi2FreeInstance of a null pointer");
    bench.fmu.free_nothing()?;
    if bench.description().co_simulation.can_get_and_set_state {
        unit.call("fmi2FreeFMUstate of a null pointer", Instance::free_no_state)?;
    }
    // Empty lists at null pointers: whether they are refused is the unit's choice, to live through them is not.
    let _ =
        unit.call("fmi2GetReal and fmi2SetReal of no variables, at null pointers,", Instance::access_nothing);
    Ok(())
}

pub(super) fn unknown(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    let highest = bench.description().variables.iter().map(|variable| variable.reference).max().unwrap_or(0);
    let mut strange: Vec<u32> =
        [highest.saturating_add(1), highest.saturating_add(100_000), u32::MAX].to_vec();
    strange.retain(|reference| *reference > highest);
    for kind in [Kind::Real, Kind::Integer, Kind::Boolean, Kind::String] {
        if !bench.description().variables.iter().any(|variable| variable.kind == kind) {
            continue;
        }
        let value = match kind {
            Kind::Real => Value::Real(0.0),
            Kind::Integer => Value::Integer(0),
            Kind::Boolean => Value::Boolean(false),
            Kind::String => Value::String(String::new()),
        };
        let mut taken = Vec::new();
        for reference in &strange {
            let mut unit = bench.started("unit")?;
            let get = unit.call(&format!("fmi2Get{kind} of the unknown value reference {reference}"), |i| {
                i.get(kind, *reference)
            });
            let set = unit.call(&format!("fmi2Set{kind} of the unknown value reference {reference}"), |i| {
                i.set(*reference, &value)
            });
            if get.is_ok() || set.is_ok() {
                taken.push(reference.to_string());
            }
        }
        if !taken.is_empty() {
            found.warning(format!(
                "value references that no variable has ({}) are read or set as {kind} without an error",
                taken.join(", ")
            ));
        }
    }
    Ok(())
}

/// Not more inputs than these are tried, each with an instance of its own.
const INPUTS: usize = 20;

pub(super) fn not_a_number(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    for input in bench.real_inputs().into_iter().take(INPUTS) {
        for value in [f64::NAN, f64::INFINITY] {
            let mut unit = bench.started("unit")?;
            let refused =
                unit.set(input, &Value::Real(value)).is_err() || unit.step(bench.start, bench.step).is_err();
            if refused {
                continue;
            }
            // Where it was taken, the unit must not be spoilt for good: a reset brings it back.
            if unit.call("fmi2Reset", Instance::reset_itself).is_err() {
                continue;
            }
            unit.set_up()?;
            unit.exit_initialization()?;
            let outputs = bench.outputs();
            let values = unit.read(&outputs)?;
            let fresh = bench.started("fresh")?.read(&outputs)?;
            let finite = |value: &Value| value.as_f64().is_none_or(f64::is_finite);
            let spoilt = outputs
                .iter()
                .zip(values)
                .zip(&fresh)
                .find(|((_, value), fresh)| !finite(value) && finite(fresh));
            if let Some(((output, value), _)) = spoilt {
                let text =
                    format!("it is {value} after {} was {value} once, even after fmi2Reset", input.name);
                found.say(crate::Severity::Error, Some(&output.name), text);
            }
        }
    }
    Ok(())
}
