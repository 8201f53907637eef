//! Trials of the search: which candidates are fitted, from which coordinates, and which of them is accepted.

use super::classes::HOPELESS;
use super::evaluation::Evaluation;
use super::evidence::lacking;
use super::folds::Folds;
use super::refit::refit_closely;
use super::screen::{Hit, Screen, screen};
use super::search::SEARCH;
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Candidate, Motion, Side};
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::statistics::linear::submatrix;
use crate::watch::Watch;

/// A trial: candidate, decrease of the deviance, and where it was fitted.
pub(super) type Trial = (usize, f64, Evaluation);

/// The one that was accepted.
pub(super) struct Accepted {
    pub(super) candidate: usize,
    pub(super) trial: Evaluation,
    pub(super) held_out: (f64, f64),
}

/// What trials are judged by.
pub(super) struct Trials<'a> {
    pub(super) candidates: &'a [Candidate],
    pub(super) folds: &'a Folds,
    pub(super) last: &'a Evaluation,
    pub(super) found: &'a Screen,
    pub(super) active: &'a [usize],
}

impl Trials<'_> {
    /// Fits the shortlist and takes the best that also explains the runs left out.
    pub(super) fn best_that_holds(
        &self,
        cut: &mut Tracked,
        shortlist: &[Hit],
        switched: Option<Trial>,
        refused: &mut Vec<usize>,
        watch: &mut Watch<'_>,
    ) -> Result<Option<Accepted>, Error> {
        // a switch is judged by fits: columns say nothing of terms that are left out of the equations of motion
        let small = switched.is_none();
        let large = SELECTION.large * self.last.total.square;
        let linear = cut.policy().lattice && small && shortlist.iter().all(|hit| hit.gain < large);
        let of_log = |hit: &Hit| self.candidates[hit.candidate].side.is_of_log();
        if linear && !cut.policy().free_pose && !shortlist.iter().any(of_log) {
            return Ok(self.first_that_holds(cut, shortlist, refused, watch));
        }
        let mut trials: Vec<Trial> = Vec::new();
        if let Some((candidate, decrease, trial)) = switched {
            let left = trial.deviance();
            let trial = self.refit_from_end(cut, candidate, trial);
            trials.push((candidate, decrease + left - trial.deviance(), trial));
        }
        for (place, hit) in shortlist.iter().enumerate() {
            if watch.is_over(SEARCH) {
                break;
            }
            watch.trying(self.candidates[hit.candidate].name, place + 1, shortlist.len());
            let enough = self.least_deviance(cut, hit, &trials);
            self.fit_from_starts(cut, hit, enough, &mut trials);
        }
        if linear {
            trials.iter_mut().for_each(|trial| trial.1 = self.gain(trial.0));
        }
        let most = trials.iter().map(|trial| trial.1).fold(0.0, f64::max);
        self.handicap(&mut trials, cut.policy().clock_doubt, most);
        trials.sort_by(|a, b| b.1.total_cmp(&a.1));
        for (candidate, _, trial) in trials {
            let held_out = self.held_out(&trial, candidate, linear && self.is_straight(candidate));
            if held_out.1 < held_out.0 {
                return Ok(Some(Accepted { candidate, trial, held_out }));
            }
            refused.push(candidate);
        }
        Ok(None)
    }

    /// The first of a shortlist by columns, best first, that explains the runs left out: those behind it need no fit.
    fn first_that_holds(
        &self,
        cut: &mut Tracked,
        shortlist: &[Hit],
        refused: &mut Vec<usize>,
        watch: &mut Watch<'_>,
    ) -> Option<Accepted> {
        let mut trials: Vec<Trial> = Vec::new();
        for (place, hit) in shortlist.iter().enumerate() {
            if watch.is_over(SEARCH) {
                break;
            }
            let candidate = hit.candidate;
            watch.trying(self.candidates[candidate].name, place + 1, shortlist.len());
            let own = trials.len();
            let straight = self.is_straight(candidate) && !hit.shows_seldom(self.candidates);
            self.fit_from_starts(cut, hit, f64::INFINITY, &mut trials);
            for place in own..trials.len() {
                let held_out = self.held_out(&trials[place].2, candidate, straight);
                if held_out.1 < held_out.0 {
                    return Some(Accepted { candidate, trial: trials.swap_remove(place).2, held_out });
                }
                refused.push(candidate);
            }
        }
        None
    }

    /// A column says what a fit would: a part of a whole step is none, however well columns would have it, and no column is a saturation's
    /// beyond its own level.
    fn is_straight(&self, candidate: usize) -> bool {
        let own = &self.candidates[candidate];
        !own.is_discrete() && !matches!(own.motion, Motion::Saturation { .. })
    }

    /// The deviance that a fit to an image must come down to, if only the best counts: near that of the best so far. Faults of the log are
    /// weighed otherwise, and where images follow a plant a fit leaves frames elsewhere for the next one.
    fn least_deviance(&self, cut: &Tracked, hit: &Hit, trials: &[Trial]) -> f64 {
        let mut all = trials.iter().map(|trial| trial.0).chain([hit.candidate]);
        let of_log = all.any(|candidate| self.candidates[candidate].side.is_of_log());
        if !cut.policy().lattice || cut.policy().free_pose || of_log {
            return f64::INFINITY;
        }
        HOPELESS + trials.iter().map(|trial| trial.2.deviance()).fold(f64::INFINITY, f64::min)
    }

    /// What shows in a few windows only, a saturation or a short delay, has a small statistic over all blocks. Where more than noise
    /// remains of a plant and nothing else is named, the likeliest is taken with which the residual is noise, if runs left out agree.
    pub(super) fn best_of_sparse(
        &self,
        cut: &mut Tracked,
        refused: &[usize],
    ) -> Result<Option<Accepted>, Error> {
        let (explained, pictured) = (cut.policy().explained, cut.policy().lattice);
        let driven = !pictured || cut.policy().free_pose;
        if cut.policy().discrepancy_dominated
            || !driven
            || !lacking(self.last, self.folds, explained, pictured)
        {
            return Ok(None);
        }
        let kept = cut.nuisances.clone();
        let plants = |hit: &&Hit| !pictured || self.candidates[hit.candidate].side == Side::Plant;
        let mut trials: Vec<Trial> = Vec::new();
        let hits = self.hits_without_discrepancy();
        let open = hits.iter().filter(|hit| !refused.contains(&hit.candidate) && hit.gain > SELECTION.sparse);
        for hit in open.filter(plants).take(SELECTION.sparse_trials) {
            self.fit_from_starts(cut, hit, f64::INFINITY, &mut trials);
        }
        trials.retain(|(_, decrease, _)| *decrease > SELECTION.sparse);
        trials.sort_by(|a, b| b.1.total_cmp(&a.1));
        for (candidate, _, trial) in trials {
            cut.reset();
            let settled = Evaluation::at(cut, &trial.point, &[])?;
            let held_out = self.held_out(&trial, candidate, false);
            if held_out.1 < held_out.0 && !lacking(&settled, self.folds, explained, pictured) {
                return Ok(Some(Accepted { candidate, trial, held_out }));
            }
        }
        cut.restore(&kept);
        Ok(None)
    }

    /// What each could take away at most, best first: beside the discrepancy that is reckoned with, or in its place. What pushes all
    /// along, a bias, passes for discrepancy and then for nothing.
    fn hits_without_discrepancy(&self) -> Vec<Hit> {
        let hard = self.last.hard();
        let more = self.last.deviance() - hard.deviance();
        let mut hits = self.found.hits.clone();
        for pure in screen(&hard, self.candidates, self.active).hits {
            match hits.iter_mut().find(|hit| hit.candidate == pure.candidate) {
                Some(hit) if hit.gain >= pure.gain + more => {}
                Some(hit) => *hit = Hit { gain: pure.gain + more, ..pure },
                None => hits.push(Hit { gain: pure.gain + more, ..pure }),
            }
        }
        hits.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        hits
    }

    /// Fits a hit from wherever that may begin, and no further where the deviance won't come down to `enough`.
    fn fit_from_starts(&self, cut: &mut Tracked, hit: &Hit, enough: f64, into: &mut Vec<Trial>) {
        let mut beginnings = starts(self.candidates, self.last, hit);
        let mut place = 0;
        while let Some(x) = beginnings.get(place).copied() {
            place += 1;
            let mut point = self.last.point.clone();
            point[hit.candidate] = x;
            // a value that the unit refuses is no trial
            let active = active_with(self.active, hit.candidate);
            let Ok(trial) = refit_closely(cut, self.candidates, &point, &active, enough) else { continue };
            let best = into.iter().map(|trial| trial.2.deviance()).fold(self.last.deviance(), f64::min);
            let trial = self.refit_lost_windows(cut, hit.candidate, &point, trial);
            let trial =
                if trial.deviance() < best { self.refit_from_end(cut, hit.candidate, trial) } else { trial };
            // the largest whole number that was tried needn't be the largest that fits
            if trial.deviance() < best && place == beginnings.len() {
                beginnings.extend(self.candidates[hit.candidate].count_after(x));
            }
            // a composite likelihood's gain counts as much as its blocks agree
            let temper = if cut.policy().discrepancy_dominated {
                hit.statistic * hit.statistic / hit.gain
            } else {
                1.0
            };
            into.push((hit.candidate, (self.last.deviance() - trial.deviance()) * temper, trial));
        }
    }

    /// Puts a fault of the log behind an effect that it resembles, or before it where a clock may be off by as much.
    fn handicap(&self, trials: &mut [Trial], doubt: f64, most: f64) {
        let of_log = |index: usize| self.candidates[index].side.is_of_log();
        let effects: Vec<usize> =
            trials.iter().map(|trial| trial.0).filter(|index| !of_log(*index)).collect();
        for (fault, decrease, trial) in trials.iter_mut().filter(|trial| of_log(trial.0)) {
            let late = stamped_late(&self.candidates[*fault], trial.point[*fault], doubt);
            // clocks that have nothing to do with each other were set by the motion, and what that leaves is theirs
            let known_to_be_off = doubt.is_infinite() || self.candidates[*fault].side == Side::Timestamps;
            let by = match known_to_be_off {
                true => -POLICY.clock_behind.max(SELECTION.doubted * most),
                false if late => -POLICY.clock_behind,
                false => POLICY.clock_behind,
            };
            if effects.iter().any(|effect| self.cosine(*fault, *effect) > SELECTION.trials_alike) {
                *decrease -= by;
            }
        }
    }

    /// Cosine of the angle between the columns of two candidates.
    fn cosine(&self, one: usize, other: usize) -> f64 {
        let places = self.last.places(&[one, other]);
        let gram = submatrix(&self.last.total.gram, &places);
        if places.len() < 2 { 0.0 } else { gram[(0, 1)].abs() / (gram[(0, 0)] * gram[(1, 1)]).sqrt() }
    }

    /// Decrease of the squares that the screen predicts of a candidate.
    fn gain(&self, index: usize) -> f64 {
        self.found.hits.iter().find(|hit| hit.candidate == index).map_or(0.0, |hit| hit.gain)
    }

    /// Held-out squares without and with a candidate.
    fn held_out(&self, trial: &Evaluation, candidate: usize, linear: bool) -> (f64, f64) {
        let more = active_with(self.active, candidate);
        if linear {
            return (self.last.held_out(self.folds, self.active), self.last.held_out(self.folds, &more));
        }
        let before = self.last.under(trial);
        (before.held_out(self.folds, self.active), trial.held_out(self.folds, &more))
    }
}

