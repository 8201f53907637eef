//! What is tried where something is left that no single effect takes away: two effects together, and then names beside an unlisted input.

use super::residual::{Residual, judge_residual};
use crate::error::Error;
use crate::infer::{At, Fit};
use crate::search::Search;
use crate::watch::Watch;

/// What a search has: the parameters off their neutral values, their fit, and what process noise says of it.
type Found = (Vec<usize>, Fit, Residual);

/// Goes on where process noise stays above its floor.
///
/// # Errors
/// A unit failed.
pub(super) fn name_the_rest(
    search: &mut Search<'_>,
    residual: Residual,
    effects: Vec<usize>,
    here: Fit,
    watch: &mut Watch<'_>,
) -> Result<Found, Error> {
    let told = search.story.len();
    if let Some(found) = by_two(search, &residual, &effects, &here, watch)? {
        return Ok(found);
    }
    // names that did not hold are no part of the story
    search.story.truncate(told);
    beside_unlisted(search, residual, effects, here, watch)
}

/// Two effects that leave nothing without a name, and the search from there on; `None` where something stays without one: an unlisted input that
/// is there no two take away.
fn by_two(
    search: &mut Search<'_>,
    residual: &Residual,
    effects: &[usize],
    here: &Fit,
    watch: &mut Watch<'_>,
) -> Result<Option<Found>, Error> {
    if watch.is_over("the search for two effects together") {
        return Ok(None);
    }
    let Some((with, fit)) = search.with_pair(effects, here, residual.evidence)? else { return Ok(None) };
    let fit = search.with_linearised_runs(fit)?;
    if judge_residual(search.engine, &fit, &search.sizes, &search.policy).unlisted.is_some() {
        return Ok(None);
    }
    let (effects, here) = search.pruned(with, fit, "the others don't")?;
    let here = search.with_linearised_runs(here)?;
    let (effects, here) = search.walk(effects, here, watch)?;
    let here = search.with_linearised_runs(here)?;
    let left = judge_residual(search.engine, &here, &search.sizes, &search.policy);
    Ok(left.unlisted.is_none().then_some((effects, here, left)))
}

/// Goes on beside the unlisted input that was found: what has no name remembers, and beside it only names count that explain more than it
/// does.
fn beside_unlisted(
    search: &mut Search<'_>,
    residual: Residual,
    effects: Vec<usize>,
    here: Fit,
    watch: &mut Watch<'_>,
) -> Result<Found, Error> {
    search.story.push(format!(
        "process noise stays above its floor: it gains {:.0} of deviance; the search goes on beside an unlisted input",
        residual.evidence
    ));
    let alone = search.policy;
    search.policy = alone.beside(residual.evidence);
    search.sizes = residual.sizes;
    search.visited.clear();
    let mut start = here.at;
    start.noise = residual.unlisted.unwrap_or(start.noise);
    if let Some(bare) = with_a_turned_sign(search, &effects, &start)? {
        let residual = judge_residual(search.engine, &bare, &search.sizes, &search.policy);
        return Ok((Vec::new(), bare, residual));
    }
    let again = search.visit(&effects, &start)?;
    let (effects, here) = search.pruned(effects, again, "the unlisted input doesn't")?;
    let fresh = search.with_linearised_runs(here)?;
    let (effects, here) = search.walk(effects, fresh, watch)?;
    let here = search.with_linearised_runs(here)?;
    let (effects, here) = search.agreed(effects, here)?;
    let (effects, here) = search.nearer(effects, here, alone, watch)?;
    let residual = judge_residual(search.engine, &here, &search.sizes, &search.policy);
    Ok((effects, here, residual))
}

/// The fit without any name, if it says that the sign of a column is turned: beside that every name is wrong. Whole runs have no course of an
/// unlisted input that could say so.
fn with_a_turned_sign(search: &mut Search<'_>, effects: &[usize], start: &At) -> Result<Option<Fit>, Error> {
    if start.noise.disturbance.is_none() || search.engine.machine.whole {
        return Ok(None);
    }
    let mut start = start.clone();
    for effect in effects {
        start.theta[*effect] = search.engine.machine.parameters[*effect].neutral;
    }
    let bare = match search.visit(&[], &start) {
        Ok(bare) => search.with_linearised_runs(bare)?,
        // it can't be followed without them
        Err(Error::Model(_)) => return Ok(None),
        Err(error) => return Err(error),
    };
    Ok(search.finds_a_turned_sign(&bare)?.then_some(bare))
}
