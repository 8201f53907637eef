//! Forward selection on one cut: screen linearly, refit the best few through the units, accept what survives the
//! bootstrap and the runs left out, drop what became superfluous, look again.

mod classes;
mod evaluation;
mod refit;
mod screen;

pub use classes::{Alternative, CLASS, alternatives};
pub use evaluation::{Evaluation, FREE, Folds, all_probes};
pub use refit::refit;
pub use screen::{Hit, Screen, screen};

use crate::candidates::{Candidate, Motion, Side};
use crate::error::Error;
use crate::residual::Cut;

/// Family-wise error of one look; a cut is looked at once where nothing is missing.
pub const ALPHA: f64 = 0.005;
/// More effects than this are not a diagnosis any more.
const MOST: usize = 6;
/// How many of the screen's best are refitted, and how good they must be against the best.
const SHORTLIST: usize = 6;
const WORTH: f64 = 0.5;
/// Where a column says little, a fit also begins this many times further out.
const FURTHER: f64 = 2.5;
/// The same where a column says little.
const BENT_WORTH: f64 = 0.15;
/// A gain beyond which columns bend. Below it, pictures are compared by their columns at one and the same pose: the
/// deviances of refits differ by what the pixel lattice does when the picture moves under it.
const LARGE: f64 = 4000.0;
/// By how much a clock that is off must explain more than an effect: forwards it looks just like a delay.
const HANDICAP: f64 = 10.0;
/// Most rounds of fitting values and nuisances in turns; it ends when no value moves by more than this share of its
/// standard error.
const SETTLE: usize = 3;
const MOVED: f64 = 0.2;
/// An active effect below this many standard errors is dropped again.
const KEEP: f64 = 2.6;
/// An effect whose share of the rest's variance is below this is not worth a name when the model lacks something
/// that no candidate gives (with much data anything becomes significant there).
const LEAST_SHARE: f64 = 0.03;

/// One look in the story.
#[derive(Debug, Clone)]
pub struct Step {
    /// Best candidates of the screen with their gains.
    pub best: Vec<Hit>,
    /// Probability that the best is chance.
    pub p_value: f64,
    /// Who was accepted, if anyone.
    pub accepted: Option<usize>,
    /// Who was dropped afterwards.
    pub dropped: Vec<usize>,
    /// Deviance before and after.
    pub deviance: (f64, f64),
    /// Mean square of the whitened rest before and after.
    pub rest: (f64, f64),
    /// Held-out squares before and after.
    pub held_out: (f64, f64),
}

/// The result on one cut.
pub struct Study {
    /// What was compared.
    pub name: &'static str,
    /// Accepted candidates in the order found.
    pub active: Vec<usize>,
    /// The nominal model.
    pub nominal: Evaluation,
    /// The final model with the columns of all candidates.
    pub last: Evaluation,
    /// The last screen: its null distribution and the standard errors of everything.
    pub screen: Screen,
    /// The story.
    pub steps: Vec<Step>,
    /// Blocks left out together.
    pub folds: Folds,
    /// Which candidates the cut sees.
    pub seen: Vec<usize>,
    /// Size of the discrepancy that scattering time stamps explain.
    pub explained: f64,
    /// What the model lacks outweighs noise.
    pub outweighed: bool,
}

