//! Inputs that a lab can apply, within the range that the unit declares, or that the logs have seen where it declares none.

use super::policy::EXPERIMENTS;
use crate::dynamics::Engine;
use crate::observe::Problem;

/// How an input runs.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    /// Levels up and down, each held for a twelfth of the run, as a share of the range.
    Steps(f64),
    /// Periods in the run.
    Sine(Period),
    /// From a period a run to one of six rows.
    Chirp,
    /// From the middle to the top, and there it stays.
    Hold,
}

/// Of a sine.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Period {
    Run,
    Rows(f64),
}

/// All shapes, the simplest first: of two that tell the same the first is taken.
const SHAPES: [Shape; 6] = [
    Shape::Hold,
    Shape::Steps(1.0),
    Shape::Steps(0.2),
    Shape::Sine(Period::Run),
    Shape::Sine(Period::Rows(12.0)),
    Shape::Chirp,
];
/// Levels of the steps, as shares of the amplitude: both signs, large and small, neighbours far and near.
const LEVELS: [f64; 12] = [0.0, 1.0, -0.4, 0.6, -1.0, 0.2, 0.9, -0.7, -0.2, 0.4, -0.9, 0.7];

/// One experiment: what each input does.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Wave {
    /// In words.
    pub what: String,
    /// When its rows are.
    pub time: Vec<f64>,
    /// Values at the rows, one list an input.
    pub values: Vec<Vec<f64>>,
}

/// Middle and half of the range of each input.
fn ranges(problem: &Problem, engine: &Engine) -> Vec<(f64, f64)> {
    let of = |(place, input): (usize, &crate::dynamics::machine::Input)| {
        // what nobody logs nobody is asked to move
        let Some(channel) = input.channel else {
            return (input.given.values.first().copied().unwrap_or(0.0), 0.0);
        };
        let described = problem.model.variable(problem.channels[channel].variable);
        let seen = engine.grids.iter().flat_map(|grid| grid.inputs[place].values.iter().copied());
        let (low, high) = seen.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let (low, high) = match (described.min, described.max) {
            (Some(min), Some(max)) if min.is_finite() && max.is_finite() => (min, max),
            (Some(min), _) if min.is_finite() => (min, high.max(min)),
            (_, Some(max)) if max.is_finite() => (low.min(max), max),
            _ => (low, high),
        };
        (0.5 * (low + high), 0.5 * EXPERIMENTS.used * (high - low))
    };
    engine.machine.inputs.iter().enumerate().map(of).collect()
}

/// All experiments for rows at these times.
pub(super) fn waves(problem: &Problem, engine: &Engine, time: &[f64]) -> Vec<Wave> {
    let ranges = ranges(problem, engine);
    let still = |place: usize| vec![ranges[place].0; time.len()];
    let mut list = Vec::new();
    for (place, input) in engine.machine.inputs.iter().enumerate().filter(|(place, _)| ranges[*place].1 > 0.0)
    {
        for shape in SHAPES {
            let (middle, half) = ranges[place];
            let mut values: Vec<Vec<f64>> = (0..ranges.len()).map(still).collect();
            values[place] = course(shape, time).iter().map(|share| middle + half * share).collect();
            list.push(Wave {
                what: describe_wave(shape, &input.name, &input.unit, middle, half, time),
                time: time.to_vec(),
                values,
            });
        }
    }
    list
}

/// Shares of the amplitude at the rows.
fn course(shape: Shape, time: &[f64]) -> Vec<f64> {
    let begin = time[0];
    let span = time[time.len() - 1] - begin;
    let row = span / (time.len() - 1) as f64;
    let turn = std::f64::consts::TAU;
    let at = |since: f64| match shape {
        Shape::Steps(share) => {
            let place = (LEVELS.len() as f64 * since / span) as usize;
            share * LEVELS[place.min(LEVELS.len() - 1)]
        }
        Shape::Sine(Period::Run) => libm::sin(turn * since / (0.5 * span)),
        Shape::Sine(Period::Rows(rows)) => libm::sin(turn * since / (rows * row)),
        Shape::Chirp => {
            let (first, last) = (1.0 / span, 1.0 / (6.0 * row));
            let grows = libm::log(last / first);
            libm::sin(turn * first * span / grows * (libm::exp(grows * since / span) - 1.0))
        }
        Shape::Hold => f64::from(since >= 0.1 * span),
    };
    time.iter().map(|t| at(t - begin)).collect()
}

fn describe_wave(shape: Shape, name: &str, unit: &str, middle: f64, half: f64, time: &[f64]) -> String {
    let span = time[time.len() - 1] - time[0];
    let row = span / (time.len() - 1) as f64;
    // FMI's unit of a number is 1
    let unit = if ["", "1"].contains(&unit) { String::new() } else { format!(" {unit}") };
    let range = |share: f64| {
        format!("between {} and {}{unit}", brief(middle - share * half), brief(middle + share * half))
    };
    let over = format!("for {} s, a row each {} s", brief(span), brief(row));
    match shape {
        Shape::Steps(share) => {
            format!("drive {name} in steps {}, each held for {} s, {over}", range(share), brief(span / 12.0))
        }
        Shape::Sine(Period::Run) => {
            format!("drive {name} as a sine {} with a period of {} s, {over}", range(1.0), brief(0.5 * span))
        }
        Shape::Sine(Period::Rows(rows)) => {
            format!("drive {name} as a sine {} with a period of {} s, {over}", range(1.0), brief(rows * row))
        }
        Shape::Chirp => format!(
            "drive {name} as a chirp {} from {} to {} Hz, {over}",
            range(1.0),
            brief(1.0 / span),
            brief(1.0 / (6.0 * row))
        ),
        Shape::Hold => format!("step {name} to {}{unit} once and hold it, {over}", brief(middle + half)),
    }
}

/// Three digits.
pub(super) fn brief(value: f64) -> String {
    let text: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    format!("{text}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_a_wave_is_told_with_its_unit_and_a_number_without() {
        let time = [0.0, 1.0, 2.0];
        let of = |shape, unit| describe_wave(shape, "copter.thr", unit, 0.5, 0.25, &time);
        assert!(of(Shape::Hold, "1").starts_with("step copter.thr to 0.75 once"));
        assert!(of(Shape::Hold, "V").starts_with("step copter.thr to 0.75 V once"));
        assert!(of(Shape::Chirp, "").contains("between 0.25 and 0.75 from"));
    }

    #[test]
    fn law_courses_stay_within_the_amplitude_and_use_it() {
        let time: Vec<f64> = (0..300).map(|row| 0.02 * f64::from(row)).collect();
        for shape in SHAPES {
            let most = course(shape, &time).iter().fold(0.0, |most: f64, v| most.max(v.abs()));
            let wanted = if let Shape::Steps(share) = shape { share } else { 1.0 };
            // a sine of twelve rows meets its top to cos(π/12)
            assert!(most <= wanted && most > 0.96 * wanted, "{shape:?}: {most}");
        }
    }
}
