//! The plant's cut: logged torque in, encoder columns out, in windows with free start states.

use super::settings::settings;
pub use super::trajectory::MOTION;
use super::trajectory::{CHANNELS, Ports, Row, State};
use super::{Block, Cut, Linearised, Nuisances, Perturbation, Policy, Signal};
use crate::error::Error;
use crate::rigs::acrobot::bench::{Bench, Setting};
use crate::rigs::acrobot::candidates::{Candidate, Side};
use crate::rigs::acrobot::channels::{Channel, Measures};
use crate::rigs::acrobot::dataset::{DataSet, Run};
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::parameters;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::plant::policy::WINDOWS;
use crate::statistics::levels::{FAR, HALF};
use rayon::prelude::*;
use std::sync::Arc;

mod applied_torque;
mod camera_poses;
mod fitted_motion;
mod fitting;
mod follows_log;
mod forced_windows;
pub mod jitter;
mod layout;
mod log_correction;
mod memory;
pub(crate) mod policy;
mod window;
mod window_restart;

pub use camera_poses::Poses;
use camera_poses::Through;
use fitting::WindowFit;
use layout::Layout;
use log_correction::has_changing_torque;
pub use log_correction::zeros;
pub use window::WindowState;
use window::{Kept, Window, cut_run, most_windows, runaway_rate, thin_windows};

/// Perturbations for derivatives: far above the integrator's 1e-9, far below where the plant bends.
const NUDGE: State = {
    let (angle, rate) = (HALF * POLICY.read, HALF * POLICY.read * FAR);
    [angle, angle, rate, rate]
};

/// Torque in, motion out.
#[derive(Clone)]
pub struct PlantCut {
    bench: Arc<Bench>,
    ports: Ports,
    candidates: Arc<Vec<Candidate>>,
    runs: Arc<Vec<Run>>,
    windows: Vec<Window>,
    signals: Vec<Signal>,
    through: Option<Through>,
    clock: Option<usize>,
    /// By how much the log's angles were turned back, rad.
    zeros: [f64; 2],
    /// Scatter of the log's timestamps, s.
    jitter: f64,
    /// By how much the log may be late, s: no bound where runs were found to have clocks of their own.
    doubt: f64,
    /// Torque that the scatter of its timestamps explains, N·m.
    explained: f64,
    /// How near to a change of the command each run's torque is in doubt, s.
    reach: Arc<Vec<f64>>,
    /// Start states as the data alone have them.
    first: Arc<Vec<WindowState>>,
    /// Windows that the logs were cut into, before they were thinned.
    cut: usize,
    /// How heavy the arm is.
    inertia_scale: f64,
}

/// The plant's signals; torques of an arm of this inertia scale.
fn signals_of(data: &DataSet, inertia_scale: f64) -> Vec<Signal> {
    let signal = |channel: &Channel| {
        let name = format!("plant.{}", channel.column);
        let known = data.known_noise(&name).filter(|sigma| *sigma > 0.0);
        let scale = if channel.measures == Measures::AppliedTorque { inertia_scale } else { 1.0 };
        let noise = channel.noise.unwrap_or_default();
        let sigma = known.unwrap_or(scale * noise.guess);
        Signal {
            name,
            unit: channel.unit,
            measures: channel.measures,
            known,
            sigma,
            least: scale * noise.least,
            tolerance: 0.0,
        }
    };
    CHANNELS.iter().map(signal).collect()
}

/// The windows of all runs that are compared, and how many there were. `contact` is the angle at which links touch, rad, and `pace` the
/// share of the usual time that a quick arm's windows last.
fn cut_windows(data: &DataSet, contact: f64, pace: f64) -> (Vec<Window>, usize) {
    let mut windows = Vec::new();
    for (index, run) in data.runs.iter().enumerate() {
        cut_run(index, run, contact, pace, &mut windows);
    }
    let count = windows.len();
    // where there are images each window has frames to tell of
    if data.runs.iter().all(|run| run.camera.is_none()) {
        let most = most_windows(&windows, &data.runs);
        thin_windows(&mut windows, most);
    }
    (windows, count)
}

