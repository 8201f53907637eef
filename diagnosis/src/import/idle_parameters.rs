//! Parameters that change nothing of what the logs show: settings of a solver, of a plot, of what this machine doesn't have. As candidates
//! they would cost a run of the unit each, in every round of a diagnosis, for nothing.
//!
//! Each is moved far, since a limit that is not reached acts only where it is much lower; then step by step to the ends of its range, since
//! what is off may be a large number (an inhibition that begins at 1e9); then beside each that is off, switched on: where a stop is does
//! nothing as long as its stiffness is 0.
//!
//! The unit runs in a process of its own and may take ten times as long as with its own values: nobody tried these before, and with some a
//! solver never ends. A diagnosis would not end with them either, so they are struck out as well.

use super::policy::IMPORT;
use super::trial::{Trial, name};
use crate::options::GIVEN_UP;
use crate::statistics::levels::{FAR, ROUNDING, SAMPLE};
use orchestrator::fmu::Variable;
use orchestrator::{Kind, MemoryRecorder, Value};
use std::time::{Duration, Instant};

/// What was found of parameters, by their places.
#[derive(Default)]
pub(super) struct Found {
    /// They change no measured output, or the unit can't be run with them.
    pub idle: Vec<usize>,
    /// Those of them with values of which the unit didn't run to the end, and why.
    pub failing: Vec<(usize, String)>,
    /// These were not tried: there was no time, or the unit can't be run in a process of its own.
    pub untried: usize,
    /// So many of those that change nothing were not tried to the ends of their ranges and beside all that is off, for want of time.
    pub unfinished: usize,
}

/// What values of a parameter did.
enum Did {
    /// An output is another with this one.
    Something(String),
    /// With the values with which the unit runs; why it doesn't with another.
    Nothing(Option<String>),
    /// The unit took too long.
    Hung,
}

/// Why a unit that took too long was not run on.
const HUNG: &str = "it takes too long";

/// Runs of the unit with other values.
struct Probe<'a> {
    trial: &'a Trial<'a>,
    began: Instant,
    /// Real time of a run.
    limit: Duration,
}

/// Tries each of these parameters, as long as there is time. Where a state that no variable shows starts is nothing that the log tells: what
/// acts with another of these `starts` isn't idle.
pub(super) fn find_idle(trial: &Trial<'_>, parameters: &[usize], starts: &[usize]) -> Found {
    let began = Instant::now();
    let Ok(Some(nominal)) = trial.run(&[], None) else {
        return Found { untried: parameters.len(), ..Found::default() };
    };
    let probe = Probe { trial, began, limit: limit(began.elapsed()) };
    let (mut found, mut silent) = (Found::default(), Vec::new());
    // what is off, and values with which it is on
    let mut off: Vec<(usize, Vec<String>)> = Vec::new();
    for place in parameters {
        let variable = probe.variable(*place);
        // what can't be moved was not seen to do nothing
        let values = moves(variable);
        if probe.is_over() {
            found.untried += 1;
        } else if !values.is_empty() {
            match probe.tried(&nominal, &[], *place, &values) {
                Did::Something(_) if !is_off(variable) => {}
                Did::Something(first) => off.push((*place, on(values, &first))),
                Did::Nothing(failed) => {
                    silent.push(*place);
                    found.failing.extend(failed.map(|why| (*place, why)));
                }
                Did::Hung => found.hangs(*place),
            }
        }
    }
    silent.retain(|place| match probe.tried(&nominal, &[], *place, &ladder(probe.variable(*place))) {
        Did::Something(first) => {
            off.push((*place, vec![first]));
            false
        }
        Did::Nothing(failed) => {
            found.failing.extend(failed.map(|why| (*place, why)));
            true
        }
        Did::Hung => {
            found.hangs(*place);
            false
        }
    });
    let quiet = silent.iter().filter(|place| is_off(probe.variable(**place)));
    off.extend(
        quiet
            .chain(starts)
            .copied()
            .map(|place| (place, on(moves(probe.variable(place)), "")))
            .collect::<Vec<_>>(),
    );
    probe.beside(&off, &mut silent);
    found.unfinished = if probe.is_over() { silent.len() } else { 0 };
    found.idle.extend(silent);
    let idle = &found.idle;
    found.failing.retain(|(place, _)| idle.contains(place));
    // the first reason that a value gave
    found.failing.sort_by_key(|(place, _)| *place);
    found.failing.dedup_by_key(|(place, _)| *place);
    found
}

