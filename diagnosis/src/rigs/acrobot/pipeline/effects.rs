//! The effects of a cut, with their classes, values and intervals.

use super::Rig;
use super::compare::Part;
use super::encoder_zeros::Shared;
use super::intervals::{Worth, ci95, confirmed, is_open, standard_errors, worths};
use super::policy::PIPELINE;
use crate::diagnosis::{Effect, Member};
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::rigs::acrobot::selection::{Alternative, CLASS};
use crate::statistics::levels::{DOUBTED, WITHIN};
use nalgebra::DVector;

/// A better guess within the class of an effect.
#[derive(Debug, Clone, Copy)]
pub(super) struct Alternates {
    /// The candidate that was found.
    pub(super) found: usize,
    /// The candidate that is named in its place, and its coordinate.
    pub(super) named: usize,
    pub(super) x: f64,
}

/// What the effects of a cut are told from.
pub(super) struct PartEffects<'a> {
    rig: &'a Rig<'a>,
    part: &'a Part,
    /// The active candidates that are continuous; what follows has an entry for each.
    free: &'a [usize],
    /// Standard errors of their coordinates, beside noise alone.
    errors: Vec<Option<f64>>,
    /// Variances of their coordinates by what right renderers differ by.
    systematic: DVector<f64>,
    /// The same by another light than the nominal one; `None` in that one.
    unlit: Option<DVector<f64>>,
    /// What their names are worth beside a residual that has none; `None` where there is no such residual.
    worths: Option<Vec<Worth>>,
    /// Candidates that the log's clock leaves in doubt, and the standard deviation of their coordinate by it.
    doubts: &'a [(usize, f64)],
    /// Time was up before all had been asked.
    early: bool,
}

impl<'a> PartEffects<'a> {
    /// `confounded` says, beside a residual without a name, whether names only stand for something else.
    pub(super) fn new(
        rig: &'a Rig<'a>,
        part: &'a Part,
        free: &'a [usize],
        doubts: &'a [(usize, f64)],
        confounded: Option<bool>,
        early: bool,
    ) -> Self {
        let errors = standard_errors(&part.study, free);
        let systematic = part.study.last.systematic(free, &part.signals);
        let larger = part.noise.filter(|noise| !noise.is_lit()).map(|noise| noise.larger);
        let unlit = larger.map(|larger| part.study.last.systematic_unlit(free, &part.signals, larger));
        let worths = confounded.map(|confounded| worths(&part.study, &rig.list, free, confounded));
        Self { rig, part, free, errors, systematic, unlit, worths, doubts, early }
    }

    /// Each effect, and the candidate that is named in its place if another one is.
    pub(super) fn effects(&self) -> Vec<(Effect, Option<Alternates>)> {
        let mut taken = self.part.study.active.clone();
        let mut all = Vec::new();
        for (found, class) in &self.part.classes {
            // a name that another effect has already says nothing of this one
            let open = |other: &&Alternative| other.candidate == *found || !taken.contains(&other.candidate);
            let class: Vec<Alternative> = class.iter().filter(open).cloned().collect();
            let best = better_guess(*found, &class, &self.rig.list);
            let alternates = best.map(|best| Alternates { found: *found, named: best.candidate, x: best.x });
            taken.extend(alternates.map(|alternates| alternates.named));
            all.push((self.effect(*found, alternates, &class), alternates));
        }
        all
    }

