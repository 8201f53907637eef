//! Trials of the search: which candidates are fitted, from which coordinates, and which of them is accepted.

use super::classes::HOPELESS;
use super::evaluation::Evaluation;
use super::evidence::lacking;
use super::folds::Folds;
use super::refit::refit_closely;
use super::screen::{Hit, Screen, screen};
use super::search::SEARCH;
use super::settle::is_kept;
use super::shortlist::Refused;
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
        refused: &mut Refused,
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
            let holds = held_out.1 < held_out.0; // not for NaN
            if holds && self.is_kept(cut, candidate, &trial) {
                return Ok(Some(Accepted { candidate, trial, held_out }));
            }
            refused.add(candidate, holds);
        }
        Ok(None)
    }

    /// The first of a shortlist by columns, best first, that explains the runs left out: those behind it need no fit.
    fn first_that_holds(
        &self,
        cut: &mut Tracked,
        shortlist: &[Hit],
        refused: &mut Refused,
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
                refused.add(candidate, false);
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

    /// Whether settling keeps a candidate, where the way there is long: a plant's windows begin anew.
    fn is_kept(&self, cut: &Tracked, candidate: usize, trial: &Evaluation) -> bool {
        let (policy, active) = (cut.policy(), active_with(self.active, candidate));
        policy.lattice
            || policy.discrepancy_dominated
            || is_kept(trial, self.candidates, &active, candidate, cut.signals())
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
    use crate::rigs::acrobot::residual::Policy;
    use crate::rigs::acrobot::selection::examples::{candidate, evaluation, found, hit, toy_like};

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
    fn law_a_plants_effect_that_settling_would_drop_is_refused_before() {
        let kept = |deviations: f64, lattice: bool| {
            let candidates = [candidate(Side::Plant, false)];
            let policy = Policy { lattice, ..Policy::USUAL };
            let mut cut = toy_like(policy, move |x| vec![deviations - 10.0 * x[0]]);
            let last = evaluation(&[0.0], &[0.0], &[1.0]);
            let fit = refit_closely(&mut cut, &candidates, &[0.0], &[0], f64::INFINITY).expect("runs");
            let (folds, found) = (Folds { of: Vec::new(), count: 0, runs: Vec::new() }, found(Vec::new()));
            Trials { candidates: &candidates, folds: &folds, last: &last, found: &found, active: &[] }
                .is_kept(&cut, 0, &fit)
        };
        assert_eq!([2.7, 3.3].map(|deviations| kept(deviations, false)), [false, true]);
        // an image's search asks of effects together once one did not stay
        assert!(kept(2.7, true));
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
