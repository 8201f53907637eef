//! Start values that a unit has against its description. A diagnosis sets every candidate, be it to its nominal value: from the
//! description alone it would diagnose another model than the one that runs when nobody sets anything.

use super::{Nominal, VariableId};
use crate::error::Notice;
use crate::statistics::levels::ROUNDING;
use orchestrator::fmu::{Begin, Causality, Initial, Variability, Variable};
use orchestrator::{Fmu, Kind, Value};

/// Takes the values that the units themselves have, where they differ and nobody set them.
pub(super) fn take(model: &mut Nominal, notices: &mut Vec<Notice>) {
    for instance in 0..model.fmus.len() {
        let set: Vec<(u32, Value)> = (model.set.iter())
            .filter(|(id, _)| id.instance == instance)
            .map(|(id, value)| (model.variable(*id).reference, value.clone()))
            .collect();
        // a unit that can't be asked tells why when it is to be run
        let name = &model.scenario.units[instance].name;
        let Ok(others) = others(&model.fmus[instance], name, &set) else { continue };
        for (place, value) in others {
            let id = VariableId { instance, place };
            if model.set.iter().any(|(known, _)| *known == id) {
                continue;
            }
            let described = model.number(id).unwrap_or(f64::NAN);
            let message = format!(
                "{} starts at {described} by the description and at {value} in the unit: the unit's own value is taken",
                model.name(id)
            );
            notices.push(Notice { file: "dataset.toml".into(), line: 0, message });
            model.set.push((id, Value::Real(value)));
        }
    }
}

/// Real parameters whose value after initialisation is another than the description says.
fn others(fmu: &Fmu, name: &str, set: &[(u32, Value)]) -> Result<Vec<(usize, f64)>, orchestrator::Error> {
    let description = fmu.description();
    let places: Vec<usize> =
        (0..description.variables.len()).filter(|place| is_a_start(&description.variables[*place])).collect();
    let references: Vec<u32> = places.iter().map(|place| description.variables[*place].reference).collect();
    if references.is_empty() {
        return Ok(Vec::new());
    }
    let mut instance = fmu.instantiate(name)?;
    instance.begin(0.0, None, Begin { settings: set, ..Begin::default() })?;
    instance.exit_initialization()?;
    let mut values = vec![f64::NAN; references.len()];
    instance.get_real(&references, &mut values)?;
    let differs = |(place, value): &(usize, f64)| {
        let start = description.variables[*place].start.as_ref().and_then(Value::as_f64);
        start.is_some_and(|start| (value - start).abs() > ROUNDING * start.abs().max(value.abs()))
    };
    Ok(places.into_iter().zip(values).filter(differs).collect())
}

fn is_a_start(variable: &Variable) -> bool {
    variable.causality == Causality::Parameter
        && variable.kind == Kind::Real
        && matches!(variable.variability, Variability::Fixed | Variability::Tunable)
        && matches!(variable.initial, None | Some(Initial::Exact))
}
