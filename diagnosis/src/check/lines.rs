//! Inputs that run along lines between the rows of a log: what a sensor measured, and not what a computer set from row to row.
//!
//! Read as held they act half a row late, and whatever makes a machine quicker is named for it.

use super::nearer::Reading;
use super::policy::DOUBTS;
use super::readings::{Residual, residual};
use super::ways::{list, named};
use crate::observe::{Hold, Problem, Role, Series};
use crate::statistics::levels::FEW;
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

/// How an input runs between rows, and not as it is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Runs {
    /// Along lines.
    Lines,
    /// Held from row to row, and logged a row late: along lines it acts half a row early, which is nearer than a whole row late.
    Late,
}

/// An input that the nominal model follows the logs with where it is read otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Smooth {
    /// Its channel.
    pub place: usize,
    /// How it runs.
    pub runs: Runs,
    /// How many times as much is left as it is read.
    pub times: f64,
}

/// Inputs that run smoothly and with which, read otherwise, the nominal model follows the logs, and far worse as they are held. Where none does so by
/// itself, all of them together.
pub(crate) fn along_lines(problem: &Problem) -> Vec<Smooth> {
    let places = held_and_smooth(problem);
    if places.is_empty() {
        return Vec::new();
    }
    let own = residual(problem, &DOUBTS.long);
    let better = |places: &[usize]| {
        let lines = residual(&with_lines(problem, places), &DOUBTS.long);
        let follows = |residual: &Residual| {
            residual.share.is_none_or(|share| share < DOUBTS.right) && own.is_worse(residual)
        };
        if !follows(&lines) {
            return None;
        }
        let late = residual(&a_row_earlier(problem, places), &DOUBTS.long);
        let (runs, left) = match follows(&late) && lines.is_worse(&late) {
            true => (Runs::Late, late),
            false => (Runs::Lines, lines),
        };
        Some((runs, own.excess / left.excess.max(1.0)))
    };
    let smooth = |place: usize, (runs, times): (Runs, f64)| Smooth { place, runs, times };
    let each = places.iter().filter_map(|place| Some(smooth(*place, better(&[*place])?)));
    let told: Vec<Smooth> = each.collect();
    if !told.is_empty() || places.len() == 1 {
        return told;
    }
    let all = better(&places);
    all.map_or(Vec::new(), |all| places.into_iter().map(|place| smooth(place, all)).collect())
}

/// The same with the columns of these inputs moved up by one row; the last one stays.
fn a_row_earlier(problem: &Problem, places: &[usize]) -> Problem {
    let mut other = problem.clone();
    for run in &mut other.runs {
        for place in places {
            let values = &mut run.series[*place].values;
            let rows = values.len();
            values.copy_within(1.min(rows).., 0);
        }
    }
    other
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

/// Whether an input moves from row to row, and by nearly as much as between the rows before: steps do neither, and noise not the second. Over a
/// few rows, too: from row to row noise may hide how it runs.
fn runs_along_lines<'a>(runs: impl Iterator<Item = &'a Series> + Clone) -> bool {
    let smooth = |apart: usize| {
        let (mut moves, mut bends) = (Vec::new(), Vec::new());
        for series in runs.clone() {
            let over = |place: usize| series.values[place + apart] - series.values[place];
            let count = series.values.len().saturating_sub(apart);
            moves.extend((0..count).map(|place| over(place).abs()));
            bends.extend((apart..count).map(|place| (over(place) - over(place - apart)).abs()));
        }
        let usual = |all: Vec<f64>| median(all).unwrap_or(0.0);
        let (moves, bends) = (usual(moves), usual(bends));
        moves > 0.0 && bends < DOUBTS.smooth * moves
    };
    (0..FEW).any(|doublings| smooth(1 << doublings))
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
        // over four rows noise of a third of what it moves in one is little
        let noisy = |size: f64| {
            let mut random = Random::new(5);
            let noise: Vec<f64> = (0..200).map(|_| size * random.normal()).collect();
            of(&|row| (row as f64 * 0.05).sin() + noise[row])
        };
        assert!(noisy(0.015) && !noisy(0.15));
        assert!(!of(&|row| Random::new((row / 5) as u64).normal()), "levels of five rows");
    }
}
