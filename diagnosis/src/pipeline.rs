//! The workflow from a folder to a [`Diagnosis`]: plant first, then picture, then what both say together.

use crate::candidates::{CLOCK, Candidate, Cuts, Motion, Side, candidates};
use crate::counting::losses;
use crate::dataset::DataSet;
use crate::diagnosis::{Diagnosis, Effect, Gap, Trace, Unknown, Verdict, Where};
use crate::error::{Error, Notice};
use crate::model::Model;
use crate::residual::chain::Chain;
use crate::residual::image::{ImageCut, Pose};
use crate::residual::plant::PlantCut;
use crate::residual::trajectory::Motion as Logged;
use crate::residual::weak::Weak;
use crate::residual::{Cut, Signal};
use crate::rest::unknown;
use crate::selection::{ALPHA, Alternative, CLASS, Study, alternatives, study};
use crate::{amend, experiment, gap, story};
use orchestrator::UnitPath;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// What a user may choose.
#[derive(Debug, Clone)]
pub struct Options {
    /// Candidates that are not to be named.
    pub without: Vec<String>,
    /// Most frames that are rendered again for each candidate.
    pub frames: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { without: Vec::new(), frames: 720 }
    }
}

/// Share of windows in which the plant must be led, beyond which torques are compared instead of angles.
const MOSTLY_LED: f64 = 0.5;
/// Step of a fitted motion, s: the cubic between is good to 1e-8 rad.
const MOTION_STEP: f64 = 1.0 / 120.0;
/// How well it is known where the model had to be led along the log, rad.
const COARSE_MOTION: f64 = 1e-3;
/// How well a fitted motion is known beside its noise, as a share of the encoder's standard deviation.
const MOTION_SHARE: f64 = 0.5;

/// One cut with all that was found on it.
struct Part {
    study: Study,
    signals: Vec<Signal>,
    classes: Vec<(usize, Vec<Alternative>)>,
    torque: bool,
}

/// Diagnoses a data set. `tell` gets a line at each stage.
///
/// # Errors
/// The data set or the nominal model can't be used, or a unit failed.
pub fn diagnose(
    path: &Path,
    units: &UnitPath,
    options: &Options,
    tell: &mut dyn FnMut(&str),
) -> Result<Diagnosis, Error> {
    let data = DataSet::load(path)?;
    let model = Model::load(&data, units)?;
    let list = Arc::new(candidates(&model, &options.without, &|cuts| ceilings(&data, cuts)));
    let mut notices = data.notices.clone();
    let mut point: Vec<f64> = list.iter().map(|candidate| candidate.off).collect();
    let mut parts = Vec::new();
    let motions = plant_part(&data, &model, &list, &mut point, &mut parts, tell)?;
    camera_part(&data, &model, &list, motions, options, &mut point, &mut parts, &mut notices, tell)?;
    if parts.is_empty() {
        return Err(Error::NothingUsable { path: path.to_owned(), notices });
    }
    clear_clock(&list, &mut parts, &mut point, &mut notices);
    conclude(&data, &model, &list, &parts, &point, notices, units)
}

fn plant_part(
    data: &DataSet,
    model: &Model,
    list: &Arc<Vec<Candidate>>,
    point: &mut Vec<f64>,
    parts: &mut Vec<Part>,
    tell: &mut dyn FnMut(&str),
) -> Result<Option<(Vec<Logged>, f64)>, Error> {
    let Some(mut rows) = PlantCut::new(data, model, list.clone(), false)? else { return Ok(None) };
    tell("plant: windows of the logs");
    rows.find_jitter(point)?;
    rows.linearise(point, &[], false)?;
    let mut start = Vec::new();
    let mut coarse = None;
    if rows.led() > MOSTLY_LED
        && !switch_leads(&mut rows, list, point)?
        && let Some(mut weak) = Weak::new(data, model, list.clone())?
    {
        let part = part(&mut weak, list, point, &[], true, tell)?;
        point.clone_from(&part.study.last.point);
        start.clone_from(&part.study.active);
        rows.afresh();
        rows.linearise(point, &[], false)?;
        coarse = Some(part);
    }
    let part = match coarse {
        Some(part) if rows.led() > MOSTLY_LED => part,
        _ => part(&mut rows, list, point, &start, true, tell)?,
    };
    point.clone_from(&part.study.last.point);
    let sigma = match part.study.outweighed {
        true => COARSE_MOTION,
        false => part.study.last.sigmas[..2].iter().fold(0.0, |a: f64, b| a.max(*b)),
    };
    parts.push(part);
    if data.runs.iter().all(|run| run.camera.is_none()) {
        return Ok(None);
    }
    rows.linearise(point, &[], false)?;
    Ok(Some((rows.motion(point, MOTION_STEP)?, MOTION_SHARE * sigma)))
}