impl Found {
    fn hangs(&mut self, place: usize) {
        self.idle.push(place);
        self.failing.push((place, HUNG.into()));
    }
}

impl<'a> Probe<'a> {
    fn variable(&self, place: usize) -> &'a Variable {
        &self.trial.fmu.description().variables[place]
    }

    fn is_over(&self) -> bool {
        self.began.elapsed().as_secs_f64() > GIVEN_UP
    }

    /// What a parameter does at values of it, beside others that are set, against a run with these.
    fn tried(&self, own: &MemoryRecorder, set: &[(String, String)], place: usize, values: &[String]) -> Did {
        let mut failed = None;
        for value in values.iter().take_while(|_| !self.is_over()) {
            let mut set = set.to_vec();
            set.push((self.variable(place).name.clone(), value.clone()));
            match self.trial.run(&set, Some(self.limit)) {
                Ok(Some(moved)) if differ(self.trial, own, &moved) => return Did::Something(value.clone()),
                Ok(None) => return Did::Hung,
                Err(why) => failed = failed.or_else(|| Some(why.in_short().to_owned())),
                Ok(_) => {}
            }
        }
        Did::Nothing(failed)
    }

    /// Takes from those that are silent what acts beside something that is off, once that is on.
    fn beside(&self, off: &[(usize, Vec<String>)], silent: &mut Vec<usize>) {
        for (place, values) in off {
            for value in values {
                if silent.is_empty() || self.is_over() {
                    return;
                }
                let set = [(self.variable(*place).name.clone(), value.clone())];
                let Ok(Some(own)) = self.trial.run(&set, Some(self.limit)) else { continue };
                let acts = |one: &usize| {
                    let values = moves(self.variable(*one));
                    one != place && matches!(self.tried(&own, &set, *one, &values), Did::Something(_))
                };
                let acting: Vec<usize> = silent.iter().copied().filter(acts).collect();
                // one of the two moved alone did nothing: each acts beside the other
                let is_silent = |one: &usize| !acting.contains(one) && (acting.is_empty() || one != place);
                silent.retain(is_silent);
            }
        }
    }
}

/// Real time that a run may take, where one with the unit's own values took so much.
fn limit(own: Duration) -> Duration {
    own.mul_f64(FAR) + IMPORT.idle_least
}

/// Whether a parameter's own value may stand for an effect that is off: 0, or no.
fn is_off(variable: &Variable) -> bool {
    variable.start.as_ref().and_then(Value::as_f64) == Some(0.0)
}

/// Values with which something is on: the first that acts, which leaves most as it is, and the farthest, with which the most acts.
fn on(values: Vec<String>, first: &str) -> Vec<String> {
    let from = values.iter().position(|value| value == first).unwrap_or(0);
    let mut ends: Vec<String> = [values.get(from), values.last()].into_iter().flatten().cloned().collect();
    ends.dedup();
    ends
}

