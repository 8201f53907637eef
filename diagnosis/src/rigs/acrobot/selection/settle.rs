//! After a candidate was accepted: values and nuisances settle, what became superfluous goes, and a second opinion.

use super::classes::{Alternative, Questioned, alternatives};
use super::evaluation::Evaluation;
use super::refit::refit_closely;
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Candidate, Side, continuous};
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::{Signal, Tracked};
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::watch::Watch;

/// What a second opinion comes to.
pub(super) enum Opinion {
    /// The effect stays where it is; all that could stand in its place.
    Stays(Vec<Alternative>),
    /// Another takes its place: the effects then, that one last, and the coordinates of all candidates.
    Swapped { active: Vec<usize>, point: Vec<f64> },
}

/// Asks at the fitted model, where noise is small again and columns are short, whether another candidate in the place of
/// the one just accepted is better, and settles it there: at the model before, what was missing counted as noise. Not one that had its
/// place `before`, and lost it again.
pub(super) fn second_opinion(
    cut: &mut Tracked,
    asked: &Questioned<'_>,
    before: &[usize],
    watch: &mut Watch<'_>,
) -> Result<Opinion, Error> {
    let Questioned { candidates, last, active, effect: candidate, .. } = *asked;
    let others = alternatives(cut, asked, watch)?;
    let kept = cut.nuisances.clone();
    let own = others.iter().find(|other| other.candidate == candidate).map_or(0.0, |own| own.loss);
    let first = others.first().filter(|best| !before.contains(&best.candidate));
    let Some(best) = first.filter(|best| best.candidate != candidate && own > best.loss + SELECTION.better)
    else {
        return Ok(Opinion::Stays(others));
    };
    let mut point = last.point.clone();
    point[candidate] = candidates[candidate].off;
    point[best.candidate] = best.x;
    let mut swapped: Vec<usize> = active.iter().copied().filter(|index| *index != candidate).collect();
    swapped.push(best.candidate);
    // a straight line may lead to where the unit shows nothing: then there is no second opinion
    match settle(cut, candidates, &mut swapped, &mut point) {
        Ok(dropped) if !dropped.contains(&best.candidate) => {}
        _ => {
            cut.restore(&kept);
            return Ok(Opinion::Stays(others));
        }
    }
    Ok(Opinion::Swapped { active: swapped, point })
}

/// Nuisances and values in turns, until no value moves much. Answers who was dropped.
pub(super) fn settle(
    cut: &mut Tracked,
    candidates: &[Candidate],
    active: &mut Vec<usize>,
    point: &mut Vec<f64>,
) -> Result<Vec<usize>, Error> {
    let mut all = Vec::new();
    for _ in 0..SELECTION.settle {
        // the nuisances first, since a fit leaves them where the last linearisation found them
        cut.linearise_anew(point, &[])?;
        let before = point.clone();
        let (dropped, tiny) = prune(cut, candidates, active, point)?;
        all.extend(dropped);
        if (0..point.len()).all(|place| (point[place] - before[place]).abs() <= tiny[place]) {
            break;
        }
    }
    Ok(all)
}

/// The last value that nothing shows, be it taken away as a whole: a saturation that cuts nothing any more, which stands in the way of all
/// others. A delay shows nothing in small either, where torques are held from step to step.
fn idle(
    cut: &mut Tracked,
    candidates: &[Candidate],
    fit: &Evaluation,
    free: &[usize],
) -> Result<Option<usize>, Error> {
    for index in free.iter().copied().rev().filter(|index| !fit.shows(*index)) {
        let mut without = fit.point.clone();
        without[index] = candidates[index].off;
        if Evaluation::chord(cut, &without, &[])?.deviance() < fit.deviance() + SELECTION.idle {
            return Ok(Some(index));
        }
    }
    Ok(None)
}

/// Drops what is superfluous or at the end of its range, the weakest first, and fits the rest again. Answers who was dropped, and for each
/// candidate by how much it may still move to count as settled.
fn prune(
    cut: &mut Tracked,
    candidates: &[Candidate],
    active: &mut Vec<usize>,
    point: &mut Vec<f64>,
) -> Result<(Vec<usize>, Vec<f64>), Error> {
    let mut dropped = Vec::new();
    let mut tiny = vec![f64::INFINITY; candidates.len()];
    loop {
        let fit = refit_closely(cut, candidates, point, active, f64::INFINITY)?;
        point.clone_from(&fit.point);
        let free = continuous(candidates, active);
        let Some(errors) = errors(&fit, &free, cut.signals()) else {
            let Some(dead) = idle(cut, candidates, &fit, &free)? else { return Ok((dropped, tiny)) };
            active.retain(|other| *other != dead);
            point[dead] = candidates[dead].off;
            dropped.push(dead);
            continue;
        };
        for (error, index) in errors.iter().zip(&free) {
            tiny[*index] = SELECTION.moved * error;
        }
        let weakest = (errors.iter().zip(&free))
            .map(|(error, index)| (strength(&candidates[*index], fit.point[*index], *error), *index))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match weakest {
            Some((strength, index)) if strength < 1.0 => {
                active.retain(|other| *other != index);
                point[index] = candidates[index].off;
                dropped.push(index);
            }
            _ => return Ok((dropped, tiny)),
        }
    }
}

