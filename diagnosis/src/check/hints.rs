//! What looks odd in a data set and is no proof: notices before anything is fitted, each with what would be right.

use super::held_over;
use super::lines::{Runs, Smooth, along_lines};
use super::policy::DOUBTS;
use super::stuck::alternates;
use crate::error::Notice;
use crate::nuisance::scatter;
use crate::observe::{Channel, Problem, Role, Run};
use crate::statistics::median::median;
use crate::text::brief;
use orchestrator::fmu::Description;

/// The problem with notices of what looks odd in it, and without readings that were held over.
pub(crate) fn hinted(problem: &Problem) -> Problem {
    let hints = [small_noise, rows_between_steps, other_clock, held_ramps];
    let mut hinted = problem.clone();
    held_over::leave_out(&mut hinted);
    hinted.notices.extend(hints.iter().flat_map(|hint| hint(problem)));
    hinted
}

fn notice(line: usize, message: String) -> Notice {
    Notice { file: "dataset.toml".into(), line, message }
}

/// Stated noise that is far less than what rows scatter by: the rest would be told as something that the model lacks.
fn small_noise(problem: &Problem) -> Vec<Notice> {
    let told = |(place, channel): (usize, &Channel)| {
        let stated = channel.noise.filter(|_| channel.role == Role::Compared)?;
        let runs: Vec<&[f64]> = problem.runs.iter().map(|run| run.series[place].values.as_slice()).collect();
        let scatters = scattered(&runs).filter(|scatters| *scatters > DOUBTS.too_small * stated)?;
        let written = |noise: f64| brief(noise / channel.conversion.scale.abs());
        Some(notice(
            channel.line,
            format!(
                "column {:?} ({}): its noise is stated as {}, and neighbouring rows scatter by {}, each on its own: what the stated noise is \
                 too small for is taken for something that the model lacks. Mend the number, or leave it out to have the noise estimated",
                channel.column,
                channel.name,
                written(stated),
                written(scatters)
            ),
        ))
    };
    problem.channels.iter().enumerate().filter_map(told).collect()
}

/// What neighbouring rows scatter by, if it is noise: a smooth course that is merely quick does not turn from row to row.
fn scattered(runs: &[&[f64]]) -> Option<f64> {
    (alternates(runs) >= DOUBTS.alternates).then(|| scatter(runs).quiet)
}

/// Rows that a unit which can't vary its steps can't follow.
fn rows_between_steps(problem: &Problem) -> Vec<Notice> {
    let intervals: Vec<f64> = problem.runs.iter().flat_map(intervals).collect();
    let units = problem.model.fmus.iter().zip(&problem.model.scenario.units);
    units.filter_map(|(fmu, unit)| off_step(&unit.name, fmu.description(), &intervals)).collect()
}

/// Whether a unit has steps of one size only and rows are not so far apart: in its own steps, where these fit the usual distance of rows.
fn off_step(unit: &str, description: &Description, intervals: &[f64]) -> Option<Notice> {
    if description.co_simulation.can_handle_variable_step {
        return None;
    }
    let usual = median(intervals.iter().copied())?;
    let own = description.default_experiment.step_size.filter(|own| *own > 0.0 && is_whole(usual / own));
    let step = own.unwrap_or(usual);
    let (odd, all) = (intervals.iter().filter(|one| !is_whole(*one / step)).count(), intervals.len());
    let message = format!(
        "{unit} says that it can't vary its steps (canHandleVariableCommunicationStepSize isn't true), and {odd} of {all} rows are no whole \
         number of steps of {} s after the row before: what it makes of them may be told as something that the model lacks. Log, or \
         resample, on an even clock",
        brief(step)
    );
    (odd as f64 > DOUBTS.odd_rows * all as f64).then(|| notice(0, message))
}

/// Runs whose rows are far closer than the others', or far less close: one of them may be in another unit of time.
fn other_clock(problem: &Problem) -> Vec<Notice> {
    let steps: Vec<Option<f64>> = problem.runs.iter().map(|run| median(intervals(run))).collect();
    let Some(usual) = median(steps.iter().copied().flatten()) else { return Vec::new() };
    let is_other = |step: &f64| (step / usual).max(usual / step) >= DOUBTS.other_clock;
    let told = |(run, step): (&Run, &Option<f64>)| {
        let step = step.filter(is_other)?;
        let message = format!(
            "{}: its rows are {} s apart, and those of other runs {} s: if its times are in another unit than is said, write it to this [[run]], \
             time = {{ unit = \"s\" }} or what they are in",
            run.name,
            brief(step),
            brief(usual)
        );
        Some(notice(run.line, message))
    };
    problem.runs.iter().zip(&steps).filter_map(told).collect()
}

