//! Rules on plain runs: it gets to the end of its experiment, twice the same way, within its limits, however finely stepped.

use super::bench::{Bench, Halt, STEPS, is_exact};
use super::worker::say_trace;
use crate::Severity;
use crate::finding::Found;
use orchestrator::fmu::Variability;
use orchestrator::{Kind, Value};

/// Longer experiments are not run to their end.
const LONGEST: u64 = 300;

/// Steps of the unit's own experiment, as far as they are made.
fn steps(bench: &Bench) -> u64 {
    let stop = bench.description().default_experiment.stop.unwrap_or(f64::INFINITY);
    // Half a step for the rounding.
    let whole = ((stop - bench.start) / bench.step + 0.5).floor();
    if whole >= 1.0 && whole < LONGEST as f64 { whole as u64 } else { LONGEST }
}

pub(super) fn runs(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    let outputs = bench.outputs();
    let mut told = vec![false; outputs.len()];
    let mut unit = bench.started("unit")?;
    for k in 0..=steps(bench) {
        for ((output, value), told) in outputs.iter().zip(unit.read(&outputs)?).zip(&mut told) {
            if matches!(value, Value::Real(value) if !value.is_finite()) && !*told {
                *told = true;
                let time = bench.start + k as f64 * bench.step;
                let text = format!("it is {value} at t = {time} s, near the start values of all inputs");
                found.say(Severity::Warning, Some(&output.name), text);
            }
        }
        if k < steps(bench) {
            unit.advance(k)?;
        }
    }
    Ok(())
}

pub(super) fn repeatable(bench: &Bench, _: &mut Found) -> Result<(), Halt> {
    let mut unit = bench.started("unit")?;
    let rows = unit.trace(0..STEPS);
    let rows = match rows {
        Err(Halt::Ended) => Vec::new(),
        other => other?,
    };
    let mut bits = String::new();
    for value in rows.iter().flatten() {
        match value {
            Value::Real(value) => bits.push_str(&format!("{:x} ", value.to_bits())),
            value => bits.push_str(&format!("{value} ")),
        }
    }
    say_trace(&bits);
    Ok(())
}

pub(super) fn output_range(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    let outputs = bench.outputs();
    let mut told = vec![false; outputs.len()];
    let mut unit = bench.started("unit")?;
    for k in 0..STEPS {
        unit.advance(k)?;
        for ((output, value), told) in outputs.iter().zip(unit.read(&outputs)?).zip(&mut told) {
            let Some(number) = value.as_f64().filter(|_| !*told) else { continue };
            let below = output.min.is_some_and(|min| number < min);
            if below || output.max.is_some_and(|max| number > max) {
                *told = true;
                let limit = if below {
                    format!("min {}", output.min.unwrap_or_default())
                } else {
                    format!("max {}", output.max.unwrap_or_default())
                };
                let text = format!("it is {number} in step {}, beyond its {limit}", k + 1);
                found.say(Severity::Warning, Some(&output.name), text);
            }
            let is_item =
                |items: &[(String, i32)]| items.iter().any(|(_, item)| value == Value::Integer(*item));
            if output.items.as_deref().is_some_and(|items| !is_item(items)) && !*told {
                *told = true;
                let text = format!("it is {number} in step {}, no item of its enumeration", k + 1);
                found.say(Severity::Warning, Some(&output.name), text);
            }
        }
    }
    Ok(())
}

/// Steps of the coarse run.
const COARSE: u64 = 10;
/// A solver's own error within these few steps is below this share of what an output does; a step that counts for another
/// one is far above.
const SHARE: f64 = 0.02;

pub(super) fn splitting(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    if !bench.description().co_simulation.can_handle_variable_step {
        return Ok(());
    }
    let outputs: Vec<_> = (bench.outputs().into_iter())
        .filter(|output| output.kind == Kind::Real && output.variability == Variability::Continuous)
        .collect();
    let mut courses = Vec::new();
    for parts in [1, 2u64] {
        let mut unit = bench.started(if parts == 1 { "coarse" } else { "fine" })?;
        // Held a little beside their start values: a unit that is at rest there shows nothing.
        unit.excite(0)?;
        let mut rows = vec![unit.read(&outputs)?];
        for k in 0..COARSE * parts {
            let size = bench.step / parts as f64;
            unit.step(bench.start + k as f64 * size, size)?;
            if (k + 1) % parts == 0 {
                rows.push(unit.read(&outputs)?);
            }
        }
        courses.push(rows);
    }
    for (place, output) in outputs.iter().enumerate() {
        let course =
            |rows: &[Vec<Value>]| -> Vec<f64> { rows.iter().filter_map(|row| row[place].as_f64()).collect() };
        let (coarse, fine) = (course(&courses[0]), course(&courses[1]));
        let (low, high) = coarse
            .iter()
            .chain(&fine)
            .fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(*value), high.max(*value)));
        // The last point: where an event lies between two points, the ones around it may differ.
        let (Some(one), Some(two)) = (coarse.last(), fine.last()) else { continue };
        let span = high - low;
        let difference = (one - two).abs();
        if span.is_finite() && difference > SHARE * span && difference > 1e-9 * one.abs() {
            let end = COARSE as f64 * bench.step;
            let text = format!(
                "after {end} s with inputs held it is {one} by {COARSE} steps and {two} by {} half ones: results depend on the communication interval, though canHandleVariableCommunicationStepSize",
                2 * COARSE
            );
            found.say(Severity::Warning, Some(&output.name), text);
        }
    }
    Ok(())
}

/// Whether a value at the start is that of the description.
pub(super) fn is_start(variable: &orchestrator::fmu::Variable, value: &Value) -> bool {
    match (&variable.start, value) {
        (Some(Value::Real(start)), Value::Real(value)) => {
            start == value || (start.is_nan() && value.is_nan())
        }
        (Some(start), value) => start == value,
        (None, _) => true,
    }
}

/// The variables whose start values hold.
pub(super) fn started_exactly(bench: &Bench) -> Vec<&orchestrator::fmu::Variable> {
    let all = bench.description().variables.iter();
    all.filter(|variable| is_exact(variable) && variable.start.is_some()).collect()
}
