//! Which parameters start states, where neither a name nor what shows after initialisation proves it: believed where the model, begun anew
//! within a run, goes on as it did with them as states, and clearly not with them as constants.
//!
//! Many a state rests at its own start, or hardly moves within a log: there a start does what a constant does. So the model's run begins
//! elsewhere, with each of them moved as far as moves an output by as much as it moves in the logs. From then on a constant has the value
//! that it was given, and a state has not.

use super::policy::IMPORT;
use crate::dynamics::build::build;
use crate::dynamics::memory::Stretches;
use crate::observe::{Problem, Role, State, VariableId};
use crate::options::GIVEN_UP;
use crate::statistics::levels::ROUNDING;
use orchestrator::Value;
use std::time::Instant;

/// A parameter of the unit that may start a state, with the variable that shows it, by their places.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Likely {
    pub start: usize,
    pub shows: Option<usize>,
}

/// The model's run, begun elsewhere, and what it misses where it begins anew in it.
struct Run {
    problem: Problem,
    stretches: Stretches,
    missed: f64,
}

/// Those of some parameters that start states; where the model remembers more than all of them together, one of the `others` with them, if it
/// is the only one with which it doesn't.
pub(super) fn among(problem: &Problem, likely: &[Likely], others: &[usize]) -> Vec<Likely> {
    let problem = Problem { candidates: Vec::new(), ..problem.clone() };
    let few = begun_elsewhere(&problem, likely, Stretches::Few).map(|run| (likely.to_vec(), run));
    let more = || remembers(&problem, likely).then(|| with_another(&problem, likely, others)).flatten();
    let found = few.or_else(more);
    let Some((mut starts, mut run)) = found else { return Vec::new() };
    // a constant that is called like a start is none
    for one in starts.clone() {
        let others: Vec<Likely> = starts.iter().copied().filter(|other| *other != one).collect();
        let without = missed(&with_states(&run.problem, &others), run.stretches);
        if let Some(without) = without.filter(|without| !is_more(*without, run.missed)) {
            (starts, run.missed) = (others, without);
        }
    }
    starts
}

/// The only one of some parameters with which, beside those that are likely, the model remembers no more than its states.
fn with_another(problem: &Problem, likely: &[Likely], others: &[usize]) -> Option<(Vec<Likely>, Run)> {
    let began = Instant::now();
    let mut found: Vec<(Vec<Likely>, Run)> = Vec::new();
    let is_other = |start: &&usize| likely.iter().all(|one| one.start != **start);
    for start in others.iter().filter(is_other) {
        // which is the only one, those tell that were not tried
        if began.elapsed().as_secs_f64() > GIVEN_UP {
            return None;
        }
        let starts: Vec<Likely> =
            likely.iter().copied().chain([Likely { start: *start, shows: None }]).collect();
        found.extend(begun_elsewhere(problem, &starts, Stretches::Long).map(|run| (starts, run)));
    }
    found.sort_by(|one, other| one.1.missed.total_cmp(&other.1.missed));
    let clear = match found.as_slice() {
        [(_, best), (_, second), ..] => is_more(second.missed, best.missed),
        _ => true,
    };
    found.into_iter().next().filter(|_| clear)
}

/// Whether the model misses clearly more where it begins anew than it does otherwise, solvers aside.
fn is_more(missed: f64, otherwise: f64) -> bool {
    missed > IMPORT.is_state * otherwise.max(ROUNDING)
}

/// Whether the model remembers more than the states that it can be begun from; it may have none.
fn remembers(problem: &Problem, likely: &[Likely]) -> bool {
    let with = with_states(problem, likely);
    build(&with, &with.whole_runs())
        .is_ok_and(|built| built.engine.machine.whole || !built.engine.remembered().is_empty())
}

/// The share of its motion in its own run that the model misses where it begins anew, if it can.
fn missed(problem: &Problem, stretches: Stretches) -> Option<f64> {
    let engine = build(problem, &problem.whole_runs()).ok()?.engine;
    if engine.machine.whole { None } else { engine.missed_begun_anew(stretches) }
}

/// A variable of the unit.
fn id(place: usize) -> VariableId {
    VariableId { instance: 0, place }
}

/// With these states.
fn with_states(problem: &Problem, starts: &[Likely]) -> Problem {
    let measures = |shows: VariableId| {
        problem.channels.iter().position(|one| one.variable == shows && one.role == Role::Compared)
    };
    let state = |one: &Likely| State {
        name: problem.model.name(id(one.start)),
        start: id(one.start),
        shows: one.shows.map(id),
        channel: one.shows.map(id).and_then(measures),
    };
    let mut with = problem.clone();
    with.states.extend(starts.iter().map(state));
    with
}

/// The run with each of these moved as far as moves an output by as much as it moves in the logs, or as far as it may, one way or the other, if the
/// model, begun anew from its states and these, goes on as it did there and where nothing is moved: a constant may be moved to where the model forgets
/// at once. Where the unit bears no such move, and names tell, the run as it is.
fn begun_elsewhere(problem: &Problem, starts: &[Likely], stretches: Stretches) -> Option<Run> {
    if starts.is_empty() {
        return None;
    }
    let most = if stretches == Stretches::Few { IMPORT.goes_on } else { IMPORT.goes_on_long };
    let run = |problem: Problem| {
        let missed = missed(&with_states(&problem, starts), stretches).filter(|missed| *missed <= most)?;
        Some(Run { problem, stretches, missed })
    };
    let own = run(problem.clone())?;
    let with = with_states(problem, starts);
    let engine = build(&with, &with.whole_runs()).ok()?.engine;
    let scales: Vec<f64> = engine.scales.iter().skip(problem.states.len()).copied().collect();
    drop(engine);
    let moved = |sign: f64| {
        let mut moved = problem.clone();
        for (one, scale) in starts.iter().zip(&scales) {
            let variable = problem.model.variable(id(one.start));
            let to = problem.model.number(id(one.start)).unwrap_or(0.0) + sign * scale;
            let (least, most) =
                (variable.min.unwrap_or(f64::NEG_INFINITY), variable.max.unwrap_or(f64::INFINITY));
            moved.model.set.push((id(one.start), Value::Real(to.min(most).max(least))));
        }
        run(moved)
    };
    moved(1.0).or_else(|| moved(-1.0)).or_else(|| Some(own).filter(|_| stretches == Stretches::Few))
}
