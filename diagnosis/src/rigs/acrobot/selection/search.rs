//! The search on one cut: linearise, accept one more effect, settle, drop what became superfluous, ask for a second opinion, and
//! linearise again, until nothing is worth a name.

use super::evaluation::{Evaluation, all_perturbations};
use super::folds::Folds;
use super::screen::{Screen, screen};
use super::settle::{Opinion, second_opinion, settle};
use super::shortlist::{Refused, shortlist};
use super::switches::best_switch;
use super::trials::{Accepted, Trials};
use super::{Alternative, Questioned, Step, Study};
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Candidate, Side, continuous};
use crate::rigs::acrobot::noise_floor;
use crate::rigs::acrobot::residual::{Perturbation, Tracked};
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::watch::Watch;

mod subset_steps;

/// What ends early where time is up.
pub(super) const SEARCH: &str = "the search for effects";

/// Selects on one cut, beginning from `start`, where the `known` are on already.
///
/// # Errors
/// A unit failed at the nominal model.
pub fn study(
    cut: &mut Tracked,
    candidates: &[Candidate],
    start: &[f64],
    known: &[usize],
    watch: &mut Watch<'_>,
) -> Result<Study, Error> {
    study_until(cut, candidates, start, known, watch, &mut |_, _| Ok(false))
}

/// Says of the effects that are on whether to search no further.
pub type Enough<'a> = &'a mut dyn FnMut(&[usize], &mut Watch<'_>) -> Result<bool, Error>;

/// Selects on one cut as [`study`] does, ended when it is `enough`.
///
/// # Errors
/// A unit failed at the nominal model.
pub fn study_until(
    cut: &mut Tracked,
    candidates: &[Candidate],
    start: &[f64],
    known: &[usize],
    watch: &mut Watch<'_>,
    enough: Enough<'_>,
) -> Result<Study, Error> {
    let mut search = Search::begin(cut, candidates, start, known)?;
    // a repeated search begins with what has stood that already
    if watch.known().is_none() {
        search.doubt_known(watch)?;
    }
    search.one_by_one(SELECTION.search_most, watch, &mut *enough)?;
    if !watch.is_over(SEARCH) && search.all_at_once(watch) {
        let most = search.active.len() + 1;
        search.one_by_one(most, watch, enough)?;
    }
    Ok(search.end())
}

/// A search on one cut, as far as it has come.
struct Search<'a> {
    cut: &'a mut Tracked,
    candidates: &'a [Candidate],
    folds: Folds,
    active: Vec<usize>,
    nominal: Evaluation,
    last: Evaluation,
    found: Screen,
    refused: Refused,
    /// All that were ever accepted, and who took whose place.
    accepted: Vec<usize>,
    swaps: Vec<(usize, usize)>,
    /// Switches that make things worse.
    in_vain: Vec<usize>,
    class: Option<(usize, Vec<Alternative>)>,
    steps: Vec<Step>,
}

impl<'a> Search<'a> {
    /// Linearises the nominal model, and the model with the `known` effects on if there are any.
    fn begin(
        cut: &'a mut Tracked,
        candidates: &'a [Candidate],
        start: &[f64],
        known: &[usize],
    ) -> Result<Self, Error> {
        let mut bare = start.to_vec();
        known.iter().for_each(|index| bare[*index] = candidates[*index].off);
        let nominal = linearise(cut, candidates, &bare, &[])?;
        let mut active = known.to_vec();
        let mut last = nominal.clone();
        if !known.is_empty() {
            let mut point = start.to_vec();
            cut.reset();
            settle(cut, candidates, &mut active, &mut point)?;
            last = linearise(cut, candidates, &point, &active)?;
        }
        Ok(Self {
            folds: Folds::new(&nominal.blocks),
            found: screen(&last, candidates, &active),
            cut,
            candidates,
            active,
            nominal,
            last,
            refused: Refused::default(),
            accepted: Vec::new(),
            swaps: Vec::new(),
            in_vain: Vec::new(),
            class: None,
            steps: Vec::new(),
        })
    }

    /// Rounds until nothing more is found, or so many are on.
    fn one_by_one(&mut self, most: usize, watch: &mut Watch<'_>, enough: Enough<'_>) -> Result<(), Error> {
        while self.active.len() < most && self.refused.vain <= SELECTION.vain {
            if watch.is_over(SEARCH) || enough(&self.active, watch)? || !self.round(watch)? {
                break;
            }
        }
        Ok(())
    }

