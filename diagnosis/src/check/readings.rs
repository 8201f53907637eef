//! Other ways to read the logs: if the model follows them in one of these and not as they are, `dataset.toml` lacks a line.
//!
//! Stretches of the logs are followed with the nominal model, each from the start state that fits best. A model that lacks an effect
//! leaves as much in any other way: none of them is near to what it lacks.

use super::Doubt;
use super::by_inputs;
use super::pairs_of_ways;
use super::policy::DOUBTS;
use super::times;
use super::ways::{self, Way};
use crate::dynamics::build::build;
use crate::dynamics::stretch::{Glance, Left};
use crate::observe::{Problem, Reading};
use crate::statistics::levels::{HALF, SEVERAL, SLIGHT};
use std::cell::LazyCell;
use std::time::Instant;

/// What the model leaves of all channels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Residual {
    /// The largest share of its motion that is left of a channel that tells; nothing where none does.
    pub(super) share: Option<f64>,
    /// What is left beyond the sensors' noise, in their variances.
    pub(super) excess: f64,
}

impl Residual {
    /// Nothing follows, or the model fails.
    const ALL: Self = Self { share: Some(f64::INFINITY), excess: f64::INFINITY };

    pub(super) fn of_stretches(left: &[Left]) -> Self {
        let beyond = |sum: f64, one: &Left| (sum - one.count * one.variance).max(0.0);
        let tells = |one: &&Left| one.error.max(one.motion) > DOUBTS.tells * one.count * one.variance;
        let share =
            |one: &Left| beyond(one.error, one) / beyond(one.motion, one).max(one.count * one.variance);
        Self {
            share: left.iter().filter(tells).map(share).max_by(f64::total_cmp),
            excess: left
                .iter()
                .filter(|one| one.variance > 0.0)
                .map(|one| beyond(one.error, one) / one.variance)
                .sum(),
        }
    }

    /// Whether the model follows the logs as they are read, or nothing tells.
    fn is_followed(&self) -> bool {
        self.share.is_none_or(|share| share < DOUBTS.wrong)
    }

    /// Whether it leaves so little in this way that it can't be what it leaves of the logs as they are read: in the sensors' variances, and of
    /// the motion, since a command that is read as an output brings its own steps as a variance.
    fn is_less(&self, way: &Way, own: &Self) -> bool {
        let most = if way.is_extreme() { DOUBTS.extreme.1 } else { DOUBTS.less };
        let share = |residual: &Self| residual.share.unwrap_or(0.0);
        self.excess <= most * own.excess && share(self) <= share(own)
    }

    /// Whether it leaves clearly more than another.
    pub(super) fn is_worse(&self, other: &Self) -> bool {
        self.excess >= DOUBTS.exact * other.excess + DOUBTS.clear
    }

    /// Whether it can't be told from the one that leaves least.
    pub(super) fn is_near(&self, least: f64) -> bool {
        self.excess <= DOUBTS.same * least
    }

    /// Whether the model follows all channels in this way.
    fn is_right(&self, way: &Way) -> bool {
        self.share.is_some() && self.may_be_right(way)
    }

    /// Whether it may, in so few rows that nothing need move there.
    pub(super) fn may_be_right(&self, way: &Way) -> bool {
        let most = if way.is_extreme() { DOUBTS.extreme.0 } else { DOUBTS.right };
        self.share.is_none_or(|share| share < most)
    }
}

/// The noise that a stated one counts as, where the log scatters by so much.
fn counted(stated: f64, scatter: f64) -> f64 {
    stated.min(DOUBTS.stated * scatter)
}

/// How well the model follows a data set.
pub(super) fn residual(problem: &Problem, glance: &Glance) -> Residual {
    let of = |channels: Vec<(usize, Left)>| {
        let left: Vec<Left> = channels.into_iter().map(|(_, left)| left).collect();
        Residual::of_stretches(&left)
    };
    left_of_channels(problem, glance).map_or(Residual::ALL, of)
}

