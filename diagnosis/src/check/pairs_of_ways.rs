//! Two things at once that `dataset.toml` doesn't say: an angle in degrees, and a gyro that was mounted the other way round.
//!
//! Neither alone lets the model follow the logs. So all pairs of signs and units of measurement are looked at, and both are asked for as one
//! is: each must be beyond doubt in the logs that are read in the other.

use super::Doubt;
use super::policy::DOUBTS;
use super::readings::{Residual, describe_doubt, is_it, nearest, residual};
use super::ways::{self, Way};
use crate::observe::Problem;
use crate::statistics::levels::PART;
use std::time::Instant;

/// One way, and another of the logs that are read in it.
type Pair = (Way, Way);

/// The two ways in which the model follows the logs.
pub(super) fn doubt(problem: &Problem, own: &Residual) -> Option<Doubt> {
    // two readings that are wrong leave most of a motion; less than that is what a machine lacks, and of a model that fails nothing is known
    own.share.filter(|share| (DOUBTS.extreme.0..f64::INFINITY).contains(share))?;
    let pairs = pairs(problem);
    if !is_in_time(problem, pairs.len()) {
        return None;
    }
    let glanced = pairs.into_iter().filter_map(|pair| {
        let left = residual(&read(problem, &pair), &DOUBTS.short);
        leaves_hardly_anything(&left).then_some((left, pair))
    });
    let mut glanced: Vec<(Residual, Pair)> = glanced.collect();
    glanced.sort_by(|(a, _), (b, _)| a.excess.total_cmp(&b.excess));
    let judged = glanced.into_iter().take(DOUBTS.pairs).flat_map(|(_, pair)| {
        let others = other_signs(problem, &pair);
        let both = both(problem, pair);
        let mirrored = both.as_ref().and_then(|(left, _)| mirrored(problem, others?, left));
        mirrored.into_iter().chain(both)
    });
    let (best, others) = nearest(judged.collect())?;
    Some(describe_doubt(&best.1, &others.iter().collect::<Vec<_>>(), Some((best.0, *own))))
}

/// Each pair once: of two channels, or sign and unit of one.
fn pairs(problem: &Problem) -> Vec<Pair> {
    let place =
        |way: &Way| problem.channels.iter().position(|channel| way.channels(problem)[0] == channel.name);
    let mut all = Vec::new();
    for first in ways::single(problem) {
        let is_next = |second: &Way| {
            place(second) > place(&first)
                || place(second) == place(&first) && first.is_sign() && !second.is_sign()
        };
        let seconds = ways::single(&first.read(problem)).into_iter().filter(is_next);
        all.extend(seconds.map(|second| (first.clone(), second)));
    }
    all
}

/// Whether so many looks take a part of the time that there is: so large a one that a busy computer answers as a quiet one does.
fn is_in_time(problem: &Problem, looks: usize) -> bool {
    let Some(deadline) = problem.deadline else { return true };
    let began = Instant::now();
    residual(problem, &DOUBTS.short);
    let left = deadline.saturating_duration_since(began).as_secs_f64();
    looks as f64 * began.elapsed().as_secs_f64() <= PART * left
}

/// Whether the model follows a pair as it would a sign: among so many pairs one takes flows, or forces, away from a machine that lacks something,
/// and what then stands still is followed by where it is begun.
fn leaves_hardly_anything(left: &Residual) -> bool {
    left.share.is_none_or(|share| share < DOUBTS.right)
}

fn read(problem: &Problem, (first, second): &Pair) -> Problem {
    second.read(&first.read(problem))
}

/// What the model leaves where both are beyond doubt, each beside the other; as one way to tell.
fn both(problem: &Problem, pair: Pair) -> Option<(Residual, Way)> {
    let left = residual(&read(problem, &pair), &DOUBTS.long);
    if !leaves_hardly_anything(&left) {
        return None;
    }
    let (first, second) = pair;
    let one = first.read(problem);
    let other = second.read(problem);
    let alone = |problem: &Problem| residual(problem, &DOUBTS.long);
    if !(is_it(&second, &one, &left, &alone(&one)) && is_it(&first, &other, &left, &alone(&other))) {
        return None;
    }
    let what = format!("{} and {}", first.what, second.what);
    // the second was made of logs that are read in the first: of the same channel its line says both
    let same = first.channels(problem) == second.channels(problem);
    let add = if same { second.add.clone() } else { format!("{}. {}", first.add, second.add) };
    Some((left, Way { what, add, line: first.line.min(second.line), ..second }))
}

