//! Readings of one channel in which the model comes nearer to the logs than as they are read, and not near: perhaps it lacks something as well.
//!
//! None is beyond doubt before a fit. Whether what the machine lacks has a name in one of them, and none as the logs are read, the search tells.

use super::policy::DOUBTS;
use super::readings::{Residual, left_of_channels};
use super::units;
use super::ways::{self, Change, Way};
use crate::dynamics::stretch::{Glance, Left};
use crate::observe::{Affine, Problem};
use crate::statistics::levels::{FAR, FEW, HALF};
use std::time::{Duration, Instant};

/// Another reading of a data set.
#[derive(Debug, Clone)]
pub(crate) struct Reading {
    /// The data set that is read so.
    pub(crate) problem: Problem,
    /// Line of `dataset.toml` that it is about.
    pub(crate) line: usize,
    /// What is otherwise, after "with".
    pub(crate) what: String,
    /// What to write.
    pub(crate) add: String,
}

fn reading(way: &Way, problem: &Problem) -> Reading {
    Reading { problem: way.read(problem), line: way.line, what: way.what.clone(), add: way.add.clone() }
}

/// Signs and units of one channel, and signs of several, with which the model leaves at most half of what it leaves as the logs are read; those
/// that leave least, first. Of an output only what it shows itself counts: others may move far more of their noise.
pub(crate) fn nearer(problem: &Problem) -> Vec<Reading> {
    let nominal = &problem.as_it_is();
    let began = Instant::now();
    let [Some(glanced), Some(own)] =
        [&DOUBTS.short, &DOUBTS.long].map(|glance| left_of_channels(nominal, glance))
    else {
        return Vec::new();
    };
    // a machine that is fed a million times as much may take its solver a minute a look, and follows nothing
    let patience = Duration::from_secs(1).max(began.elapsed().mul_f64(FAR));
    let left = |way: &Way, glance: &Glance, own: &[(usize, Left)]| -> Option<f64> {
        let end = Instant::now() + patience;
        let deadline = Some(problem.deadline.map_or(end, |deadline| deadline.min(end)));
        let read = Problem { deadline, ..way.read(nominal) };
        let left = share_left(way, own, &left_of_channels(&read, glance)?);
        (left <= HALF).then_some(left)
    };
    let judged = tried(nominal).into_iter().filter_map(|way| {
        left(&way, &DOUBTS.short, &glanced)?;
        Some((left(&way, &DOUBTS.long, &own)?, way))
    });
    ranked(judged.collect()).iter().take(FEW).map(|way| reading(way, problem)).collect()
}

/// Readings that are tried: signs first, of inputs, of outputs, of several; inputs that were logged late; then units, of columns as they are and turned.
fn tried(problem: &Problem) -> Vec<Way> {
    let mut all = ways::signs(problem);
    all.extend(earlier(problem));
    all.extend((0..problem.channels.len()).flat_map(|place| units::units(problem, place)));
    let turned = ways::signs(problem).into_iter().filter_map(|sign| match &sign.change {
        Change::Values(by) if by.len() == 1 => Some((by[0].0, sign)),
        _ => None,
    });
    for (place, sign) in turned {
        let both = |unit: Way| Way {
            change: match (&sign.change, &unit.change) {
                (Change::Values(one), Change::Values(other)) => {
                    Change::Values(vec![(place, ways::then(one[0].1, other[0].1))])
                }
                _ => unit.change,
            },
            what: format!("{} and {}", sign.what, unit.what),
            ..unit
        };
        all.extend(units::units(&sign.read(problem), place).into_iter().map(both));
    }
    all
}

/// What a reading leaves beyond noise of what is left as the logs are read: of the outputs that it changes, or of all where it changes inputs.
fn share_left(way: &Way, own: &[(usize, Left)], other: &[(usize, Left)]) -> f64 {
    let changed = changed(way);
    let is_output = |place: &usize| own.iter().any(|(output, _)| output == place);
    let all = !changed.iter().all(is_output);
    let excess = |left: &[(usize, Left)]| -> f64 {
        let counts = left.iter().filter(|(place, _)| all || changed.contains(place));
        Residual::of_stretches(&counts.map(|(_, left)| *left).collect::<Vec<_>>()).excess
    };
    excess(other) / excess(own).max(1.0)
}

/// The rows of an input one and two rows earlier: they were written after what they did. No delay is less than none, so that no effect says so.
fn earlier(problem: &Problem) -> Vec<Way> {
    let row = problem.row();
    let way = |(place, rows): (usize, usize)| {
        let channel = &problem.channels[place];
        let s = if rows > 1 { "s" } else { "" };
        Way {
            change: Change::Earlier(place, rows as f64 * row),
            line: channel.line,
            what: format!("{} {rows} row{s} earlier", ways::named(channel)),
            add: format!("Move this column up by {rows} row{s} against the others in the logs"),
            exact: false,
        }
    };
    let (fed, _) = ways::fed_and_compared(problem);
    fed.into_iter().flat_map(|place| [(place, 1), (place, 2)]).map(way).collect()
}

