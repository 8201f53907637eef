//! Windows twice as long, for two models that both follow the log: what tells them apart grows with the plant.

use super::*;
use crate::rigs::acrobot::candidates::Motion as Way;

/// Windows begin together if they do so within this time, s.
const SAME: f64 = 1e-6;

impl PlantCut {
    /// The same log in windows twice as long. They begin where every second usual one does, and in its state, `at` where a linearisation at the point left it: where these windows
    /// have been fitted to all that follows, noise grows by no more than in the second half. `None` where a window needs slack torques,
    /// since a model that lacks more than noise leaves the data before a long window ends.
    ///
    /// # Errors
    /// The unit failed, or lacks a variable.
    pub fn longer(
        &mut self,
        data: &DataSet,
        model: &Model,
        point: &[f64],
        at: &Nuisances,
    ) -> Result<Option<Tracked<Self>>, Error> {
        self.begin_from(at);
        let Some(mut long) = Self::of(data, model, self.candidates.clone(), Span::LONG)? else {
            return Ok(None);
        };
        long.jitter = self.jitter;
        if self.clock.is_none() {
            long.trust_clock();
        }
        long.correct_log(point);
        for window in &mut long.windows {
            let same = |usual: &&Window| {
                usual.run == window.run && (usual.drive.start() - window.drive.start()).abs() < SAME
            };
            if let Some(usual) = self.windows.iter().find(same) {
                window.start = usual.start;
            }
        }
        let begun = long.nuisances(false);
        let mut long = Tracked::new(long);
        long.restore(&begun);
        long.linearise(point, &[])?;
        Ok((long.share_with_slack() == 0.0).then_some(long))
    }

    /// A probe so small that no column bends. Saturations and switches have columns of their whole size only.
    pub(super) fn gentle(&self, probe: Probe) -> Probe {
        let whole = matches!(self.candidates[probe.candidate].motion, Way::Saturation { .. } | Way::Switch);
        Probe { by: if whole { probe.by } else { self.span.gentle() * probe.by }, ..probe }
    }
}

impl Tracked<PlantCut> {
    /// As [`PlantCut::longer`], from where the nuisances are.
    ///
    /// # Errors
    /// The unit failed, or lacks a variable.
    pub fn longer(
        &mut self,
        data: &DataSet,
        model: &Model,
        point: &[f64],
    ) -> Result<Option<Tracked<PlantCut>>, Error> {
        let at = self.nuisances.clone();
        PlantCut::longer(self, data, model, point, &at)
    }

    /// As [`PlantCut::motion`], where the nuisances are.
    ///
    /// # Errors
    /// The unit failed.
    pub fn motion(&mut self, point: &[f64], every: f64) -> Result<Vec<Motion>, Error> {
        let at = self.nuisances.clone();
        PlantCut::motion(self, point, every, &at)
    }
}
