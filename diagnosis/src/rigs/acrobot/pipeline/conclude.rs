//! What all parts say together.

use super::correct::correct;
use super::interval;
use super::*;
use crate::diagnosis::{Effect, Gap, Member, Trace, Unknown, Verdict, Where};
use crate::overlay;
use crate::provenance::Provenance;
use crate::rigs::acrobot::candidates::{Motion, Side};
use crate::rigs::acrobot::counting::losses;
use crate::rigs::acrobot::differ::differing;
use crate::rigs::acrobot::imitation::{anything, imitation};
use crate::rigs::acrobot::rest::{drifting, torque_shape, unknown};
use crate::rigs::acrobot::selection::{ALPHA, PICTURED};
use crate::rigs::acrobot::{amend, experiment, gap, places, story};
use std::collections::BTreeMap;

#[allow(clippy::too_many_arguments)] // one stage of one workflow: a struct would only rename its locals
pub(super) fn conclude(
    data: &DataSet,
    model: &Model,
    list: &Arc<Vec<Candidate>>,
    parts: &[Part],
    point: &[f64],
    mut notices: Vec<Notice>,
    units: &UnitPath,
    watch: &mut Watch<'_>,
) -> Result<(Diagnosis, Vec<gap::Compared>), Error> {
    let (mut effects, mut swaps): (_, Vec<Swap>) = (Vec::new(), Vec::new());
    let mut smallest = BTreeMap::new();
    let mut found: Vec<(f64, Where)> = Vec::new();
    let mut gaps: Vec<Gap> = Vec::new();
    let mut rest: Option<Unknown> = None;
    let mut correction = None;
    let mut withdrawn: Vec<usize> = Vec::new();
    let mut story = Vec::new();
    let (mut traces, mut compared): (Vec<Trace>, Vec<gap::Compared>) = (Vec::new(), Vec::new());
    let doubts = doubts(model, list, parts);
    let drift = parts.iter().find_map(|part| drifting(&part.study, list));
    let runs: Vec<String> = data.runs.iter().map(|run| run.name.clone()).collect();
    for part in parts {
        let free: Vec<usize> =
            part.study.active.iter().copied().filter(|index| !list[*index].is_discrete()).collect();
        let (mut gap, of) = gap::widest(&part.study, &free, &runs, part.torque, &part.signals);
        let (own, torque) = (places::places(&part.study, &part.signals), of == gap::Compared::Torques);
        compared.push(of);
        let left = unknown(&part.study, &part.signals, list, part.torque);
        let imitated = imitation(&part.study, &part.signals, list, part.torque)
            .or_else(|| anything(&part.study, &part.signals, list, &part.classes, part.torque));
        let imitates = imitated.is_some();
        let left = left.or(imitated);
        // beside a rest without a name nobody knows what would have been found
        if left.is_none() {
            detectable(part, list, &free, &doubts, &mut smallest);
        }
        // what clocks that drift leave looks like much else
        let left = if left.is_some() { drift.clone().or(left) } else { drifting(&part.study, list) };
        let differ = (part.torque && left.is_some() && drift.is_none())
            .then(|| differing(&part.study.last, &part.study.active, list, &runs))
            .flatten();
        let left = left.map(|left| match differ {
            Some(shape) => Unknown { shape, ..left },
            None => left,
        });
        if !part.coarse.is_empty() {
            story.push(story::of_coarse(&part.coarse, list));
        }
        story.extend(story::of(&part.study, list, &gap, left.as_ref()));
        let mut trace = places::trace(&part.study, torque, &blamed(left.as_ref(), &own, torque, &part.study));
        found.extend(own);
        let widened = part.torque && gap::widened(&part.study, &free, &gap);
        if widened {
            story.push(story::of_widened(&gap));
            gap = Gap { after: gap.before, closed: Some(0.0), ..gap };
            trace.after.clone_from(&trace.before);
            withdrawn.extend(&part.study.active);
        } else {
            let imitates = left.is_some().then_some(imitates);
            for (effect, swap) in part_effects(data, part, list, &free, &doubts, imitates) {
                effects.push(effect);
                swaps.extend(swap);
            }
        }
        // a correction is fitted beside the effects, and without them would be another one
        let corrects = part.torque && left.is_some() && drift.is_none() && !widened;
        if corrects && !watch.is_over("the correction of what has no name") {
            watch.stage("a correction of what has no name");
            correction = correct(data, model, list, part, units, &mut notices);
            // measured as the effects' gap is: with it no more may be left than with effects alone
            correction = correction.filter(|correction| correction.usual <= gap.after);
            story.push(story::of_correction(correction.as_ref()));
        }
        if let Some(correction) = correction.as_ref().filter(|_| part.torque) {
            (gap, trace) = (correction.closes(&gap), correction.drawn(trace));
        }
        gaps.push(gap);
        traces.push(trace);
        rest = rest.or(left);
    }
    // a rest that no effect gives scatters, too
    let mut point = point.to_vec();
    withdrawn.iter().for_each(|index| point[*index] = list[*index].off);
    match rest {
        None => scattered(parts, list, &mut effects, &mut smallest),
        Some(_) => list
            .iter()
            .enumerate()
            .filter(|(_, candidate)| candidate.side == Side::Scatter)
            .for_each(|(index, candidate)| point[index] = candidate.off),
    }
    counted(data, model, list, &mut effects, &mut smallest);
    let gone = correction.as_ref().map_or(&[][..], |correction| correction.supersedes.as_slice());
    effects.retain(|effect| !gone.contains(&effect.name));
    story.extend(super::scale::unscaled(data, list, &mut effects));
    let amended = |index: usize| {
        if gone.iter().any(|name| name == list[index].name) { list[index].off } else { point[index] }
    };
    let point: Vec<f64> = (0..point.len()).map(amended).collect();
    if let Some(correction) = &correction {
        rest = rest.map(|left| correction.told(left));
    }
    let verdict = if rest.is_some() {
        Verdict::Unknown
    } else if effects.is_empty() {
        Verdict::None
    } else if effects.iter().any(|effect| effect.class.len() > 1) {
        Verdict::Ambiguous
    } else {
        Verdict::Named
    };
    let gap = gaps.iter().cloned().max_by(|a, b| gap::above(a).total_cmp(&gap::above(b)));
    let gap = gap.ok_or_else(|| Error::Model("no cut of the loop was compared".into()))?;
    // where a model lacks much, noise says nothing of what an experiment would tell, nor are effects asked for that a
    // correction took the place of
    let stands = |part: &&Part| part.study.active.iter().all(|index| !withdrawn.contains(index));
    let certain = parts.iter().filter(|part| !part.study.outweighed).filter(stands);
    let cuts = certain.filter(|part| !part.torque || gone.is_empty());
    let cuts = cuts.map(|part| (&part.study, part.signals.as_slice(), part.classes.as_slice()));
    watch.stage("the next experiment");
    let (next, experiment) = match watch.is_over("the next experiment") {
        true => (None, None),
        false => experiment::next(data, model, list, &point, cuts, units),
    };
    let mut point = point;
    for (own, best, x) in swaps {
        // not what a correction has withdrawn
        if point[own] != list[own].off {
            (point[own], point[best]) = (list[own].off, x);
        }
    }
    for effect in effects.iter().filter(|effect| effect.at_end) {
        story.push(story::of_end(effect));
    }
    for effect in &mut effects {
        effect.unit = model.units().get(&effect.name).cloned().unwrap_or_default();
    }
    let amended = amend::amended(data, model, list, &point, &effects, correction.as_ref(), units)?;
    // the nominal model misses noise by a little everywhere; that is no place
    if verdict == Verdict::None {
        found.clear();
    }
    let cross_validation = gaps.clone();
    let diagnosis = Diagnosis {
        provenance: Provenance::of(data),
        units: model.units().clone(),
        verdict,
        effects,
        place: places::shares(found),
        gap,
        unknown: rest,
        correction,
        next_experiment: next,
        minimum_detectable: smallest,
        gaps,
        cross_validation,
        ended_early: Vec::new(),
        notices,
        story,
        amended,
        attachments: Vec::new(),
        experiment,
        traces,
        channels: parts.iter().flat_map(|part| overlay::channels(&part.study, &part.signals, data)).collect(),
    };
    Ok((diagnosis, compared))
}

