//! Which listed effects do most of what the unlisted input did: a real machine lacks several things at once, and the one that nobody listed
//! takes up the listed ones as well.
//!
//! What an effect does to a state within an interval (∂F/∂θ, or a chord) is held against what the unlisted input does there (G d), and
//! its smoothed course is told by few of them, by forward selection.

use super::policy::SEARCHING;
use super::trials::trials;
use super::{Policy, Search};
use crate::dynamics::Engine;
use crate::dynamics::linearise::Chord;
use crate::error::Error;
use crate::infer::sweep::direction;
use crate::infer::{Disturbance, Fit, Linearised, smooth};
use crate::statistics::linear::solve;
use crate::watch::Watch;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Listed effects that together do a part of what the unlisted input did.
#[derive(Debug, Clone, PartialEq)]
struct Nearest {
    /// Parameters and their values, the one that does most first.
    effects: Vec<(usize, f64)>,
    /// Share of the course's square that they take away.
    share: f64,
}

impl Search<'_> {
    /// The effects with those that do most of what the unlisted input did, where the data want them beside it. It takes up what they do, so
    /// that each gains little; but what it did is then told by few numbers. `alone` are the numbers of a search without it.
    ///
    /// # Errors
    /// A unit failed.
    pub fn nearer(
        &mut self,
        mut effects: Vec<usize>,
        mut here: Fit,
        alone: Policy,
        watch: &mut Watch<'_>,
    ) -> Result<(Vec<usize>, Fit), Error> {
        while effects.len() < self.policy.most && !watch.is_over("the search for what an unlisted input did")
        {
            let others = self.others(&effects);
            let Some(near) = nearest(self.engine, &here, &others)? else { break };
            let Some((with, fitted)) = self.with_nearest(&effects, &here, near) else { break };
            let beside = std::mem::replace(&mut self.policy, alone);
            let kept = self.pruned(with, fitted, "the unlisted input doesn't");
            let kept = kept.and_then(|(with, fit)| self.agreed(with, fit));
            self.policy = beside;
            let (with, fit) = kept?;
            if fit.deviance >= here.deviance - alone.gain || with.len() <= effects.len() {
                break;
            }
            (effects, here) = (with, fit);
        }
        Ok((effects, here))
    }

    /// The effects with those that come nearest to the unlisted input, fitted; nothing where they can't be.
    fn with_nearest(&mut self, effects: &[usize], here: &Fit, near: Nearest) -> Option<(Vec<usize>, Fit)> {
        let mut start = here.at.clone();
        let mut with = effects.to_vec();
        for (parameter, value) in near.effects {
            start.theta[parameter] = value;
            with.push(parameter);
        }
        let names: Vec<&str> = with[effects.len()..].iter().map(|place| self.name(*place)).collect();
        let told = format!(
            "{} would do {:.0} % of what the unlisted input did",
            names.join(", "),
            100.0 * near.share
        );
        self.story.push(told);
        match self.visit(&with, &start) {
            Ok(fitted) => Some((with, fitted)),
            Err(error) => {
                self.story.push(format!("they can't be fitted: {error}"));
                None
            }
        }
    }
}

/// What one trial of an effect does, in units of the unlisted input.
pub(super) struct Column {
    pub chord: Chord,
    /// Where its parameter is.
    from: f64,
    pub values: Vec<f64>,
}

impl Column {
    pub fn new(chord: Chord, from: f64, values: Vec<f64>) -> Self {
        Self { chord, from, values }
    }

    /// Where an amount of it takes its parameter.
    pub fn value(&self, amount: f64) -> f64 {
        self.from + amount * (self.chord.to - self.from) / self.chord.per
    }
}

/// The effects among `candidates` that come nearest to the unlisted input of a fit; nothing where none does a part that counts.
///
/// # Errors
/// A unit failed.
fn nearest(engine: &Engine, fit: &Fit, candidates: &[usize]) -> Result<Option<Nearest>, Error> {
    let within = |parameter: usize, value: f64| {
        let (least, most) = engine.machine.parameters[parameter].range;
        (least..=most).contains(&value)
    };
    let course = columns(engine, fit, candidates)?;
    Ok(course.and_then(|Course { columns, values }| selected(&columns, &values, &within)))
}

/// The course of an unlisted input, and what trials of effects do.
pub(super) struct Course {
    pub columns: Vec<Column>,
    pub values: Vec<f64>,
}