/// Selects on one cut, beginning from `start`, where the `known` are on already.
///
/// # Errors
/// A unit failed at the nominal model.
pub fn study(
    cut: &mut dyn Cut,
    candidates: &[Candidate],
    start: &[f64],
    known: &[usize],
    tell: &mut dyn FnMut(&str),
) -> Result<Study, Error> {
    let seen: Vec<usize> = (0..candidates.len()).filter(|index| cut.sees(&candidates[*index])).collect();
    let look = |cut: &mut dyn Cut, point: &[f64], active: &[usize]| {
        let probes = {
            let cut: &dyn Cut = cut;
            all_probes(candidates, point, &|candidate| cut.sees(candidate), active)
        };
        Evaluation::at(cut, point, &probes, false)
    };
    let mut active: Vec<usize> = known.to_vec();
    let mut bare = start.to_vec();
    known.iter().for_each(|index| bare[*index] = candidates[*index].off);
    let mut last = look(cut, &bare, &[])?;
    let nominal = last.clone();
    let folds = Folds::new(&last.blocks);
    let mut steps = Vec::new();
    if !known.is_empty() {
        let mut point = start.to_vec();
        cut.afresh();
        settle(cut, candidates, &mut active, &mut point)?;
        last = look(cut, &point, &active)?;
    }
    let mut found = screen(&last, candidates, &active);
    let mut refused: Vec<usize> = Vec::new();
    while active.len() < MOST {
        let mut step = Step {
            best: found.hits.iter().take(8).cloned().collect(),
            p_value: found.p_value,
            accepted: None,
            dropped: Vec::new(),
            deviance: (last.deviance(), last.deviance()),
            rest: (rest(&last), rest(&last)),
            held_out: (f64::NAN, f64::NAN),
        };
        let threshold = found.null.threshold(ALPHA);
        let shortlist = shortlist(&found, candidates, &refused, threshold, cut.outweighed());
        let switched = switched(cut, candidates, &last, &active, &refused)?;
        if shortlist.is_empty() && switched.is_none() {
            steps.push(step);
            break;
        }
        let mut trials: Vec<(usize, f64, Evaluation)> = switched.into_iter().collect();
        for hit in &shortlist {
            for x in starts(candidates, &last, hit) {
                let mut point = last.point.clone();
                point[hit.candidate] = x;
                let mut with = active.clone();
                with.push(hit.candidate);
                if let Ok(trial) = refit(cut, candidates, &point, &with) {
                    // a composite likelihood's gain counts as much as its blocks agree
                    let temper =
                        if cut.outweighed() { hit.statistic * hit.statistic / hit.gain } else { 1.0 };
                    let nuisance = candidates[hit.candidate].side == Side::Clock;
                    let handicap = if nuisance { HANDICAP } else { 0.0 };
                    trials.push((
                        hit.candidate,
                        (last.deviance() - trial.deviance()) * temper - handicap,
                        trial,
                    ));
                }
            }
        }
        trials.sort_by(|a, b| b.1.total_cmp(&a.1));
        let linear = cut.lattice() && shortlist.iter().all(|hit| hit.gain < LARGE);
        if linear {
            let gain = |index: usize| {
                found.hits.iter().find(|hit| hit.candidate == index).map_or(0.0, |hit| hit.gain)
            };
            trials.sort_by(|a, b| gain(b.0).total_cmp(&gain(a.0)));
        }
        let mut accepted = None;
        for (candidate, _, trial) in trials {
            let before = last.under(&trial);
            let now = if linear { &last } else { &trial };
            let then = if linear { &last } else { &before };
            let held_out = (then.held_out(&folds, &active), now.held_out(&folds, &with(&active, candidate)));
            let share = 1.0 - trial.total.square / before.total.square;
            let enough = share >= LEAST_SHARE || last.total.square < 1.5 * last.total.freedom;
            if held_out.1 < held_out.0 && enough {
                step.held_out = held_out;
                step.deviance.1 = trial.deviance();
                accepted = Some((candidate, trial));
                break;
            }
            refused.push(candidate);
        }
        let Some((candidate, trial)) = accepted else {
            steps.push(step);
            break;
        };
        tell(&format!("{}: {}", cut.name(), candidates[candidate].name));
        active.push(candidate);
        step.accepted = Some(candidate);
        let mut point = trial.point.clone();
        step.dropped = settle(cut, candidates, &mut active, &mut point)?;
        refused.extend(&step.dropped);
        last = look(cut, &point, &active)?;
        step.rest.1 = rest(&last);
        found = screen(&last, candidates, &active);
        let stuck = step.dropped.contains(&candidate);
        steps.push(step);
        if stuck {
            break;
        }
    }
    let (explained, outweighed) = (cut.explained(), cut.outweighed());
    let name = cut.name();
    Ok(Study { name, active, nominal, last, screen: found, steps, folds, seen, explained, outweighed })
}

/// The best of the switches, if one makes the model fit far better: half a law of motion is too much for a column, and
/// windows that had to be led along the log say nothing linear of it. Tried only where more than noise is left.
fn switched(
    cut: &mut dyn Cut,
    candidates: &[Candidate],
    last: &Evaluation,
    active: &[usize],
    refused: &[usize],
) -> Result<Option<(usize, f64, Evaluation)>, Error> {
    let mut best: Option<(usize, f64, Evaluation)> = None;
    if last.softness == 0.0 || cut.outweighed() || cut.lattice() {
        return Ok(None);
    }
    for (index, candidate) in candidates.iter().enumerate() {
        let open =
            candidate.motion == Motion::Switch && !active.contains(&index) && !refused.contains(&index);
        if !open || !cut.sees(candidate) || last.point[index] != candidate.off {
            continue;
        }
        let mut point = last.point.clone();
        point[index] += candidate.steps[0];
        cut.afresh();
        let trial = Evaluation::at(cut, &point, &[], false);
        cut.afresh();
        Evaluation::at(cut, &last.point, &[], false)?;
        let Ok(trial) = trial else { continue };
        let fall = last.deviance() - trial.deviance();
        if fall > LARGE.max(best.as_ref().map_or(0.0, |best| best.1)) {
            best = Some((index, fall, trial));
        }
    }
    Ok(best)
}