/// The sign of the channel beside two signs, if there is one.
fn other_signs(problem: &Problem, (first, second): &Pair) -> Option<Way> {
    let turned = [first, second].map(|way| way.channels(problem)).concat();
    let is_other = |way: &Way| way.channels(problem).iter().all(|name| !turned.contains(name));
    let beside = || ways::signs(problem).into_iter().filter(is_other);
    let both = first.is_sign() && second.is_sign() && problem.channels.len() == turned.len() + 1;
    beside().next().filter(|_| both)
}

/// The one sign, if the model follows the logs with it as well as with the two others: a machine that does the opposite where all is turned does,
/// and one sign is the simpler story.
fn mirrored(problem: &Problem, one: Way, left: &Residual) -> Option<(Residual, Way)> {
    let there = residual(&one.read(problem), &DOUBTS.long);
    there.is_near(left.excess).then_some((there, one))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A swinging pendulum, each of whose angles counts so many times as much, and a pair by what it says of each.
    fn asked(name: &str, factors: [f64; 2], says: [&str; 2]) -> Option<Way> {
        let mut problem = crate::dynamics::tests::swung(name, 400);
        for (angle, factor) in ["acrobot_plant.q1", "acrobot_plant.q2"].into_iter().zip(factors) {
            let place = problem.channels.iter().position(|channel| channel.name == angle);
            let values = &mut problem.runs[0].series[place.expect("it is compared")].values;
            values.iter_mut().for_each(|value| *value *= factor);
        }
        let is = |(first, second): &Pair| first.what.contains(says[0]) && second.what.contains(says[1]);
        let found: Vec<Pair> = pairs(&problem).into_iter().filter(is).collect();
        assert_eq!(found.len(), 1, "each pair once");
        found.into_iter().find_map(|pair| both(&problem, pair)).map(|(_, way)| way)
    }

    #[test]
    fn value_two_readings_at_once_are_told_with_a_line_for_each() {
        let degrees = 1f64.to_degrees();
        let says = ["q1 (column \"q1\") in deg", "sign of acrobot_plant.q2"];
        let two = asked("both", [degrees, -1.0], says).expect("neither alone will do");
        assert!(two.add.contains("unit = \"deg\"") && two.add.contains("scale = -1"), "{}", two.add);
        // one that nothing asks for beside the other
        assert_eq!(asked("first", [degrees, 1.0], says), None);
        // of one column both are one line
        let says = ["sign of acrobot_plant.q1", "q1 (column \"q1\") in deg"];
        let one = asked("one", [-degrees, 1.0], says).expect("neither alone will do");
        let line = format!("scale = {}", -1f64.to_radians());
        assert!(one.add.contains(&line) && one.add.matches("Write in").count() == 1, "{}", one.add);
    }

    #[test]
    fn law_one_sign_is_told_before_two_that_do_the_same() {
        let mut problem = crate::dynamics::tests::swung("mirrored", 400);
        let sign = |name: &str, problem: &Problem| {
            let all = ways::signs(problem).into_iter();
            let mut own = all.filter(|way| way.channels(problem) == [format!("acrobot_plant.{name}")]);
            own.next().expect("it is a channel")
        };
        let angles = ["q1", "q2"].map(|name| sign(name, &problem));
        let torque = sign("tau", &problem);
        // a torque that is felt, and what the model does with it
        let place =
            problem.channels.iter().position(|own| own.name == "acrobot_plant.tau").expect("it is fed");
        problem.runs[0].series[place].values.iter_mut().for_each(|value| *value *= 100.0);
        let problem = crate::dynamics::tests::simulated(problem);
        let pair: Pair = (angles[0].clone(), angles[1].clone());
        assert_eq!(other_signs(&problem, &pair), Some(torque.clone()));
        // beside another unit there is none
        let unit = ways::single(&problem).into_iter().find(|way| !way.is_sign()).expect("logs have units");
        assert_eq!(other_signs(&problem, &(angles[0].clone(), unit)), None);
        // the pendulum hangs: where it is turned round with its torque it swings as it did
        let turned = read(&problem, &pair);
        let left = residual(&problem, &DOUBTS.long);
        assert_eq!(mirrored(&turned, torque.clone(), &left).map(|(_, way)| way), Some(torque.clone()));
        assert_eq!(mirrored(&problem, torque, &left), None);
    }
}
