//! Derivatives: those that a unit computes against differences (FMI 2.0.4 section 2.1.9), and those of inputs and outputs over
//! time (section 4.2.1).

use super::bench::{Bench, Halt, Subject, within};
use crate::Severity;
use crate::finding::Found;
use orchestrator::fmu::{Instance, Variability, Variable};
use orchestrator::{Kind, Value};

/// Not more pairs than these are looked at.
const PAIRS: usize = 400;
/// Differences over two widths agree to this share, or they are none of a smooth function.
const SMOOTH: f64 = 1e-2;
/// What a derivative may be off by: as a share of it, and of the size of the output.
const SHARE: f64 = 1e-2;
const OF_OUTPUT: f64 = 1e-6;

pub(super) fn directional(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    if !bench.description().co_simulation.provides_directional_derivative {
        return Ok(());
    }
    let mut unit = bench.initialising("unit")?;
    at_point(bench, &mut unit, "at initialisation", found)?;
    drop(unit);
    let mut unit = bench.started("unit")?;
    for k in 0..3 {
        unit.advance(k)?;
    }
    at_point(bench, &mut unit, "after three steps", found)
}

fn continuous(variable: &&Variable) -> bool {
    variable.kind == Kind::Real && variable.variability == Variability::Continuous
}

fn at_point(bench: &Bench, unit: &mut Subject<'_>, when: &str, found: &mut Found) -> Result<(), Halt> {
    let outputs: Vec<&Variable> = bench.outputs().into_iter().filter(continuous).collect();
    let mut pairs = 0;
    for input in bench.real_inputs().into_iter().filter(continuous) {
        let now = unit.read(&[input])?.remove(0).as_f64().unwrap_or(0.0);
        let width = 1e-4 * now.abs().max(1.0);
        let wide = slopes(unit, input, now, width, &outputs)?;
        let narrow = slopes(unit, input, now, width / 10.0, &outputs)?;
        let sizes = unit.read(&outputs)?;
        for (place, output) in outputs.iter().enumerate() {
            let depends = |list: Option<&[usize]>| list.is_none_or(|listed| bench.lists(listed, input));
            let description = bench.description();
            let listed = description.place(&output.name).is_some_and(|place| match when {
                "at initialisation" => depends(description.initial_dependencies(place)),
                _ => depends(description.step_dependencies(place)),
            });
            pairs += 1;
            if !listed || pairs > PAIRS {
                continue;
            }
            let (Some(wide), Some(narrow)) = (wide[place], narrow[place]) else { continue };
            // While it steps, a unit may compute its outputs with the step only.
            if wide == 0.0 && narrow == 0.0 && when != "at initialisation" {
                continue;
            }
            let size = sizes[place].as_f64().map_or(1.0, |size| size.abs().max(1.0));
            if (wide - narrow).abs() > SMOOTH * narrow.abs() + OF_OUTPUT * size {
                continue;
            }
            let mut told = [f64::NAN];
            let what = format!("fmi2GetDirectionalDerivative of {} by {}", output.name, input.name);
            unit.call(&what, |i| {
                i.directional_derivative(&[output.reference], &[input.reference], &[1.0], &mut told)
            })?;
            let off = (told[0] - narrow).abs();
            // Also where it is no number.
            if off.is_nan() || off > SHARE * narrow.abs() + OF_OUTPUT * size {
                let text = format!(
                    "its derivative by {} is said to be {}, by differences it is {narrow} {when}",
                    input.name, told[0]
                );
                found.say(Severity::Error, Some(&output.name), text);
            }
        }
    }
    Ok(())
}

/// Central differences of the outputs; `None` where the input can't be moved to both sides, or an output is not finite.
fn slopes(
    unit: &mut Subject<'_>,
    input: &Variable,
    now: f64,
    width: f64,
    outputs: &[&Variable],
) -> Result<Vec<Option<f64>>, Halt> {
    let (low, high) = (now - width, now + width);
    if within(input, low) != low || within(input, high) != high {
        return Ok(vec![None; outputs.len()]);
    }
    let mut at = |value: f64| {
        unit.set(input, &Value::Real(value))?;
        unit.read(outputs)
    };
    let (below, above) = (at(low)?, at(high)?);
    at(now)?;
    let slope = |(a, b): (&Value, &Value)| {
        Some((b.as_f64()? - a.as_f64()?) / (high - low)).filter(|slope| slope.is_finite())
    };
    Ok(below.iter().zip(&above).map(slope).collect())
}

pub(super) fn interpolation(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    let capabilities = &bench.description().co_simulation;
    let inputs: Vec<&Variable> = bench.real_inputs().into_iter().filter(continuous).collect();
    let references: Vec<u32> = inputs.iter().map(|input| input.reference).collect();
    let mut unit = bench.started("unit")?;
    unit.advance(0)?;
    if capabilities.can_interpolate_inputs && !inputs.is_empty() {
        let (orders, zeros) = (vec![1; inputs.len()], vec![0.0; inputs.len()]);
        let set = |i: &mut Instance| i.set_input_derivatives(&references, &orders, &zeros);
        if let Err(Halt::Call(error)) = unit.call("fmi2SetRealInputDerivatives", set) {
            found.error(format!("it declares canInterpolateInputs and refuses first derivatives: {error}"));
        }
        unit.advance(1)?;
    }
    let outputs: Vec<&Variable> = bench.outputs().into_iter().filter(continuous).collect();
    if capabilities.max_output_derivative_order > 0 && !outputs.is_empty() {
        output_rates(&mut unit, &outputs, capabilities.max_output_derivative_order, found)?;
    }
    Ok(())
}

/// First derivatives, of one output after the other: a unit may discard those that it can't give, if it gives some.
fn output_rates(
    unit: &mut Subject<'_>,
    outputs: &[&Variable],
    order: u32,
    found: &mut Found,
) -> Result<(), Halt> {
    let (mut given, mut discarded) = (0, None);
    for output in outputs {
        let mut value = [0.0];
        let get = |i: &mut Instance| i.get_output_derivatives(&[output.reference], &[1], &mut value);
        match unit.call("fmi2GetRealOutputDerivatives", get) {
            Err(Halt::Call(error)) if is_discard(&error) => discarded = Some(error),
            Err(Halt::Call(error)) => found.say(
                Severity::Error,
                Some(&output.name),
                format!("maxOutputDerivativeOrder is {order}, and its first derivative is refused: {error}"),
            ),
            other => {
                other?;
                given += 1;
                if !value[0].is_finite() {
                    let text = format!("its first derivative over time is {}", value[0]);
                    found.say(Severity::Error, Some(&output.name), text);
                }
            }
        }
    }
    if let (0, Some(error)) = (given, discarded) {
        found.error(format!(
            "it declares maxOutputDerivativeOrder {order} and gives no first derivative: {error}"
        ));
    }
    Ok(())
}

fn is_discard(error: &orchestrator::Error) -> bool {
    matches!(error, orchestrator::Error::Call { status: orchestrator::fmu::Status::Discard, .. })
}
