//! Names that windows hardly tell apart: what linked states say of them, where the model follows the log to within noise.
//!
//! A window's free start state takes what two effects differ by where that is slow: a balanced arm leans into a drag for seconds.
//! Linked states lose none of it. Each is fitted in the place of the effect, and the deviance decides.

use super::policy::LINKED;
use super::{LinkedFit, is_quiet};
use crate::infer::Fit;
use crate::infer::Sizes;
use crate::infer::fit::At;
use crate::rigs::acrobot::candidates::{Candidate, Side};
use crate::rigs::acrobot::dataset::DataSet;
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::selection::{Alternative, Study};
use crate::watch::Watch;
use std::sync::Arc;

/// Judges the plant's classes that are open, each from where the study ended; and the fit of the study's effects there, where one was needed.
pub fn weigh_linked_classes(
    data: &DataSet,
    model: &Model,
    list: &Arc<Vec<Candidate>>,
    (study, signals): (&Study, &[Signal]),
    classes: &mut [(usize, Vec<Alternative>)],
    watch: &mut Watch<'_>,
) -> Option<LinkedFit> {
    // a log's clock that is off is no parameter of the unit, and moves with each delay
    let late = study.active.iter().any(|index| list[*index].side == Side::Clock);
    if study.discrepancy_dominated
        || late
        || !classes.iter().any(|(effect, class)| is_open(*effect, class, list))
    {
        return None;
    }
    watch.stage("plant: names that look alike, with linked states");
    // a log that can't be linked says nothing, and must not end a diagnosis that stands without it
    let own = LinkedFit::of(data, model, list, (study, signals)).ok()??;
    for (effect, class) in classes.iter_mut().filter(|(effect, class)| is_open(*effect, class, list)) {
        if watch.is_over("the comparison of names that look alike") {
            break;
        }
        if let Some(told) = judge_class(&own, list, (*effect, class), watch) {
            *class = told;
        }
    }
    Some(own)
}

/// The class with the deviances of linked fits; nothing where even the best of them lacks something. `own` is the fit with the effect itself.
fn judge_class(
    own: &LinkedFit,
    list: &[Candidate],
    (effect, class): (usize, &[Alternative]),
    watch: &mut Watch<'_>,
) -> Option<Vec<Alternative>> {
    let asked: Vec<&Alternative> = class.iter().filter(|other| is_asked(effect, other, list)).collect();
    let sizes = &own.linked.built.sizes;
    let members = Members { own, list, effect, asked: &asked };
    let mut best = asked.iter().position(|other| other.candidate == effect)?;
    let mut fits: Vec<Option<Fit>> = vec![None; asked.len()];
    let mut quiet = false;
    // once more where another member turns out to be the best one
    for _ in 0..2 {
        let sized = match &fits[best] {
            None => Some(own.fit.clone()).filter(has_ended),
            Some(fit) => members.fitted(best, &fit.at, Some(sizes)),
        }?;
        // process noise that a wrong member needs must not take what tells it from the right one
        let held = sized.at.noise.clone();
        quiet = is_quiet(&sized, sizes);
        fits[best] = Some(sized);
        for (place, other) in asked.iter().enumerate().filter(|(place, _)| *place != best) {
            watch.trying(list[other.candidate].name, place + 1, asked.len());
            let known = fits[place].take().map_or_else(|| members.start(place), |fit| fit.at);
            fits[place] = members.fitted(place, &At { noise: held.clone(), ..known }, None);
        }
        let deviance = |place: &usize| fits[*place].as_ref().map_or(f64::INFINITY, |fit| fit.deviance);
        let least = (0..fits.len()).min_by(|a, b| deviance(a).total_cmp(&deviance(b)))?;
        if std::mem::replace(&mut best, least) == least {
            break;
        }
    }
    quiet.then(|| told(class, &asked, &fits))
}

/// A class with the losses of the members that were fitted.
fn told(class: &[Alternative], asked: &[&Alternative], fits: &[Option<Fit>]) -> Vec<Alternative> {
    let fitted =
        || asked.iter().zip(fits).filter_map(|(other, fit)| Some((other.candidate, fit.as_ref()?.deviance)));
    let least = fitted().map(|(_, deviance)| deviance).fold(f64::INFINITY, f64::min);
    let loss = |other: &Alternative| {
        let own = fitted().find(|(candidate, _)| *candidate == other.candidate);
        own.map_or(other.loss, |(_, deviance)| deviance - least)
    };
    let mut told: Vec<Alternative> =
        class.iter().map(|other| Alternative { loss: loss(other), ..other.clone() }).collect();
    told.sort_by(|a, b| a.loss.total_cmp(&b.loss));
    told
}

/// Whether a fit came to an end: one that doesn't is judged by windows alone.
fn has_ended(fit: &Fit) -> bool {
    fit.rounds < super::OPTIONS.rounds
}

/// The members of a class, each in the place of its effect.
struct Members<'a> {
    own: &'a LinkedFit,
    list: &'a [Candidate],
    effect: usize,
    asked: &'a [&'a Alternative],
}

impl Members<'_> {
    /// Where a member begins: at its own value, the path and the noises those of the effect.
    fn start(&self, place: usize) -> At {
        let (own, member) = (self.own, self.asked[place]);
        let mut point = own.point.clone();
        point[self.effect] = self.list[self.effect].off;
        point[member.candidate] = member.x;
        At { theta: own.linked.theta(&point), ..own.fit.at.clone() }
    }

    /// A member fitted, with all that is beside it; nothing where it can't be run, or comes to no end.
    fn fitted(&self, place: usize, start: &At, sizes: Option<&Sizes>) -> Option<Fit> {
        let member = self.asked[place].candidate;
        let replaced = |index: &usize| if *index == self.effect { member } else { *index };
        let free: Vec<usize> = self.own.active.iter().map(replaced).collect();
        self.own.linked.fitted(start, &free, sizes).ok().filter(has_ended)
    }
}

/// Whether linked states are asked of a member: a plant's, and not far from the best.
fn is_asked(effect: usize, other: &Alternative, list: &[Candidate]) -> bool {
    (other.candidate == effect || other.loss < LINKED.near) && list[other.candidate].side == Side::Plant
}

/// Whether there is another parameter of the plant that is not far from the effect.
fn is_open(effect: usize, class: &[Alternative], list: &[Candidate]) -> bool {
    list[effect].side == Side::Plant && class.iter().filter(|other| is_asked(effect, other, list)).count() > 1
}