/// Whether a switch of the model lets the plant follow the log by itself. Leaves the windows at the nominal model.
fn switch_leads(rows: &mut PlantCut, list: &[Candidate], point: &[f64]) -> Result<bool, Error> {
    let mut leads = false;
    for (index, candidate) in list.iter().enumerate().filter(|(_, c)| c.motion == Motion::Switch) {
        let mut other = point.to_vec();
        other[index] += candidate.steps[0];
        rows.afresh();
        leads |= rows.linearise(&other, &[], false).is_ok() && rows.led() < MOSTLY_LED;
    }
    rows.afresh();
    rows.linearise(point, &[], false)?;
    Ok(leads)
}

#[allow(clippy::too_many_arguments)] // one stage of one workflow: a struct would only rename its locals
fn camera_part(
    data: &DataSet,
    model: &Model,
    list: &Arc<Vec<Candidate>>,
    motions: Option<(Vec<Logged>, f64)>,
    options: &Options,
    point: &mut Vec<f64>,
    parts: &mut Vec<Part>,
    notices: &mut Vec<Notice>,
    tell: &mut dyn FnMut(&str),
) -> Result<(), Error> {
    let pose = match motions {
        Some((motions, sigma)) => Pose::Logged(motions, sigma),
        None => Pose::Free,
    };
    let chained = matches!(pose, Pose::Free);
    let mut chain = if chained { Chain::new(data, model, list.clone())? } else { None };
    let mut image = match chain {
        Some(_) => None,
        None => ImageCut::new(data, model, list.clone(), pose, options.frames)?,
    };
    let cut: &mut dyn Cut = match (&mut chain, &mut image) {
        (Some(chain), _) => chain,
        (_, Some(image)) => image,
        _ => return Ok(()),
    };
    tell("camera: frames rendered again at the measured pose");
    match part(cut, list, point, &[], false, tell) {
        Ok(part) => {
            *point = part.study.last.point.clone();
            parts.push(part);
            Ok(())
        }
        Err(error) if !parts.is_empty() => {
            notices.push(Notice {
                file: "camera.csv".into(),
                line: 0,
                message: format!("not compared: {error}"),
            });
            Ok(())
        }
        Err(error) => Err(error),
    }
}

/// Takes clocks that are off out of what is named. A plant log that is stamped late makes the actuator look slow and
/// the camera early by the same time; a delay of either does only one of both.
fn clear_clock(list: &[Candidate], parts: &mut [Part], point: &mut [f64], notices: &mut Vec<Notice>) {
    const SAME: f64 = 5e-4;
    let place = |name: &str| list.iter().position(|candidate| candidate.name == name);
    let mut gone = Vec::new();
    let mut late = None;
    if let Some(clock) = place(CLOCK).filter(|index| point[*index] != 0.0) {
        late = Some(point[clock]);
        gone.push(clock);
    }
    if let Some(delay) = place("camera.T_delay").filter(|index| point[*index] < 0.0) {
        let actuator = place("plant.tau_delay").filter(|index| (point[*index] + point[delay]).abs() < SAME);
        late = late.or(Some(-point[delay]));
        gone.push(delay);
        gone.extend(actuator);
    }
    for index in &gone {
        point[*index] = list[*index].off;
    }
    for part in parts {
        part.classes.retain(|(index, _)| !gone.contains(index));
    }
    if let Some(late) = late {
        let message = format!(
            "stamped {:.2} ms late against the other logs: taken as its clock, not as an effect",
            1e3 * late
        );
        notices.push(Notice { file: "plant.csv".into(), line: 0, message });
    }
}

