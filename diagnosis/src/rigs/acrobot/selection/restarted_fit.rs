//! Fits of a plant that lost their windows on the way, and where they should have gone. Where a model is far off, a window's columns and
//! start state hold for no other model; linearisations that begin from the data again do.

use super::evaluation::Evaluation;
use super::evidence::discrepancy;
use super::refit::refit;
use super::trials::{Trials, active_with};
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::Tracked;

impl Trials<'_> {
    /// A fit that fled, leaving more than without the candidate, begun anew from where it began or from where it ended.
    pub(super) fn refit_lost_windows(
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
        let again = self.refit_from_data(cut, candidate, from, last);
        again.or_else(|| self.refit_from_data(cut, candidate, &trial.point, last)).unwrap_or(trial)
    }

    /// A fit of what is nonlinear in its size that leaves a torque lacking, begun anew where it ended.
    pub(super) fn refit_from_end(
        &self,
        cut: &mut Tracked,
        candidate: usize,
        trial: Evaluation,
    ) -> Evaluation {
        if cut.policy().lattice
            || cut.policy().steady
            || !self.candidates[candidate].nonlinear
            || discrepancy(&trial) < POLICY.evidence
        {
            return trial;
        }
        let enough = trial.deviance() - POLICY.evidence;
        self.refit_from_data(cut, candidate, &trial.point, enough).unwrap_or(trial)
    }

    /// A fit that begins from the data, if a linearisation there leaves less than `enough`. Windows that slack torques held to the log under a model without
    /// the candidate may not find back by the columns that they had there, and a fit then flees from where the candidate belongs.
    fn refit_from_data(
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
        let fit =
            better.then(|| refit(cut, self.candidates, point, &active_with(self.active, candidate)).ok());
        cut.restore(&kept);
        fit.flatten().filter(|fit| fit.deviance() < enough)
    }
}