impl PlantCut {
    /// Windows over all runs that have a torque and a motion; `None` if there is none.
    ///
    /// # Errors
    /// The plant unit lacks a variable.
    pub fn new(
        data: &DataSet,
        model: &Model,
        candidates: Arc<Vec<Candidate>>,
    ) -> Result<Option<Self>, Error> {
        let (ports, inertia_scale) =
            (Ports::of(&model.plant, runaway_rate(data, model))?, model.inertia_scale());
        let contact = data.contact(model.number(parameters::LIMIT).unwrap_or(f64::INFINITY));
        let growth = model.growth();
        let pace = growth.map_or(1.0, |growth| (WINDOWS.quick / growth).min(1.0));
        let (windows, cut) = cut_windows(data, contact, pace);
        if windows.is_empty() {
            return Ok(None);
        }
        let runs = Arc::new(data.runs.clone());
        // without a torque that changes there is no other log that this one could be late against
        let clock = candidates
            .iter()
            .position(|candidate| candidate.side == Side::Clock)
            .filter(|_| runs.iter().any(has_changing_torque));
        let part = windows.first().map_or(WINDOWS.window, |window| window.edges[1] - window.edges[0]);
        let explained = jitter::torque_jitter(&runs, part);
        let reach = Arc::new(runs.iter().map(applied_torque::doubt_of_torque).collect());
        let first = Arc::new(windows.iter().map(Window::state).collect());
        let through = clock.map(|_| Through { index: clock, delay: 0.0, poses: Poses::new(runs.len()) });
        Ok(Some(Self {
            bench: model.plant.clone(),
            ports,
            candidates,
            runs,
            windows,
            signals: signals_of(data, inertia_scale),
            through,
            clock,
            zeros: [0.0; 2],
            jitter: 0.0,
            explained,
            reach,
            first,
            doubt: if data.clocks_apart { f64::INFINITY } else { data.late_by_hand },
            cut,
            inertia_scale,
        }))
    }

    /// Whether a signal is the torque that arrives.
    fn applied(&self, signal: usize) -> bool {
        CHANNELS[signal].measures == Measures::AppliedTorque
    }

    /// Windows that are compared, and those that the logs were cut into.
    pub fn windows(&self) -> (usize, usize) {
        (self.windows.len(), self.cut)
    }

    fn settings(&self, point: &[f64], moved: Option<Perturbation>) -> Result<Vec<Setting>, Error> {
        settings(&self.bench, &self.candidates, Side::Plant, point, moved)
    }

    /// Puts windows where nuisances have them.
    pub(super) fn begin_from(&mut self, from: &Nuisances) {
        match &from.windows {
            Some(states) => {
                self.windows.iter_mut().zip(&**states).for_each(|(window, state)| window.restore(state))
            }
            None => self.begin_anew(),
        }
    }

    /// Begins windows from the data.
    fn begin_anew(&mut self) {
        let runs = self.runs.clone();
        self.windows.iter_mut().for_each(|window| window.begin(&runs[window.run]));
    }

    /// Where the windows are.
    pub(super) fn state(&self) -> Arc<Vec<WindowState>> {
        Arc::new(self.windows.iter().map(Window::state).collect())
    }

    fn nuisances(&self, in_vain: bool) -> Nuisances {
        Nuisances { windows: Some(self.state()), frames: None, in_vain }
    }

    /// Linearises all windows from where they are. Answers, too, whether doubts of windows were in vain.
    pub(super) fn settle_all(
        &mut self,
        point: &[f64],
        perturbations: &[Perturbation],
        in_vain: bool,
    ) -> Result<(Vec<Block>, bool), Error> {
        self.correct_log(point);
        let all: Vec<usize> = (0..self.windows.len()).collect();
        self.settle_some(&all, point, perturbations, in_vain)
    }

    /// Linearises some windows.
    fn settle_some(
        &mut self,
        places: &[usize],
        point: &[f64],
        perturbations: &[Perturbation],
        in_vain: bool,
    ) -> Result<(Vec<Block>, bool), Error> {
        let fit = |place: &usize| self.linearised(&self.windows[*place], point, perturbations);
        let mut done: Vec<_> = places.par_iter().map(fit).collect();
        let in_vain = !self.restart_windows(places, point, perturbations, &mut done, in_vain)? || in_vain;
        let settings = self.settings(point, None)?;
        let mut blocks = Vec::with_capacity(done.len());
        for (place, result) in places.iter().zip(done) {
            let WindowFit { start, slack, block, free } = result?;
            let window = &mut self.windows[*place];
            window.free = free.map(Arc::new);
            window.kept = block.cells.first().map(|cell| {
                let count = cell.soft.ncols() - cell.discrepancy;
                let soft = cell.soft.columns(cell.discrepancy, count).into_owned();
                let (settings, drive) = (settings.clone(), window.drive.clone());
                Arc::new(Kept { start, slack: slack.clone(), hard: cell.hard.clone(), soft, settings, drive })
            });
            (window.start, window.slack) = (start, slack);
            blocks.push(block);
        }
        Ok((blocks, in_vain))
    }

    /// A chord step of all windows from where they are.
    pub(super) fn step_all(
        &mut self,
        point: &[f64],
        perturbations: &[Perturbation],
    ) -> Result<Vec<Block>, Error> {
        self.correct_log(point);
        let fit = |window: &Window| self.stepped(window, point, perturbations);
        let done: Vec<_> = self.windows.par_iter().map(fit).collect();
        let mut blocks = Vec::with_capacity(done.len());
        for (window, result) in self.windows.iter_mut().zip(done) {
            let WindowFit { start, slack, block, .. } = result?;
            (window.start, window.slack) = (start, slack);
            blocks.push(block);
        }
        Ok(blocks)
    }

