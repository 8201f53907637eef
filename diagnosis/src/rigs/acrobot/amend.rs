//! The nominal scenario with what was found switched on, and the residual unit where a residual has no name.

use crate::diagnosis::Effect;
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Attribute, Candidate, name};
use crate::rigs::acrobot::correction::{Correction, wiring};
use crate::rigs::acrobot::dataset::DataSet;
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::{parameters, replay};
use orchestrator::{Scenario, Simulation, UnitPath};

/// The amended scenario, as text that `acroscope run` accepts.
///
/// # Errors
/// The scenario can't be built with these values.
pub fn amended(
    data: &DataSet,
    model: &Model,
    list: &[Candidate],
    point: &[f64],
    effects: &[Effect],
    correction: Option<&Correction>,
    units: &UnitPath,
) -> Result<String, Error> {
    let mut scenario: Scenario = model.scenario.clone();
    let failed = |error: orchestrator::Error| Error::Model(format!("amended scenario: {error}"));
    for (index, candidate) in list.iter().enumerate() {
        if point[index] != candidate.off && !candidate.side.is_of_log() {
            scenario
                .set(candidate.name, &written(candidate, candidate.value(point[index])))
                .map_err(failed)?;
        }
    }
    for effect in effects.iter().filter(|effect| effect.name == name(Attribute::LostFrames)) {
        scenario.set(&effect.name, &format!("{:?}", effect.value)).map_err(failed)?;
    }
    if let Some(correction) = correction {
        wiring::insert(&mut scenario, correction);
    }
    // It is another model now, and must not go under the nominal one's title.
    let nominal = scenario.origin.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut named: Vec<&str> = effects.iter().map(|effect| effect.name.as_str()).collect();
    named.extend(correction.map(|_| "a correction"));
    if !named.is_empty() {
        scenario.description = format!("{nominal}, amended by a diagnosis: {}", named.join(", "));
    }
    let plain = scenario.clone();
    let text = |scenario: &Scenario| Ok(Simulation::new(scenario, units).map_err(failed)?.resolved());
    let replayed = replay::insert(&mut scenario, data, model.number(parameters::LIMIT)).and_then(|words| {
        let text = text(&scenario).ok()?;
        Some(format!("# The amended model, fed with {words}.\n{text}"))
    });
    // what can't be replayed, in a scenario with other units, keeps the scenario's own inputs
    replayed.map_or_else(|| text(&plain), Ok)
}

/// A value as `scenario.set` reads it.
pub fn written(candidate: &Candidate, value: f64) -> String {
    use crate::rigs::acrobot::candidates::Motion;
    match candidate.motion {
        Motion::Switch => (value > 0.5).to_string(),
        Motion::Count { .. } => format!("{value:.0}"),
        _ => format!("{value:?}"),
    }
}
