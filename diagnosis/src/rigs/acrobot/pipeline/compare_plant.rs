//! The plant compared: rows where the model follows the log, torques where it doesn't, and the motion for the camera.

use super::Rig;
use super::compare::{Compared, Part, add_classes, search_cut};
use super::encoder_zeros::weigh_zeros;
use super::replace_effect::put_best_first;
use crate::error::{Error, Notice};
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::dataset::{DataSet, Run};
use crate::rigs::acrobot::linked::policy::LINKED;
use crate::rigs::acrobot::linked::weigh_linked_classes;
use crate::rigs::acrobot::pipeline::policy::PIPELINE;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::residual::logged_motion;
use crate::rigs::acrobot::residual::plant::PlantCut;
use crate::rigs::acrobot::residual::trajectory::Motion;
use crate::rigs::acrobot::selection::{Hit, study};
use crate::watch::Watch;

/// The motions at which images are compared.
pub(super) struct Motions {
    /// One for each run.
    pub(super) runs: Vec<Motion>,
    /// How well their angles are known, rad.
    pub(super) sigma: f64,
}

/// Adds the part of the plant, where its motion was logged with its torque. Answers the motions for the images; `None` where there are no
/// images, or nothing is known of their poses.
pub(super) fn compare_plant(
    rig: &Rig<'_>,
    compared: &mut Compared,
    watch: &mut Watch<'_>,
) -> Result<Option<Motions>, Error> {
    let Some(mut rows) = rig.plant_cut()? else {
        compared.notices.extend(rig.data.runs.iter().filter_map(not_compared));
        return Ok(logged_motions(&rig.data));
    };
    if let Some(part) = by_torques_again(rig, &compared.point, watch)? {
        compared.add(part);
        return Ok(None);
    }
    watch.stage("plant: windows of the logs");
    compared.notices.extend(windows_left_out(&rows));
    rows.begin(&compared.point)?;
    let list = &rig.list;
    let mut part = search_windows_or_torques(rig, &mut rows, &mut compared.point, watch)?;
    let found = (part.study.last.point.clone(), part.study.active.clone());
    if !found.1.is_empty() && !part.study.discrepancy_dominated && !rows.jitter_remains(&found.0)? {
        part = Part { coarse: part.coarse, ..search_cut(&mut rows, list, &found.0, &found.1, true, watch)? };
    }
    if !rig.has_images() {
        part = weigh_zeros(&mut rows, list, part, watch)?;
    }
    let (study, signals) = (&part.study, part.signals.as_slice());
    part.linked =
        weigh_linked_classes(&rig.data, rig.model, list, (study, signals), &mut part.classes, watch);
    // what compares by torques is not asked: no linked state speaks there
    if !part.study.discrepancy_dominated {
        for (effect, class) in &mut part.classes {
            put_best_first(&mut rows, list, &mut part.study, (effect, class), LINKED.near)?;
        }
    }
    let sigma = match part.study.discrepancy_dominated {
        true => PIPELINE.coarse_motion,
        false => part.study.last.sigmas[..2].iter().fold(0.0, |a: f64, b| a.max(*b)),
    };
    compared.add(part);
    if !rig.has_images() {
        return Ok(None);
    }
    rows.linearise(&compared.point, &[])?;
    followed_motions(rig, &mut rows, &compared.point, sigma)
}

/// Says that not all windows of the logs are compared, where that is so.
fn windows_left_out(rows: &PlantCut) -> Option<Notice> {
    let (compared, all) = rows.windows();
    (compared < all).then(|| {
        let message = format!(
            "{compared} of {all} windows are compared, evenly chosen over all runs: intervals, and what would be found, are those of these"
        );
        Notice { file: "plant.csv".into(), line: 0, message }
    })
}

/// Searches windows of the log, if the plant follows these; if not, what torques it lacks, and the windows once more if it follows them
/// with what these show. `point` is then where the candidates are.
fn search_windows_or_torques(
    rig: &Rig<'_>,
    rows: &mut Tracked<PlantCut>,
    point: &mut Vec<f64>,
    watch: &mut Watch<'_>,
) -> Result<Part, Error> {
    let list = &rig.list;
    let strays = rows.share_with_slack() > PIPELINE.mostly_slack;
    let Some(mut torques) = (if strays { rig.torque_cut()? } else { None }) else {
        return search_cut(rows, list, point, &[], true, watch);
    };
    let coarse = search_cut(&mut torques, list, point, &[], true, watch)?;
    point.clone_from(&coarse.study.last.point);
    let mut start = coarse.study.active.clone();
    if follows_with_first(rows, list, point, &mut start) {
        rows.linearise(point, &[])?;
        let fine = study(rows, list, point, &start, watch)?;
        return Ok(Part { coarse: start, ..add_classes(rows, list, fine, true, watch)? });
    }
    // nor is a hint asked for where torques fit best with what is no body
    if !coarse.study.active.is_empty() {
        return Ok(coarse);
    }
    Ok(try_hints(rows, list, &coarse.study.screen.hits, point, watch)?.unwrap_or(coarse))
}

