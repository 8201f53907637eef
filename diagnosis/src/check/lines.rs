//! Inputs that run along lines between the rows of a log: what a sensor measured, and not what a computer set from row to row.
//!
//! Read as held they act half a row late, and whatever makes a machine quicker is named for it.

use super::nearer::Reading;
use super::policy::DOUBTS;
use super::readings::residual;
use super::ways::{list, named};
use crate::observe::{Hold, Problem, Role, Series};
use crate::statistics::median::median;
use orchestrator::Kind;

/// Inputs that are read as held and run smoothly.
fn held_and_smooth(problem: &Problem) -> Vec<usize> {
    let may_be_lines = |place: &usize| {
        let channel = &problem.channels[*place];
        channel.role == Role::Fed(Hold::Zero)
            && problem.model.variable(channel.variable).kind == Kind::Real
            && runs_along_lines(problem.runs.iter().map(|run| &run.series[*place]))
    };
    (0..problem.channels.len()).filter(may_be_lines).collect()
}

/// The same with these inputs along lines.
fn with_lines(problem: &Problem, places: &[usize]) -> Problem {
    let mut other = problem.clone();
    places.iter().for_each(|place| other.channels[*place].role = Role::Fed(Hold::Linear));
    other
}

/// Inputs with which along lines the nominal model follows the logs, and far worse as they are held: place, and how many times as much is left.
pub(crate) fn along_lines(problem: &Problem) -> Vec<(usize, f64)> {
    let places = held_and_smooth(problem);
    if places.is_empty() {
        return Vec::new();
    }
    let own = residual(problem, &DOUBTS.long);
    let told = |place: usize| {
        let lines = residual(&with_lines(problem, &[place]), &DOUBTS.long);
        let better = lines.share.is_none_or(|share| share < DOUBTS.right) && own.is_worse(&lines);
        better.then(|| (place, own.excess / lines.excess.max(1.0)))
    };
    places.into_iter().filter_map(told).collect()
}

/// Inputs that run smoothly and are read as held since nobody says how they run.
fn unsaid(problem: &Problem) -> Vec<usize> {
    held_and_smooth(problem).into_iter().filter(|place| !problem.channels[*place].hold_is_said).collect()
}

/// Their names.
pub(crate) fn may_be_lines(problem: &Problem) -> Vec<String> {
    unsaid(problem).into_iter().map(|place| problem.channels[place].name.clone()).collect()
}

/// The data set with all of them along lines, if there is one.
pub(crate) fn lines(problem: &Problem) -> Option<Reading> {
    let places = unsaid(problem);
    let channels = places.iter().map(|place| &problem.channels[*place]);
    Some(Reading {
        problem: with_lines(problem, &places),
        line: problem.channels[*places.first()?].line,
        what: format!("{} along lines between rows", list(channels.clone().map(named))),
        add: format!(
            "If what was fed did not jump at each row, write hold = \"linear\" in the [[channel]] of {}",
            list(channels.map(|channel| channel.name.clone()))
        ),
    })
}

/// Whether an input moves from row to row, and by nearly as much as between the rows before: steps do neither, and noise not the second.
fn runs_along_lines<'a>(runs: impl Iterator<Item = &'a Series>) -> bool {
    let (mut moves, mut bends) = (Vec::new(), Vec::new());
    for series in runs {
        let steps: Vec<f64> = series.values.windows(2).map(|pair| pair[1] - pair[0]).collect();
        moves.extend(steps.iter().map(|step| step.abs()));
        bends.extend(steps.windows(2).map(|pair| (pair[1] - pair[0]).abs()));
    }
    let usual = |all: Vec<f64>| median(all).unwrap_or(0.0);
    let (moves, bends) = (usual(moves), usual(bends));
    moves > 0.0 && bends < DOUBTS.smooth * moves
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::pendulum;
    use crate::statistics::random::Random;

    #[test]
    fn value_only_a_hold_that_nobody_says_is_tried_otherwise() {
        let mut problem = pendulum("unsaid", 400);
        let series = &mut problem.runs[0].series[0];
        series.values = (0..series.time.len()).map(|row| libm::sin(0.05 * row as f64)).collect();
        problem.channels[0].hold_is_said = false;
        let reading = lines(&problem).expect("a sine");
        assert_eq!(reading.problem.channels[0].role, Role::Fed(Hold::Linear));
        assert!(reading.what.contains("acrobot_plant.tau (column \"tau\") along lines"), "{}", reading.what);
        assert_eq!(may_be_lines(&problem), ["acrobot_plant.tau"]);
        problem.channels[0].hold_is_said = true;
        assert!(lines(&problem).is_none() && may_be_lines(&problem).is_empty());
    }

    #[test]
    fn value_which_inputs_run_along_lines() {
        let of = |value: &dyn Fn(usize) -> f64| {
            let values: Vec<f64> = (0..200).map(value).collect();
            let time = (0..200).map(|row| row as f64).collect();
            runs_along_lines([Series { time, values }].iter())
        };
        assert!(of(&|row| (row as f64 * 0.05).sin()), "a sine");
        assert!(of(&|row| (row % 40).min(40 - row % 40) as f64), "ramps");
        assert!(!of(&|row| (row / 20 % 2) as f64), "steps");
        assert!(!of(&|row| Random::new(row as u64).normal()), "noise");
        // a sine of w per row bends by w of what it moves, so to speak
        assert!(of(&|row| (row as f64 * 0.45).sin()) && !of(&|row| (row as f64 * 0.55).sin()));
    }
}
