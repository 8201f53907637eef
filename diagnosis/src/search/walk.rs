//! The search: add the effect that gains most, then drop and swap what has become superfluous, until nothing gains enough.

use super::Policy;
use super::screen::{Last, Screen, Screened, linearised, ranked};
use crate::dynamics::linearise::Engine;
use crate::earlier::Earlier;
use crate::error::Error;
use crate::infer::Sizes;
use crate::infer::fit::{At, Fit, Linearise, Options, fit_from};
use crate::infer::likelihood::maximise;
use crate::observe::Scale;
use crate::statistics::levels::{PART, SMALL};
use crate::watch::Watch;
use std::collections::BTreeMap;

/// What ends early where time is up.
const FURTHER: &str = "the search for further effects";

/// The models that were fitted, by their effects.
pub type Visited = BTreeMap<Vec<usize>, Fit>;

/// A search under way.
pub struct Search<'a> {
    /// The machine with its runs.
    pub engine: &'a Engine,
    /// Which noises are free.
    pub sizes: Sizes,
    /// Thresholds, in deviance, and how much is tried.
    pub policy: Policy,
    /// Knobs of each fit.
    pub options: Options,
    /// Parameters that may be off.
    pub candidates: Vec<usize>,
    /// Whether what no effect gives may be an unlisted input.
    pub yields: bool,
    /// What is known of the machine from other data.
    pub earlier: Option<&'a Earlier>,
    /// Models that were fitted already.
    pub visited: Visited,
    /// What was done, in words.
    pub story: Vec<String>,
    /// What a user should look at.
    pub doubts: Vec<String>,
    /// The last screening of a walk, which found nothing more.
    pub last: Option<Last>,
}

/// Whether a candidate that was screened may gain what a name must, once it is fitted: a linear gain is at least half of that.
fn may_gain(screened: f64, least: f64) -> bool {
    screened > 0.5 * least
}

/// Whether a candidate that was screened may fit better than the effect that gains `floor` within its class: linear gains are off by a
/// fifth where both are small.
fn may_replace(screened: f64, floor: f64) -> bool {
    screened > 0.8 * floor
}

/// Whether another takes an effect's place: by less of deviance than 1 two fits of one model differ, and a search would go to and fro.
pub(super) fn replaces(other: f64, own: f64) -> bool {
    other < own - 1.0
}

/// What the story says of a search that ended since a model has as many effects as it may.
fn ended_by_most(effects: usize, most: usize) -> Option<String> {
    (effects >= most)
        .then(|| format!("a model has {most} effects at most: whether it lacks a further one was not asked"))
}