/// What the model leaves of each compared channel, with the channel's place; nothing where it can't be followed.
pub(super) fn left_of_channels(problem: &Problem, glance: &Glance) -> Option<Vec<(usize, Left)>> {
    let mut built = build(problem, &problem.whole_runs()).ok()?;
    let engine = &mut built.engine;
    // a noise is stated in the log's unit: in a wrong one it would hide what the model leaves
    for (sd, scatter) in engine.sensors.iter_mut().zip(&built.scatter).filter(|(_, s)| s.noise > 0.0) {
        *sd = counted(*sd, scatter.noise);
    }
    let places: Vec<usize> = engine.machine.channels.iter().map(|output| output.channel).collect();
    let after = engine.follow_stretches(glance);
    // an output may follow an input at once
    let at_once = engine.at_once().ok().flatten().is_some();
    let before = at_once.then(|| {
        engine.machine.reading = Reading::Before;
        engine.follow_stretches(glance)
    });
    let excess = |left: &Vec<Left>| Residual::of_stretches(left).excess;
    let both = [after, before.flatten()].into_iter().flatten();
    let least = both.min_by(|one, other| excess(one).total_cmp(&excess(other)))?;
    Some(places.into_iter().zip(least).collect())
}

/// How well the model follows a data set; nothing where an isolated unit didn't come back within its limit: it would in no other way.
fn tried(problem: &Problem, glance: &Glance) -> Option<Residual> {
    let began = Instant::now();
    let residual = residual(problem, glance);
    let mut limits = problem.model.scenario.units.iter().filter_map(|unit| unit.isolation.as_ref());
    let hangs = residual == Residual::ALL && limits.any(|limit| began.elapsed() >= limit.step_limit);
    (!hangs).then_some(residual)
}

/// The way in which the model follows the logs, if it doesn't as they are read.
pub(super) fn otherwise(problem: &Problem) -> Option<Doubt> {
    let shorter = shorter_time(problem)?;
    if shorter.is_some() {
        return shorter;
    }
    let own = tried(problem, &DOUBTS.long)?;
    if own.is_followed() {
        return None;
    }
    let engine = LazyCell::new(|| build(problem, &problem.whole_runs()).ok().map(|built| built.engine));
    let steps =
        |factor: f64| engine.as_ref().is_none_or(|engine| engine.steps_as_far(factor, DOUBTS.farthest.0));
    let ways: Vec<Way> =
        times::longer_times(problem, &steps).into_iter().chain(ways::others(problem)).collect();
    drop(engine);
    let Some((best, others)) = only(problem, &own, &ways) else { return pairs_of_ways::doubt(problem, &own) };
    Some(describe_doubt(&best.1, &others.iter().collect::<Vec<_>>(), Some((best.0, own))))
}

/// The shorter unit of time in which the model follows the logs, if there is one; nothing where a unit doesn't come back.
///
/// Times that are a thousand times too long may cost a thousand times as much: the shorter ones come first, and need no look at the logs as
/// they are read, since no model that moves within rows follows both.
fn shorter_time(problem: &Problem) -> Option<Option<Doubt>> {
    for way in &times::shorter_times(problem) {
        let read = way.read(problem);
        if !tried(&read, &DOUBTS.short)?.is_right(way) {
            continue;
        }
        let residual = tried(&read, &DOUBTS.long)?;
        if residual.is_right(way) && is_exact(way, problem, &residual) {
            return Some(Some(describe_doubt(way, &[], None)));
        }
    }
    Some(None)
}

/// With what times the model follows the logs and not as they are read, in a sentence, if these are a shorter unit's.
pub(crate) fn too_long_times(problem: &Problem) -> Option<String> {
    shorter_time(problem).flatten().map(|doubt| doubt.sentence)
}