/// A repeated search compares by torques at once where the first one found that the plant doesn't follow its logs; where images need the
/// motion, it is followed all the same.
fn by_torques_again(rig: &Rig<'_>, point: &[f64], watch: &mut Watch<'_>) -> Result<Option<Part>, Error> {
    let by_torques = watch.known().is_some_and(|known| known.by_torques);
    if !by_torques || rig.has_images() {
        return Ok(None);
    }
    let torques = rig.torque_cut()?;
    torques.map(|mut torques| search_cut(&mut torques, &rig.list, point, &[], true, watch)).transpose()
}

/// The motions as they were logged; `None` where there are none.
pub(super) fn logged_motions(data: &DataSet) -> Option<Motions> {
    let mut runs = vec![Motion::default(); data.runs.len()];
    fill_logged(data, &mut runs).map(|sigma| Motions { runs, sigma })
}

/// The motions for the images as the plant follows its logs; `None` where there are no images. `sigma` is how well the angles are known,
/// rad. Call after `linearise` at the same point.
pub(super) fn followed_motions(
    rig: &Rig<'_>,
    rows: &mut Tracked<PlantCut>,
    point: &[f64],
    sigma: f64,
) -> Result<Option<Motions>, Error> {
    if !rig.has_images() {
        return Ok(None);
    }
    let mut runs = rows.motion(point, POLICY.motion_step)?;
    let others = fill_logged(&rig.data, &mut runs).unwrap_or(0.0);
    Ok(Some(Motions { runs, sigma: others.max(POLICY.motion_share * sigma) }))
}

/// Why a log of motion and torque wasn't compared, where none was.
fn not_compared(run: &Run) -> Option<Notice> {
    (run.plant.is_some() && run.controller.is_some()).then(|| Notice {
        file: format!("{}/plant.csv", run.name),
        line: 0,
        message:
            "no stretch of a second holds six rows of q1 or q2 in which the torque is known: not compared"
                .into(),
    })
}

/// Where torques show nothing certain, as few rows hardly tell an acceleration, the likeliest of what they resemble is tried: it
/// counts if with it the plant follows the log by itself.
fn try_hints(
    rows: &mut Tracked<PlantCut>,
    list: &[Candidate],
    hits: &[Hit],
    point: &[f64],
    watch: &mut Watch<'_>,
) -> Result<Option<Part>, Error> {
    let real = |hit: &&Hit| !list[hit.candidate].side.is_of_log() && !list[hit.candidate].is_discrete();
    for hit in hits.iter().filter(real).take(PIPELINE.hints) {
        let (candidate, mut there) = (&list[hit.candidate], point.to_vec());
        there[hit.candidate] =
            (point[hit.candidate] + hit.displacement).clamp(candidate.range.0, candidate.range.1);
        // a hint that the unit can't be run with says nothing, and must not end a diagnosis that stands without it
        if rows.linearise(&there, &[]).is_err() {
            continue;
        }
        let Ok(fine) = study(rows, list, &there, &[hit.candidate], watch) else { continue };
        if !fine.active.is_empty() && rows.follows(&fine.last.point, PIPELINE.mostly_slack).unwrap_or(false) {
            rows.linearise(&fine.last.point, &[])?;
            return add_classes(rows, list, fine, true, watch).map(Some);
        }
    }
    rows.reset();
    rows.linearise(point, &[])?;
    Ok(None)
}

/// Puts the motions of runs with images whose plant nothing drives in their places, as encoders have them. Answers how well they are known,
/// rad.
fn fill_logged(data: &DataSet, motions: &mut [Motion]) -> Option<f64> {
    let undriven = |run: &Run| run.controller.is_none() && run.camera.is_some();
    let mut worst = None;
    for (run, into) in data.runs.iter().zip(motions).filter(|(run, _)| undriven(run)) {
        let Some((motion, sigma)) = logged_motion::motion(run) else { continue };
        *into = motion;
        worst = Some(sigma.max(worst.unwrap_or(0.0)));
    }
    worst
}

/// Whether the plant follows the log by itself with what torques showed, or with the first of it alone: the last may be what differences
/// of angles are wrong by. If so, leaves no more than that on.
fn follows_with_first(
    rows: &mut Tracked<PlantCut>,
    list: &[Candidate],
    point: &mut Vec<f64>,
    found: &mut Vec<usize>,
) -> bool {
    let mut there = point.clone();
    for most in (found.len().min(1)..=found.len()).rev() {
        found[most..].iter().for_each(|index| there[*index] = list[*index].off);
        if rows.follows(&there, PIPELINE.mostly_slack).unwrap_or(false) {
            (*point, _) = (there, found.truncate(most));
            return true;
        }
    }
    // zeros and clock of the log as they were found; the first window that strays ends it
    let _ = rows.follows(point, 0.0);
    false
}
