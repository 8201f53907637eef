//! Whether the plant follows the log by itself, or needs slack torques to do so.

use super::PlantCut;
use super::fitting::Fit;
use super::layout::Layout;
use super::window::Window;
use crate::error::Error;
use crate::rigs::acrobot::bench::Setting;
use crate::rigs::acrobot::residual::Tracked;
use crate::rigs::acrobot::residual::plant::policy::WINDOWS;
use rayon::prelude::*;

impl PlantCut {
    /// Whether the share of windows in which the plant needs slack torques stays within `most` at a point, all windows begun
    /// anew. Answers the question alone, without slack torques: that is what a linearisation there costs most.
    ///
    /// # Errors
    /// The unit failed.
    pub fn follows(&mut self, point: &[f64], most: f64) -> Result<bool, Error> {
        self.correct_log(point);
        self.begin_anew();
        let settings = self.settings(point, None)?;
        let each = self.windows.par_iter().map(|window| self.strays(window, &settings));
        let strays: Vec<bool> = each.collect::<Result<_, _>>()?;
        let count = strays.iter().filter(|strays| **strays).count();
        Ok(count as f64 <= most * strays.len() as f64)
    }

    /// Far more than noise is left.
    pub(super) fn astray(&self, layout: &Layout, fit: &Fit) -> bool {
        self.loose(layout, fit) > WINDOWS.slack * WINDOWS.slack
    }

    /// Whether a window that was begun anew needs slack torques to follow the log.
    pub(super) fn strays(&self, window: &Window, settings: &[Setting]) -> Result<bool, Error> {
        let layout = Layout::of(self, window);
        let begin = self.fit(window, &layout, settings, window.start, window.slack.clone())?;
        let fit = self.settle(window, &layout, settings, false, begin)?;
        Ok(self.astray(&layout, &fit))
    }

    /// Where another scatter of the timestamps changes whether the plant needs slack torques, fits again from the beginning;
    /// elsewhere that would find the same once more.
    pub(super) fn slacken_again(&mut self, point: &[f64], in_vain: bool) -> Result<bool, Error> {
        let changed = |place: &usize| {
            let window = &self.windows[*place];
            let layout = Layout::of(self, window);
            window.free.as_ref().is_none_or(|free| self.astray(&layout, free) != window.has_slack())
        };
        let places: Vec<usize> = (0..self.windows.len()).filter(changed).collect();
        for place in &places {
            let window = &mut self.windows[*place];
            window.begin(&self.runs[window.run]);
        }
        self.settle_some(&places, point, &[], in_vain).map(|(_, in_vain)| in_vain)
    }
}

impl Tracked<PlantCut> {
    /// Share of windows in which the plant needs slack torques to stay with the log.
    pub fn share_with_slack(&self) -> f64 {
        let windows = self.nuisances.windows.iter().flat_map(|windows| windows.iter());
        windows.filter(|window| window.has_slack()).count() as f64 / self.windows().0.max(1) as f64
    }

    /// As [`PlantCut::follows`]; windows begin from the data afterwards.
    ///
    /// # Errors
    /// The unit failed.
    pub fn follows(&mut self, point: &[f64], most: f64) -> Result<bool, Error> {
        self.reset();
        PlantCut::follows(self, point, most)
    }
}