    /// One effect with its class, by the name of the better guess where there is one.
    fn effect(&self, found: usize, alternates: Option<Alternates>, class: &[Alternative]) -> Effect {
        let list = &self.rig.list;
        let x = self.part.study.last.point[found];
        let (name, at) = alternates.map_or((found, x), |other| (other.named, other.x));
        let candidate = &list[name];
        // the same share of the effect's size, whatever its name
        let size = |index: usize, x: f64| (x - list[index].off).abs();
        let share = if alternates.is_some() { size(name, at) / size(found, x).max(1e-300) } else { 1.0 };
        let error = self.standard_error(found).map(|error| share * error);
        let mut members = members(name, found, class, list);
        let kept = self.share_of_certainty(found);
        members.iter_mut().for_each(|member| member.probability *= kept);
        let probability = members.iter().map(|member| member.probability).sum::<f64>();
        let integer = self.part.integers.iter().find(|integer| integer.candidate == name);
        let ci95 = integer.map_or_else(|| ci95(candidate, at, error), |integer| integer.ends);
        Effect {
            name: candidate.name.to_owned(),
            class: members.iter().map(|member| member.name.clone()).collect(),
            value: candidate.value(at),
            ci95,
            at_end: integer.map_or_else(|| candidate.ends_at(at), |integer| integer.beyond),
            unbounded: is_open(candidate, ci95),
            probability: probability.min(1.0 - SELECTION.alpha),
            members,
            phrase: candidate.phrase.to_owned(),
            unit: String::new(),
            off: candidate.value(candidate.off),
        }
    }

    /// Where a candidate stands among the continuous ones.
    fn place(&self, index: usize) -> Option<usize> {
        self.free.iter().position(|other| *other == index)
    }

    /// What a name is worth beside a residual without one; `None` where there is no such residual.
    fn worth(&self, index: usize) -> Option<Worth> {
        let worths = self.worths.as_ref()?;
        // what is an integer or not there at all imitates as well as others do
        Some(self.place(index).map_or(Worth::LEAST, |place| worths[place]))
    }

    /// The standard error of a continuous effect's coordinate, with all that it is in doubt by.
    fn standard_error(&self, index: usize) -> Option<f64> {
        let place = self.place(index)?;
        let doubt = doubt_of(self.doubts, index).hypot(doubt_of(&self.part.rough, index));
        let simulated = self.systematic[place].sqrt().hypot(self.by_light(index));
        let own = self.errors[place]?.hypot(simulated).hypot(doubt);
        Some(self.worth(index).map_or(own, |worth| (own * worth.wider).hypot(worth.moves / WITHIN)))
    }

    /// The share of its certainty that a name keeps.
    fn share_of_certainty(&self, index: usize) -> f64 {
        self.worth(index).map_or(1.0, |worth| worth.share)
            * confirmed(&self.part.study, &self.rig.data, &self.rig.list, index)
            * share_beside_zeros(&self.part.shared, index, self.early)
            * share_in_light(
                self.part.study.last.point[index] - self.rig.list[index].off,
                self.by_light(index),
            )
    }

    /// The standard deviation of a coordinate by another light than the nominal one, 0 in that one.
    fn by_light(&self, index: usize) -> f64 {
        self.unlit.as_ref().zip(self.place(index)).map_or(0.0, |(unlit, place)| unlit[place].sqrt())
    }
}

/// The share of its certainty that a name of this size keeps, where another light than the nominal one, which makes so much of it, may be
/// all that it stands for.
fn share_in_light(size: f64, light: f64) -> f64 {
    if size.abs() < DOUBTED * light { PIPELINE.half_asked } else { 1.0 }
}

/// The share of its certainty that a name keeps beside zeros that explain as much, and where time was up `early`: then who else might
/// have its place was not asked.
fn share_beside_zeros(shared: &[Shared], index: usize, early: bool) -> f64 {
    let zeros: f64 = shared.iter().filter(|one| one.effect == index).map(|one| one.share).product();
    if early { zeros * PIPELINE.half_asked } else { zeros }
}

/// The standard deviation by which a candidate's coordinate is in doubt, 0 where it isn't.
pub(super) fn doubt_of(doubts: &[(usize, f64)], index: usize) -> f64 {
    doubts.iter().find(|(other, _)| *other == index).map_or(0.0, |(_, doubt)| *doubt)
}

/// The member that is to be named first, if it isn't the effect itself.
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
    use crate::rigs::acrobot::candidates::Side;
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
    fn value_a_name_keeps_half_within_three_standard_deviations_of_another_light() {
        let kept = [(-2.9, 1.0), (3.1, 1.0), (1e-6, 0.0)].map(|(size, light)| share_in_light(size, light));
        assert_eq!(kept, [0.5, 1.0, 1.0]);
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