/// The signal that is blamed: of what has no name, or where the nominal model is furthest off.
fn blamed(left: Option<&Unknown>, own: &[(f64, Where)], torque: bool, study: &Study) -> String {
    let left = left.map(|left| left.signal.clone());
    match torque {
        true => left.unwrap_or_else(|| torque_shape(study, &study.nominal).0),
        false => {
            let worst = own.iter().filter(|(_, place)| place.signal.starts_with("camera."));
            let worst = worst.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, place)| place.signal.clone());
            left.or(worst).unwrap_or_default()
        }
    }
}

/// A better guess within the class of an effect: whom it replaces, by whom, at which coordinate.
type Swap = (usize, usize, f64);

fn part_effects(
    data: &DataSet,
    part: &Part,
    list: &[Candidate],
    free: &[usize],
    doubts: &[(usize, f64)],
    imitates: Option<bool>,
) -> Vec<(Effect, Option<Swap>)> {
    let errors = interval::errors(&part.study, free);
    let systematic = part.study.last.systematic(free, &part.signals);
    let worth = imitates.map(|imitates| interval::worth(&part.study, list, free, imitates));
    let worth = |index: usize| {
        let place = free.iter().position(|other| *other == index);
        let worth = worth.as_ref()?;
        // what is whole or not there at all imitates as well as others do
        Some(place.map_or(interval::Worth::LEAST, |place| worth[place]))
    };
    let error = |index: usize| {
        let place = free.iter().position(|other| *other == index)?;
        let doubt = doubt(doubts, index).hypot(doubt(&part.rough, index));
        let own = errors[place]?.hypot(systematic[place].sqrt()).hypot(doubt);
        Some(worth(index).map_or(own, |worth| (own * worth.wider).hypot(worth.moves / 1.96)))
    };
    let mut taken = part.study.active.clone();
    part.classes
        .iter()
        .map(|(index, alternatives)| {
            let x = part.study.last.point[*index];
            // a name that another effect has already says nothing of this one
            let open = |other: &&Alternative| other.candidate == *index || !taken.contains(&other.candidate);
            let alternatives: Vec<Alternative> = alternatives.iter().filter(open).cloned().collect();
            let swap = better_guess(*index, &alternatives, list).map(|best| (*index, best.candidate, best.x));
            taken.extend(swap.map(|(_, best, _)| best));
            let (name, at) = swap.map_or((*index, x), |(_, best, at)| (best, at));
            let candidate = &list[name];
            // the same share of the effect's size, whatever its name
            let share = |index: usize, x: f64| (x - list[index].off).abs();
            let known = if swap.is_some() { share(name, at) / share(*index, x).max(1e-300) } else { 1.0 };
            let error = error(*index).map(|error| known * error);
            let mut members = members(name, *index, &alternatives, list);
            let kept = worth(*index).map_or(1.0, |worth| worth.share)
                * interval::confirmed(&part.study, data, list, *index);
            members.iter_mut().for_each(|member| member.probability *= kept);
            let probability = members.iter().map(|member| member.probability).sum::<f64>().min(1.0 - ALPHA);
            let effect = Effect {
                name: candidate.name.to_owned(),
                class: members.iter().map(|member| member.name.clone()).collect(),
                value: candidate.value(at),
                ci95: interval::ci95(candidate, at, error),
                at_end: at != candidate.off && (at <= candidate.range.0 || at >= candidate.range.1),
                probability,
                members,
                phrase: candidate.phrase.to_owned(),
                unit: String::new(),
                off: candidate.value(candidate.off),
            };
            (effect, swap)
        })
        .collect()
}

