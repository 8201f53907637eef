//! Parameters that change nothing of what the logs show: settings of a solver, of a plot, of what this machine doesn't have. As candidates
//! they would cost a run of the unit each, in every round of a diagnosis, for nothing.
//!
//! Each is moved far, since a limit that is not reached acts only where it is much lower. The unit runs in a process of its own and may
//! take ten times as long as with its own values: nobody tried these before, and with some a solver never ends. A diagnosis would not end
//! with them either, so they are struck out as well.

use super::policy::IMPORT;
use super::trial::{Trial, name};
use crate::options::GIVEN_UP;
use crate::statistics::levels::{FAR, ROUNDING};
use orchestrator::fmu::Variable;
use orchestrator::{Kind, MemoryRecorder, Value};
use std::time::{Duration, Instant};

/// What was found of parameters, by their places.
#[derive(Default)]
pub(super) struct Found {
    /// They change no measured output.
    pub idle: Vec<usize>,
    /// These were not tried: there was no time, or the unit can't be run in a process of its own.
    pub untried: usize,
}

/// Tries each of these, as long as there is time.
pub(super) fn find_idle(trial: &Trial<'_>, parameters: &[usize]) -> Found {
    let began = Instant::now();
    let mut found = Found::default();
    let Ok(Some(nominal)) = trial.run(&[], None) else {
        return Found { untried: parameters.len(), ..found };
    };
    let limit = limit(began.elapsed());
    for place in parameters {
        if began.elapsed().as_secs_f64() > GIVEN_UP {
            found.untried += 1;
        } else if is_idle(trial, &nominal, *place, limit) {
            found.idle.push(*place);
        }
    }
    found
}

/// Real time that a run may take, where one with the unit's own values took so much.
fn limit(own: Duration) -> Duration {
    own.mul_f64(FAR) + IMPORT.idle_least
}

fn is_idle(trial: &Trial<'_>, nominal: &MemoryRecorder, place: usize, limit: Duration) -> bool {
    let variable = &trial.fmu.description().variables[place];
    let values = moves(variable);
    // what can't be moved was not seen to do nothing
    if values.is_empty() {
        return false;
    }
    for value in values {
        match trial.run(&[(variable.name.clone(), value)], Some(limit)) {
            Ok(Some(moved)) if differ(trial, nominal, &moved) => return false,
            Ok(None) => return true,
            _ => {}
        }
    }
    true
}

/// Values far from the own one; where a bound is nearer, the bound.
fn moves(variable: &Variable) -> Vec<String> {
    let Some(own) = variable.start.as_ref() else { return Vec::new() };
    let number = own.as_f64().unwrap_or(0.0);
    let within = |value: f64| {
        value.min(variable.max.unwrap_or(f64::INFINITY)).max(variable.min.unwrap_or(f64::NEG_INFINITY))
    };
    match (variable.kind, own) {
        (Kind::Boolean, Value::Boolean(on)) => vec![(!on).to_string()],
        (Kind::Integer, _) => [number + 1.0, number - 1.0, 2.0 * number]
            .into_iter()
            .map(within)
            .filter(|value| *value != number)
            .map(|value| format!("{value:.0}"))
            .collect(),
        (Kind::Real, _) => {
            let zero = number == 0.0;
            let all = IMPORT
                .idle_moves
                .into_iter()
                .flat_map(|by| if zero { vec![by, -by] } else { vec![by * number] });
            let mut values: Vec<f64> = all.map(within).filter(|value| *value != number).collect();
            values.dedup();
            values.iter().map(|value| format!("{value:e}")).collect()
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

#[cfg(test)]
mod tests {
    use super::*;
    use orchestrator::fmu::Description;

    fn moves_of(attributes: &str) -> Vec<f64> {
        let text = format!(
            r#"<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g"><CoSimulation modelIdentifier="m"/><ModelVariables>
            <ScalarVariable name="T" valueReference="0" causality="parameter" variability="fixed" initial="exact"><Real {attributes}/></ScalarVariable>
            </ModelVariables><ModelStructure/></fmiModelDescription>"#
        );
        let description = Description::parse(&text).expect("a description");
        moves(&description.variables[0]).iter().map(|value| value.parse().expect("a number")).collect()
    }

    #[test]
    fn value_where_a_bound_is_near_the_bound_is_tried() {
        assert_eq!(moves_of(r#"start="300" min="270" max="320""#), [270.0, 320.0]);
        assert_eq!(moves_of(r#"start="0" min="0""#), [0.1, 0.5, 2.0, 10.0]);
        assert_eq!(moves_of(r#"start="4""#), [0.4, 2.0, 8.0, 40.0]);
    }

    #[test]
    fn value_how_long_a_run_may_take() {
        // a process of its own starts within a few tenths of a second on a busy machine, however little the unit does
        let least = limit(Duration::ZERO);
        assert!(least > Duration::from_millis(700) && least < Duration::from_millis(1500), "{least:?}");
        let slow = limit(Duration::from_secs(3));
        assert!(slow > Duration::from_secs(25) && slow < Duration::from_secs(35), "{slow:?}");
    }
}
