//! Units of time that logs can be read in, beside the one that is said.

use super::policy::DOUBTS;
use super::ways::{Change, Way};
use crate::observe::{Problem, UNITS};
use crate::statistics::levels::ROUNDING;

/// Units of time that are shorter than the one that is said; those that no machine is logged in are left out.
pub(super) fn shorter_times(problem: &Problem) -> Vec<Way> {
    let row = problem.row();
    times(problem, |factor| factor < 1.0 - ROUNDING && !is_too_near(factor * row))
}

/// Those that are longer. A unit that doesn't say how long its steps are is asked whether it can step so far.
pub(super) fn longer_times(problem: &Problem, steps: &dyn Fn(f64) -> bool) -> Vec<Way> {
    let row = problem.row();
    let step = problem.model.fmus.iter().filter_map(|fmu| fmu.description().default_experiment.step_size);
    let step = step.filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min);
    let can = |factor: f64| !is_too_far(factor * row, step) && (step.is_finite() || steps(factor));
    times(problem, |factor| factor > 1.0 + ROUNDING && can(factor))
}

fn times(problem: &Problem, fits: impl Fn(f64) -> bool) -> Vec<Way> {
    let Some(run) = problem.runs.first() else { return Vec::new() };
    let way = |(unit, seconds): &(&str, f64)| {
        let factor = seconds / run.seconds;
        fits(factor).then(|| Way {
            change: Change::Time(factor),
            line: run.line,
            what: format!("times in {unit}"),
            add: format!("Add to each [[run]]: time = {{ unit = \"{unit}\" }}"),
            exact: false,
        })
    };
    UNITS.iter().filter_map(way).collect()
}

/// Whether no logger writes rows so near to each other, s.
fn is_too_near(row: f64) -> bool {
    row < DOUBTS.nearest
}

/// Whether no machine is logged in rows so far apart, s, whose units have this step: `INFINITY` where none is said.
fn is_too_far(row: f64, step: f64) -> bool {
    row > if step.is_finite() { DOUBTS.farthest.0 * step } else { DOUBTS.farthest.1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_rows_that_no_logger_and_no_machine_has() {
        // a megahertz: the fastest that machines' loggers are clocked with
        assert!(is_too_near(0.9e-6) && !is_too_near(1.1e-6));
        // a unit in steps of 10 ms is logged once in 3 s at most: what moves within steps would not be seen
        assert!(!is_too_far(2.7, 0.01) && is_too_far(3.3, 0.01));
        // a house, of which nothing says how it is stepped, every hour
        assert!(!is_too_far(3300.0, f64::INFINITY) && is_too_far(3900.0, f64::INFINITY));
    }
}