/// What the log's clock leaves in doubt of a candidate.
fn doubt(doubts: &[(usize, f64)], index: usize) -> f64 {
    doubts.iter().find(|(other, _)| *other == index).map_or(0.0, |(_, doubt)| *doubt)
}

/// Loss by which another member of the class must be better to be named first.
const FIRST: f64 = 0.2;

fn better_guess<'a>(
    own: usize,
    alternatives: &'a [Alternative],
    list: &[Candidate],
) -> Option<&'a Alternative> {
    // fits in the place of a whole number are judged by the lattice
    if list[own].is_discrete() {
        return None;
    }
    // who was left out is no member any more
    let loss = alternatives.iter().find(|other| other.candidate == own).map_or(f64::INFINITY, |own| own.loss);
    alternatives.first().filter(|best| best.candidate != own && best.loss + FIRST < loss)
}

/// The class, the best guess first, the others by their probability.
fn members(first: usize, own: usize, alternatives: &[Alternative], list: &[Candidate]) -> Vec<Member> {
    let weight = |alternative: &Alternative| libm::exp(-0.5 * alternative.loss);
    let all: f64 = alternatives.iter().map(weight).sum();
    let mut members: Vec<(bool, Member)> = alternatives
        .iter()
        .filter(|other| other.candidate == first || other.loss < CLASS)
        .map(|other| {
            let name = list[other.candidate].name.to_owned();
            let probability = (weight(other) / all).min(1.0 - ALPHA);
            (other.candidate != first, Member { name, probability })
        })
        .collect();
    if members.is_empty() {
        members.push((false, Member { name: list[own].name.to_owned(), probability: 1.0 - ALPHA }));
    }
    members.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.probability.total_cmp(&a.1.probability)));
    members.into_iter().map(|(_, member)| member).collect()
}

