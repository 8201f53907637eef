//! Whether what the model is fed has a say in what it follows, read in another way.
//!
//! In a unit that is a thousand times too large no force counts: a ball that a loop holds in the air flies on, and a line, or a parabola, is
//! most of what a stretch of its log shows. Such a reading leaves less than the logs as they are read, if the machine is unstable, and yet
//! nothing speaks for it. So inputs are held at their mean: if that is the same to what is read otherwise, and not to it as it is read, then
//! it isn't followed by the model.

use super::policy::DOUBTS;
use super::readings::left_of_channels;
use super::ways::{Change, Way};
use crate::observe::{Problem, Role};
use crate::statistics::levels::SMALL;

/// Whether the reading of a way takes the inputs' say away.
pub(super) fn mutes(way: &Way, problem: &Problem) -> bool {
    let Change::Values(list) = &way.change else { return false };
    let is_fed = |place: usize| matches!(problem.channels[place].role, Role::Fed(_));
    let changed: Vec<usize> = list.iter().map(|(place, _)| *place).collect();
    let (fed, compared): (Vec<usize>, Vec<usize>) =
        (0..problem.channels.len()).partition(|place| is_fed(*place));
    // of an output that is read otherwise, what all inputs do to it; of an input, what it does to any output
    let (held, shown) = match changed.iter().all(|place| is_fed(*place)) {
        true => (changed, compared),
        false => (fed, changed),
    };
    !has_a_say(&way.read(problem), &held, &shown) && has_a_say(problem, &held, &shown)
}

/// Whether what is left of these outputs is another where these inputs are held.
fn has_a_say(problem: &Problem, inputs: &[usize], outputs: &[usize]) -> bool {
    let left = |problem: &Problem| -> Option<f64> {
        let channels = left_of_channels(problem, &DOUBTS.long)?;
        let of = channels.iter().filter(|(place, left)| outputs.contains(place) && left.variance > 0.0);
        Some(of.map(|(_, left)| left.error / left.variance).sum())
    };
    // a model that can't be followed at all is another
    match (left(problem), left(&held(problem, inputs))) {
        (Some(fed), Some(held)) => (held - fed).abs() > SMALL * fed,
        (one, other) => one.is_some() != other.is_some(),
    }
}

/// The same with these inputs at their mean in each run.
fn held(problem: &Problem, inputs: &[usize]) -> Problem {
    let mut held = problem.clone();
    for run in &mut held.runs {
        for place in inputs {
            let values = &mut run.series[*place].values;
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            values.fill(mean);
        }
    }
    held
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::swung;
    use crate::observe::Affine;

    #[test]
    fn law_a_reading_that_takes_the_say_of_an_input_away_is_told() {
        let problem = swung("say", 400);
        let of = |name: &str| problem.channels.iter().position(|channel| channel.name.ends_with(name));
        let way = |place: usize, scale: f64| Way {
            change: Change::Values(vec![(place, Affine { scale, offset: 0.0 })]),
            line: 1,
            what: String::new(),
            add: String::new(),
            exact: false,
        };
        let (tau, q1) = (of("tau").expect("it is fed"), of("q1").expect("it is compared"));
        assert!(mutes(&way(tau, 1e-9), &problem), "a torque that is as good as none");
        assert!(!mutes(&way(tau, -1.0), &problem), "turned it still drives");
        assert!(!mutes(&way(q1, 0.9999), &problem), "nearly the same angle, which it drives");
        // what had no say before has none to lose
        let still = held(&problem, &[tau]);
        assert!(!mutes(&way(tau, 1e-9), &still));
        assert!(still.runs[0].series[tau].one_value().is_some());
    }
}