fn with(active: &[usize], candidate: usize) -> Vec<usize> {
    let mut all = active.to_vec();
    all.push(candidate);
    all
}

/// Mean square of the whitened rest.
fn rest(evaluation: &Evaluation) -> f64 {
    evaluation.total.square / evaluation.total.freedom.max(1.0)
}

/// Who is worth a fit. One statistic above the threshold says that something is there; what it is, the likelihood
/// says: an effect that shows in a few blocks only (a delay, in transients) has a small statistic over blocks however
/// large it is, so below the threshold it still competes by its gain.
fn shortlist(
    found: &Screen,
    candidates: &[Candidate],
    refused: &[usize],
    threshold: f64,
    outweighed: bool,
) -> Vec<Hit> {
    let mut hits: Vec<Hit> =
        found.hits.iter().filter(|hit| !refused.contains(&hit.candidate)).cloned().collect();
    if outweighed || !hits.iter().any(|hit| hit.statistic > threshold) {
        hits.retain(|hit| hit.statistic > threshold);
    }
    let worth = |hit: &Hit| if outweighed { hit.statistic * hit.statistic } else { hit.gain };
    hits.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    let best = hits.first().map_or(0.0, worth);
    let least = |hit: &Hit| if candidates[hit.candidate].bends && !outweighed { BENT_WORTH } else { WORTH };
    hits.retain(|hit| worth(hit) >= least(hit) * best);
    hits.truncate(SHORTLIST);
    hits
}

/// Coordinates from which a hit is fitted.
fn starts(candidates: &[Candidate], last: &Evaluation, hit: &Hit) -> Vec<f64> {
    let candidate = &candidates[hit.candidate];
    let x = last.point[hit.candidate];
    if candidate.is_discrete() {
        // the whole numbers around what the columns ask for
        let wanted = x + hit.displacement;
        let near = |at: &f64| (at - wanted).abs() <= 1.0;
        let all: Vec<f64> = candidate.steps.iter().map(|step| candidate.off + step).collect();
        let some: Vec<f64> = all.iter().copied().filter(near).collect();
        return if some.is_empty() { all[..1].to_vec() } else { some };
    }
    let by = last.probes[hit.column].by;
    let wanted = match candidate.motion {
        Motion::Ceiling { .. } => x + by,
        _ => x + hit.displacement,
    };
    let mut all = vec![wanted.clamp(candidate.range.0, candidate.range.1)];
    if candidate.bends {
        all.push((x + FURTHER * (wanted - x)).clamp(candidate.range.0, candidate.range.1));
    }
    all
}

/// Nuisances and values in turns, until no value moves much. Answers who was dropped.
fn settle(
    cut: &mut dyn Cut,
    candidates: &[Candidate],
    active: &mut Vec<usize>,
    point: &mut Vec<f64>,
) -> Result<Vec<usize>, Error> {
    let mut all = Vec::new();
    for _ in 0..SETTLE {
        // the nuisances first, since a fit leaves them where the last look found them
        Evaluation::at(cut, point, &[], false)?;
        let before = point.clone();
        let (dropped, tiny) = prune(cut, candidates, active, point)?;
        all.extend(dropped);
        if (0..point.len()).all(|place| (point[place] - before[place]).abs() <= tiny[place]) {
            break;
        }
    }
    Ok(all)
}

/// Drops what is superfluous, the weakest first, and fits the rest again. Answers who was dropped, and for each
/// candidate by how much it may still move to count as settled.
fn prune(
    cut: &mut dyn Cut,
    candidates: &[Candidate],
    active: &mut Vec<usize>,
    point: &mut Vec<f64>,
) -> Result<(Vec<usize>, Vec<f64>), Error> {
    let mut dropped = Vec::new();
    let mut tiny = vec![f64::INFINITY; candidates.len()];
    loop {
        let fit = refit(cut, candidates, point, active)?;
        point.clone_from(&fit.point);
        let free: Vec<usize> =
            active.iter().copied().filter(|index| !candidates[*index].is_discrete()).collect();
        let Some(covariance) = fit.covariance(&free) else { return Ok((dropped, tiny)) };
        let error = |place: usize| covariance[(place, place)].sqrt();
        for (place, index) in free.iter().enumerate() {
            tiny[*index] = MOVED * error(place);
        }
        let size =
            |place: usize, index: usize| (fit.point[index] - candidates[index].off).abs() / error(place);
        let weakest = (free.iter().enumerate())
            .map(|(place, index)| (size(place, *index), *index))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match weakest {
            Some((size, index)) if size < KEEP => {
                active.retain(|other| *other != index);
                point[index] = candidates[index].off;
                dropped.push(index);
            }
            _ => return Ok((dropped, tiny)),
        }
    }
}