/// The way in which the model follows the logs and not as they are read, with those that can't be told from it.
fn only(problem: &Problem, own: &Residual, ways: &[Way]) -> Option<((Residual, Way), Vec<Way>)> {
    let fits = |way: &&Way| residual(&way.read(problem), &DOUBTS.short).may_be_right(way);
    let judged =
        ways.iter().filter(fits).map(|way| (residual(&way.read(problem), &DOUBTS.long), way.clone()));
    nearest(judged.filter(|(residual, way)| is_it(way, problem, residual, own)).collect())
}

/// The first of those that leave least, and the others.
pub(super) fn nearest(mut found: Vec<(Residual, Way)>) -> Option<((Residual, Way), Vec<Way>)> {
    let least = found.iter().map(|(residual, _)| residual.excess).min_by(f64::total_cmp)?;
    found.retain(|(residual, _)| residual.is_near(least));
    let mut found = found.into_iter();
    Some((found.next()?, found.map(|(_, way)| way).collect()))
}

/// Whether the model follows the logs in this way and not as they are read.
pub(super) fn is_it(way: &Way, problem: &Problem, residual: &Residual, own: &Residual) -> bool {
    // beside a model that fails as they are read anything leaves less
    let is_far = way.is_extreme() && own.excess.is_finite();
    residual.is_right(way)
        && residual.is_less(way, own)
        && (is_far || way.is_sign() && turns(way, problem, own) || is_exact(way, problem, residual))
        && !by_inputs::mutes(way, problem)
        && is_less_in_its_rows(way, problem)
}

/// Whether it is this way in the rows, too, through which the model can be followed in it. A machine that flies apart where a pressure is
/// read with its sign turned is followed there through a few rows, and through a few any model is.
fn is_less_in_its_rows(way: &Way, problem: &Problem) -> bool {
    let read = way.read(problem);
    let rows = |problem: &Problem| {
        build(problem, &problem.whole_runs()).ok().map(|built| built.engine.rows_followed(DOUBTS.long.rows).0)
    };
    let Some((there, _)) = rows(&read).zip(rows(problem)).filter(|(there, own)| there < own) else {
        return true;
    };
    let glance = Glance { rows: there, ..DOUBTS.long };
    let own = residual(problem, &glance);
    !own.is_followed() && residual(&read, &glance).is_less(way, &own)
}

/// Whether the model follows the logs better with this sign than as they are read, even where it has another gain as well.
fn turns(way: &Way, problem: &Problem, own: &Residual) -> bool {
    way.beside(problem).iter().all(|beside| residual(beside, &DOUBTS.long).excess <= HALF * own.excess)
}

/// Whether the model follows the logs clearly worse a little beside this way.
fn is_exact(way: &Way, problem: &Problem, residual: &Residual) -> bool {
    way.beside(problem).iter().all(|beside| self::residual(beside, &DOUBTS.long).is_worse(residual))
}

/// The signs with which the model follows the logs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Signs {
    /// Names of the channels that are turned.
    pub turned: Vec<String>,
    /// The largest share of its motion that is left of a channel that tells.
    pub left: f64,
}

/// The signs with which the model follows stretches of the logs, the fewest turns first where several follow as well: a model that drifts off
/// within a whole log is followed through stretches of it. Nothing where none is followed, or another sign of a single channel, of those that the
/// stretches see, is followed nearly as well: they are too short for it.
pub(crate) fn signs(problem: &Problem) -> Option<Signs> {
    let own = tried(problem, &DOUBTS.long)?;
    let turns = ways::signs(problem).into_iter();
    let mut all: Vec<(Residual, Vec<String>)> = turns
        .map(|way| (residual(&way.read(problem), &DOUBTS.long), way.channels(problem)))
        .filter(|(residual, _)| (residual.excess - own.excess).abs() > SLIGHT * own.excess)
        .collect();
    all.push((own, Vec::new()));
    let least = all.iter().map(|(residual, _)| residual.excess).min_by(f64::total_cmp)?;
    let near = all.iter().filter(|(residual, _)| residual.is_near(least));
    let (residual, turned) = near.min_by_key(|(_, turned)| turned.len())?;
    let left = residual.share.filter(|share| *share < DOUBTS.extreme.0)?;
    let is_worse = |other: &Residual| other.excess >= SEVERAL * residual.excess;
    let mut others = all.iter().filter(|(_, other)| other.len() < 2 && other != turned);
    (all.len() > 1 && others.all(|(other, _)| is_worse(other)))
        .then(|| Signs { turned: turned.clone(), left })
}

