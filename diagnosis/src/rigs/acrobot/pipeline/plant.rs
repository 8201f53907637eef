//! The plant's part: rows where the model follows the log, torques where it doesn't, and the motion for the camera.

use super::*;
use crate::rigs::acrobot::dataset::Run;
use crate::rigs::acrobot::linked::policy::LINKED;
use crate::rigs::acrobot::linked::told_apart;
use crate::rigs::acrobot::pipeline::policy::PIPELINE;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::logged;
use crate::rigs::acrobot::residual::plant::PlantCut;
use crate::rigs::acrobot::residual::weak::Weak;
use crate::rigs::acrobot::selection::Hit;

pub(super) fn plant_part(
    data: &DataSet,
    model: &Model,
    list: &Arc<Vec<Candidate>>,
    point: &mut Vec<f64>,
    parts: &mut Vec<Part>,
    notices: &mut Vec<Notice>,
    watch: &mut Watch<'_>,
) -> Result<Option<(Vec<Logged>, f64)>, Error> {
    let Some(mut rows) = PlantCut::new(data, model, list.clone())?.map(Tracked::new) else {
        notices.extend(data.runs.iter().filter_map(not_compared));
        return Ok(logged_poses(data));
    };
    if let Some(part) = by_torques_again(data, model, list, point, watch)? {
        point.clone_from(&part.study.last.point);
        parts.push(part);
        return Ok(None);
    }
    watch.stage("plant: windows of the logs");
    let (compared, all) = rows.windows();
    if compared < all {
        let message = format!("{compared} of {all} windows are compared, evenly chosen over all runs");
        notices.push(Notice { file: "plant.csv".into(), line: 0, message });
    }
    rows.begin(point)?;
    let mut start = Vec::new();
    let mut coarse = None;
    if rows.share_with_slack() > PIPELINE.mostly_slack
        && let Some(mut weak) = Weak::new(data, model, list.clone())?.map(Tracked::new)
    {
        let part = part(&mut weak, list, point, &[], true, watch)?;
        point.clone_from(&part.study.last.point);
        start.clone_from(&part.study.active);
        coarse = Some(part);
    }
    let follows = coarse.is_some() && leading(&mut rows, list, point, &mut start);
    let mut part = match coarse {
        // nor does it where torques fit best with what is no body
        Some(part) if !follows => match part.study.active.is_empty() {
            true => hinted(&mut rows, list, &part.study.screen.hits, point, watch)?.unwrap_or(part),
            false => part,
        },
        Some(_) => {
            rows.linearise(point, &[])?;
            let fine = study(&mut rows, list, point, &start, watch)?;
            Part { coarse: start, ..classed(&mut rows, list, fine, true, watch)? }
        }
        None => part(&mut rows, list, point, &start, true, watch)?,
    };
    let found = (part.study.last.point.clone(), part.study.active.clone());
    if !found.1.is_empty() && !part.study.discrepancy_dominated && !rows.jitter_remains(&found.0)? {
        part = Part { coarse: part.coarse, ..self::part(&mut rows, list, &found.0, &found.1, true, watch)? };
    }
    if data.runs.iter().all(|run| run.camera.is_none()) {
        part = zeros::both(&mut rows, list, part, watch)?;
    }
    told_apart(data, model, list, (&part.study, &part.signals), &mut part.classes, watch);
    // what compares by torques is not asked: no linked state speaks there
    if !part.study.discrepancy_dominated {
        for (effect, class) in &mut part.classes {
            seat(&mut rows, list, &mut part.study, (effect, class), LINKED.near)?;
        }
    }
    point.clone_from(&part.study.last.point);
    let sigma = match part.study.discrepancy_dominated {
        true => PIPELINE.coarse_motion,
        false => part.study.last.sigmas[..2].iter().fold(0.0, |a: f64, b| a.max(*b)),
    };
    parts.push(part);
    if data.runs.iter().all(|run| run.camera.is_none()) {
        return Ok(None);
    }
    rows.linearise(point, &[])?;
    pose_of(data, &mut rows, point, sigma)
}

/// A repeated search compares by torques at once where the first one found that the plant doesn't follow its logs; where images need the
/// motion, it is followed all the same.
fn by_torques_again(
    data: &DataSet,
    model: &Model,
    list: &Arc<Vec<Candidate>>,
    point: &[f64],
    watch: &mut Watch<'_>,
) -> Result<Option<Part>, Error> {
    let by_torques = watch.known().is_some_and(|known| known.by_torques);
    if !by_torques || data.runs.iter().any(|run| run.camera.is_some()) {
        return Ok(None);
    }
    let weak = Weak::new(data, model, list.clone())?.map(Tracked::new);
    weak.map(|mut weak| part(&mut weak, list, point, &[], true, watch)).transpose()
}

/// The motions as they were logged, and how well they are known, rad; `None` where there are none.
pub(super) fn logged_poses(data: &DataSet) -> Option<(Vec<Logged>, f64)> {
    let mut motions = vec![Logged::default(); data.runs.len()];
    as_logged(data, &mut motions).map(|sigma| (motions, sigma))
}

/// The motions for the images, and how well they are known, rad; `None` where there are no images. `sigma` is that of the angles. Call
/// after `linearise` at the same point.
pub(super) fn pose_of(
    data: &DataSet,
    rows: &mut Tracked<PlantCut>,
    point: &[f64],
    sigma: f64,
) -> Result<Option<(Vec<Logged>, f64)>, Error> {
    if data.runs.iter().all(|run| run.camera.is_none()) {
        return Ok(None);
    }
    let mut motions = rows.motion(point, POLICY.motion_step)?;
    let others = as_logged(data, &mut motions).unwrap_or(0.0);
    Ok(Some((motions, others.max(POLICY.motion_share * sigma))))
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
fn hinted(
    rows: &mut Tracked<PlantCut>,
    list: &Arc<Vec<Candidate>>,
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
            return classed(rows, list, fine, true, watch).map(Some);
        }
    }
    rows.reset();
    rows.linearise(point, &[])?;
    Ok(None)
}

/// Motions of runs with images whose plant nothing drives, as encoders have them; answers how well they are known, rad.
fn as_logged(data: &DataSet, motions: &mut [Logged]) -> Option<f64> {
    let bare = |run: &Run| run.controller.is_none() && run.camera.is_some();
    let mut worst = None;
    for (run, into) in data.runs.iter().zip(motions).filter(|(run, _)| bare(run)) {
        let Some((motion, sigma)) = logged::motion(run) else { continue };
        *into = motion;
        worst = Some(sigma.max(worst.unwrap_or(0.0)));
    }
    worst
}

/// Whether the plant follows the log by itself with what torques showed, or with the first of it alone: the last may be what differences
/// of angles are wrong by. If so, leaves no more than that on.
fn leading(
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