/// What trials of these candidates do, and the smoothed course of the unlisted input of a fit; nothing where it has none.
///
/// # Errors
/// A unit failed.
pub(super) fn columns(engine: &Engine, fit: &Fit, candidates: &[usize]) -> Result<Option<Course>, Error> {
    let Fit { at, .. } = fit;
    let Some(unlisted) = at.noise.disturbance.filter(|_| !engine.machine.whole) else { return Ok(None) };
    let chords: Vec<Chord> =
        candidates.iter().flat_map(|parameter| trials(engine, &at.theta, *parameter)).collect();
    let runs = engine.chords(&at.theta, &at.paths, &chords)?;
    let values: Vec<f64> = (runs.par_iter().zip(&fit.runs))
        .flat_map(|(run, own)| {
            let mut course = smooth(own, &at.noise).disturbance;
            course.truncate(run.rows().saturating_sub(1));
            course
        })
        .collect();
    let column = |(place, chord): (usize, &Chord)| {
        let values = runs.iter().flat_map(|run| likened(run, place, &unlisted, &engine.scales)).collect();
        Column::new(*chord, at.theta[chord.parameter], values)
    };
    let columns = chords.iter().enumerate().map(column).collect();
    Ok(Some(Course { columns, values }))
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// What an effect does in each interval of a run, as the unlisted input that comes nearest to it.
fn likened(run: &Linearised, column: usize, unlisted: &Disturbance, scales: &[f64]) -> Vec<f64> {
    let of = |row: usize| {
        let (mut along, mut square) = (0.0, 0.0);
        // states behind those with a scale are lags of sensors, which no input drives
        for (state, (drive, scale)) in run.column(row, column).iter().zip(scales).enumerate() {
            let by = direction(run, row, unlisted.equation, state) / scale;
            along += by * drive / scale;
            square += by * by;
        }
        along / square.max(f64::MIN_POSITIVE)
    };
    (0..run.rows().saturating_sub(1)).map(of).collect()
}

/// Columns held against a course.
struct Held<'a> {
    columns: &'a [Column],
    /// Their products with each other, below the diagonal.
    gram: Vec<Vec<f64>>,
    /// Their products with the course.
    along: Vec<f64>,
    /// The course's square.
    whole: f64,
    within: &'a dyn Fn(usize, f64) -> bool,
}

impl<'a> Held<'a> {
    fn new(columns: &'a [Column], course: &[f64], within: &'a dyn Fn(usize, f64) -> bool) -> Self {
        let below =
            |i: usize| columns[..=i].iter().map(|other| dot(&columns[i].values, &other.values)).collect();
        let gram = (0..columns.len()).into_par_iter().map(below).collect();
        let along = columns.iter().map(|column| dot(&column.values, course)).collect();
        Self { columns, gram, along, whole: dot(course, course), within }
    }

    fn product(&self, i: usize, j: usize) -> f64 {
        self.gram[i.max(j)][i.min(j)]
    }

    /// The share that one takes away by itself.
    fn alone(&self, place: usize) -> f64 {
        self.along[place].powi(2) / (self.product(place, place) * self.whole)
    }

    /// What a set of columns takes away; nothing for two of one parameter, and where a value leaves its range.
    fn taken(&self, chosen: &[usize]) -> Option<Nearest> {
        let parameter = |place: usize| self.columns[place].chord.parameter;
        let twice = |(at, place): (usize, &usize)| {
            chosen[..at].iter().any(|one| parameter(*one) == parameter(*place))
        };
        if chosen.iter().enumerate().any(twice) {
            return None;
        }
        let gram = DMatrix::from_fn(chosen.len(), chosen.len(), |i, j| self.product(chosen[i], chosen[j]));
        let score = DVector::from_fn(chosen.len(), |i, _| self.along[chosen[i]]);
        let amounts = solve(&gram, &score)?;
        let value = |(place, by): (&usize, &f64)| (parameter(*place), self.columns[*place].value(*by));
        let effects: Vec<(usize, f64)> = chosen.iter().zip(amounts.iter()).map(value).collect();
        let allowed = effects.iter().all(|(parameter, value)| (self.within)(*parameter, *value));
        allowed.then(|| Nearest { effects, share: amounts.dot(&score) / self.whole })
    }

    /// The best of these sets.
    fn best(&self, sets: impl Iterator<Item = Vec<usize>>) -> Option<(Nearest, Vec<usize>)> {
        let found = sets.filter_map(|set| Some((self.taken(&set)?, set)));
        found.max_by(|a, b| a.0.share.total_cmp(&b.0.share))
    }
}

