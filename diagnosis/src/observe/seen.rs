//! Whether a start value is seen where a run begins, in the unit itself.

use super::raw::File;
use super::{Nominal, VariableId};
use crate::statistics::levels::{ROUNDING, STEP};
use orchestrator::fmu::{Begin, Causality, Variable};
use orchestrator::{Kind, Value};
use std::path::Path;

/// Whether any output or local variable of its unit is another where a run begins with another value of a start; nothing where the unit can't be
/// asked.
pub(crate) fn is_seen(model: &Nominal, start: VariableId) -> Option<bool> {
    let value = model.number(start)?;
    let by = STEP * if value == 0.0 { 1.0 } else { value.abs() };
    let variable = model.variable(start);
    let room = |value: &f64| {
        variable.max.is_none_or(|most| *value <= most) && variable.min.is_none_or(|least| *value >= least)
    };
    let moved = [value + by, value - by].into_iter().find(room)?;
    let own = begun(model, start, value).ok()?;
    let there = begun(model, start, moved).ok()?;
    let is_other = |(one, other): (&f64, &f64)| (one - other).abs() > ROUNDING * one.abs().min(by);
    Some(own.iter().zip(&there).any(is_other))
}

/// What outputs and local variables are after initialisation with a value of a start.
fn begun(model: &Nominal, start: VariableId, value: f64) -> Result<Vec<f64>, orchestrator::Error> {
    let instance = start.instance;
    let is_own = |(id, _): &&(VariableId, Value)| id.instance == instance && *id != start;
    let others =
        model.set.iter().filter(is_own).map(|(id, value)| (model.variable(*id).reference, value.clone()));
    let own = (model.variable(start).reference, Value::Real(value));
    let settings: Vec<(u32, Value)> = others.chain([own]).collect();
    let mut unit = model.fmus[instance].instantiate(&model.scenario.units[instance].name)?;
    unit.begin(0.0, None, Begin { settings: &settings, ..Begin::default() })?;
    unit.exit_initialization()?;
    let shows = |variable: &&Variable| {
        variable.kind == Kind::Real && matches!(variable.causality, Causality::Output | Causality::Local)
    };
    let references: Vec<u32> = model
        .description(instance)
        .variables
        .iter()
        .filter(shows)
        .map(|variable| variable.reference)
        .collect();
    let mut values = vec![f64::NAN; references.len()];
    unit.get_real(&references, &mut values)?;
    Ok(values)
}

/// The line of `dataset.toml` on which a `[[state]]` names its start, if one does.
pub(crate) fn line_of_state(folder: &Path, start: &str) -> Option<usize> {
    let file = File::read(&folder.join("dataset.toml")).ok()?;
    let mut given = file.raw.state.iter().map(|state| &state.get_ref().start);
    let found = given.find(|given| given.get_ref() == start)?;
    Some(file.line(&found.span()))
}
