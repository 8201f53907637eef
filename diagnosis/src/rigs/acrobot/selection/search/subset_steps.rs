//! Where the search goes on by more than one effect at once: what linear effects of an image say together, and one of them in the place
//! of two.

use super::{SEARCH, Search, linearise, mean_square};
use crate::rigs::acrobot::selection::Step;
use crate::rigs::acrobot::selection::policy::SELECTION;
use crate::rigs::acrobot::selection::screen::screen;
use crate::rigs::acrobot::selection::settle::settle;
use crate::rigs::acrobot::selection::subsets::{Proposal, Subsets, pays};
use crate::watch::Watch;

impl Search<'_> {
    /// What no step of one effect finds. Whether anything did. A repeated search begins where the first one had it all.
    pub(super) fn all_at_once(&mut self, watch: &mut Watch<'_>) -> bool {
        let found = self.search_subsets(watch);
        (watch.known().is_none() && self.one_for_two(watch)) || found
    }

    /// Tries in the place of all that were found what linear effects say together. Whether they stay.
    fn search_subsets(&mut self, watch: &mut Watch<'_>) -> bool {
        let mut found = false;
        // far from the truth columns bend, and more seems to be needed than is
        for _ in 0..SELECTION.again {
            let Some(proposal) = self.linear_subsets().and_then(|linear| linear.best()) else { break };
            let new = proposal.active.iter().filter(|index| !self.active.contains(index)).count();
            if !found && new < 2 {
                break;
            }
            watch.stage(&format!("{}: effects that show only together", self.cut.name()));
            if !self.fit_proposal(proposal) {
                break;
            }
            found = true;
        }
        found
    }

    /// Tries one in the place of two, as long as that pays. Whether it did. A tilt and a small offset of the principal point look so alike
    /// that a search one by one takes two other terms for the offset: columns err by a share of the tilt, which is more.
    fn one_for_two(&mut self, watch: &mut Watch<'_>) -> bool {
        let mut found = false;
        'again: for _ in 0..SELECTION.again {
            let proposals = self.linear_subsets().map_or_else(Vec::new, |linear| linear.one_for_two());
            for proposal in proposals.into_iter().take(SELECTION.sparse_trials) {
                if watch.is_over(SEARCH) {
                    break 'again;
                }
                watch.stage(&format!("{}: one effect in the place of two", self.cut.name()));
                if self.fit_proposal(proposal) {
                    found = true;
                    continue 'again;
                }
            }
            break;
        }
        found
    }

    /// What the linear effects of the image say together, where there are several, or one that didn't stay alone, and the image is all that is
    /// compared.
    fn linear_subsets(&self) -> Option<Subsets<'_>> {
        let policy = self.cut.policy();
        let several = self.active.len() > 1 || self.refused.vain > 0;
        if !policy.lattice || policy.free_pose || !several {
            return None;
        }
        Subsets::of(&self.last, self.candidates, &self.active, self.cut.signals())
    }

    /// Fits a proposal through the units and puts it in the place of all that were found, if it pays.
    fn fit_proposal(&mut self, Proposal { mut active, mut point }: Proposal) -> bool {
        let kept = self.cut.nuisances.clone();
        let fitted = settle(self.cut, self.candidates, &mut active, &mut point)
            .and_then(|dropped| Ok((dropped, linearise(self.cut, self.candidates, &point, &active)?)));
        // where a unit can't follow a proposal, what stood goes on standing
        let Ok((dropped, there)) = fitted else {
            self.cut.restore(&kept);
            return false;
        };
        let more = active.len() as f64 - self.active.len() as f64;
        let gained = self.last.under(&there).total.square - there.total.square;
        if !pays(gained, more, there.total.square) {
            self.cut.restore(&kept);
            return false;
        }
        self.steps.push(Step {
            best: Vec::new(),
            p_value: self.found.p_value,
            accepted: None,
            together: active.clone(),
            dropped,
            deviance: (self.last.deviance(), there.deviance()),
            mean_square: (mean_square(&self.last), mean_square(&there)),
            held_out: (f64::NAN, f64::NAN),
        });
        (self.active, self.last, self.class) = (active, there, None);
        self.found = screen(&self.last, self.candidates, &self.active);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::Search;
    use crate::rigs::acrobot::candidates::Side;
    use crate::rigs::acrobot::residual::Policy;
    use crate::rigs::acrobot::selection::examples::{candidate, toy_like};
    use crate::rigs::acrobot::selection::study;
    use crate::watch::{Doing, Watch};

    /// Of two effects that are on, and a third that does what both do but for a share of the second's.
    fn left(missing: f64) -> Vec<usize> {
        let candidates = [(); 3].map(|()| candidate(Side::Camera, false));
        let image = Policy { lattice: true, ..Policy::USUAL };
        let rows =
            move |x: &[f64]| vec![100.0 * (1.0 - x[0] - x[2]), 100.0 * (1.0 - x[1] - (1.0 - missing) * x[2])];
        let mut nobody = |_: &Doing<'_>| {};
        let watch = &mut Watch::new(&mut nobody, None);
        let found = study(&mut toy_like(image, rows), &candidates, &[1.0, 1.0, 0.0], &[0, 1], watch);
        found.expect("runs").active
    }

    #[test]
    fn law_one_takes_the_place_of_two_that_together_only_do_what_it_does() {
        assert_eq!(left(0.0), [2]);
        // a tenth of 100 standard deviations is more than two effects are worth
        assert_eq!(left(0.1), [0, 1]);
    }

    #[test]
    fn law_two_that_hide_each_other_are_asked_together_once_one_of_them_did_not_stay() {
        let candidates = [(); 2].map(|()| candidate(Side::Camera, false));
        let image = Policy { lattice: true, ..Policy::USUAL };
        // one of each, which do the opposite but for a tenth: alone either explains next to nothing
        let rows = |x: &[f64]| vec![100.0 * (x[1] - x[0]), 10.0 * (2.0 - x[0] - x[1])];
        let found = |vain: usize| {
            let mut cut = toy_like(image, rows);
            let mut search = Search::begin(&mut cut, &candidates, &[0.0; 2], &[]).expect("runs");
            search.refused.vain = vain;
            let mut nobody = |_: &Doing<'_>| {};
            search.all_at_once(&mut Watch::new(&mut nobody, None));
            (search.active.clone(), search.last.point.clone())
        };
        assert_eq!(found(0), (vec![], vec![0.0; 2]));
        let (active, point) = found(1);
        assert!(active == [0, 1] && point.iter().all(|x| (x - 1.0).abs() < 1e-6), "{active:?} {point:?}");
    }
}
