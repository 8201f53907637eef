//! The effects of a cut, with their classes, values and intervals.

use super::interval;
use super::zeros::Shared;
use super::*;
use crate::diagnosis::{Effect, Member};
use crate::rigs::acrobot::pipeline::policy::PIPELINE;
use crate::statistics::levels::WITHIN;

/// A better guess within the class of an effect: whom it replaces, by whom, at which coordinate.
pub(super) type Swap = (usize, usize, f64);

pub(super) fn part_effects(
    data: &DataSet,
    part: &Part,
    list: &[Candidate],
    free: &[usize],
    doubts: &[(usize, f64)],
    confounded: Option<bool>,
    early: bool,
) -> Vec<(Effect, Option<Swap>)> {
    let errors = interval::errors(&part.study, free);
    let systematic = part.study.last.systematic(free, &part.signals);
    let worth = confounded.map(|confounded| interval::worth(&part.study, list, free, confounded));
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
        Some(worth(index).map_or(own, |worth| (own * worth.wider).hypot(worth.moves / WITHIN)))
    };
    let whole = |index: usize| part.whole.iter().find(|whole| whole.candidate == index);
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
                * interval::confirmed(&part.study, data, list, *index)
                * doubted(&part.shared, *index, early);
            members.iter_mut().for_each(|member| member.probability *= kept);
            let probability =
                members.iter().map(|member| member.probability).sum::<f64>().min(1.0 - SELECTION.alpha);
            let ci95 = whole(name).map_or_else(|| interval::ci95(candidate, at, error), |whole| whole.ends);
            let effect = Effect {
                name: candidate.name.to_owned(),
                class: members.iter().map(|member| member.name.clone()).collect(),
                value: candidate.value(at),
                ci95,
                at_end: whole(name).map_or_else(|| candidate.ends_at(at), |whole| whole.beyond),
                unbounded: interval::is_open(candidate, ci95),
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

/// The share of its certainty that a name keeps beside zeros that explain as much, and where time was up `early`: then who else might
/// have its place was not asked.
fn doubted(shared: &[Shared], index: usize, early: bool) -> f64 {
    let zeros: f64 = shared.iter().filter(|one| one.effect == index).map(|one| one.share).product();
    if early { zeros * PIPELINE.beside } else { zeros }
}

/// What the log's clock leaves in doubt of a candidate.
pub(super) fn doubt(doubts: &[(usize, f64)], index: usize) -> f64 {
    doubts.iter().find(|(other, _)| *other == index).map_or(0.0, |(_, doubt)| *doubt)
}

/// Who is to be named first, if it isn't the effect itself.
pub(super) fn better_guess<'a>(
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
    alternatives.first().filter(|best| best.candidate != own && best.loss + PIPELINE.first < loss)
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
            let probability = (weight(other) / all).min(1.0 - SELECTION.alpha);
            (other.candidate != first, Member { name, probability })
        })
        .collect();
    if members.is_empty() {
        members.push((false, Member { name: list[own].name.to_owned(), probability: 1.0 - SELECTION.alpha }));
    }
    members.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.probability.total_cmp(&a.1.probability)));
    members.into_iter().map(|(_, member)| member).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::selection::examples::candidate;

    fn class(best: f64, own: f64) -> [Alternative; 2] {
        [(1, best), (0, own)].map(|(candidate, loss)| Alternative { candidate, x: 1.0, loss })
    }

    #[test]
    fn value_a_member_is_named_first_that_is_better_by_more_than_a_third_or_so() {
        let list = [candidate(Side::Plant, false), candidate(Side::Plant, false)];
        let better = |loss: f64| better_guess(0, &class(0.0, loss), &list).map(|best| best.candidate);
        // 0.3
        assert_eq!([0.27, 0.33].map(better), [None, Some(1)]);
    }

    #[test]
    fn value_who_loses_more_than_six_is_no_member() {
        let list = [candidate(Side::Plant, false), candidate(Side::Plant, false)];
        let count = |loss: f64| members(1, 0, &class(0.0, loss), &list).len();
        assert_eq!([5.5, 6.5].map(count), [2, 1]);
        // e^(-loss/2) of the whole: odds of 1 to 20
        let last = members(1, 0, &class(0.0, 5.999), &list)[1].probability;
        assert!((last - 1.0 / 21.0).abs() < 1e-3, "{last}");
    }
}
