//! Names that windows hardly tell apart: what linked states say of them, where the model follows the log to within noise.
//!
//! A window's free start state takes what two effects differ by where that is slow: a balanced arm leans into a drag for seconds.
//! Linked states lose none of it. Each is fitted in the place of the effect, and the deviance decides.

use super::policy::LINKED;
use super::{Linked, is_quiet};
use crate::error::Error;
use crate::infer::Fit;
use crate::infer::Sizes;
use crate::infer::fit::At;
use crate::rigs::acrobot::candidates::{Candidate, Side};
use crate::rigs::acrobot::dataset::DataSet;
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::residual::Signal;
use crate::rigs::acrobot::selection::{Alternative, Study};
use crate::watch::Watch;

/// Judges the plant's classes that are open, each from where the study ended.
pub fn weigh_linked_classes(
    data: &DataSet,
    model: &Model,
    list: &[Candidate],
    (study, signals): (&Study, &[Signal]),
    classes: &mut [(usize, Vec<Alternative>)],
    watch: &mut Watch<'_>,
) {
    // a log's clock that is off is no parameter of the unit, and moves with each delay
    let late = study.active.iter().any(|index| list[*index].side == Side::Clock);
    if study.discrepancy_dominated
        || late
        || !classes.iter().any(|(effect, class)| is_open(*effect, class, list))
    {
        return;
    }
    watch.stage("plant: names that look alike, with linked states");
    // a log that can't be linked says nothing, and must not end a diagnosis that stands without it
    let sigma = |name: &str| {
        let place = signals.iter().position(|signal| signal.name.strip_prefix("plant.") == Some(name))?;
        study.last.sigmas.get(place).copied()
    };
    let linked = Linked::of(data, model, list, &study.last.point, &sigma);
    let Ok(Some(mut linked)) = linked else { return };
    let Ok((start, _)) = linked.first_path(&study.last.point, &[]) else { return };
    for (effect, class) in classes.iter_mut().filter(|(effect, class)| is_open(*effect, class, list)) {
        if watch.is_over("the comparison of names that look alike") {
            return;
        }
        if let Some(told) = judge_class(&linked, list, study, (*effect, class), &start, watch) {
            *class = told;
        }
    }
}

/// The class with the deviances of linked fits; nothing where even the best of them lacks something.
fn judge_class(
    linked: &Linked<'_>,
    list: &[Candidate],
    study: &Study,
    (effect, class): (usize, &[Alternative]),
    start: &At,
    watch: &mut Watch<'_>,
) -> Option<Vec<Alternative>> {
    let asked: Vec<&Alternative> = class.iter().filter(|other| is_asked(effect, other, list)).collect();
    let sizes = &linked.built.sizes;
    let fit_member = |other: &Alternative, start: &At, sizes: Option<&Sizes>| {
        let fitted = fit_in_place(linked, list, study, (effect, other), start, sizes);
        // one that can't be run, or comes to no end, is judged by windows alone
        fitted.ok().filter(|fit| fit.rounds < super::OPTIONS.rounds)
    };
    let mut best = asked.iter().position(|other| other.candidate == effect)?;
    let mut fits: Vec<(usize, Fit)> = Vec::new();
    // once more where another member turns out to be the best one
    for _ in 0..2 {
        let own = fit_member(asked[best], start, Some(sizes))?;
        // process noise that a wrong member needs must not take what tells it from the right one
        let held = own.at.clone();
        fits = vec![(best, own)];
        for (place, other) in asked.iter().enumerate().filter(|(place, _)| *place != best) {
            watch.trying(list[other.candidate].name, place + 1, asked.len());
            fits.extend(fit_member(other, &held, None).map(|fit| (place, fit)));
        }
        let least = fits.iter().min_by(|a, b| a.1.deviance.total_cmp(&b.1.deviance))?.0;
        if std::mem::replace(&mut best, least) == least {
            break;
        }
    }
    if !is_quiet(&fits.first()?.1, sizes) {
        return None;
    }
    let least = fits.iter().map(|(_, fit)| fit.deviance).fold(f64::INFINITY, f64::min);
    let loss = |other: &Alternative| {
        let own = fits.iter().find(|(place, _)| asked[*place].candidate == other.candidate);
        own.map_or(other.loss, |(_, fit)| fit.deviance - least)
    };
    let mut told: Vec<Alternative> =
        class.iter().map(|other| Alternative { loss: loss(other), ..other.clone() }).collect();
    told.sort_by(|a, b| a.loss.total_cmp(&b.loss));
    Some(told)
}

/// A member fitted in the place of the effect.
fn fit_in_place(
    linked: &Linked<'_>,
    list: &[Candidate],
    study: &Study,
    (effect, member): (usize, &Alternative),
    start: &At,
    sizes: Option<&Sizes>,
) -> Result<Fit, Error> {
    let mut point = study.last.point.clone();
    point[effect] = list[effect].off;
    point[member.candidate] = if member.candidate == effect { study.last.point[effect] } else { member.x };
    let replaced = |index: &usize| if *index == effect { member.candidate } else { *index };
    let free: Vec<usize> = study.active.iter().map(replaced).collect();
    linked.fitted(start, &point, &free, sizes)
}

/// Whether linked states are asked of a member: a plant's, and not far from the best.
fn is_asked(effect: usize, other: &Alternative, list: &[Candidate]) -> bool {
    (other.candidate == effect || other.loss < LINKED.near) && list[other.candidate].side == Side::Plant
}

/// Whether there is another parameter of the plant that is not far from the effect.
fn is_open(effect: usize, class: &[Alternative], list: &[Candidate]) -> bool {
    list[effect].side == Side::Plant && class.iter().filter(|other| is_asked(effect, other, list)).count() > 1
}