/// Whether a clock is off by no more than timestamps that scatter let it be; without a scatter there is no such doubt, and of a clock that
/// is known to be off it isn't the question.
pub(super) fn stamped_late(candidate: &Candidate, x: f64, doubt: f64) -> bool {
    candidate.side == Side::Clock && doubt > 0.0 && doubt.is_finite() && x.abs() <= doubt
}

/// Candidates that are worth a fit. One statistic above the threshold says that something is there; what it is, the likelihood
/// says: an effect that shows in a few blocks only (a delay, in transients) has a small statistic over blocks however
/// large it is, so below the threshold it still competes by its gain.
pub(super) fn shortlist(
    found: &Screen,
    candidates: &[Candidate],
    refused: &[usize],
    threshold: f64,
    discrepancy_dominated: bool,
) -> Vec<Hit> {
    let mut hits: Vec<Hit> =
        found.hits.iter().filter(|hit| !refused.contains(&hit.candidate)).cloned().collect();
    if discrepancy_dominated || !hits.iter().any(|hit| hit.statistic > threshold) {
        let seldom = |hit: &Hit| !discrepancy_dominated && hit.shows_seldom(candidates);
        hits.retain(|hit| hit.statistic > threshold || seldom(hit));
    }
    let worth = |hit: &Hit| if discrepancy_dominated { hit.statistic * hit.statistic } else { hit.gain };
    hits.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    let best = hits.first().map_or(0.0, worth);
    let least = |hit: &Hit| {
        if candidates[hit.candidate].nonlinear && !discrepancy_dominated {
            SELECTION.bent_worth
        } else {
            SELECTION.worth
        }
    };
    hits.retain(|hit| worth(hit) >= least(hit) * best);
    hits.truncate(SELECTION.search_most);
    hits
}

