//! Fits of a plant that lost their windows on the way, and where they should have gone. Where a model is far off, a window's columns and
//! start state hold for no other model; linearisations that begin from the data again do.

use super::evaluation::Evaluation;
use super::evidence::discrepancy;
use super::refit::refit;
use super::trials::{Trials, with};
use crate::rigs::acrobot::candidates::Motion;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::selection::policy::SELECTION;

/// A saturation is followed by steps of these shares, so many of each at most, for as long as one of them leaves so much of what lacked.
const PACES: [f64; 4] = [1.03, 1.01, 1.003, 1.001];

impl Trials<'_> {
    /// A fit that fled, leaving more than without the candidate, begun anew from where it began or from where it ended.
    pub(super) fn found_back(
        &self,
        cut: &mut Tracked,
        candidate: usize,
        from: &[f64],
        trial: Evaluation,
    ) -> Evaluation {
        let last = self.last.deviance();
        if cut.policy().lattice || cut.policy().steady || trial.deviance() <= last {
            return trial;
        }
        let again = self.begun_anew(cut, candidate, from, last);
        again.or_else(|| self.begun_anew(cut, candidate, &trial.point, last)).unwrap_or(trial)
    }

    /// A fit of what is nonlinear in its size that leaves a torque lacking, begun anew where it ended, and a saturation where linearisations lead it, for as long as each
    /// pace of that takes half of what lacks away.
    pub(super) fn followed(&self, cut: &mut Tracked, candidate: usize, trial: Evaluation) -> Evaluation {
        if cut.policy().lattice
            || cut.policy().steady
            || !self.candidates[candidate].nonlinear
            || discrepancy(&trial) < POLICY.evidence
        {
            return trial;
        }
        let enough = trial.deviance() - POLICY.evidence;
        let mut best = self.begun_anew(cut, candidate, &trial.point, enough).unwrap_or(trial);
        if !matches!(self.candidates[candidate].motion, Motion::Saturation { .. }) {
            return best;
        }
        for pace in PACES {
            let lacks = discrepancy(&best);
            if lacks < POLICY.evidence {
                break;
            }
            let Some(there) = self.walked(cut, candidate, &best.point, pace) else { continue };
            let enough = best.deviance() - POLICY.evidence;
            let Some(again) = self.begun_anew(cut, candidate, &there, enough) else { break };
            best = again;
            if discrepancy(&best) > SELECTION.left * lacks {
                break;
            }
        }
        best
    }

    /// Where linearisations that begin from the data lead a saturation. Far from where it belongs it leaves a window or two that nothing follows, and
    /// their columns lead nowhere.
    fn walked(&self, cut: &mut Tracked, candidate: usize, from: &[f64], pace: f64) -> Option<Vec<f64>> {
        cut.restore_linearised();
        let kept = cut.nuisances.clone();
        let mut look = |factor: f64| {
            let mut there = from.to_vec();
            there[candidate] *= factor;
            cut.reset();
            let seen = Evaluation::at(cut, &there, &[]);
            (seen.map_or(f64::INFINITY, |seen| seen.deviance()), there)
        };
        let here = look(1.0);
        let mut best = here.clone();
        for pace in [pace, 1.0 / pace] {
            for step in 1..=SELECTION.furthest {
                let there = look(pace.powi(step));
                if there.0 >= best.0 {
                    break;
                }
                best = there;
            }
        }
        cut.restore(&kept);
        (best.0 < here.0).then_some(best.1)
    }

    /// A fit that begins from the data, if a linearisation there leaves less than `enough`. Windows that slack torques held to the log under a model without
    /// the candidate may not find back by the columns that they had there, and a fit then flees from where the candidate belongs.
    fn begun_anew(
        &self,
        cut: &mut Tracked,
        candidate: usize,
        point: &[f64],
        enough: f64,
    ) -> Option<Evaluation> {
        // what the fit that fled did to nuisances is not worth remembering
        cut.restore_linearised();
        let kept = cut.nuisances.clone();
        cut.reset();
        let there = Evaluation::at(cut, point, &[]).ok();
        let better = there.is_some_and(|there| there.deviance() < enough);
        let fit = better.then(|| refit(cut, self.candidates, point, &with(self.active, candidate)).ok());
        cut.restore(&kept);
        fit.flatten().filter(|fit| fit.deviance() < enough)
    }
}
