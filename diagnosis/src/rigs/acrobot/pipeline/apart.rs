//! Classes that usual windows leave open: what longer ones say of them, where the model follows the log to within noise.

use super::*;
use crate::rigs::acrobot::residual::plant::PlantCut;
use crate::rigs::acrobot::selection::{Evaluation, all_probes, discrepancy, refit};

/// Noise may look larger in longer windows by this much before they are taken to show what the model lacks.
const LOUDER: f64 = 1.05;
/// So may a lacking torque (deviance; a mixture of chi-squared of one degree and nothing): by chance more once in 200 times.
const CHANCE: f64 = 6.6;

pub(super) fn told_apart(
    rows: &mut Tracked<PlantCut>,
    data: &DataSet,
    model: &Model,
    list: &[Candidate],
    part: &mut Part,
    watch: &mut Watch<'_>,
) {
    let study = &part.study;
    if study.discrepancy_dominated || study.last.discrepancy_sd > 0.0 {
        return;
    }
    let kept = rows.nuisances.clone();
    for (effect, class) in part.classes.iter_mut().filter(|(effect, class)| open(*effect, class, list)) {
        let members = class.iter().filter(|other| is_member(*effect, other, list));
        for member in members.cloned().collect::<Vec<_>>() {
            // a member that the unit can't be run with says nothing, and must not end a diagnosis that stands without it
            rows.restore(&kept);
            if let Ok(Some(told)) = judged(rows, data, model, list, study, (*effect, &member), watch) {
                *class = told;
                break;
            }
        }
        rows.restore(&kept);
    }
}

/// The class as long windows see it from one member's model; nothing where they show that this model lacks something, as they
/// do with a wrong member.
fn judged(
    rows: &mut Tracked<PlantCut>,
    data: &DataSet,
    model: &Model,
    list: &[Candidate],
    study: &Study,
    (effect, member): (usize, &Alternative),
    watch: &mut Watch<'_>,
) -> Result<Option<Vec<Alternative>>, Error> {
    let mut point = study.last.point.clone();
    point[effect] = list[effect].off;
    point[member.candidate] = if member.candidate == effect { study.last.point[effect] } else { member.x };
    let seated = |index: &usize| if *index == effect { member.candidate } else { *index };
    let active: Vec<usize> = study.active.iter().map(seated).collect();
    rows.linearise(&point, &[])?;
    let Some(mut long) = rows.longer(data, model, &point)? else { return Ok(None) };
    let fit = refit(&mut long, list, &point, &active)?;
    let probes = all_probes(list, &fit.point, &|candidate| long.sees(candidate), &active);
    let last = Evaluation::at(&mut long, &fit.point, &probes)?;
    let louder = last.sigmas.iter().zip(&study.last.sigmas).any(|(now, before)| *now > LOUDER * before);
    if louder || discrepancy(&last) > CHANCE {
        return Ok(None);
    }
    alternatives(&mut long, list, &last, &active, member.candidate, &study.steps, watch).map(Some)
}

fn is_member(effect: usize, other: &Alternative, list: &[Candidate]) -> bool {
    (other.candidate == effect || other.loss < CLASS) && list[other.candidate].side == Side::Plant
}

/// Whether two parameters of the plant are in the class of one.
fn open(effect: usize, class: &[Alternative], list: &[Candidate]) -> bool {
    list[effect].side == Side::Plant
        && class.iter().filter(|other| is_member(effect, other, list)).count() > 1
}