/// Standard errors of values, with what right renderers differ by; `None` where they can't be told from each other.
fn errors(fit: &Evaluation, free: &[usize], signals: &[Signal]) -> Option<Vec<f64>> {
    let covariance = fit.covariance(free)?;
    let systematic = fit.systematic(free, signals);
    Some((0..free.len()).map(|place| (covariance[(place, place)] + systematic[place]).sqrt()).collect())
}

/// How far a value is from being dropped: 1 and less is superfluous.
fn strength(candidate: &Candidate, x: f64, error: f64) -> f64 {
    let size = if candidate.is_at_its_end(x) { 0.0 } else { (x - candidate.off).abs() / error };
    size / if candidate.side == Side::Camera { POLICY.clear } else { SELECTION.keep }
}

/// Whether an effect that is fitted beside those that are on is none of those that are dropped. A trial without columns says nothing of that.
pub(super) fn is_kept(
    fit: &Evaluation,
    candidates: &[Candidate],
    active: &[usize],
    effect: usize,
    signals: &[Signal],
) -> bool {
    let free = continuous(candidates, active);
    let shown = fit.places(&free).len() == free.len();
    let own = free.iter().position(|index| *index == effect).filter(|_| shown);
    let told = own.and_then(|place| Some(errors(fit, &free, signals)?[place]));
    let dropped = |error: f64| strength(&candidates[effect], fit.point[effect], error) < 1.0;
    !told.is_some_and(dropped)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::residual::Cut;
    use crate::rigs::acrobot::selection::examples::{candidate, toy};

    /// Fitted and pruned: whether the only value stays, and by how much it may still move.
    fn pruned(deviations: f64) -> (bool, f64) {
        // ten per unit
        let mut cut = toy(move |x| vec![deviations - 10.0 * x[0]]);
        let (mut active, mut point) = (vec![0], vec![0.0]);
        let (_, tiny) =
            prune(&mut cut, &[candidate(Side::Plant, false)], &mut active, &mut point).expect("runs");
        (active == [0], tiny[0])
    }

    #[test]
    fn value_an_effect_goes_below_three_standard_errors_and_settles_within_a_third_of_one() {
        assert_eq!([2.7, 3.3].map(|deviations| pruned(deviations).0), [false, true]);
        assert!((pruned(3.3).1 - 0.03).abs() < 1e-9);
    }

    #[test]
    fn value_an_effect_that_settling_would_drop_is_not_kept() {
        let kept = |deviations: f64| {
            let candidates = [candidate(Side::Plant, false)];
            let mut cut = toy(move |x| vec![deviations - 10.0 * x[0]]);
            let fit = refit_closely(&mut cut, &candidates, &[0.0], &[0], f64::INFINITY).expect("runs");
            is_kept(&fit, &candidates, &[0], 0, cut.signals())
        };
        assert_eq!([2.7, 3.3].map(kept), [false, true]);
        // a saturation that a machine ran away from is tried at levels, without columns
        let mut cut = toy(|x| vec![2.7 - 10.0 * x[0]]);
        let bare = Evaluation::at(&mut cut, &[0.1], &[]).expect("runs");
        assert!(is_kept(&bare, &[candidate(Side::Plant, false)], &[0], 0, cut.signals()));
    }

    #[test]
    fn value_what_shows_nothing_is_idle_where_it_takes_nothing_away_either() {
        let goes = |more: f64| {
            let mut cut = toy(move |x| vec![if x[0] == 0.0 { (1.0 + more).sqrt() } else { 1.0 }]);
            let candidates = [candidate(Side::Plant, false)];
            let fit = refit_closely(&mut cut, &candidates, &[1.0], &[0], f64::INFINITY).expect("runs");
            idle(&mut cut, &candidates, &fit, &[0]).expect("runs").is_some()
        };
        // 0.001 of deviance
        assert_eq!([0.0009, 0.0011].map(goes), [true, false]);
    }
}
