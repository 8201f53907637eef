//! Parameters that change nothing of what the logs show: settings of a solver, of a plot, of what this machine doesn't have. As candidates
//! they would cost a run of the unit each, in every round of a diagnosis, for nothing.
//!
//! Each is moved far, since a limit that is not reached acts only where it is much lower. The unit runs in a process of its own and may
//! take ten times as long as with its own values: nobody tried these before, and with some a solver never ends. A diagnosis would not end
//! with them either, so they are struck out as well.

use super::trial::{Trial, name};
use crate::options::GIVEN_UP;
use crate::statistics::levels::{FAR, HALF, ROUNDING, SMALL};
use orchestrator::fmu::Variable;
use orchestrator::{Kind, MemoryRecorder, Value};
use std::time::{Duration, Instant};

/// What a number is multiplied by; one that is 0 is set to these and to their opposites.
const MOVES: [f64; 4] = [SMALL, HALF, 2.0, FAR];
/// Real time that a run may take in any case: to start a process takes some of it.
const LEAST: Duration = Duration::from_secs(1);

/// What was found of parameters, by their places.
pub(super) struct Found {
    /// They change no measured output.
    pub idle: Vec<usize>,
    /// These were not tried: there was no time, or the unit can't be run in a process of its own.
    pub untried: usize,
}

/// Tries each of these, as long as there is time.
pub(super) fn of(trial: &Trial<'_>, parameters: &[usize]) -> Found {
    let began = Instant::now();
    let mut found = Found { idle: Vec::new(), untried: 0 };
    let Ok(Some(nominal)) = trial.run(&[], Duration::MAX) else {
        return Found { untried: parameters.len(), ..found };
    };
    let limit = began.elapsed().mul_f64(FAR) + LEAST;
    for place in parameters {
        if began.elapsed().as_secs_f64() > GIVEN_UP {
            found.untried += 1;
        } else if is_idle(trial, &nominal, *place, limit) {
            found.idle.push(*place);
        }
    }
    found
}

fn is_idle(trial: &Trial<'_>, nominal: &MemoryRecorder, place: usize, limit: Duration) -> bool {
    let variable = &trial.fmu.description().variables[place];
    for value in moves(variable) {
        match trial.run(&[(variable.name.clone(), value)], limit) {
            Ok(Some(moved)) if differ(trial, nominal, &moved) => return false,
            Ok(None) => return true,
            _ => {}
        }
    }
    true
}

/// Values far from the own one, within the variable's bounds.
fn moves(variable: &Variable) -> Vec<String> {
    let Some(own) = variable.start.as_ref() else { return Vec::new() };
    let number = own.as_f64().unwrap_or(0.0);
    let room = |value: &f64| {
        variable.max.is_none_or(|most| *value <= most) && variable.min.is_none_or(|least| *value >= least)
    };
    match (variable.kind, own) {
        (Kind::Boolean, Value::Boolean(on)) => vec![(!on).to_string()],
        (Kind::Integer, _) => [number + 1.0, number - 1.0, 2.0 * number]
            .into_iter()
            .filter(|value| *value != number && room(value))
            .map(|value| format!("{value:.0}"))
            .collect(),
        (Kind::Real, _) => {
            let zero = number == 0.0;
            let all = MOVES.into_iter().flat_map(|by| if zero { vec![by, -by] } else { vec![by * number] });
            all.filter(room).map(|value| format!("{value:e}")).collect()
        }
        _ => Vec::new(),
    }
}

/// Whether a measured output is another.
fn differ(trial: &Trial<'_>, one: &MemoryRecorder, other: &MemoryRecorder) -> bool {
    trial.matches.iter().filter(|matched| !matched.fed).any(|matched| {
        let output = name(trial.fmu, matched);
        let (Ok(one), Ok(other)) = (one.series(&output), other.series(&output)) else { return true };
        let size = one.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        let same = |(a, b): (&f64, &f64)| (a - b).abs() <= ROUNDING * size;
        // what is no number is not the same
        one.len() != other.len() || !one.iter().zip(other).all(same)
    })
}
