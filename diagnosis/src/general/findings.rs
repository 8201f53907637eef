//! Effects with their classes and intervals, what the data would show, and the story.

use super::policy::GENERAL;
use super::study::Studied;
use crate::diagnosis::{Effect, Member};
use crate::error::Error;
use crate::infer::fit::Linearise;
use crate::infer::likelihood::reduced;
use crate::observe::{Problem, Scale};
use crate::ports::measures;
use crate::provenance::{Provenance, Used};
use crate::statistics::levels::WITHIN;
use crate::statistics::linear::{inverse, submatrix};
use crate::text::brief;
use std::collections::BTreeMap;

/// What was found, in the order found; beside something unnamed, or a gap that stays, no name is sure.
pub fn effects(problem: &Problem, studied: &Studied, in_doubt: bool) -> Vec<Effect> {
    let units = units(problem);
    let policy = studied.policy;
    let parameters = &studied.built.engine.machine.parameters;
    let mut list = Vec::new();
    for (place, own) in studied.effects.iter().enumerate() {
        let alternatives = &studied.classes[place];
        let weight = |loss: f64| libm::exp(-0.5 * loss);
        let all: f64 = alternatives.iter().map(|one| weight(one.loss)).sum();
        let class: Vec<_> = alternatives.iter().filter(|one| one.loss < policy.class).collect();
        let members: Vec<Member> = class
            .iter()
            .map(|one| Member {
                name: parameters[one.parameter].name.clone(),
                probability: weight(one.loss) / all,
            })
            .collect();
        let parameter = &parameters[*own];
        let value = studied.fit.at.theta[*own];
        let (least, most) = parameter.range;
        let interval = match (parameter.scale, studied.fit.robust_deviation(*own)) {
            (Scale::Switch | Scale::Count, _) => [value, value],
            (_, sd) if sd.is_finite() => [(value - WITHIN * sd).max(least), (value + WITHIN * sd).min(most)],
            _ => [least, most],
        };
        list.push(Effect {
            name: parameter.name.clone(),
            class: members.iter().map(|member| member.name.clone()).collect(),
            value,
            ci95: interval,
            probability: worth(
                members.iter().map(|member| member.probability).sum(),
                in_doubt || may_be_off(interval, parameter.neutral),
            ),
            members,
            phrase: parameter.phrase.clone(),
            unit: units.get(&parameter.name).cloned().unwrap_or_default(),
            off: parameter.neutral,
            at_end: value != parameter.neutral && (value <= least || value >= most),
            unbounded: false,
        });
    }
    list
}

/// What a name is worth that its class gives a probability, perhaps in doubt.
fn worth(probability: f64, in_doubt: bool) -> f64 {
    probability.min(if in_doubt { GENERAL.beside } else { GENERAL.sure })
}

/// Whether an interval holds the value at which an effect is off: stretches of the log disagree so much that none may be there.
fn may_be_off([low, high]: [f64; 2], off: f64) -> bool {
    low < high && (low..=high).contains(&off)
}

/// Units of the model's variables, and of what is added at ports.
pub fn units(problem: &Problem) -> BTreeMap<String, String> {
    let model = &problem.model;
    let mut units = BTreeMap::new();
    for (place, entry) in model.scenario.units.iter().enumerate() {
        for variable in &model.description(place).variables {
            let name = format!("{}.{}", entry.name, variable.name);
            for (kind, measure) in measures() {
                units.extend(
                    measure.unit(variable.unit.as_deref()).map(|unit| (format!("{name}:{kind}"), unit)),
                );
            }
            units.extend(variable.unit.clone().map(|unit| (name, unit)));
        }
    }
    units
}