/// Distances of a run's rows, s.
fn intervals(run: &Run) -> Vec<f64> {
    let mut times: Vec<f64> = run.series.iter().flat_map(|series| series.time.iter().copied()).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// Whether so many steps are a whole number of them, one at least.
fn is_whole(steps: f64) -> bool {
    steps.round() >= 1.0 && (steps - steps.round()).abs() <= DOUBTS.apart
}

/// Inputs that are read as held and run along lines, or were logged a row late: the model follows the logs far better so.
fn held_ramps(problem: &Problem) -> Vec<Notice> {
    let told = |Smooth { place, runs, times }: Smooth| {
        let Channel { column, name, line, .. } = &problem.channels[place];
        let (other, mend) = match runs {
            Runs::Lines => (
                "along lines between its rows",
                "If the input did not jump at each row, write hold = \"linear\" in its [[channel]]",
            ),
            Runs::Late => (
                "with its rows one row earlier",
                "If it was logged a row late, move this column up by 1 row against the others in the logs",
            ),
        };
        let message = format!(
            "column {column:?} ({name}) runs smoothly and is read as held from row to row; {other} the model leaves {} times less than that of the \
             logs. {mend}",
            brief(times)
        );
        notice(*line, message)
    };
    along_lines(problem).into_iter().map(told).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::{pendulum, simulated, swung};
    use crate::observe::Hold;
    use crate::statistics::random::Random;

    #[test]
    fn value_a_stated_noise_that_is_far_too_small_is_told_with_both_numbers() {
        let mut problem = swung("small-noise", 200);
        let (mut random, last) = (Random::new(5), problem.channels.len() - 1);
        problem.runs[0].series[last].values.iter_mut().for_each(|value| *value += 0.02 * random.normal());
        let told = |stated: f64, problem: &mut Problem| {
            problem.channels[last].noise = Some(stated);
            small_noise(problem)
        };
        let found = told(1e-6, &mut problem);
        let message = &found.first().expect("20 000 times too small").message;
        assert!(message.contains("(acrobot_plant.q2)") && message.contains("stated as 1.00e-6"), "{message}");
        assert!(message.contains("scatter by 0.02") || message.contains("scatter by 0.01"), "{message}");
        assert_eq!(found[0].line, problem.channels[last].line);
        // ten times too small, and an estimate of it is good to a tenth or so
        assert_eq!((told(0.0025, &mut problem).len(), told(0.0015, &mut problem).len()), (0, 1));
        // what swings without noise is no noise, however little is stated
        problem.channels[last - 1].noise = Some(1e-9);
        assert_eq!(small_noise(&problem).len(), 1);
    }

    #[test]
    fn value_a_run_whose_rows_are_thirty_times_as_close_is_told() {
        let mut problem = crate::dynamics::tests::pendulum("clock", 60);
        problem.runs = vec![problem.runs[0].clone(), problem.runs[0].clone(), problem.runs[0].clone()];
        let mut of_factor = |factor: f64| {
            problem.runs[1] = problem.runs[0].clone();
            let series = problem.runs[1].series.iter_mut();
            series.flat_map(|series| &mut series.time).for_each(|time| *time *= factor);
            other_clock(&problem)
        };
        let told = of_factor(1e-3);
        assert!(told.len() == 1 && told[0].message.contains("2.00e-5 s apart"), "{told:?}");
        // minutes; runs at 10 Hz and at 200 Hz are nothing odd
        assert_eq!((of_factor(60.0).len(), of_factor(1.0).len(), of_factor(0.05).len()), (1, 0, 0));
        assert_eq!((of_factor(0.035).len(), of_factor(0.03).len()), (0, 1));
    }

    #[test]
    fn value_rows_that_are_no_whole_number_of_steps() {
        assert!(is_whole(1.0) && is_whole(2.995) && !is_whole(2.98) && !is_whole(0.5) && !is_whole(0.004));
        let unit = |flag: bool, step: &str| {
            let text = format!(
                r#"<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g"><CoSimulation modelIdentifier="m"
                canHandleVariableCommunicationStepSize="{flag}"/><DefaultExperiment {step}/><ModelVariables/><ModelStructure/></fmiModelDescription>"#
            );
            Description::parse(&text).expect("a description")
        };
        // of 200 rows so many come 0.4 s late
        let late = |count: usize| -> Vec<f64> {
            let pairs = std::iter::repeat_n([2.4, 1.6], count).flatten();
            pairs.chain(std::iter::repeat_n(2.0, 200 - 2 * count)).collect()
        };
        let fixed = unit(false, "stepSize=\"1.0\"");
        assert_eq!(off_step("tank", &fixed, &late(0)), None, "an even clock");
        assert_eq!(off_step("tank", &fixed, &late(1)), None, "one row of a hundred");
        let told = off_step("tank", &fixed, &late(40)).expect("jitter").message;
        for part in ["tank says", "80 of 200 rows", "steps of 1 s", "even clock"] {
            assert!(told.contains(part), "{told}");
        }
        assert_eq!(off_step("tank", &unit(true, ""), &late(40)), None, "it can");
        // steps that no row fits are those of a description that nobody filled in
        let told = off_step("tank", &unit(false, "stepSize=\"7.0\""), &late(40)).expect("jitter").message;
        assert!(told.contains("80 of 200 rows") && told.contains("steps of 2 s"), "{told}");
    }

    #[test]
    fn value_an_input_that_ran_along_lines_and_is_read_as_held_is_told() {
        let mut problem = pendulum("ramps", 400);
        problem.runs[0].series[0].values.iter_mut().for_each(|value| *value *= 60.0);
        problem.channels[0].role = Role::Fed(Hold::Linear);
        let mut problem = simulated(problem);
        assert_eq!(held_ramps(&problem), [], "it is read as it was");
        problem.channels[0].role = Role::Fed(Hold::Zero);
        let found = held_ramps(&problem);
        let message = &found.first().expect("half a row late").message;
        assert!(
            message.contains("(acrobot_plant.tau)") && message.contains("hold = \"linear\""),
            "{message}"
        );
        let mut held = simulated(problem);
        assert_eq!(held_ramps(&held), [], "it was held");
        let row = held.row();
        held.runs[0].series[0].time.iter_mut().for_each(|time| *time += row);
        let found = held_ramps(&held);
        let message = &found.first().expect("a row late").message;
        assert!(message.contains("up by 1 row") && !message.contains("linear"), "{message}");
    }
}