    /// The log is none of encoders but what a camera with this delay saw.
    pub fn see_through(&mut self, delay: f64) {
        let poses = Poses::new(self.runs.len());
        self.clock = None;
        self.through = Some(Through { index: None, delay: 0.0, poses });
        self.shift(delay);
    }

    /// Other poses for the log's rows, and another delay of the camera (its candidate and value).
    pub fn replace(&mut self, poses: Poses, delay: Option<(usize, f64)>) {
        let zeros = self.zeros;
        for (run, angles) in Arc::make_mut(&mut self.runs).iter_mut().zip(&poses.angles) {
            let Some(log) = &mut run.plant else { continue };
            for (place, name) in ["q1", "q2"].iter().enumerate() {
                if let Some(column) = log.column_mut(name) {
                    column
                        .iter_mut()
                        .zip(angles)
                        .for_each(|(value, angles)| *value = angles[place] - zeros[place]);
                }
            }
        }
        if let Some(through) = &mut self.through {
            through.poses = poses;
            through.index = delay.map(|(index, _)| index);
        }
        if let Some((_, delay)) = delay {
            self.shift(delay);
        }
    }

    /// A column that needs no simulation: what moving the camera does to angles that were read off its image.
    fn seen_column(
        &self,
        window: &Window,
        layout: &Layout,
        base: &[Row],
        place: usize,
        candidate: usize,
    ) -> Vec<f64> {
        if let Some(angle) = self.candidates[candidate].zero() {
            return layout.bins.iter().map(|(signal, _)| f64::from(u8::from(*signal == angle))).collect();
        }
        let Some(through) = &self.through else { return vec![0.0; layout.len()] };
        if through.index == Some(candidate) {
            return self.slopes(window, layout, base).iter().map(|slope| -slope).collect();
        }
        let moves = |row: &usize, signal: usize| {
            let all = &through.poses.moves[window.run];
            all.get(window.rows[*row]).map_or(0.0, |moves| moves[(signal, place)])
        };
        (layout.bins.iter())
            .map(|(signal, rows)| rows.iter().map(|row| moves(row, *signal)).sum::<f64>() / rows.len() as f64)
            .collect()
    }

    /// How fast what goes into each bin changes, per second.
    fn slopes(&self, window: &Window, layout: &Layout, base: &[Row]) -> Vec<f64> {
        let Some(log) = &self.runs[window.run].plant else { return vec![0.0; layout.len()] };
        // of what is no angle, by neighbouring rows
        let slope = |row: usize, signal: usize| {
            if signal < 2 {
                return base[row][2 + signal];
            }
            let (before, after) = (row.saturating_sub(1), (row + 1).min(base.len() - 1));
            let span = log.time[window.rows[after]] - log.time[window.rows[before]];
            if span > 0.0 { (base[after][signal] - base[before][signal]) / span } else { 0.0 }
        };
        (layout.bins.iter())
            .map(|(signal, rows)| {
                rows.iter().map(|row| slope(*row, *signal)).sum::<f64>() / rows.len() as f64
            })
            .collect()
    }
}

impl Cut for PlantCut {
    fn name(&self) -> &'static str {
        "plant: torque in, motion out"
    }

    fn signals(&self) -> &[Signal] {
        &self.signals
    }

    fn sees(&self, candidate: &Candidate) -> bool {
        match candidate.side {
            Side::Plant => true,
            Side::Clock => self.clock.is_some(),
            Side::Zero => true,
            Side::Camera => self.through.is_some() && self.clock.is_none(),
            _ => false,
        }
    }

    fn policy(&self) -> Policy {
        let tick_drift = jitter::tick_drift(&self.runs);
        Policy { clock_doubt: self.doubt, explained: self.explained, tick_drift, ..Policy::USUAL }
    }

    fn initial(&self) -> Nuisances {
        Nuisances { windows: Some(self.first.clone()), ..Nuisances::default() }
    }

    fn linearise(
        &mut self,
        at: &[f64],
        perturbations: &[Perturbation],
        from: &Nuisances,
    ) -> Result<Linearised, Error> {
        self.begin_from(from);
        let (blocks, in_vain) = self.settle_all(at, perturbations, from.in_vain)?;
        Ok(Linearised { blocks, nuisances: self.nuisances(in_vain), unseen: 0 })
    }

    fn chord(
        &mut self,
        at: &[f64],
        perturbations: &[Perturbation],
        from: &Nuisances,
    ) -> Result<Linearised, Error> {
        self.begin_from(from);
        let blocks = self.step_all(at, perturbations)?;
        Ok(Linearised { blocks, nuisances: self.nuisances(from.in_vain), unseen: 0 })
    }
}
