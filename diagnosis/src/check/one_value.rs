//! A sensor that stood still throughout a run: one value in all rows, where the model moves what it measures.
//!
//! An untouched machine, or a pump that is off, has one value as well; then the model stays, too, and nothing is doubted. What may well stay
//! at a value for good is not asked: Booleans, whole numbers, and what a unit declares as discrete.

use super::Doubt;
use super::policy::{DOUBTS, STRETCH};
use crate::dynamics::build::build;
use crate::dynamics::stretch::Motion;
use crate::observe::{Channel, Problem, Role, Run, Series};
use crate::text::brief;
use orchestrator::Kind;
use orchestrator::fmu::Variability;

/// A compared channel of a run that has one value throughout, though the model says that it moved.
pub(super) fn still(problem: &Problem) -> Option<Doubt> {
    let of_run = |run| (0..problem.channels.len()).map(move |place| (place, run));
    let asked = problem.runs.iter().flat_map(of_run);
    let still: Vec<(usize, &Run)> = asked.filter(|(place, run)| is_still(problem, *place, run)).collect();
    if still.is_empty() {
        return None;
    }
    let engine = build(problem, &problem.whole_runs()).ok()?.engine;
    still.into_iter().find_map(|(place, run)| {
        let motion = engine.motion(&run.name, place, STRETCH)?;
        let (channel, value) = (&problem.channels[place], run.series[place].values[0]);
        moves(&motion, value, channel.noise).then(|| doubt(problem, place, run, &motion))
    })
}

/// Whether a channel that the model compares as a continuous number has one value throughout a run.
fn is_still(problem: &Problem, place: usize, run: &Run) -> bool {
    let channel = &problem.channels[place];
    let variable = problem.model.variable(channel.variable);
    let is_number = variable.kind == Kind::Real && variable.variability == Variability::Continuous;
    channel.role == Role::Compared && is_number && has_one_value(&run.series[place])
}

fn has_one_value(series: &Series) -> bool {
    series.values.len() >= DOUBTS.still_rows && series.one_value().is_some()
}

/// Whether the model clearly moves what a log says to stay at a value.
fn moves(motion: &Motion, value: f64, noise: Option<f64>) -> bool {
    let tells = noise.is_none_or(|sd| motion.size * motion.size > DOUBTS.tells * sd * sd);
    tells && motion.size > DOUBTS.moves * motion.largest.max(value.abs())
}

fn doubt(problem: &Problem, place: usize, run: &Run, motion: &Motion) -> Doubt {
    let Channel { name, column, conversion, line, .. } = &problem.channels[place];
    let series = &run.series[place];
    let value = (series.values[0] - conversion.offset) / conversion.scale;
    // what a conversion leaves in the last digits was never written
    let value: f64 = format!("{value:.12e}").parse().unwrap_or(value);
    let elsewhere = problem.runs.iter().any(|other| !has_one_value(&other.series[place]));
    let or = if elsewhere { ", or leave its cells empty in this run" } else { "" };
    Doubt {
        line: *line,
        sentence: format!(
            "{}: column {column:?} ({name}) has one value, {value}, in all its {} rows, and the model moves it by a standard deviation of {}: \
             the sensor stood still, or nothing was connected to it",
            run.name,
            series.values.len(),
            brief(motion.size / conversion.scale.abs())
        ),
        add: format!(
            "Take this [[channel]] out of dataset.toml{or}; if the machine itself stood still, take the run out"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::swung;

    #[test]
    fn bad_data_a_sensor_that_never_moved_is_refused_where_the_model_moves() {
        let mut problem = swung("stood-still", 120);
        assert_eq!(still(&problem), None, "it moves");
        let last = problem.channels.len() - 1;
        problem.runs[0].series[last].values.fill(2.5);
        let Doubt { line, sentence, add } = still(&problem).expect("the arm swings");
        assert_eq!(line, problem.channels[last].line);
        for part in [
            "a.csv: column \"q2\" (acrobot_plant.q2)",
            "one value, 2.5, in all its 120 rows",
            "standard deviation of",
        ] {
            assert!(sentence.contains(part), "{sentence}");
        }
        assert!(add.contains("Take this [[channel]] out") && !add.contains("cells"), "{add}");
        // one row less than a sensor that stood still has
        let Series { time, values } = &mut problem.runs[0].series[last];
        time.truncate(DOUBTS.still_rows - 1);
        values.truncate(DOUBTS.still_rows - 1);
        assert_eq!(still(&problem), None);
    }

    #[test]
    fn law_a_machine_at_rest_has_one_value_as_well() {
        // hung from a base that turns nothing, without a torque
        let mut problem = swung("at-rest", 60);
        for series in &mut problem.runs[0].series {
            series.values.fill(0.0);
        }
        for channel in 1..problem.channels.len() {
            problem.runs[0].series[channel].values.fill(std::f64::consts::PI);
        }
        assert_eq!(still(&problem), None, "the model hangs still, too");
    }

    #[test]
    fn value_from_where_on_a_model_moves_what_stays() {
        let motion = |size: f64, largest: f64| Motion { size, largest };
        // a tenth of how large it is, be it by the model or by the log
        assert!(moves(&motion(0.11, 1.0), 0.0, None) && !moves(&motion(0.09, 1.0), 0.0, None));
        assert!(moves(&motion(0.11, 0.2), 1.0, None) && !moves(&motion(0.09, 0.2), 1.0, None));
        assert!(!moves(&motion(0.0, 0.0), 0.0, None), "it stays");
        // and five standard deviations of a sensor whose noise is known
        assert!(moves(&motion(0.51, 1.0), 0.0, Some(0.1)) && !moves(&motion(0.49, 1.0), 0.0, Some(0.1)));
    }
}