/// The active candidates and one more.
pub(super) fn active_with(active: &[usize], candidate: usize) -> Vec<usize> {
    let mut all = active.to_vec();
    all.push(candidate);
    all
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
        // a fit to beyond the largest value that is tried begins there
        let nearest = all.iter().copied().min_by(|a, b| (a - wanted).abs().total_cmp(&(b - wanted).abs()));
        return if some.is_empty() { nearest.into_iter().collect() } else { some };
    }
    let by = last.perturbations[hit.column].by;
    let wanted = match candidate.motion {
        Motion::Saturation { .. } => x + by,
        _ => x + hit.displacement,
    };
    let mut all = vec![wanted.clamp(candidate.range.0, candidate.range.1)];
    if candidate.nonlinear {
        all.push((x + SELECTION.further * (wanted - x)).clamp(candidate.range.0, candidate.range.1));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::selection::examples::{candidate, evaluation, found, hit};

    #[test]
    fn a_clock_is_doubted_only_where_stamps_scatter() {
        let clock = Candidate {
            name: "a clock",
            side: Side::Clock,
            phrase: "",
            motion: Motion::Switch,
            off: 0.0,
            steps: Vec::new(),
            range: (-1.0, 1.0),
            nonlinear: false,
            attributes: &[],
        };
        assert!(stamped_late(&clock, 1e-3, 2e-3) && stamped_late(&clock, -3e-5, 2e-3));
        // early, late, and beyond the scatter; a clock known to be off is no question of scatter
        for (x, doubt) in [(-3e-5, 0.0), (3e-5, 0.0), (3e-3, 2e-3), (1e-3, f64::INFINITY)] {
            assert!(!stamped_late(&clock, x, doubt), "{x} {doubt}");
        }
        let actuator = Candidate { side: Side::Plant, ..clock };
        assert!(!stamped_late(&actuator, 1e-3, 2e-3));
    }

    #[test]
    fn value_who_foretells_half_of_the_best_is_worth_a_fit_and_a_tenth_where_columns_bend() {
        let listed = |gains: &[f64], nonlinear: bool, dominated: bool| {
            let candidates: Vec<Candidate> =
                gains.iter().map(|_| candidate(Side::Plant, nonlinear)).collect();
            let found = found(gains.iter().enumerate().map(|(at, gain)| hit(at, *gain)).collect());
            shortlist(&found, &candidates, &[], 1.0, dominated).len()
        };
        assert_eq!([45.0, 55.0].map(|gain| listed(&[100.0, gain], false, false)), [1, 2]);
        assert_eq!([9.0, 11.0].map(|gain| listed(&[100.0, gain], true, false)), [1, 2]);
        // where the gain is no measure, neither is a bend
        assert_eq!([45.0, 55.0].map(|gain| listed(&[100.0, gain], true, true)), [1, 2]);
        // six at most
        assert_eq!([5, 6, 7].map(|all| listed(&vec![100.0; all], false, false)), [5, 6, 6]);
    }

    #[test]
    fn value_a_bent_fit_begins_three_times_as_far_as_well() {
        let from = |nonlinear: bool| {
            starts(&[candidate(Side::Plant, nonlinear)], &evaluation(&[2.0], &[0.0], &[1.0]), &hit(0, 1.0))
        };
        assert_eq!((from(false), from(true)), (vec![3.0], vec![3.0, 5.0]));
    }

    #[test]
    fn value_a_clock_gives_way_to_an_effect_that_it_looks_like() {
        let candidates = [candidate(Side::Clock, false), candidate(Side::Plant, false)];
        let handicapped = |cosine: f64, doubt: f64, most: f64| {
            let last = evaluation(&[0.5, 0.0], &[0.0; 2], &[1.0, cosine, cosine, 1.0]);
            let found = found(Vec::new());
            let folds = Folds { of: Vec::new(), count: 0, runs: Vec::new() };
            let trials =
                Trials { candidates: &candidates, folds: &folds, last: &last, found: &found, active: &[] };
            let mut all = vec![(0, 100.0, last.clone()), (1, 100.0, last.clone())];
            trials.handicap(&mut all, doubt, most);
            assert_eq!(all[1].1, 100.0);
            all[0].1
        };
        // 3², where the cosine between them is beyond 0.7
        assert_eq!([0.65, 0.75].map(|cosine| handicapped(cosine, 0.0, 1e3)), [100.0, 91.0]);
        // known to be off, it may explain 0.3 of the best less, and 9 of the smallest
        assert_eq!([10.0, 1e3].map(|most| handicapped(0.75, f64::INFINITY, most)), [109.0, 400.0]);
    }
}
