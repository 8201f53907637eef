//! For how long and how finely a drafted scenario runs: what the units propose, and a word where they do not or disagree.

use super::Unit;
use orchestrator::time::Rational;

/// A number of the scenario and the comment beside it.
pub(super) struct Guess {
    pub(super) value: f64,
    /// What is written.
    pub(super) text: String,
    pub(super) comment: String,
}

impl Guess {
    fn new(value: f64, comment: String) -> Self {
        Self { value, text: time(value), comment }
    }
}

/// What a run lasts, and the interval of a unit has of it, where nobody says.
const LASTS: f64 = 10.0;
const PARTS: f64 = 1000.0;

/// A time as a scenario writes it: a decimal, or the fraction that it came from.
fn time(value: f64) -> String {
    let decimal = format!("{value:?}");
    match Rational::recover(&decimal) {
        Some((fraction, true)) => format!("{:?}", fraction.to_string()),
        _ => decimal,
    }
}

/// Whether a run can begin or end there: some units propose what lay in memory, such as 6.4e-314 s.
fn is_a_time(value: f64) -> bool {
    value.is_finite() && Rational::recover(&format!("{value:?}")).is_some()
}

/// The times that units propose, with their names.
fn proposed(
    units: &[Unit],
    of: impl Fn(&orchestrator::fmu::DefaultExperiment) -> Option<f64>,
) -> Vec<(&str, f64)> {
    let all = units.iter().filter_map(|unit| {
        let value = of(&unit.fmu.description().default_experiment)?;
        is_a_time(value).then_some((unit.name.as_str(), value))
    });
    all.collect()
}

/// Where a number comes from: one unit, all of them, or one of several.
fn words(all: &[(&str, f64)], chosen: f64, which: &str) -> String {
    if all.iter().all(|(_, value)| *value == chosen) {
        return "from DefaultExperiment".to_owned();
    }
    let each: Vec<String> = all.iter().map(|(name, value)| format!("{name} {value} s")).collect();
    format!("guess: the {which} of what the units propose ({})", each.join(", "))
}

/// Start and stop.
pub(super) fn span(units: &[Unit]) -> (Guess, Guess) {
    let starts = proposed(units, |experiment| experiment.start);
    let latest = starts.iter().map(|(_, start)| *start).fold(f64::NEG_INFINITY, f64::max);
    let start = match starts.is_empty() {
        true => Guess::new(0.0, "guess: no unit proposes one".into()),
        false => Guess::new(latest, words(&starts, latest, "latest")),
    };
    let stops = proposed(units, |experiment| experiment.stop);
    let shortest =
        stops.iter().map(|(_, stop)| *stop).filter(|stop| *stop > start.value).fold(f64::INFINITY, f64::min);
    let stop = match shortest.is_finite() {
        true => Guess::new(shortest, words(&stops, shortest, "shortest")),
        false => Guess::new(start.value + LASTS, "guess: no unit proposes one after the start".into()),
    };
    (start, stop)
}

/// The communication interval of a unit.
pub(super) fn interval(unit: &Unit, lasts: f64) -> Guess {
    let experiment = unit.fmu.description().default_experiment;
    let fixed = match unit.fmu.description().co_simulation.can_handle_variable_step {
        true => "",
        false => "; its steps must not differ",
    };
    match experiment.step_size.filter(|step| is_a_time(*step) && *step > 0.0) {
        Some(step) if step <= lasts => Guess::new(step, format!("s, from its DefaultExperiment{fixed}")),
        Some(step) => Guess::new(lasts, format!("s, guess: its own {step} s is longer than the run{fixed}")),
        None => {
            // A round number near a thousandth.
            let power = (lasts / PARTS).log10().floor() as i32;
            let step = format!("1e{power}").parse().unwrap_or(lasts / PARTS);
            Guess::new(step, format!("s, guess: its description proposes none{fixed}"))
        }
    }
}
