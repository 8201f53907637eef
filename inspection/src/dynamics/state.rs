//! Saved states bring back what was, to the last bit (FMI 2.0.4 section 2.1.8).

use super::bench::{Bench, Halt, STEPS, difference, same};
use crate::Severity;
use crate::finding::Found;
use orchestrator::fmu::{Causality, Variable};

pub(super) fn restore(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    if !bench.description().co_simulation.can_get_and_set_state {
        return Ok(());
    }
    let (outputs, all) = (bench.outputs(), readable(bench));
    let half = STEPS / 2;
    let mut unit = bench.started("unit")?;
    unit.trace(0..half)?;
    let before = unit.read(&all)?;
    let saved = unit.save()?;
    let first = unit.trace(half..STEPS)?;
    for what in ["after fmi2SetFMUstate", "after a second fmi2SetFMUstate of one state"] {
        unit.restore(&saved)?;
        let back = unit.read(&all)?;
        if let Some(((variable, a), b)) = all.iter().zip(&before).zip(&back).find(|((_, a), b)| !same(a, b)) {
            found.say(
                Severity::Error,
                Some(&variable.name),
                format!("{what} it is {b}, not {a} as it was saved"),
            );
            break;
        }
        let again = unit.trace(half..STEPS)?;
        if let Some((step, output, a, b)) = difference(&outputs, &first, &again) {
            let step = half + step as u64 + 1;
            found.say(
                Severity::Error,
                Some(&output.name),
                format!("{what} in step {step} it is {b}, not {a} as before"),
            );
            break;
        }
    }
    if !unit.forget(saved)? {
        found.warning(
            "fmi2FreeFMUstate leaves the pointer to the state as it was and not null: a master that frees it again frees memory that is gone",
        );
    }
    Ok(())
}

/// Inputs and outputs.
fn readable(bench: &Bench) -> Vec<&Variable> {
    [bench.variables(Causality::Input), bench.outputs()].concat()
}

pub(super) fn serialize(bench: &Bench, found: &mut Found) -> Result<(), Halt> {
    if !bench.description().co_simulation.can_serialize_state {
        return Ok(());
    }
    let half = STEPS / 2;
    let mut unit = bench.started("unit")?;
    unit.trace(0..half)?;
    let saved = unit.save()?;
    let bytes = unit.call("fmi2SerializeFMUstate", |instance| instance.serialize_state(&saved))?;
    let again = unit.call("fmi2SerializeFMUstate, again,", |instance| instance.serialize_state(&saved))?;
    if bytes != again {
        found.warning("one state, serialized twice, gives different bytes: memory that was not set is in it");
    }
    let first = unit.trace(half..STEPS)?;
    unit.forget(saved)?;
    drop(unit);
    let mut other = bench.started("another")?;
    let state = other.call("fmi2DeSerializeFMUstate", |instance| instance.deserialize_state(&bytes))?;
    other.restore(&state)?;
    let rows = other.trace(half..STEPS)?;
    other.forget(state)?;
    if let Some((step, output, a, b)) = difference(&bench.outputs(), &first, &rows) {
        let step = half + step as u64 + 1;
        let text = format!(
            "another instance that was given the serialized state goes on otherwise: in step {step} it is {b}, not {a}"
        );
        found.say(Severity::Error, Some(&output.name), text);
    }
    Ok(())
}