    /// One step: whether it found anything.
    fn round(&mut self, watch: &mut Watch<'_>) -> Result<bool, Error> {
        let mut step = Step {
            best: self.found.hits.iter().take(8).cloned().collect(),
            p_value: self.found.p_value,
            accepted: None,
            together: Vec::new(),
            dropped: Vec::new(),
            deviance: (self.last.deviance(), self.last.deviance()),
            mean_square: (mean_square(&self.last), mean_square(&self.last)),
            held_out: (f64::NAN, f64::NAN),
        };
        watch.stage(self.cut.name());
        let Some(Accepted { candidate, trial, held_out }) = self.best_candidate(watch)? else {
            self.steps.push(step);
            return Ok(false);
        };
        step.held_out = held_out;
        step.deviance.1 = trial.deviance();
        watch.stage(&format!("{}: {}", self.cut.name(), self.candidates[candidate].name));
        step.accepted = Some(candidate);
        self.accept(candidate, trial.point, &mut step)?;
        self.found = screen(&self.last, self.candidates, &self.active);
        let stuck = step.dropped.contains(&candidate);
        self.steps.push(step);
        let again = self.accepted.contains(&candidate);
        self.accepted.push(candidate);
        if stuck {
            // refused from now on; what it hid may be the truth
            self.refused.vain += 1;
        } else {
            // accepted and swapped away in turns, two would go on for ever
            self.refused.vain += usize::from(again);
            self.ask_second_opinion(candidate, watch)?;
        }
        Ok(true)
    }

    /// The likeliest of what isn't on yet, if it is worth a name.
    fn best_candidate(&mut self, watch: &mut Watch<'_>) -> Result<Option<Accepted>, Error> {
        let Self { cut, candidates, folds, active, last, found, refused, in_vain, .. } = self;
        let cut: &mut Tracked = cut;
        let threshold = found.null.threshold(SELECTION.alpha);
        let shortlist =
            shortlist(found, candidates, &refused.candidates, threshold, cut.policy().discrepancy_dominated);
        let switched = best_switch(cut, candidates, last, active, &refused.candidates, in_vain)?;
        let set = Trials { candidates, folds, last, found, active };
        match set.best_that_holds(cut, &shortlist, switched, refused, watch)? {
            None => set.best_of_sparse(cut, &refused.candidates),
            best => Ok(best),
        }
    }

    /// Switches it on, from `point`, settles all, and drops what became superfluous.
    fn accept(&mut self, candidate: usize, mut point: Vec<f64>, step: &mut Step) -> Result<(), Error> {
        self.class = None;
        self.active.push(candidate);
        // windows that needed slack torques may follow the log by themselves now
        self.cut.reset();
        step.dropped = settle(self.cut, self.candidates, &mut self.active, &mut point)?;
        self.last = linearise(self.cut, self.candidates, &point, &self.active)?;
        step.dropped.extend(self.settle_again()?);
        step.mean_square.1 = mean_square(&self.last);
        self.refused.candidates.extend(&step.dropped);
        Ok(())
    }

    /// A second opinion on all that was on when the search began: another cut found them, and at its noise a delay and a lag look alike.
    fn doubt_known(&mut self, watch: &mut Watch<'_>) -> Result<(), Error> {
        for candidate in self.active.clone() {
            if self.active.contains(&candidate) {
                self.class = None;
                self.ask_second_opinion(candidate, watch)?;
            }
        }
        Ok(())
    }

    /// A second opinion on what was accepted last.
    fn ask_second_opinion(&mut self, candidate: usize, watch: &mut Watch<'_>) -> Result<(), Error> {
        let Self { cut, candidates, last, active, steps, .. } = self;
        let before: Vec<usize> =
            self.swaps.iter().filter(|(out, _)| *out == candidate).map(|(_, into)| *into).collect();
        let asked = Questioned { candidates, last, active, effect: candidate, steps };
        let (active, other) = match second_opinion(cut, &asked, &before, watch)? {
            Opinion::Stays(others) => {
                self.class = Some((candidate, others));
                return Ok(());
            }
            Opinion::Swapped { active, point } => (active, point),
        };
        self.active = active;
        let swapped = self.active.last().copied();
        self.swaps.extend(swapped.map(|into| (candidate, into)));
        self.last = linearise(self.cut, self.candidates, &other, &self.active)?;
        let dropped = self.settle_again()?;
        self.found = screen(&self.last, self.candidates, &self.active);
        self.refused.candidates.extend(&dropped);
        // what was swapped for it could be accepted again and again
        self.refused.vain += usize::from(!dropped.is_empty());
        if let Some(step) = self.steps.last_mut() {
            step.accepted = swapped;
            step.dropped.extend(dropped);
            step.mean_square.1 = mean_square(&self.last);
        }
        Ok(())
    }

