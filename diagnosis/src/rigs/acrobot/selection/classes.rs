//! What else could it be: every other candidate in an effect's place, fitted, and compared.
//!
//! Nothing here is a table of look-alikes. A candidate belongs to the class of an effect when the data, with
//! everything else fitted again, can't tell the two: their difference in deviance is what noise does.

mod through_delay;

use super::Step;
use super::column_loss::{Replaced, allowed_loss, linear_loss, predicted_loss, tolerance};
use super::evaluation::Evaluation;
use super::refit::{own_fit, refit, refit_towards, settled};
use super::start_points::starts;
use super::without_effect::WithoutEffect;
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Attribute, Candidate, Motion, Side, continuous};
use crate::rigs::acrobot::residual::{Nuisances, Perturbation, Tracked};
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::statistics::linear::submatrix;
use crate::watch::Watch;
use nalgebra::DMatrix;

/// Half the predicted loss beyond which an alternative isn't even fitted: at 24, noise (a standard deviation of 2 √24)
/// hardly brings it below `CLASS`.
pub const HOPELESS: f64 = 2.0 * CLASS;
/// Loss up to which the data can't tell: odds of 1 to 20. Two candidates that data tell apart by x standard deviations lose
/// x² ± 2x; the wrong one is left alone where that comes out below -6, at most once in 140 (below -3.2, once in 27).
pub const CLASS: f64 = 6.0;

/// What ends early where time is up.
const CLASSES: &str = "the comparison of names that look alike";

/// A candidate in the place of another.
#[derive(Debug, Clone, PartialEq)]
pub struct Alternative {
    /// Index of the candidate.
    pub candidate: usize,
    /// Its coordinate there.
    pub x: f64,
    /// How much worse than the best, in effective deviance.
    pub loss: f64,
}

/// An effect of a model, of which is asked what else it could be.
#[derive(Clone, Copy)]
pub struct Questioned<'a> {
    /// All candidates.
    pub candidates: &'a [Candidate],
    /// The model with all its effects.
    pub last: &'a Evaluation,
    /// Its effects.
    pub active: &'a [usize],
    /// The one that is asked of.
    pub effect: usize,
    /// The steps of the search so far.
    pub steps: &'a [Step],
}

impl Questioned<'_> {
    /// The effects beside it.
    fn others(&self) -> Vec<usize> {
        self.active.iter().copied().filter(|index| *index != self.effect).collect()
    }

    /// Whether another candidate may be asked for in its place.
    fn is_open_to(&self, cut: &Tracked, index: usize) -> bool {
        let candidate = &self.candidates[index];
        !self.active.contains(&index)
            && cut.sees(candidate)
            && !candidate.side.is_of_log()
            && (!self.candidates[self.effect].is_discrete() || resembled(self.steps, self.effect, index))
    }
}

/// All that could stand in the place of an effect, the best first (the effect itself included, at loss ≥ 0).
///
/// # Errors
/// A unit failed at the final model.
pub fn alternatives(
    cut: &mut Tracked,
    asked: &Questioned<'_>,
    watch: &mut Watch<'_>,
) -> Result<Vec<Alternative>, Error> {
    let Questioned { candidates, last, active, effect, .. } = *asked;
    let (x, deviance) = own_fit(cut, asked)?;
    let own = OwnFit {
        unseen: cut.unseen,
        nuisances: cut.nuisances.clone(),
        candidates,
        last,
        others: asked.others(),
        effect,
        temper: temper(last, active, effect, candidates),
        offsets: if cut.policy().lattice { last.offsets(cut.signals()) } else { DMatrix::zeros(0, 0) },
        deviance,
    };
    let mut all = vec![(effect, x, 0.0)];
    all.extend(weigh_others(cut, asked, &own, watch)?);
    cut.restore(&own.nuisances);
    let lowest = all.iter().map(|(_, _, loss)| *loss).fold(f64::INFINITY, f64::min);
    let mut alternatives: Vec<Alternative> = all
        .into_iter()
        .map(|(candidate, x, loss)| Alternative { candidate, x, loss: (loss - lowest) / own.temper })
        .collect();
    alternatives.sort_by(|a, b| a.loss.total_cmp(&b.loss));
    Ok(alternatives)
}