pub(super) fn describe_doubt(way: &Way, others: &[&Way], shares: Option<(Residual, Residual)>) -> Doubt {
    let share = |residual: Residual| match residual.share {
        Some(share) if share < 10.0 => format!("{:.1} %", 100.0 * share),
        _ => "more than ten times as much".into(),
    };
    let left = shares.map_or(String::new(), |(there, own)| {
        format!(": of their motion it then leaves {}, as they are read {}", share(there), share(own))
    });
    let or = match others {
        [] => String::new(),
        ways => {
            let names: Vec<String> = ways.iter().map(|way| format!("{} ({})", way.what, way.add)).collect();
            format!("; these logs can't tell that from {}", names.join(", or "))
        }
    };
    Doubt {
        line: way.line,
        sentence: format!("the model follows the logs only with {}{left}{or}", way.what),
        add: way.add.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::ways::Change;
    use super::*;
    use crate::observe::Affine;

    /// 200 values of a sensor with a variance of 4 that moved by so many variances a value, of which so many are left.
    fn left(motion: f64, error: f64) -> Left {
        let all = 200.0 * 4.0;
        Left { error: error * all, motion: motion * all, count: 200.0, variance: 4.0 }
    }

    fn residual(share: f64, excess: f64) -> Residual {
        Residual { share: Some(share), excess }
    }

    fn way(change: Change) -> Way {
        Way { change, line: 1, what: String::new(), add: String::new(), exact: false }
    }

    #[test]
    fn value_a_channel_tells_from_five_deviations_of_its_sensor() {
        // 4.9² and 5.1² variances, of motion or of error
        assert_eq!(Residual::of_stretches(&[left(24.0, 1.0)]).share, None, "noise");
        assert!(Residual::of_stretches(&[left(26.0, 1.0)]).share.is_some(), "motion");
        assert_eq!(Residual::of_stretches(&[left(1.0, 24.0)]).share, None);
        assert!(Residual::of_stretches(&[left(1.0, 26.0)]).share.is_some(), "error");
    }

    #[test]
    fn value_a_stated_noise_that_the_log_does_not_scatter_by_does_not_count() {
        // a scatter is an estimate and a stated noise is rounded up: believed; twice as large it would hide what a model leaves
        assert_eq!(counted(1.4, 1.0), 1.4);
        assert!(counted(2.0, 1.0) < 1.7);
        assert_eq!(counted(0.2, 1.0), 0.2, "a noise that is stated too small leaves more, and hides nothing");
    }

    #[test]
    fn value_what_the_model_leaves_as_logs_are_read() {
        // a fiftieth of the motion is no wrong reading: gains and offsets of that size are sound sensors'
        assert!(residual(0.018, 1e4).is_followed() && !residual(0.022, 1e4).is_followed());
        assert!(Residual { share: None, excess: 1e4 }.is_followed(), "no channel tells");
    }

    #[test]
    fn value_what_the_model_leaves_in_another_way() {
        let sign = way(Change::Values(vec![(0, Affine { scale: -1.0, offset: 0.0 })]));
        // a tenth of the motion, and of what it leaves as they are read
        assert!(residual(0.09, 1.0).is_right(&sign) && !residual(0.11, 1.0).is_right(&sign));
        assert!(residual(0.0, 90.0).is_less(&sign, &residual(1.0, 1000.0)));
        assert!(!residual(0.0, 110.0).is_less(&sign, &residual(1.0, 1000.0)));
        // a machine at rest: it says nothing, and in the few rows of a first look that is nothing against it
        let rest = Residual { share: None, excess: 0.0 };
        assert!(!rest.is_right(&sign) && rest.may_be_right(&sign));
        // where nothing else comes near half of the motion will do, if it is a fiftieth of what it leaves as they are read
        for far in [
            Change::Time(60.0),
            Change::Exchanged(0, 1),
            Change::Values(vec![(0, Affine { scale: 1e-3, offset: 0.0 })]),
        ] {
            let far = way(far);
            assert!(residual(0.45, 1.0).is_right(&far) && !residual(0.55, 1.0).is_right(&far));
            assert!(residual(0.0, 18.0).is_less(&far, &residual(1.0, 1000.0)));
            assert!(!residual(0.0, 22.0).is_less(&far, &residual(1.0, 1000.0)));
            // steps of a command, read as an output's, are a large variance: little is left in it, and half of the motion
            assert!(!residual(0.469, 1.0).is_less(&far, &residual(0.029, 1000.0)));
        }
    }

    #[test]
    fn value_what_is_left_beside_a_way_and_in_ways_that_are_as_good() {
        // much noise: twice as much is worse, a half more is not
        assert!(
            residual(0.0, 2.1e4).is_worse(&residual(0.0, 1e4))
                && !residual(0.0, 1.9e4).is_worse(&residual(0.0, 1e4))
        );
        // hardly anything left: ten standard deviations, squared, whatever it is a multiple of
        assert!(
            residual(0.0, 110.0).is_worse(&residual(0.0, 0.1))
                && !residual(0.0, 90.0).is_worse(&residual(0.0, 0.1))
        );
        assert!(residual(0.0, 140.0).is_near(100.0) && !residual(0.0, 160.0).is_near(100.0));
    }

    #[test]
    fn bad_data_times_in_ms_are_told_without_a_run_in_seconds() {
        let problem = crate::dynamics::tests::swung("in-ms", 300);
        assert_eq!(too_long_times(&problem), None);
        let began = Instant::now();
        let told = too_long_times(&way(Change::Time(1000.0)).read(&problem)).expect("300 rows of 20 s each");
        assert!(told.contains("times in ms"), "{told}");
        // rows of 20 s cost this unit a thousand times as much as those of 20 ms: a look at them takes half a minute
        assert!(began.elapsed().as_secs() < 10, "{:?}", began.elapsed());
    }

    #[test]
    fn law_a_look_follows_what_swings_wide_with_rates_that_nobody_measures_and_costs_little() {
        let problem = crate::dynamics::tests::swung("looks", 400);
        let longer = way(Change::Time(2.0)).read(&problem);
        let share =
            |problem: &Problem, glance: &Glance| super::residual(problem, glance).share.expect("it moves");
        // to judge by: as it is read nothing is left, in other times most
        assert!(share(&problem, &DOUBTS.long) < 0.001 && share(&longer, &DOUBTS.long) > 0.5);
        // to choose by: so little that no way is passed over
        assert!(share(&problem, &DOUBTS.short) < 0.01);
        // rows that are simulated, of four states; a hundred ways are chosen from and a few are judged, with a unit of some microseconds a row
        let rows = |glance: &Glance| glance.stretches * glance.rows * glance.rounds * 5;
        assert!(100 * rows(&DOUBTS.short) < 300_000 && rows(&DOUBTS.long) < 30_000);
    }

    #[test]
    fn law_a_way_in_which_the_model_flies_apart_must_be_better_in_its_few_rows() {
        let problem = crate::dynamics::tests::swung("apart", 400);
        let place = problem.channels.iter().position(|channel| channel.name.ends_with("q1"));
        let place = place.expect("it is compared");
        let by = |offset: f64| way(Change::Values(vec![(place, Affine { scale: 1.0, offset })]));
        // an arm that hangs, read as one that stands: as it is read it is followed through these rows as well
        let standing = by(std::f64::consts::PI);
        assert!(!is_less_in_its_rows(&standing, &problem));
        // and the other way round, the rows are more
        assert!(is_less_in_its_rows(&by(-std::f64::consts::PI), &standing.read(&problem)));
    }
}