/// Where the diagnosis comes from.
pub fn provenance(problem: &Problem) -> Provenance {
    let of = |run: &crate::observe::Run| Used {
        run: run.name.clone(),
        rows: problem
            .channels
            .iter()
            .zip(&run.series)
            .map(|(c, s)| (c.column.clone(), s.time.len()))
            .collect(),
    };
    let model = &problem.model;
    Provenance {
        data: problem.path.display().to_string(),
        nominal: model
            .scenario
            .units
            .iter()
            .map(|unit| unit.fmu.value.as_str())
            .collect::<Vec<_>>()
            .join(", "),
        set: model.set.iter().map(|(id, value)| format!("{} = {value}", model.name(*id))).collect(),
        runs: problem.runs.iter().map(of).collect(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        command: format!("acroscope diagnose {}", problem.path.display()),
    }
}

/// Distance from neutral that these data would show, for each parameter that moves and was not found.
///
/// # Errors
/// A unit failed.
pub fn detectable(studied: &Studied) -> Result<BTreeMap<String, f64>, Error> {
    let engine = &studied.built.engine;
    let theta = &studied.fit.at.theta;
    let moves = |place: &usize| {
        let parameter = &engine.machine.parameters[*place];
        matches!(parameter.scale, Scale::Absolute | Scale::Relative) && !studied.effects.contains(place)
    };
    let others: Vec<usize> = (0..engine.machine.parameters.len()).filter(moves).collect();
    let columns: Vec<usize> = studied.fit.free.iter().copied().chain(others.iter().copied()).collect();
    let at = &studied.fit.at;
    let gram = match studied.last.as_ref().and_then(|last| last.gram(engine, at, &columns)) {
        Some(known) => known,
        None => {
            let runs = engine.linearise(theta, &at.paths, &columns)?;
            reduced(&runs, &at.noise, &(0..columns.len()).collect::<Vec<_>>()).gram
        }
    };
    let own = studied.fit.free.len();
    let mut told = BTreeMap::new();
    for (place, parameter) in others.iter().enumerate() {
        let mut with: Vec<usize> = (0..own).collect();
        with.push(own + place);
        let Some(covariance) = inverse(&submatrix(&gram, &with)) else { continue };
        // at what a name must gain half would be found
        let size = (studied.policy.sure.sqrt() + WITHIN) * covariance[(own, own)].sqrt();
        let (least, most) = engine.machine.parameters[*parameter].range;
        if size.is_finite() && size < most - least {
            told.insert(engine.machine.parameters[*parameter].name.clone(), size);
        }
    }
    Ok(told)
}

/// How it was found, in words.
pub fn story(studied: &Studied) -> Vec<String> {
    let engine = &studied.built.engine;
    let states = engine.machine.states.iter().map(|state| state.name.as_str()).collect::<Vec<_>>().join(", ");
    let linked = if engine.machine.whole {
        "runs are simulated whole, from the model's own start".to_owned()
    } else {
        format!("{} states are linked from row to row by the model ({states})", engine.machine.order())
    };
    let mut story = vec![format!(
        "{linked}; {} runs, {} rows, {} values; {} candidates and effects at ports",
        engine.grids.len(),
        engine.grids.iter().map(|grid| grid.time.len()).sum::<usize>(),
        engine.grids.iter().map(|grid| grid.samples.len()).sum::<usize>(),
        engine.machine.parameters.len(),
    )];
    for (output, sd) in engine.machine.channels.iter().zip(&studied.fit.at.noise.channels) {
        let how = if output.noise.is_some() { "as stated" } else { "by maximum likelihood" };
        story.push(format!("noise of {}: {} {} ({how})", output.name, brief(*sd), output.unit));
    }
    // Where it gains nothing, the search for its size may end a rounding below none.
    let gain = studied.residual.evidence.max(0.0);
    let by_inputs = gain > studied.policy.unknown && studied.residual.unlisted.is_none();
    let why = if by_inputs {
        ": as much as noise of the logged inputs gives, by what their rows scatter"
    } else {
        ""
    };
    story.push(format!("process noise gains {gain:.1} of deviance over none in the end{why}"));
    story
}

#[cfg(test)]
mod tests {
    use super::{may_be_off, worth};

    #[test]
    fn value_what_a_name_is_worth() {
        // a class that holds its effect in 99.7 of 100 sets (three deviations) says so, and none is beyond a doubt in a thousand
        assert_eq!(worth(0.9973, false), 0.9973);
        assert!((0.998..0.9995).contains(&worth(1.0, false)));
        // in doubt three of twenty were right: no name is likelier than not, nor out of the question
        assert_eq!(worth(0.25, true), 0.25);
        assert!((0.25..0.35).contains(&worth(1.0, true)));
        // so is one whose interval holds the value at which it is off; a switch that was thrown has no interval
        assert!(may_be_off([-0.1, 0.4], 0.0) && may_be_off([0.0, 0.4], 0.0));
        assert!(!may_be_off([0.1, 0.4], 0.0) && !may_be_off([1.0, 1.0], 1.0));
    }
}
