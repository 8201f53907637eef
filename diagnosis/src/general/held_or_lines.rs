//! Inputs that run smoothly, and of which nobody says how they run between rows: held, or along lines, whichever is likelier beside what the machine
//! lacks. The nominal model follows the logs in neither way then, so that no look at it tells.

use super::policy::GENERAL;
use super::study::studied;
use crate::check::lines;
use crate::observe::{Ports, Problem, Run};
use crate::options::Options;
use crate::statistics::levels::{CERTAIN, FEW, SAMPLE};
use crate::step_budget::StepBudget;
use crate::watch::{Doing, Watch};

/// Whether the logs are likelier with these inputs along lines; nothing where they don't tell, or where the model can't be followed.
pub(crate) fn likelier_lines(problem: &Problem) -> Option<bool> {
    // what has no name is process noise, in either reading
    let ports = Ports { unknown_inputs: false, ..problem.ports.clone() };
    let held = Problem { ports, ..problem.clone() };
    let along = lines(&held)?.problem;
    // a few rows tell most, and a search in many takes long
    let mut asked = [1, FEW].map(|stretches| stretches * GENERAL.stretch).into_iter();
    asked.find_map(|rows| likelier((&held, &along), rows, GENERAL.glanced_steps()))
}

/// Whether the other reading is likelier, by so many rows; nothing where they don't tell, or where a search takes more steps than these.
fn likelier((one, other): (&Problem, &Problem), rows: usize, steps: u64) -> Option<bool> {
    let (options, mut nobody) = (Options::default(), |_: &Doing<'_>| {});
    let watch = &mut Watch::new(&mut nobody, one.deadline);
    let mut deviance = |problem: &Problem| {
        let budget = StepBudget::new(steps);
        let problem = &Problem { budget: Some(budget.clone()), ..problem.clone() };
        let found = studied(problem, &begins(problem, rows), &options, None, false, watch).ok()?;
        (!budget.is_spent() && !watch.is_over("reading the logs otherwise")).then_some(found.fit.deviance)
    };
    let (one, other) = (deviance(one)?, deviance(other)?);
    ((one - other).abs() > CERTAIN * CERTAIN).then_some(other < one)
}

/// The beginnings of runs, so many rows in all: of all runs, or of so many that each has rows enough to tell anything.
fn begins(problem: &Problem, rows: usize) -> Vec<(&Run, (f64, f64))> {
    let runs = problem.runs.len().min(rows / SAMPLE).max(1);
    let length = (rows / runs) as f64 * problem.row();
    let part = |(run, (from, to)): (_, (f64, f64))| (run, (from, to.min(from + length)));
    problem.whole_runs().into_iter().take(runs).map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::pendulum;

    #[test]
    fn value_a_search_ends_by_its_steps_and_not_by_the_clock() {
        // an input that is ten times as large in the other reading
        let one = pendulum("likelier", 100);
        let mut other = one.clone();
        other.runs[0].series[0].values.iter_mut().for_each(|value| *value *= 10.0);
        let told = |steps: u64| likelier((&one, &other), 100, steps);
        assert_eq!(told(GENERAL.glanced_steps()), Some(false));
        assert_eq!(told(1000), None, "a hundred rows of four states take more");
    }

    #[test]
    fn value_each_run_has_thirty_rows_or_is_left_out() {
        let mut problem = pendulum("begins", 200);
        let one = problem.runs[0].clone();
        let mut lengths = |runs: usize, rows: usize| {
            problem.runs = vec![one.clone(); runs];
            let begins = begins(&problem, rows);
            let rows = begins.iter().map(|(_, (from, to))| ((to - from) / problem.row()).round());
            (begins.len(), rows.fold(0.0, f64::max))
        };
        assert_eq!([lengths(1, 60), lengths(2, 60), lengths(3, 60)], [(1, 60.0), (2, 30.0), (2, 30.0)]);
        // fewer rows than that are what there is of one run
        assert_eq!([lengths(4, 10), lengths(1, 1000)], [(1, 10.0), (1, 199.0)]);
    }
}
