//! What most likely made a diagnosis fail, where the data set tells: times of a run in another unit, a start that starts nothing.

use super::policy::GENERAL;
use crate::error::Error;
use crate::observe::{self, Problem, Run, State};
use crate::statistics::median::{median, usual_step};
use orchestrator::fmu::Causality;

/// How a unit fails whose values are wrong: it says so. One that crashes or hangs is at fault itself, whatever starts it.
const ANSWERED: &str = " answered ";

/// The error of a diagnosis with what most likely made it fail, if that is known.
pub(super) fn blamed(problem: &Problem, error: Error) -> Error {
    let found = match &error {
        Error::TooSlow => doubted_time(problem, &error),
        Error::Model(why) => no_start(problem, why),
        _ => None,
    };
    let path = problem.path.join("dataset.toml");
    found.map_or(error, |(line, problem)| Error::Manifest { path, line, problem })
}

/// The first run whose rows are so far apart that its times may be a shorter unit's: beside those of the other runs, or beside the steps of the
/// units where all are alike.
fn doubted_time(problem: &Problem, error: &Error) -> Option<(usize, String)> {
    let steps: Vec<f64> = problem.runs.iter().map(row).collect();
    let least = steps.iter().copied().filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min);
    let own = problem.model.fmus.iter().filter_map(|fmu| fmu.description().default_experiment.step_size);
    let own = median(own.filter(|step| *step > 0.0)).unwrap_or(f64::INFINITY);
    let (run, step) =
        problem.runs.iter().zip(steps).find(|(_, step)| *step > 0.0 && far(*step, least.min(own)))?;
    let unit = observe::shorter_unit(run.seconds, |factor| !far(step * factor, least.min(own)))?;
    let beside = match far(step, least) {
        true => format!("those of other runs {least:.3e} s"),
        false => format!("the unit's own step is {own:.3e} s"),
    };
    let told = format!(
        "the rows of {} are {step:.3e} s apart, and {beside}: are its times in {unit}? Then write unit = {unit:?} in its `time`. As they are read, \
         there is {error}",
        run.name
    );
    Some((run.line, told))
}

/// Usual distance of a run's rows, s; 0 where none has two.
fn row(run: &Run) -> f64 {
    run.series.iter().filter_map(|series| usual_step(&series.time)).fold(0.0, f64::max)
}

/// Whether rows so far apart are no rows of a machine that moves within so much.
fn far(step: f64, beside: f64) -> bool {
    step >= GENERAL.rows_apart * beside
}

/// The first parameter that a `[[state]]` takes for a start, and with which nothing is another where a run begins. That alone proves nothing: what a
/// unit keeps to itself is seen by nobody. A unit that fails with its states moved says the rest.
fn no_start(problem: &Problem, why: &str) -> Option<(usize, String)> {
    let is_none = |state: &&State| {
        problem.model.variable(state.start).causality == Causality::Parameter
            && observe::is_seen(&problem.model, state.start) == Some(false)
    };
    let state = problem.states.iter().filter(|_| why.contains(ANSWERED)).find(is_none)?;
    let line = observe::line_of_state(&problem.path, &state.name)?;
    // what was fed is not what is doubted here
    let why = why.split(", fed ").next().unwrap_or(why);
    let told = format!(
        "{} starts no state, as it seems: with another value of it no output or local variable is another where a run begins, and with it as a start \
         the unit failed ({why}). Take this [[state]] out; a parameter that may be off is a [[candidate]]",
        state.name
    );
    Some((line, told))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::pendulum;
    use crate::observe::VariableId;

    #[test]
    fn bad_data_a_run_whose_times_are_another_units_is_named() {
        let mut problem = pendulum("blame-times", 40);
        assert!(matches!(blamed(&problem, Error::TooSlow), Error::TooSlow), "twelve steps a row");
        let mut run = Run { name: "b.csv".into(), line: 77, ..problem.runs[0].clone() };
        run.series.iter_mut().flat_map(|series| &mut series.time).for_each(|time| *time *= 1e3);
        problem.runs.push(run.clone());
        let error = blamed(&problem, Error::TooSlow);
        let told = error.to_string();
        let wanted = "dataset.toml:77: the rows of b.csv are 2.000e1 s apart, and those of other runs 2.000e-2 s: are its times in ms?";
        assert!(told.contains(wanted) && told.contains("unit = \"ms\"") && error.is_input(), "{told}");
        // alone, beside the unit's own step
        problem.runs = vec![run];
        let told = blamed(&problem, Error::TooSlow).to_string();
        assert!(told.contains("the unit's own step is 1.667e-3 s: are its times in ms?"), "{told}");
    }

    #[test]
    fn bad_data_a_state_that_a_parameter_does_not_start_is_named() {
        let mut problem = pendulum("blame-state", 40);
        let failed =
            |how: &str| Error::Model(format!("unit plant: fmi2DoStep at t = 1 s {how}, fed tau = 3; look"));
        let unchanged = blamed(&problem, failed("answered error")).to_string();
        assert!(unchanged.contains("fed tau = 3"), "{unchanged}");
        let place = problem.model.description(0).place("tau_max").expect("a parameter of the plant");
        let start = VariableId { instance: 0, place };
        let name = problem.model.name(start);
        problem.states.push(State { name, start, shows: None, channel: None });
        problem.path =
            std::env::temp_dir().join(format!("diagnosis-blame-state-file-{}", std::process::id()));
        std::fs::create_dir_all(&problem.path).expect("it can be made");
        let text = "format = 2\n[[state]]\nstart = \"acrobot_plant.tau_max\"\n";
        std::fs::write(problem.path.join("dataset.toml"), text).expect("it can be written");
        let error = blamed(&problem, failed("answered error"));
        let hung = blamed(&problem, failed("did not come back"));
        let _ = std::fs::remove_dir_all(&problem.path);
        let told = error.to_string();
        assert!(told.contains("dataset.toml:3: acrobot_plant.tau_max starts no state"), "{told}");
        assert!(!told.contains("fed tau") && error.is_input(), "{told}");
        assert!(!hung.is_input(), "{hung}");
    }
}
