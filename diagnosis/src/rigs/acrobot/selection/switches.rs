//! Candidates that no column leads to: a switch, which leaves terms out of the equations of motion, and a saturation from which a machine
//! ran away.

use super::evaluation::Evaluation;
use super::refit::ran_away;
use super::trials::Trial;
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Candidate, Cuts, Motion};
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::selection::policy::SELECTION;
use std::cmp::Ordering;

/// The best of the switches, if one makes the model fit far better. A column is too short for terms that are left out of the equations of
/// motion, and windows that needed slack torques to follow the log say nothing linear of it. Tried only where more than noise is left, and once for all
/// (`in_vain`) where it makes things worse.
///
/// # Errors
/// A unit failed at the model that is there.
pub(super) fn best_switch(
    cut: &mut Tracked,
    candidates: &[Candidate],
    last: &Evaluation,
    active: &[usize],
    refused: &[usize],
    in_vain: &mut Vec<usize>,
) -> Result<Option<Trial>, Error> {
    let mut best: Option<Trial> = None;
    let pictured = cut.policy().lattice;
    if last.discrepancy_sd == 0.0
        || cut.policy().discrepancy_dominated
        || (pictured && !cut.policy().free_pose)
    {
        return Ok(None);
    }
    // a machine that ran away from its saturation: no tangent says anything of such a window
    let wild = last.reduced.iter().any(ran_away);
    for (index, candidate) in candidates.iter().enumerate() {
        let worth = match candidate.motion {
            Motion::Switch => true,
            Motion::Saturation { cuts } => wild && cuts == Cuts::Torque,
            _ => false,
        };
        let open = worth && [active, refused, in_vain].iter().all(|known| !known.contains(&index));
        if !open || !cut.sees(candidate) || last.point[index] != candidate.off {
            continue;
        }
        let nearest = best_value(cut, candidate, last, index);
        cut.reset();
        Evaluation::at(cut, &last.point, &[])?;
        let Some(trial) = nearest.filter(|trial| trial.deviance() < last.deviance()) else {
            in_vain.push(index);
            continue;
        };
        // with the right switch every window follows the log
        let follows = trial.discrepancy_sd <= SELECTION.follows * last.discrepancy_sd;
        let decrease = last.deviance() - trial.deviance();
        if follows && decrease > best.as_ref().map_or(0.0, |best| best.1) {
            best = Some((index, decrease, trial));
        }
    }
    Ok(best)
}

/// Of all values of a candidate the one with which windows, begun anew, need the least slack torques.
fn best_value(
    cut: &mut Tracked,
    candidate: &Candidate,
    last: &Evaluation,
    index: usize,
) -> Option<Evaluation> {
    let mut evaluated = |x: f64| {
        let mut point = last.point.clone();
        point[index] = x;
        cut.reset();
        // a value that the unit refuses is no trial
        Evaluation::at(cut, &point, &[]).ok()
    };
    let steps = candidate.steps.iter().map(|step| candidate.off + step);
    if !matches!(candidate.motion, Motion::Saturation { .. }) {
        return steps.filter_map(evaluated).min_by(by_slack);
    }
    let (low, high) = steps.fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
    let apart = (SELECTION.beside * SELECTION.beside).max((high / low).powf(SELECTION.levels.recip()));
    let count = libm::ceil(libm::log(high / low) / libm::log(apart)) as i32;
    let (mut best, mut beyond): (Option<Evaluation>, _) = (None, 0);
    // the tightest first: under one that is too loose machines run away, which takes long
    for trial in (0..=count).filter_map(|k| evaluated(high / apart.powi(k))) {
        let far = best
            .as_ref()
            .is_some_and(|best| trial.discrepancy_sd > SELECTION.switched_far * best.discrepancy_sd);
        beyond = if far { beyond + 1 } else { 0 };
        best = best.into_iter().chain([trial]).min_by(by_slack);
        if beyond == SELECTION.beyond {
            break;
        }
    }
    let x = best.as_ref()?.point[index];
    best.into_iter()
        .chain([SELECTION.beside * x, x / SELECTION.beside].into_iter().filter_map(evaluated))
        .min_by(by_slack)
}

/// The deviance alone says little: under a saturation that is far too tight all windows have slack torques, and so meet the rows.
fn by_slack(a: &Evaluation, b: &Evaluation) -> Ordering {
    a.discrepancy_sd.total_cmp(&b.discrepancy_sd).then(a.deviance().total_cmp(&b.deviance()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::candidates::Side;
    use crate::rigs::acrobot::selection::examples::{candidate, evaluation, toy};
    use std::sync::{Arc, Mutex};

    /// Where a saturation is tried that no row tells anything of, from the tightest of these to the loosest.
    fn levels(high: f64, low: f64) -> Vec<f64> {
        let saturation = Candidate {
            motion: Motion::Saturation { cuts: Cuts::Torque },
            steps: vec![low, high],
            ..candidate(Side::Plant, true)
        };
        let tried_at = Arc::new(Mutex::new(Vec::new()));
        let told = tried_at.clone();
        let mut cut = toy(move |x| {
            told.lock().expect("no panic").push(x[0]);
            vec![0.0]
        });
        best_value(&mut cut, &saturation, &evaluation(&[0.0], &[0.0], &[0.0]), 0).expect("the first");
        tried_at.lock().expect("no panic").clone()
    }

    #[test]
    fn value_levels_are_a_fifth_apart_or_thirty_and_the_best_is_tried_on_both_sides() {
        // ln 8/ln 1.21 = 10.9
        let near = levels(8.0, 1.0);
        assert!((near[0] - 8.0).abs() < 1e-9 && (near[1] - 8.0 / 1.21).abs() < 1e-9, "{near:?}");
        // the first is as good as any: a tenth beside it
        assert_eq!(near.len(), 12 + 2);
        assert!((near[12] - 8.8).abs() < 1e-9 && (near[13] - 8.0 / 1.1).abs() < 1e-9, "{near:?}");
        // over six decades a fifth of one each; rounding may add one
        let far = levels(1e6, 1.0);
        assert!((far[0] / far[1] - libm::pow(10.0, 0.2)).abs() < 1e-9, "{far:?}");
        assert!((31 + 2..=32 + 2).contains(&far.len()), "{}", far.len());
    }
}