/// Places of the channels that are read otherwise.
fn changed(way: &Way) -> Vec<usize> {
    match &way.change {
        Change::Values(by) => by.iter().map(|(place, _)| *place).collect(),
        Change::Exchanged(one, other) => vec![*one, *other],
        Change::Earlier(place, _) => vec![*place],
        Change::Time(_) => Vec::new(),
    }
}

/// Those that leave least first; of those that can't be told from the best, those of fewest channels.
fn ranked(mut judged: Vec<(f64, Way)>) -> Vec<Way> {
    let least = judged.iter().map(|(left, _)| *left).fold(f64::INFINITY, f64::min);
    let channels = |way: &Way| changed(way).len();
    let near = |left: f64| left <= DOUBTS.same * least;
    judged.sort_by(|(one, first), (other, second)| match (near(*one), near(*other)) {
        (true, true) => channels(first).cmp(&channels(second)),
        _ => one.total_cmp(other),
    });
    judged.into_iter().map(|(_, way)| way).collect()
}

/// The unit of a channel's column in which its values are so many times as large as they are read.
pub(crate) fn unit_of_ratio(problem: &Problem, place: usize, ratio: f64, within: f64) -> Option<Reading> {
    let is_it = |by: &Affine| (by.scale / ratio - 1.0).abs() <= within;
    let ways = units::units(problem, place).into_iter();
    let mut fits = ways.filter(|way| matches!(&way.change, Change::Values(by) if by.iter().all(|(_, by)| by.offset == 0.0 && is_it(by))));
    fits.next().map(|way| reading(&way, problem))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::swung;

    fn left(error: f64) -> Left {
        Left { error, motion: 1e3, count: 1.0, variance: 1.0 }
    }

    fn way(scales: &[(usize, f64)]) -> Way {
        let by = scales.iter().map(|(place, scale)| (*place, Affine { scale: *scale, offset: 0.0 }));
        Way {
            change: Change::Values(by.collect()),
            line: 1,
            what: String::new(),
            add: String::new(),
            exact: false,
        }
    }

    #[test]
    fn value_what_a_reading_leaves_is_that_of_its_own_outputs_or_of_all() {
        // channel 0 is fed; 1 moves far more of its noise than 2 does
        let (own, other) = ([(1, left(9001.0)), (2, left(101.0))], [(1, left(9001.0)), (2, left(26.0))]);
        assert_eq!(share_left(&way(&[(2, -1.0)]), &own, &other), 0.25);
        assert!(share_left(&way(&[(0, -1.0)]), &own, &other) > 0.99);
    }

    #[test]
    fn value_of_readings_that_leave_as_much_the_one_of_fewest_channels_is_first() {
        let judged = |one: f64| ranked(vec![(0.1, way(&[(1, -1.0), (2, -1.0)])), (one, way(&[(0, -1.0)]))]);
        let first = |one: f64| judged(one)[0] == way(&[(0, -1.0)]);
        assert!(first(0.05) && first(0.14) && !first(0.16));
    }

    #[test]
    fn value_a_reading_in_which_the_model_comes_nearer() {
        let mut problem = swung("nearer", 400);
        assert_eq!(nearer(&problem).len(), 0, "as it is read it follows");
        let place = problem.channels.iter().position(|channel| channel.name.ends_with("q2"));
        let place = place.expect("it is compared");
        let mut told = |factor: f64| {
            let values = &mut problem.runs[0].series[place].values;
            values.iter_mut().for_each(|value| *value *= factor);
            let found = nearer(&problem);
            problem.runs[0].series[place].values.iter_mut().for_each(|value| *value /= factor);
            found.first().map(|reading| (reading.what.clone(), reading.add.clone()))
        };
        let (what, add) = told(-1.0).expect("turned");
        assert!(what.contains("the sign of acrobot_plant.q2") && add.contains("scale = -1"), "{what}: {add}");
        let (what, add) = told(-1f64.to_degrees()).expect("turned, and in degrees");
        assert!(what.contains("turned and") && what.contains("in deg"), "{what}");
        assert!(add.contains(&format!("scale = {}", -1f64.to_radians())), "{add}");
    }

    #[test]
    fn value_the_unit_whose_ratio_a_gain_is() {
        let problem = swung("ratio", 60);
        let place = problem.channels.iter().position(|channel| channel.name.ends_with("q2"));
        let place = place.expect("it is compared");
        let of = |ratio: f64, within: f64| unit_of_ratio(&problem, place, ratio, within).map(|one| one.what);
        assert!(of(1f64.to_radians(), 1e-6).is_some_and(|what| what.contains("in deg")));
        assert_eq!(of(1.02f64.to_radians(), 0.01), None);
        assert!(of(1.02f64.to_radians(), 0.03).is_some());
    }
}
