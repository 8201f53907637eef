//! Forward selection on one cut: screen linearly, refit the best few through the units, accept what survives the
//! bootstrap and the runs left out, drop what became superfluous, look again.

mod bare;
mod classes;
mod evaluation;
mod evidence;
mod refit;
mod screen;
mod settle;
mod steady;
mod trials;

pub use classes::{Alternative, CLASS, alternatives};
pub use evaluation::{Evaluation, FREE, Folds, all_probes};
pub use evidence::{STAMPS, lacking};
pub use refit::refit;
pub use screen::{Hit, Screen, screen};
use settle::{Opinion, second_opinion, settle};
pub use steady::{Steadiness, steadiness};
use trials::{Accepted, Trials, shortlist, switched};

use crate::candidates::Candidate;
use crate::error::Error;
use crate::residual::Cut;

/// Family-wise error of one look; a cut is looked at once where nothing is missing.
pub const ALPHA: f64 = 0.005;
/// More effects than this are not a diagnosis any more.
const MOST: usize = 6;

/// So many may be accepted and turn out superfluous at once.
const VAIN: usize = 4;

/// A fit that leaves so much more than without the new effect (deviance) has led the windows elsewhere, and taken what was found
/// before away with it.
const ASTRAY: f64 = 100.0;

/// What a step of the active values promises at most where they are settled, a standard error, and how often they are settled
/// again.
const UNSETTLED: f64 = 1.0;
const AGAIN: usize = 3;

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
    /// All that could stand in the place of the effect that was accepted last, where they were asked for at the final model.
    pub class: Option<(usize, Vec<Alternative>)>,
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
        let first = Evaluation::at(cut, point, &probes, false)?;
        // the look itself has put frames elsewhere
        if cut.free_pose() { Evaluation::at(cut, point, &probes, false) } else { Ok(first) }
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
    let (mut vain, mut in_vain) = (0, Vec::new());
    let mut class = None;
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
        let switched = switched(cut, candidates, &last, &active, &refused, &mut in_vain)?;
        let set = Trials { candidates, folds: &folds, last: &last, found: &found, active: &active };
        let best = match set.best(cut, &shortlist, switched, &mut refused)? {
            None => set.sparse(cut, &refused)?,
            best => best,
        };
        let Some(best) = best else {
            steps.push(step);
            break;
        };
        let Accepted { candidate, trial, held_out } = best;
        step.held_out = held_out;
        step.deviance.1 = trial.deviance();
        tell(&format!("{}: {}", cut.name(), candidates[candidate].name));
        let before = (active.clone(), last.point.clone(), last.deviance());
        class = None;
        active.push(candidate);
        step.accepted = Some(candidate);
        let mut point = trial.point.clone();
        // windows that had to be led may follow the log by themselves now
        cut.afresh();
        step.dropped = settle(cut, candidates, &mut active, &mut point)?;
        last = look(cut, &point, &active)?;
        step.dropped.extend(again(cut, candidates, &look, &mut active, &mut last)?);
        refused.extend(&step.dropped);
        step.rest.1 = rest(&last);
        let compared = !cut.lattice() || cut.free_pose();
        if compared && !cut.outweighed() && last.deviance() > before.2 + ASTRAY {
            (active, point) = (before.0, before.1);
            (step.dropped, step.rest.1) = (vec![candidate], step.rest.0);
            refused.push(candidate);
            cut.afresh();
            last = look(cut, &point, &active)?;
        }
        found = screen(&last, candidates, &active);
        let stuck = step.dropped.contains(&candidate);
        steps.push(step);
        if stuck {
            // refused from now on; what it hid may be the truth
            vain += 1;
            if vain > VAIN {
                break;
            }
            continue;
        }
        match second_opinion(cut, candidates, &last, &mut active, candidate, &steps)? {
            Opinion::Stays(others) => class = Some((candidate, others)),
            Opinion::Swapped(other) => {
                class = None;
                let swapped = active.last().copied();
                last = look(cut, &other, &active)?;
                let dropped = again(cut, candidates, &look, &mut active, &mut last)?;
                found = screen(&last, candidates, &active);
                refused.extend(&dropped);
                // what was swapped for it could be accepted again and again
                vain += usize::from(!dropped.is_empty());
                if let Some(step) = steps.last_mut() {
                    step.accepted = swapped;
                    step.dropped.extend(dropped);
                    step.rest.1 = rest(&last);
                }
                if vain > VAIN {
                    break;
                }
            }
        }
    }
    let (explained, outweighed) = (cut.explained(), cut.outweighed());
    let name = cut.name();
    Ok(Study { name, active, nominal, last, class, screen: found, steps, folds, seen, explained, outweighed })
}

/// A look at a point, with the columns of all candidates.
type Look<'a> = dyn Fn(&mut dyn Cut, &[f64], &[usize]) -> Result<Evaluation, Error> + 'a;

/// Fits again and looks again where a look has put frames elsewhere, so that values aren't at their best any more. Answers who was
/// dropped.
fn again(
    cut: &mut dyn Cut,
    candidates: &[Candidate],
    look: &Look<'_>,
    active: &mut Vec<usize>,
    last: &mut Evaluation,
) -> Result<Vec<usize>, Error> {
    let mut dropped = Vec::new();
    for _ in 0..AGAIN {
        let free: Vec<usize> =
            active.iter().copied().filter(|index| !candidates[*index].is_discrete()).collect();
        let settled = last.promise(&free).is_none_or(|promise| promise < UNSETTLED);
        if settled || !cut.free_pose() {
            break;
        }
        let mut point = last.point.clone();
        dropped.extend(settle(cut, candidates, active, &mut point)?);
        *last = look(cut, &point, active)?;
    }
    Ok(dropped)
}

/// Mean square of the whitened rest.
fn rest(evaluation: &Evaluation) -> f64 {
    evaluation.total.square / evaluation.total.freedom.max(1.0)
}
