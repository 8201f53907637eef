//! The nominal scenario with what was found switched on, and the residual unit where a rest has no name.

use crate::candidates::Candidate;
use crate::correction::{Correction, wiring};
use crate::diagnosis::Effect;
use crate::error::Error;
use crate::model::Model;
use orchestrator::{Scenario, Simulation, UnitPath};

/// The amended scenario, as text that `acroscope run` accepts.
///
/// # Errors
/// The scenario can't be built with these values.
pub fn amended(
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
    for effect in effects.iter().filter(|effect| effect.name == "camera.drop_rate") {
        scenario.set(&effect.name, &format!("{:?}", effect.value)).map_err(failed)?;
    }
    if let Some(correction) = correction {
        wiring::insert(&mut scenario, correction);
    }
    Ok(Simulation::new(&scenario, units).map_err(failed)?.resolved())
}

/// A value as `scenario.set` reads it.
pub fn written(candidate: &Candidate, value: f64) -> String {
    use crate::candidates::Motion;
    match candidate.motion {
        Motion::Switch => (value > 0.5).to_string(),
        Motion::Count { .. } => format!("{value:.0}"),
        _ => format!("{value:?}"),
    }
}
