//! Which candidates of a screen are worth a fit, and which are out of the question.

use super::screen::{Hit, Screen};
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::selection::policy::SELECTION;

/// Who is out of the question from now on.
#[derive(Default)]
pub(super) struct Refused {
    /// Candidates that turned out to be superfluous, or to explain no runs that were left out.
    pub(super) candidates: Vec<usize>,
    /// How many were accepted and dropped, or would have been, or were accepted again.
    pub(super) vain: usize,
}

impl Refused {
    /// One more; `in_vain` where settling would drop it again: what it hid may be the truth. Trials from several starts count once.
    pub(super) fn add(&mut self, candidate: usize, in_vain: bool) {
        self.vain += usize::from(in_vain && !self.candidates.contains(&candidate));
        self.candidates.push(candidate);
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::candidates::Side;
    use crate::rigs::acrobot::selection::examples::{candidate, found, hit};

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
    fn value_a_candidate_that_was_tried_from_two_starts_is_refused_in_vain_once() {
        let mut refused = Refused::default();
        let tried = [(4, true), (4, true), (5, false), (6, true)];
        tried.into_iter().for_each(|(index, in_vain)| refused.add(index, in_vain));
        assert_eq!(
            (refused.vain, [4, 5, 6].map(|index| refused.candidates.contains(&index))),
            (2, [true; 3])
        );
    }
}