    /// Fits again and linearises again where a linearisation has put frames elsewhere, so that values aren't at their best any more. Answers who
    /// was dropped.
    fn settle_again(&mut self) -> Result<Vec<usize>, Error> {
        let mut dropped = Vec::new();
        for _ in 0..SELECTION.again {
            let free = continuous(self.candidates, &self.active);
            let settled =
                self.last.predicted_decrease(&free).is_none_or(|predicted| predicted < SELECTION.unsettled);
            if settled || !self.cut.policy().free_pose {
                break;
            }
            let mut point = self.last.point.clone();
            dropped.extend(settle(self.cut, self.candidates, &mut self.active, &mut point)?);
            self.last = linearise(self.cut, self.candidates, &point, &self.active)?;
        }
        Ok(dropped)
    }

    /// What was found.
    fn end(self) -> Study {
        let cut = self.cut;
        Study {
            name: cut.name(),
            explained: cut.policy().explained,
            tick_drift: cut.policy().tick_drift,
            discrepancy_dominated: cut.policy().discrepancy_dominated,
            seen: candidates_seen(cut, self.candidates),
            noise: noise_floor::estimate(&self.nominal, &self.last, cut.signals()),
            active: self.active,
            nominal: self.nominal,
            last: self.last,
            class: self.class,
            screen: self.found,
            steps: self.steps,
            folds: self.folds,
        }
    }
}

/// Indices of the candidates that a cut sees.
fn candidates_seen(cut: &Tracked, candidates: &[Candidate]) -> Vec<usize> {
    (0..candidates.len()).filter(|index| cut.sees(&candidates[*index])).collect()
}

/// A linearisation at a point, with the columns of all candidates.
///
/// # Errors
/// A unit failed.
pub fn linearise(
    cut: &mut Tracked,
    candidates: &[Candidate],
    point: &[f64],
    active: &[usize],
) -> Result<Evaluation, Error> {
    let perturbations = all_perturbations(candidates, point, &|candidate| cut.sees(candidate), active);
    if cut.policy().free_pose {
        // the linearisation itself puts frames elsewhere, for which it needs no columns of the plant: they are taken there again
        let pictured: Vec<_> = perturbations.iter().copied().filter(|p| is_pictured(candidates, p)).collect();
        cut.linearise_anew(point, if pictured.is_empty() { &perturbations } else { &pictured })?;
    }
    Evaluation::at(cut, point, &perturbations)
}

/// Whether a perturbation moves the camera.
fn is_pictured(candidates: &[Candidate], perturbation: &Perturbation) -> bool {
    candidates[perturbation.candidate].side == Side::Camera
}

/// Mean square of the whitened residual.
fn mean_square(evaluation: &Evaluation) -> f64 {
    evaluation.total.square / evaluation.total.freedom.max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::residual::Policy;
    use crate::rigs::acrobot::selection::examples::{candidate, toy, toy_like};
    use crate::watch::Doing;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn every_column_of_a_plant_is_taken_once_where_a_linearisation_moves_frames() {
        let taken = |sides: [Side; 2]| {
            let moved: Arc<[AtomicUsize; 2]> = Arc::default();
            let heard = moved.clone();
            let policy = Policy { lattice: true, free_pose: true, ..Policy::USUAL };
            let mut cut = toy_like(policy, move |x| {
                let here = heard.iter().zip(x).filter(|(_, x)| **x != 0.0);
                here.for_each(|(count, _)| _ = count.fetch_add(1, Ordering::Relaxed));
                vec![1.0 - x[0] - x[1]]
            });
            let candidates = sides.map(|side| candidate(side, false));
            linearise(&mut cut, &candidates, &[0.0; 2], &[]).expect("runs");
            [0, 1].map(|place| moved[place].load(Ordering::Relaxed))
        };
        assert_eq!(taken([Side::Plant, Side::Camera]), [1, 2]);
        // frames go elsewhere with any column: without a camera's, with the plant's
        assert_eq!(taken([Side::Plant, Side::Plant]), [2, 2]);
    }

    #[test]
    fn law_what_another_cut_found_gives_way_to_a_better_one() {
        let candidates = [candidate(Side::Plant, false), candidate(Side::Plant, false)];
        // 30 of the second, of which the first takes all but 35 of deviance: no screen of one block says so
        let mut cut = toy(|x| vec![30.0 - x[0] - x[1], -0.2 * x[0]]);
        let mut nobody = |_: &Doing<'_>| {};
        let watch = &mut Watch::new(&mut nobody, None);
        let found = study(&mut cut, &candidates, &[30.0, 0.0], &[0], watch).expect("runs");
        assert_eq!(found.active, [1]);
        assert!(
            (found.last.point[1] - 30.0).abs() < 1e-6 && found.last.point[0] == 0.0,
            "{:?}",
            found.last.point
        );
    }
}
