//! The fitted motion: what the plant did between the rows, by windows where a linearisation left them.

use super::super::trajectory::{Drive, Motion, PREROLL, State, simulate, state_of};
use super::super::{Nuisances, Tracked};
use super::PlantCut;
use super::policy::WINDOWS;
use crate::error::Error;
use rayon::prelude::*;

impl PlantCut {
    /// The fitted motion on a grid of `every` s, one stretch a window (the last scored time of one to that of the
    /// next), with nuisances `at` where a linearisation at the point left them.
    ///
    /// # Errors
    /// The unit failed.
    pub fn motion(&mut self, point: &[f64], every: f64, at: &Nuisances) -> Result<Vec<Motion>, Error> {
        self.begin_from(at);
        self.motion_now(point, every)
    }

    /// The fitted motion with windows where they are, `every` so many seconds.
    pub(in super::super) fn motion_now(&self, point: &[f64], every: f64) -> Result<Vec<Motion>, Error> {
        let settings = self.settings(point, None)?;
        let mut motions = vec![Motion::default(); self.runs.len()];
        let stretches: Vec<_> = self
            .windows
            .par_iter()
            .map(|window| {
                let log = &self.runs[window.run];
                let first = log.plant.as_ref().map_or(0.0, |plant| plant.time[window.rows[0]]);
                // back to where the window before ended
                let from = (first - WINDOWS.window.min(PREROLL)).max(window.drive.start());
                let count = ((window.drive.end() - from) / every).ceil().max(1.0) as usize;
                let times: Vec<f64> = (0..=count)
                    .map(|k| from + (window.drive.end() - from) * k as f64 / count as f64)
                    .collect();
                let drive = Drive::new(log, window.drive.start(), &times, &window.edges);
                let rows = simulate(
                    &self.bench,
                    &self.ports,
                    &settings,
                    &drive,
                    &window.start,
                    &window.pushes(&window.slack),
                )?;
                let states: Vec<State> = rows.iter().map(state_of).collect();
                Ok::<_, Error>((window.run, times, states))
            })
            .collect::<Result<_, _>>()?;
        for (run, times, states) in stretches {
            motions[run].stretches.push((times, states));
        }
        Ok(motions)
    }
}

impl Tracked<PlantCut> {
    /// As [`PlantCut::motion`], where the nuisances are.
    ///
    /// # Errors
    /// The unit failed.
    pub fn motion(&mut self, point: &[f64], every: f64) -> Result<Vec<Motion>, Error> {
        let at = self.nuisances.clone();
        PlantCut::motion(self, point, every, &at)
    }
}