/// Candidate, coordinate and loss in deviance of each that isn't too far from the effect: by its column where that tells, else fitted.
fn weigh_others(
    cut: &mut Tracked,
    asked: &Questioned<'_>,
    own: &OwnFit<'_>,
    watch: &mut Watch<'_>,
) -> Result<Vec<(usize, f64, f64)>, Error> {
    let Questioned { candidates, last, effect, .. } = *asked;
    let mut all = Vec::new();
    let mut without: Option<WithoutEffect> = None;
    for (index, candidate) in candidates.iter().enumerate() {
        if !asked.is_open_to(cut, index) {
            continue;
        }
        if watch.is_over(CLASSES) {
            break;
        }
        watch.trying(candidate.name, index + 1, candidates.len());
        let linear = linear_loss(last, &own.others, effect, index, candidates);
        let Some(strength) = own.near(index, linear.as_ref()) else { continue };
        if let Some(replaced) = linear.filter(|_| by_columns(cut, candidates, effect, index)) {
            let loss = own.loss_by_columns(cut, index, &replaced, strength);
            let through = if loss <= CLASS * own.temper { own.loss_through_delay(cut, index)? } else { None };
            all.push((index, replaced.x, through.map_or(loss, |through| loss.max(through))));
            continue;
        }
        let without = match &mut without {
            Some(known) => known,
            none => none.insert(WithoutEffect::of(cut, candidates, last, &own.others, effect)?),
        };
        if !without.is_hopeless(effect, index, own.temper) {
            all.extend(own.fit_instead(cut, index)?);
        }
    }
    Ok(all)
}

/// The fit of an effect, against which others in its place are weighed.
struct OwnFit<'a> {
    candidates: &'a [Candidate],
    last: &'a Evaluation,
    /// The effects beside it.
    others: Vec<usize>,
    effect: usize,
    /// By how much the likelihood overstates.
    temper: f64,
    /// How each column answers to what right renderers differ by, a column for each such error.
    offsets: DMatrix<f64>,
    deviance: f64,
    nuisances: Nuisances,
    /// Frames in which the data show what the model's camera didn't find.
    unseen: usize,
}

impl OwnFit<'_> {
    /// What the effect explains, unless another is too far from it to be fitted.
    fn near(&self, index: usize, linear: Option<&Replaced>) -> Option<f64> {
        let (predicted, strength) =
            predicted_loss(self.last, &self.others, self.effect, index, self.candidates)?;
        let bent = [self.effect, index].iter().any(|index| blurs(&self.candidates[*index]));
        let alike = if bent { SELECTION.alike_bent } else { SELECTION.classes_alike };
        let apart = predicted / self.temper > HOPELESS && predicted > alike * strength;
        let hopeless = linear.is_none_or(|linear| linear.loss / self.temper > 2.0 * HOPELESS);
        (!apart || !hopeless).then_some(strength)
    }

    /// Loss by another's column, less what is not known of columns. What is nonlinear in its size is believed only if seen from either fit.
    fn loss_by_columns(&self, cut: &mut Tracked, index: usize, replaced: &Replaced, strength: f64) -> f64 {
        let bent = self.candidates[self.effect].nonlinear || self.candidates[index].nonlinear;
        let tolerance = tolerance(self.last, &self.offsets, &self.others, replaced.own, replaced.other);
        let allowed = |loss: f64| allowed_loss(loss, tolerance, strength, bent);
        let loss = allowed(replaced.loss);
        // a column over another step than the one it asks for says nothing of what is nonlinear in its size
        let blurs = blurs(&self.candidates[index]);
        if !bent || (loss <= CLASS * self.temper && !blurs) {
            return loss;
        }
        let from = Place { others: &self.others, effect: index, x: replaced.x };
        // where the unit shows nothing at all there is nothing to be seen from
        let Ok(there) = seen_from(cut, self.candidates, self.last, &from, self.effect) else { return loss };
        let lost = self.lost(cut);
        let there = there.map_or(0.0, |gain| gain.max(0.0)) + lost;
        if blurs { allowed(there).max(lost) } else { loss.min(there) }
    }

    /// What frames weigh that the camera lost at the last linearisation, and the data have.
    fn lost(&self, cut: &Tracked) -> f64 {
        SELECTION.unseen * cut.unseen.saturating_sub(self.unseen) as f64
    }

    /// Fits another through the units: candidate, coordinate and loss.
    fn fit_instead(&self, cut: &mut Tracked, index: usize) -> Result<Option<(usize, f64, f64)>, Error> {
        let fitted = self.fitted_instead(cut, index)?;
        Ok(fitted.map(|(fit, loss)| (index, fit.point[index], loss)))
    }

    /// The fit of another in the place of the effect, and its loss; nothing where it comes out at none.
    fn fitted_instead(&self, cut: &mut Tracked, index: usize) -> Result<Option<(Evaluation, f64)>, Error> {
        let candidate = &self.candidates[index];
        cut.restore(&self.nuisances);
        let mut set = self.others.clone();
        set.push(index);
        let mut best: Option<Evaluation> = None;
        let enough = self.deviance + self.temper * SELECTION.classes_far;
        for x in starts(candidate, self.last, self.effect, index, self.candidates) {
            let mut point = self.last.point.clone();
            point[self.effect] = self.candidates[self.effect].off;
            point[index] = x;
            if let Ok(fit) = refit_towards(cut, self.candidates, &point, &set, enough)
                && best.as_ref().is_none_or(|known| fit.deviance() < known.deviance())
            {
                best = Some(fit);
            }
        }
        let Some(fit) = best.filter(|fit| fit.point[index] != candidate.off) else { return Ok(None) };
        let fit = if fit.deviance() > enough { fit } else { settled(cut, fit)? };
        let lost = match cut.policy().lattice {
            true => Evaluation::chord(cut, &fit.point, &[]).map_or(0.0, |_| self.lost(cut)),
            false => 0.0,
        };
        let loss = fit.deviance() - self.deviance + lost;
        Ok(Some((fit, loss)))
    }
}