fn part(
    cut: &mut dyn Cut,
    list: &[Candidate],
    point: &[f64],
    known: &[usize],
    torque: bool,
    tell: &mut dyn FnMut(&str),
) -> Result<Part, Error> {
    let study = study(cut, list, point, known, tell)?;
    let mut classes = Vec::new();
    for effect in &study.active {
        classes.push((*effect, alternatives(cut, list, &study.last, &study.active, *effect, &study.steps)?));
    }
    Ok(Part { study, signals: cut.signals().to_vec(), classes, torque })
}

/// Levels at which a ceiling would cut what was commanded.
fn ceilings(data: &DataSet, cuts: Cuts) -> Vec<f64> {
    let mut sizes: Vec<f64> = Vec::new();
    for controller in data.runs.iter().filter_map(|run| run.controller.as_ref()) {
        let Some(tau) = controller.column("tau") else { continue };
        match cuts {
            Cuts::Torque => sizes.extend(tau.iter().map(|tau| tau.abs()).filter(|tau| tau.is_finite())),
            Cuts::TorqueRate => {
                sizes.extend(
                    tau.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|jump| jump.is_finite()),
                );
            }
        }
    }
    sizes.sort_by(f64::total_cmp);
    let quantile =
        |share: f64| sizes.get(((sizes.len().max(1) - 1) as f64 * share) as usize).copied().unwrap_or(0.0);
    let levels: Vec<f64> = match cuts {
        Cuts::Torque => {
            let top = [0.97, 0.9].map(|share| share * quantile(1.0));
            [0.999, 0.995, 0.97, 0.9, 0.75, 0.5].map(quantile).into_iter().chain(top).collect()
        }
        // a large step of the torque then takes 2 to 80 ms
        Cuts::TorqueRate => [0.002, 0.006, 0.02, 0.08].iter().map(|time| quantile(0.95) / time).collect(),
    };
    levels.into_iter().filter(|level| *level > 0.0).collect()
}

fn conclude(
    data: &DataSet,
    model: &Model,
    list: &[Candidate],
    parts: &[Part],
    point: &[f64],
    notices: Vec<Notice>,
    units: &UnitPath,
) -> Result<Diagnosis, Error> {
    let mut effects = Vec::new();
    let mut smallest = BTreeMap::new();
    let mut found: Vec<(f64, Where)> = Vec::new();
    let mut gaps: Vec<Gap> = Vec::new();
    let mut rest: Option<Unknown> = None;
    let mut story = Vec::new();
    let mut traces: Vec<Trace> = Vec::new();
    let runs: Vec<String> = data.runs.iter().map(|run| run.name.clone()).collect();
    for part in parts {
        let free: Vec<usize> =
            part.study.active.iter().copied().filter(|index| !list[*index].is_discrete()).collect();
        effects.extend(part_effects(part, list, &free));
        detectable(part, list, &free, &mut smallest);
        found.extend(gap::places(&part.study, &part.signals));
        let gap = gap::gap(&part.study, &free, &runs, part.torque);
        let left = unknown(&part.study, &part.signals, list, part.torque);
        story.extend(story::of(&part.study, list, &gap, left.as_ref()));
        gaps.push(gap);
        traces.push(gap::trace(&part.study, part.torque));
        rest = rest.or(left);
    }
    counted(data, model, list, &mut effects, &mut smallest);
    let verdict = if rest.is_some() {
        Verdict::Unknown
    } else if effects.is_empty() {
        Verdict::None
    } else if effects.iter().any(|effect| effect.class.len() > 1) {
        Verdict::Ambiguous
    } else {
        Verdict::Named
    };
    let ratio = |gap: &Gap| if gap.floor > 0.0 { gap.before / gap.floor } else { 0.0 };
    let gap = gaps.iter().cloned().max_by(|a, b| ratio(a).total_cmp(&ratio(b)));
    let gap = gap.ok_or_else(|| Error::Model("no cut of the loop was compared".into()))?;
    let cuts = parts.iter().map(|part| (&part.study, part.signals.as_slice(), part.classes.as_slice()));
    let (next, experiment) = experiment::next(data, model, list, point, cuts, units);
    let amended = amend::amended(model, list, point, &effects, units)?;
    Ok(Diagnosis {
        verdict,
        effects,
        place: gap::shares(found),
        gap,
        unknown: rest,
        next_experiment: next,
        minimum_detectable: smallest,
        gaps,
        notices,
        story,
        amended,
        experiment,
        traces,
    })
}