/// Smallest size that would have been found, for each candidate of a part.
fn detectable(
    part: &Part,
    list: &[Candidate],
    free: &[usize],
    doubts: &[(usize, f64)],
    into: &mut BTreeMap<String, f64>,
) {
    let threshold = part.study.screen.null.threshold(ALPHA);
    let last = &part.study.last;
    let covariance = last.covariance(free);
    let differs = last.systematic_beside(free, &part.signals);
    for index in &part.study.seen {
        let candidate = &list[*index];
        if candidate.side.is_of_log() {
            continue;
        }
        let size = if let Some(place) = free.iter().position(|other| other == index) {
            covariance.as_ref().map(|covariance| threshold * covariance[(place, place)].sqrt())
        } else {
            let columns = last.probes.iter().zip(&part.study.screen.errors).zip(&differs);
            let own = columns.filter(|((probe, error), _)| probe.candidate == *index && error.is_finite());
            // what a picture shows must be more than honest renderers differ by
            let own = own.map(|((probe, error), differs)| match candidate.side {
                Side::Camera => (probe, error.max(PICTURED * error.hypot(*differs) / threshold)),
                _ => (probe, *error),
            });
            match candidate.motion {
                // a tangent says nothing of a ceiling: it has none above the largest torque
                Motion::Ceiling { .. } => own
                    .filter(|(probe, error)| probe.by.abs() >= threshold * error)
                    .map(|(probe, _)| probe.by.abs())
                    .min_by(f64::total_cmp)
                    .map(|by| 1.0 / by),
                _ => own.map(|(_, error)| threshold * error).min_by(f64::total_cmp),
            }
        };
        // a smaller one is taken for the log's clock
        let size = size.map(|size| size.max(MISSES * doubt(doubts, *index).hypot(size / threshold)));
        let size = match (candidate.is_discrete(), size) {
            (true, Some(size)) if matches!(candidate.motion, Motion::Count { .. }) => {
                Some(size.ceil().max(1.0))
            }
            (true, Some(size)) => (size <= 1.0).then_some(1.0),
            (_, size) => size,
        };
        if let Some(size) = size.filter(|size| size.is_finite() && *size > 0.0) {
            into.insert(candidate.name.to_owned(), size);
        }
    }
}

/// The sensor's noise, where the picture scatters as no nominal sensor does.
fn scattered(
    parts: &[Part],
    list: &[Candidate],
    effects: &mut Vec<Effect>,
    smallest: &mut BTreeMap<String, f64>,
) {
    let Some(candidate) = list.iter().find(|candidate| candidate.side == Side::Scatter) else { return };
    for noise in parts.iter().filter_map(|part| part.noise) {
        smallest.insert(candidate.name.to_owned(), noise.detectable);
        if noise.clear {
            let ci95 = [(noise.value - 1.96 * noise.error).max(0.0), noise.value + 1.96 * noise.error];
            effects.push(Effect::alone(candidate, noise.value, ci95, 1.0 - ALPHA));
        }
    }
}

fn counted(
    data: &DataSet,
    model: &Model,
    list: &[Candidate],
    effects: &mut Vec<Effect>,
    smallest: &mut BTreeMap<String, f64>,
) {
    let Some(candidate) = list.iter().find(|candidate| candidate.is(Attribute::LostFrames)) else { return };
    let Some(losses) = losses(data, 1.0 / model.frame_rate()) else { return };
    let (share, ci95) = losses.share();
    // one frame that isn't there is proof against "none is ever lost"; two are asked for
    smallest.insert(candidate.name.to_owned(), candidate.off + 6.0 / losses.expected);
    let outside = candidate.off < ci95[0] || candidate.off > ci95[1];
    if outside && losses.lost >= 2.0 {
        effects.push(Effect::alone(candidate, share, ci95, 1.0 - ALPHA));
    }
}