impl Search<'_> {
    /// A switch or count is set, everything else is fitted.
    pub fn is_fitted(&self, parameter: usize) -> bool {
        !matches!(self.engine.machine.parameters[parameter].scale, Scale::Switch | Scale::Count)
    }

    /// Name of a parameter.
    pub(super) fn name(&self, parameter: usize) -> &str {
        &self.engine.machine.parameters[parameter].name
    }

    /// Fits a model from a place on, unless it was visited. `effects` are the parameters off their neutral values.
    ///
    /// # Errors
    /// A unit failed.
    pub fn visit(&mut self, effects: &[usize], start: &At) -> Result<Fit, Error> {
        self.visit_from(effects, start, None)
    }

    /// As [`Self::visit`], with what a screening about this very start has linearised already.
    pub(super) fn visit_from(
        &mut self,
        effects: &[usize],
        start: &At,
        screen: Option<&Screen>,
    ) -> Result<Fit, Error> {
        let mut key = effects.to_vec();
        key.sort_unstable();
        let free: Vec<usize> = key.iter().copied().filter(|effect| self.is_fitted(*effect)).collect();
        if let Some(known) = self.visited.get(&key) {
            return Ok(known.clone());
        }
        let known = screen.and_then(|screen| screen.about(self.engine, &start.theta, &free));
        let (start, runs) =
            match known.map_or_else(|| self.engine.linearise(&start.theta, &start.paths, &free), Ok) {
                Ok(runs) => (start.clone(), runs),
                // states that one model visits may be beyond what another can be run with: it begins along its own path
                Err(Error::Model(_)) => {
                    let paths = self.engine.first_paths(&start.theta, &start.noise)?;
                    let runs = self.engine.linearise(&start.theta, &paths, &free)?;
                    (At { paths, ..start.clone() }, runs)
                }
                Err(error) => return Err(error),
            };
        let fitted = fit_from(self.engine, &start, runs, &free, Some(&self.sizes), &self.options)?;
        self.visited.insert(key, fitted.clone());
        Ok(fitted)
    }

    /// The model without one of its effects, and its fit. A fit from elsewhere may have ended at a worse place: where it says that the
    /// effect is needed, and the effect is hardly off neutral by its own deviation, it is fitted from here, too. `None`: the model can't be
    /// followed through the log without it.
    ///
    /// # Errors
    /// Units are too slow.
    pub(super) fn without_effect(
        &mut self,
        effects: &[usize],
        here: &Fit,
        place: usize,
    ) -> Result<Option<(Vec<usize>, Fit)>, Error> {
        let mut left = effects.to_vec();
        let gone = left.remove(place);
        let mut start = here.at.clone();
        start.theta[gone] = self.engine.machine.parameters[gone].neutral;
        let less = match self.visit(&left, &start) {
            Ok(less) => less,
            Err(Error::Model(_)) => return Ok(None),
            Err(error) => return Err(error),
        };
        let off = (here.at.theta[gone] - start.theta[gone]) / here.deviation(gone);
        let doubtful = off * off < self.policy.gain && less.deviance - here.deviance >= self.policy.gain;
        if !doubtful || !self.is_fitted(gone) {
            return Ok(Some((left, less)));
        }
        let better = self.visited_anew(&left, &start)?.unwrap_or(less);
        Ok(Some((left, better)))
    }

    /// A fit of a model from this place, though it was visited from another: the better of the two; `None` where units can't be run so.
    pub(super) fn visited_anew(&mut self, effects: &[usize], start: &At) -> Result<Option<Fit>, Error> {
        let mut key = effects.to_vec();
        key.sort_unstable();
        let before = self.visited.remove(&key);
        let again = match self.visit(effects, start) {
            Ok(again) => Some(again),
            Err(Error::Model(_)) => None,
            Err(error) => return Err(error),
        };
        let best = [before, again].into_iter().flatten().min_by(|a, b| a.deviance.total_cmp(&b.deviance));
        self.visited.extend(best.clone().map(|best| (key, best)));
        Ok(best)
    }

    /// A fit with its linearised runs, made anew if they were put away.
    ///
    /// # Errors
    /// A unit failed.
    pub fn with_linearised_runs(&self, mut fit: Fit) -> Result<Fit, Error> {
        if fit.runs.is_empty() {
            fit.runs = self.engine.linearise(&fit.at.theta, &fit.at.paths, &fit.free)?;
        }
        Ok(fit)
    }

    /// Drops effects, the weakest first, until each gains enough beside the others; `than` is what explains as much as one that is dropped.
    ///
    /// # Errors
    /// A unit failed.
    pub fn pruned(
        &mut self,
        mut effects: Vec<usize>,
        mut here: Fit,
        than: &str,
    ) -> Result<(Vec<usize>, Fit), Error> {
        while !effects.is_empty() {
            let mut weakest: Option<(usize, Fit)> = None;
            for place in 0..effects.len() {
                let Some((_, less)) = self.without_effect(&effects, &here, place)? else { continue };
                if weakest.as_ref().is_none_or(|(_, known)| less.deviance < known.deviance) {
                    weakest = Some((place, less));
                }
            }
            let Some((place, less)) =
                weakest.filter(|(_, less)| less.deviance - here.deviance < self.policy.gain)
            else {
                break;
            };
            let gone = effects.remove(place);
            self.story.push(format!("{} explains nothing that {than}", self.name(gone)));
            here = less;
        }
        Ok((effects, here))
    }

    /// Withdraws effects of which the stretches of the log say different things: what an unlisted input's form gets wrong.
    ///
    /// # Errors
    /// A unit failed.
    pub fn agreed(&mut self, mut effects: Vec<usize>, mut here: Fit) -> Result<(Vec<usize>, Fit), Error> {
        let sure = self.policy.sure;
        loop {
            here = self.with_linearised_runs(here)?;
            let clear = |effect: usize| {
                let off = here.at.theta[effect] - self.engine.machine.parameters[effect].neutral;
                (off / here.robust_deviation(effect)).powi(2)
            };
            let fitted = effects.iter().copied().filter(|effect| self.is_fitted(*effect));
            let weakest = fitted.map(|effect| (clear(effect), effect)).min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, gone)) = weakest.filter(|(clear, _)| *clear < sure) else {
                return Ok((effects, here));
            };
            self.story.push(format!(
                "stretches of the log disagree about {}: it stands for a part of the unlisted input",
                self.name(gone)
            ));
            effects.retain(|effect| *effect != gone);
            let mut start = here.at.clone();
            start.theta[gone] = self.engine.machine.parameters[gone].neutral;
            here = self.visit(&effects, &start)?;
        }
    }

    /// What fitted models cost in memory: their linearised runs, which are made anew where they are wanted.
    fn trim(&mut self) {
        self.visited.values_mut().for_each(|fit| fit.runs.clear());
    }

    /// Candidates that are none of these effects.
    pub(super) fn others(&self, effects: &[usize]) -> Vec<usize> {
        self.candidates.iter().copied().filter(|candidate| !effects.contains(candidate)).collect()
    }

    /// Searches from a fitted model on. The effects and their fit.
    ///
    /// # Errors
    /// A unit failed at a place where it had worked.
    pub fn walk(
        &mut self,
        mut effects: Vec<usize>,
        mut here: Fit,
        watch: &mut Watch<'_>,
    ) -> Result<(Vec<usize>, Fit), Error> {
        while effects.len() < self.policy.most && !watch.is_over(FURTHER) {
            let screen = linearised(self.engine, &here, &self.others(&effects))?;
            let ranked = ranked(self.engine, &here, &screen, &self.sizes, &self.policy);
            if let Some(first) = ranked.first() {
                watch.trying(self.name(first.chord.parameter), effects.len(), self.policy.most);
            }
            let worth = ranked.iter().filter(|screened| may_gain(screened.gain, self.policy.gain));
            let tried: Vec<Screened> = worth.take(self.policy.fitted).copied().collect();
            let best = self.best_fitted(&effects, &here, &screen, &tried);
            let late = self.late_sensors(&effects, &here)?.into_iter();
            let late = late.map(|(delay, fit)| (effects.iter().copied().chain([delay]).collect(), fit));
            let best = late.chain(best).min_by(|a, b| a.1.deviance.total_cmp(&b.1.deviance));
            let Some((with, fit)) = best.filter(|(_, fit)| self.is_an_effect(&here, fit)) else {
                self.last = Some(screen.last(&here));
                break;
            };
            // another in its place says as much with fewer names
            let (swapped, other) = self.settled(effects.clone(), here.clone(), watch)?;
            if swapped != effects {
                (effects, here) = (swapped, self.with_linearised_runs(other)?);
                continue;
            }
            let gained = here.deviance - fit.deviance;
            let name = self.name(with[with.len() - 1]).to_owned();
            self.story
                .push(format!("{name} explains most of what is left: it gains {gained:.0} of deviance"));
            (effects, here) = (with, fit);
            (effects, here) = self.settled(effects, here, watch)?;
            self.trim();
        }
        self.tell_of_most(effects.len());
        Ok((effects, here))
    }

    /// Says that the search went no further since a model has as many effects as it may.
    fn tell_of_most(&mut self, effects: usize) {
        let told = ended_by_most(effects, self.policy.most);
        self.story.extend(told.filter(|told| !self.story.contains(told)));
    }

    /// The sizes of the noises where no equation has process noise.
    pub(super) fn without_process(&self) -> Sizes {
        self.sizes.with_pinned(vec![true; self.engine.machine.order()])
    }

    /// Whether a model with one more effect gains enough. What reality lacks and no effect gives is process noise's to begin with: an effect
    /// that gains little beside it, and without it takes little of what it gains, stands for a part of that, and is looked for again beside an
    /// unlisted input.
    fn is_an_effect(&self, here: &Fit, with: &Fit) -> bool {
        let gained = here.deviance - with.deviance;
        if gained < self.policy.gain || !self.yields || here.at.noise.disturbance.is_some() {
            return gained >= self.policy.gain;
        }
        let exact = self.without_process();
        let none = |fit: &Fit| {
            let columns: Vec<usize> = (0..fit.free.len()).collect();
            maximise(&fit.runs, &columns, &exact.quieted(fit.at.noise.clone()), &exact).1
        };
        let before = none(here);
        let process = before - here.deviance;
        process <= self.policy.unknown || gained >= SMALL * process || before - none(with) >= PART * process
    }

    /// Drops what gains too little beside the others, and swaps what another explains better.
    fn settled(
        &mut self,
        mut effects: Vec<usize>,
        mut here: Fit,
        watch: &mut Watch<'_>,
    ) -> Result<(Vec<usize>, Fit), Error> {
        let mut place = 0;
        while place < effects.len() {
            let gone = effects[place];
            let Some((without, less)) = self.without_effect(&effects, &here, place)? else {
                place += 1;
                continue;
            };
            if less.deviance - here.deviance < self.policy.gain {
                self.story.push(format!("{} is no longer needed beside the others", self.name(gone)));
                (effects, here, place) = (without, less, 0);
                continue;
            }
            if watch.is_over(FURTHER) {
                place += 1;
                continue;
            }
            let screen = linearised(self.engine, &less, &self.others(&without))?;
            let ranked = ranked(self.engine, &less, &screen, &self.sizes, &self.policy);
            let floor = less.deviance - here.deviance - self.policy.class;
            let near: Vec<Screened> = (ranked.iter())
                .filter(|screened| screened.chord.parameter != gone && may_replace(screened.gain, floor))
                .take(self.policy.fitted)
                .copied()
                .collect();
            if let Some((with, fit)) = self.best_fitted(&without, &less, &screen, &near)
                && replaces(fit.deviance, here.deviance)
            {
                let other = self.name(with[with.len() - 1]).to_owned();
                self.story.push(format!("{other} fits better than {} in its place", self.name(gone)));
                (effects, here, place) = (with, fit, 0);
                continue;
            }
            place += 1;
        }
        Ok((effects, here))
    }
}

#[cfg(test)]
mod tests {
    use super::{ended_by_most, may_gain, may_replace, replaces};

    #[test]
    fn law_a_search_that_ends_for_its_many_effects_says_so() {
        let told = [4, 5, 6].map(|effects| ended_by_most(effects, 5).is_some());
        assert_eq!(told, [false, true, true]);
    }

    #[test]
    fn value_what_a_screened_candidate_must_gain_to_be_fitted() {
        // the threshold of twenty candidates is 20.8: what seems to gain 11 may gain that, what seems to gain 10 is not tried
        assert!(may_gain(11.0, 20.8) && !may_gain(10.0, 20.8));
        assert!(may_replace(85.0, 100.0) && !may_replace(75.0, 100.0));
        assert!(replaces(98.9, 100.0) && !replaces(99.1, 100.0));
    }
}