fn part_effects(part: &Part, list: &[Candidate], free: &[usize]) -> Vec<Effect> {
    let covariance = part.study.last.covariance(free);
    part.classes
        .iter()
        .map(|(index, alternatives)| {
            let candidate = &list[*index];
            let x = part.study.last.point[*index];
            let error = free
                .iter()
                .position(|other| other == index)
                .and_then(|place| covariance.as_ref().map(|c| c[(place, place)].sqrt()))
                .unwrap_or(0.0);
            let ends = [candidate.value(x - 1.96 * error), candidate.value(x + 1.96 * error)];
            let weight = |alternative: &Alternative| libm::exp(-0.5 * alternative.loss);
            let all: f64 = alternatives.iter().map(weight).sum();
            let own = alternatives.iter().find(|other| other.candidate == *index).map_or(1.0, weight);
            let mut class = vec![candidate.name.to_owned()];
            class.extend(
                alternatives
                    .iter()
                    .filter(|other| other.candidate != *index && other.loss < CLASS)
                    .map(|other| list[other.candidate].name.to_owned()),
            );
            Effect {
                name: candidate.name.to_owned(),
                class,
                value: candidate.value(x),
                ci95: [ends[0].min(ends[1]), ends[0].max(ends[1])],
                probability: (own / all).min(1.0 - ALPHA),
                phrase: candidate.phrase.to_owned(),
                off: candidate.value(candidate.off),
            }
        })
        .collect()
}

/// Smallest size that would have been found, for each candidate of a part.
fn detectable(part: &Part, list: &[Candidate], free: &[usize], into: &mut BTreeMap<String, f64>) {
    let threshold = part.study.screen.null.threshold(ALPHA);
    let covariance = part.study.last.covariance(free);
    for index in &part.study.seen {
        let candidate = &list[*index];
        if candidate.side == Side::Clock {
            continue;
        }
        let size = if let Some(place) = free.iter().position(|other| other == index) {
            covariance.as_ref().map(|covariance| threshold * covariance[(place, place)].sqrt())
        } else {
            let columns = part.study.last.probes.iter().zip(&part.study.screen.errors);
            let own = columns.filter(|(probe, error)| probe.candidate == *index && error.is_finite());
            match candidate.motion {
                // a tangent says nothing of a ceiling: it has none above the largest torque
                Motion::Ceiling { .. } => own
                    .filter(|(probe, error)| probe.by.abs() >= threshold * **error)
                    .map(|(probe, _)| probe.by.abs())
                    .min_by(f64::total_cmp)
                    .map(|by| 1.0 / by),
                _ => own.map(|(_, error)| threshold * error).min_by(f64::total_cmp),
            }
        };
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

fn counted(
    data: &DataSet,
    model: &Model,
    list: &[Candidate],
    effects: &mut Vec<Effect>,
    smallest: &mut BTreeMap<String, f64>,
) {
    let Some(candidate) = list.iter().find(|candidate| candidate.name == "camera.drop_rate") else { return };
    let interval = 1.0 / model.number("camera.omega_cam").unwrap_or(30.0);
    let Some(losses) = losses(data, interval) else { return };
    let (share, ci95) = losses.share();
    // one frame that isn't there is proof against "none is ever lost"; two are asked for
    smallest.insert(candidate.name.to_owned(), candidate.off + 6.0 / losses.expected);
    let outside = candidate.off < ci95[0] || candidate.off > ci95[1];
    if outside && losses.lost >= 2.0 {
        effects.push(Effect {
            name: candidate.name.to_owned(),
            class: vec![candidate.name.to_owned()],
            value: share,
            ci95,
            probability: 1.0 - ALPHA,
            phrase: candidate.phrase.to_owned(),
            off: candidate.off,
        });
    }
}