/// Forward selection of the columns, from the best one; where no single one does a part that counts, from the best two. (From the best two
/// in any case a true name gave way to a resistance and a lag that together did a little more.)
fn selected(columns: &[Column], course: &[f64], within: &dyn Fn(usize, f64) -> bool) -> Option<Nearest> {
    let held = Held::new(columns, course, within);
    let all = || 0..columns.len();
    let counts = |(near, _): &(Nearest, Vec<usize>)| near.share >= SEARCHING.follows;
    let single = || held.best(all().map(|place| vec![place])).filter(counts);
    let larger = |i: usize, j: usize| if held.alone(i) >= held.alone(j) { vec![i, j] } else { vec![j, i] };
    let pair = || {
        held.best(all().flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| larger(i, j))).filter(counts)
    };
    let (mut near, mut chosen) = single().or_else(pair)?;
    while chosen.len() < SEARCHING.terms {
        let further = held.best(all().map(|place| chosen.iter().copied().chain([place]).collect()));
        match further {
            Some((more, with)) if more.share - near.share >= SEARCHING.further => {
                (near, chosen) = (more, with)
            }
            _ => break,
        }
    }
    Some(near)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A column of a parameter at 1, moved by a derivative.
    fn column(parameter: usize, of: fn(f64) -> f64) -> Column {
        let values = (0..200).map(|row| of(0.1 * f64::from(row))).collect();
        Column::new(Chord { parameter, to: 1.5, per: 0.5 }, 1.0, values)
    }

    fn columns() -> [Column; 3] {
        [column(0, libm::sin), column(1, libm::cos), column(2, |time| libm::sin(7.0 * time))]
    }

    /// Amounts of the three, and of what no column gives.
    fn course(amounts: [f64; 3], other: f64) -> Vec<f64> {
        let all = columns();
        let rest = (0..200).map(|row| libm::cos(0.1 * 23.0 * f64::from(row)));
        rest.enumerate()
            .map(|(row, rest)| {
                all.iter().zip(amounts).map(|(one, by)| by * one.values[row]).sum::<f64>() + other * rest
            })
            .collect()
    }

    fn found(amounts: [f64; 3], other: f64) -> Option<Nearest> {
        selected(&columns(), &course(amounts, other), &|_, value| value >= 0.0)
    }

    #[test]
    fn value_effects_that_a_course_is_made_of_are_found_with_their_values() {
        let near = found([0.6, 0.0, -0.4], 0.1).expect("two of them");
        assert_eq!(near.effects.iter().map(|(place, _)| *place).collect::<Vec<_>>(), [0, 2]);
        // 20 s are no whole number of periods, so that what no column gives is not quite orthogonal to them
        assert!((near.effects[0].1 - 1.6).abs() < 0.01 && (near.effects[1].1 - 0.6).abs() < 0.01, "{near:?}");
        assert!((near.share - 0.52 / 0.53).abs() < 0.01, "{near:?}");
    }

    #[test]
    fn value_what_does_less_than_a_quarter_is_not_near() {
        // 0.55² : 1 is 23 % of the square, 0.6² : 1 is 26 %
        assert_eq!(found([0.55, 0.0, 0.0], 1.0), None);
        assert!(found([0.6, 0.0, 0.0], 1.0).is_some());
        // a further one needs a twentieth
        let count = |by: f64| found([1.0, by, 0.0], 0.0).map_or(0, |near| near.effects.len());
        assert_eq!((count(0.21), count(0.25)), (1, 2));
    }

    #[test]
    fn value_two_that_only_together_tell_a_course_are_found() {
        // the first two cancel but for a little, and of the third a tenth is the course
        let nearly = |time: f64| libm::sin(time) + 0.1 * libm::cos(time);
        let other = |time: f64| libm::cos(time) + 3.0 * libm::sin(7.0 * time);
        let all = [column(0, libm::sin), column(1, nearly), column(2, other)];
        let course: Vec<f64> = (0..200).map(|row| libm::cos(0.1 * f64::from(row))).collect();
        let near = selected(&all, &course, &|_, value| value.abs() < 20.0).expect("two of them");
        assert_eq!(near.effects.iter().map(|(place, _)| *place).collect::<Vec<_>>(), [1, 0]);
        assert!((near.share - 1.0).abs() < 1e-9, "{near:?}");
    }

    #[test]
    fn value_a_value_out_of_range_is_none() {
        assert_eq!(found([-1.5, 0.0, 0.0], 0.0), None);
        assert!(found([-0.9, 0.0, 0.0], 0.0).is_some());
    }

    #[test]
    fn value_a_course_is_told_by_three_effects_at_most() {
        // as much of each: with four anything is told that is smooth
        let [one, two, three] = columns();
        let all = [one, two, three, column(3, |time| libm::cos(7.0 * time))];
        let count = |of: usize| {
            let course: Vec<f64> =
                (0..200).map(|row| all[..of].iter().map(|one| one.values[row]).sum()).collect();
            selected(&all, &course, &|_, _| true).map_or(0, |near| near.effects.len())
        };
        assert_eq!([1, 2, 3, 4].map(count), [1, 2, 3, 3]);
    }
}