/// Values from the own one to the ends of a number's range, by powers of ten, or fewer of a wide one. Where an end is 0, of the other sign or
/// not told: as far as leaves the one of both as rounding beside the other.
fn ladder(variable: &Variable) -> Vec<String> {
    let own = variable.start.as_ref().and_then(Value::as_f64).unwrap_or(0.0);
    if variable.kind != Kind::Real {
        return Vec::new();
    }
    let ends = [variable.min, variable.max];
    let rungs = |from: f64, by: f64| {
        let end = ends.iter().flatten().copied().find(|end| {
            let ratio = end / from;
            ratio > 0.0 && ratio.is_finite() && ratio.ln() * by.ln() > 0.0
        });
        let end = end.unwrap_or(from * ROUNDING.powf(-by.ln().signum()));
        let count = ((end / from).ln() / by.ln() - ROUNDING).ceil().min(SAMPLE as f64);
        let between = (1..count as usize).map(|rung| from * (end / from).powf(rung as f64 / count));
        between.chain([end]).collect::<Vec<f64>>()
    };
    let within = |value: &f64| {
        variable.max.is_none_or(|most| *value <= most) && variable.min.is_none_or(|least| *value >= least)
    };
    let all = match own {
        0.0 => [rungs(FAR, FAR), rungs(-FAR, FAR)],
        own => [rungs(own, FAR.recip()), rungs(own, FAR)],
    };
    all.concat().iter().filter(|value| within(value)).map(|value| format!("{value:e}")).collect()
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

    fn with_parameter<T>(attributes: &str, tell: impl Fn(&Variable) -> T) -> T {
        let text = format!(
            r#"<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g"><CoSimulation modelIdentifier="m"/><ModelVariables>
            <ScalarVariable name="T" valueReference="0" causality="parameter" variability="fixed" initial="exact"><Real {attributes}/></ScalarVariable>
            </ModelVariables><ModelStructure/></fmiModelDescription>"#
        );
        let description = Description::parse(&text).expect("a description");
        tell(&description.variables[0])
    }

    fn moves_of(attributes: &str) -> Vec<f64> {
        with_parameter(attributes, moves).iter().map(|value| value.parse().expect("a number")).collect()
    }

    #[test]
    fn value_where_a_bound_is_near_the_bound_is_tried() {
        assert_eq!(moves_of(r#"start="300" min="270" max="320""#), [270.0, 320.0]);
        assert_eq!(moves_of(r#"start="0" min="0""#), [0.1, 0.5, 2.0, 10.0]);
        assert_eq!(moves_of(r#"start="4""#), [0.4, 2.0, 8.0, 40.0]);
    }

    #[test]
    fn value_a_ladder_goes_to_the_ends_of_the_range() {
        let ladder = |attributes: &str| {
            let all = with_parameter(attributes, ladder);
            all.iter()
                .map(|value| format!("{:.0e}", value.parse::<f64>().expect("a number")))
                .collect::<Vec<_>>()
        };
        assert_eq!(ladder(r#"start="1e9" min="1e5" max="1e9""#), ["1e8", "1e7", "1e6", "1e5"]);
        // to 0, and without an end, as far as rounding
        assert_eq!(
            ladder(r#"start="1" min="0" max="100""#).join(" "),
            "1e-1 1e-2 1e-3 1e-4 1e-5 1e-6 1e1 1e2"
        );
        assert_eq!(ladder(r#"start="0" min="0" max="1000""#), ["1e2", "1e3"]);
        assert_eq!(ladder(r#"start="0" min="-50" max="1""#), ["-5e1"]);
        // a range that is too wide is gone through in as many steps as a sample has
        assert_eq!(ladder(r#"start="1" min="1" max="1e300""#).len(), SAMPLE);
    }

    #[test]
    fn value_what_is_off_is_switched_on_a_little_and_far() {
        let values = || ["0.1", "0.5", "2", "10"].map(String::from).to_vec();
        assert_eq!(on(values(), "0.5"), ["0.5", "10"]);
        assert_eq!(on(values(), ""), ["0.1", "10"]);
        assert_eq!(on(vec!["true".into()], "true"), ["true"]);
        assert!(with_parameter(r#"start="0""#, is_off) && !with_parameter(r#"start="0.1""#, is_off));
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