/// Whether a candidate's image changes otherwise with each step.
fn blurs(candidate: &Candidate) -> bool {
    candidate.nonlinear && candidate.side == Side::Camera
}

/// Whether two candidates are compared by their columns at one and the same pose: where one of them changes the
/// image, fits differ by what the pixel lattice does; less than columns err by where only angles were logged. A delay shifts
/// times only, and a plant leaves images alone. A saturation's column is that of another level.
fn by_columns(cut: &Tracked, candidates: &[Candidate], effect: usize, index: usize) -> bool {
    let pictured = |index: usize| {
        let candidate = &candidates[index];
        candidate.side == Side::Camera && !candidate.is(Attribute::ImageDelay)
    };
    let saturation = |index: usize| matches!(candidates[index].motion, Motion::Saturation { .. });
    let smooth = |index: usize| !candidates[index].is_discrete() && !saturation(index);
    cut.policy().lattice
        && !cut.policy().reads_angles
        && (pictured(effect) || pictured(index) || !cut.policy().free_pose)
        && smooth(effect)
        && smooth(index)
}

/// Whether a candidate's column predicted a good part of what a discrete effect then gave.
fn resembled(steps: &[Step], effect: usize, index: usize) -> bool {
    let Some(step) = steps.iter().find(|step| step.accepted == Some(effect)) else { return true };
    let decrease = step.deviance.0 - step.deviance.1;
    step.best.iter().any(|hit| hit.candidate == index && hit.gain > 0.5 * decrease - 2.0 * HOPELESS)
}

/// How much the likelihood overstates: variance of the score over blocks against what independent rows would give.
/// Varin, Reid and Firth, Statistica Sinica 21 (2011) 5, section 3.
fn temper(last: &Evaluation, active: &[usize], effect: usize, candidates: &[Candidate]) -> f64 {
    let free = continuous(candidates, active);
    let place = free.iter().position(|index| *index == effect);
    let bread = crate::statistics::linear::inverse(&submatrix(&last.total.gram, &last.places(&free)));
    match (place, bread, last.covariance(&free)) {
        (Some(i), Some(bread), Some(covariance)) => (covariance[(i, i)] / bread[(i, i)]).max(1.0),
        _ => 1.0,
    }
}

/// A candidate in the place of an effect.
struct Place<'a> {
    others: &'a [usize],
    effect: usize,
    x: f64,
}

/// What `other` gains in the place of a candidate, as seen from that candidate's own fit. A column that carries noise of the
/// lattice looks better than it is where it is fitted itself, and worse from elsewhere.
fn seen_from(
    cut: &mut Tracked,
    candidates: &[Candidate],
    last: &Evaluation,
    from: &Place,
    other: usize,
) -> Result<Option<f64>, Error> {
    let mut point = last.point.clone();
    point[other] = candidates[other].off;
    point[from.effect] = from.x;
    let mut set = from.others.to_vec();
    set.push(from.effect);
    let fit = refit(cut, candidates, &point, &set)?;
    let mut perturbations: Vec<Perturbation> = set
        .iter()
        .filter(|index| !candidates[**index].is_discrete())
        .map(|index| Perturbation {
            candidate: *index,
            by: candidates[*index].derivative_step(fit.point[*index]),
        })
        .collect();
    perturbations.push(Perturbation { candidate: other, by: last.point[other] - candidates[other].off });
    if candidates[from.effect].nonlinear {
        let by = candidates[from.effect].off - fit.point[from.effect];
        perturbations.push(Perturbation { candidate: from.effect, by });
    }
    let there = Evaluation::chord(cut, &fit.point, &perturbations)?;
    Ok(linear_loss(&there, from.others, from.effect, other, candidates).map(|replaced| -replaced.loss))
}

#[cfg(test)]
mod tests;
