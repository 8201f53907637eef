//! Fits a window: its start state and slack torques, by Gauss-Newton through the unit, and the columns that are left.

use super::layout::Layout;
use super::memory::Asked;
use super::window::Window;
use super::{NUDGE, PlantCut};
use crate::error::Error;
use crate::rigs::acrobot::bench::Setting;
use crate::rigs::acrobot::candidates::Side;
use crate::rigs::acrobot::residual::plant::policy::WINDOWS;
use crate::rigs::acrobot::residual::trajectory::{Push, Row, State, simulate};
use crate::rigs::acrobot::residual::{Block, Cut, Perturbation};
use crate::statistics::linear::{Cell, nuisances};
use nalgebra::{DMatrix, DVector};

/// A window, simulated.
#[derive(Debug, Clone)]
pub(super) struct Fit {
    pub(super) start: State,
    pub(super) slack: Vec<f64>,
    pub(super) base: Vec<Row>,
    pub(super) cell: Cell,
    /// Whether the cell's hard and soft columns were taken at this very start and these slack torques.
    pub(super) here: [bool; 2],
}

/// What a linearisation or a chord step finds in a window.
pub(super) struct WindowFit {
    pub(super) start: State,
    pub(super) slack: Vec<f64>,
    pub(super) block: Block,
    /// The fit without slack torques, if there was one.
    pub(super) free: Option<Fit>,
}

impl PlantCut {
    /// Gauss-Newton for the start state (and the slack torques, if `slackened`), a step only if it brings the rows
    /// closer. What is left then is so small that the linear projection takes care of it.
    pub(super) fn settle(
        &self,
        window: &Window,
        layout: &Layout,
        settings: &[Setting],
        slackened: bool,
        from: Fit,
    ) -> Result<Fit, Error> {
        let rounds = if window.kept.is_some() { 2 } else { 4 };
        self.settle_in(rounds, window, layout, settings, slackened, from)
    }

    /// The same in at most so many rounds.
    pub(super) fn settle_in(
        &self,
        rounds: usize,
        window: &Window,
        layout: &Layout,
        settings: &[Setting],
        slackened: bool,
        from: Fit,
    ) -> Result<Fit, Error> {
        let mut fit = from;
        for _ in 0..rounds {
            self.nuisance_columns(window, layout, settings, slackened, &mut fit)?;
            let Some((whole, slack)) = next(&fit, slackened) else { break };
            let mut length = 1.0;
            let better = loop {
                let part = |from: f64, to: f64| from + length * (to - from);
                let start: State = std::array::from_fn(|place| part(fit.start[place], whole[place]));
                let slack = fit.slack.iter().zip(&slack).map(|(from, to)| part(*from, *to)).collect();
                if let Ok(trial) = self.fit(window, layout, settings, start, slack)
                    && square(&trial.cell) < square(&fit.cell)
                {
                    break Some(trial);
                }
                length *= 0.25;
                if length < 0.01 {
                    break None;
                }
            };
            let Some(better) = better else { break };
            let (hard, soft) = (fit.cell.hard, fit.cell.soft);
            fit = better;
            (fit.cell.hard, fit.cell.soft) = (hard, soft);
        }
        Ok(fit)
    }

    /// As `settle`, with the columns that are there: one simulation a step.
    pub(super) fn chord(
        &self,
        window: &Window,
        layout: &Layout,
        settings: &[Setting],
        slackened: bool,
        from: Fit,
    ) -> Result<Fit, Error> {
        let mut fit = from;
        for _ in 0..if slackened { 1 } else { 4 } {
            let Some((start, slack)) = next(&fit, slackened) else { break };
            let Ok(trial) = self.fit(window, layout, settings, start, slack) else { break };
            if square(&trial.cell) >= square(&fit.cell) {
                break;
            }
            let (hard, soft) = (fit.cell.hard, fit.cell.soft);
            fit = trial;
            (fit.cell.hard, fit.cell.soft) = (hard, soft);
        }
        Ok(fit)
    }

    /// The rows that the unit makes of a window from a start state, unless it has just made them.
    fn driven(
        &self,
        window: &Window,
        settings: &[Setting],
        start: &State,
        pushes: &[Push],
    ) -> Result<Vec<Row>, Error> {
        let make = || simulate(&self.bench, &self.ports, settings, &window.drive, start, pushes);
        window.memory.rows(&window.drive, Asked { settings, start, pushes }, make)
    }

    /// A window simulated from a start state with slack torques, N·m; no columns yet.
    pub(super) fn fit(
        &self,
        window: &Window,
        layout: &Layout,
        settings: &[Setting],
        start: State,
        slack: Vec<f64>,
    ) -> Result<Fit, Error> {
        let base = self.driven(window, settings, &start, &window.pushes(&slack))?;
        let cell = layout.cell(self, window, &base);
        Ok(Fit { start, slack, base, cell, here: [false; 2] })
    }

    /// Puts the columns of the start state into a fit's cell, and those of slack torques if `soft`, unless they were taken here already.
    pub(super) fn nuisance_columns(
        &self,
        window: &Window,
        layout: &Layout,
        settings: &[Setting],
        soft: bool,
        fit: &mut Fit,
    ) -> Result<(), Error> {
        let pushes = window.pushes(&fit.slack);
        let [hard_here, soft_here] = fit.here;
        if !hard_here {
            let mut hard = DMatrix::zeros(layout.len(), 4);
            for place in 0..4 {
                let mut moved = fit.start;
                let by = NUDGE[place];
                moved[place] += by;
                let rows = self.driven(window, settings, &moved, &pushes)?;
                layout.column(&fit.base, &rows, by, &mut hard, place);
            }
            fit.cell.hard = hard;
        }
        if soft && !soft_here {
            let by = self.inertia_scale * WINDOWS.push;
            let mut columns = DMatrix::zeros(layout.len(), fit.slack.len());
            for place in 0..fit.slack.len() {
                let mut more = pushes.clone();
                more.push(window.push(place, by));
                let rows = self.driven(window, settings, &fit.start, &more)?;
                layout.column(&fit.base, &rows, by, &mut columns, place);
            }
            fit.cell.soft = columns;
        }
        fit.here = [true, soft || soft_here];
        Ok(())
    }

    /// Settles a window's nuisances at a point.
    pub(super) fn linearised(
        &self,
        window: &Window,
        point: &[f64],
        perturbations: &[Perturbation],
    ) -> Result<WindowFit, Error> {
        let settings = self.settings(point, None)?;
        let layout = Layout::of(self, window);
        let begin = self.fit(window, &layout, &settings, window.start, window.slack.clone())?;
        let (fit, free) = self.settled(window, &layout, &settings, begin)?;
        self.compared(window, &layout, point, perturbations, fit, free)
    }

    /// A chord step of a window, by the sensitivities of its last linearisation; without any, it is linearised.
    pub(super) fn stepped(
        &self,
        window: &Window,
        point: &[f64],
        perturbations: &[Perturbation],
    ) -> Result<WindowFit, Error> {
        let settings = self.settings(point, None)?;
        let layout = Layout::of(self, window);
        let begin = self.fit(window, &layout, &settings, window.start, window.slack.clone())?;
        let (fit, free) = match self.nearer(window, &layout, &settings, window.has_slack(), &begin)? {
            Some(near) => (near, None),
            None => self.settled(window, &layout, &settings, begin)?,
        };
        self.compared(window, &layout, point, perturbations, fit, free)
    }

    /// Chord steps from `begin`, by the columns of the window's last linearisation; `None` without any. They are few simulations beside
    /// those that new columns take.
    fn nearer(
        &self,
        window: &Window,
        layout: &Layout,
        settings: &[Setting],
        slackened: bool,
        begin: &Fit,
    ) -> Result<Option<Fit>, Error> {
        let known = window.kept.as_ref().filter(|kept| kept.hard.nrows() == layout.len());
        let Some(kept) = known else { return Ok(None) };
        let mut near = begin.clone();
        (near.cell.hard, near.cell.soft) = (kept.hard.clone(), kept.soft.clone());
        near.here = [kept.is_of(settings, &window.drive, &near); 2];
        self.chord(window, layout, settings, slackened, near).map(Some)
    }

    /// A window's nuisances settled from `begin`, and, if there was one, the fit without slack torques.
    fn settled(
        &self,
        window: &Window,
        layout: &Layout,
        settings: &[Setting],
        mut begin: Fit,
    ) -> Result<(Fit, Option<Fit>), Error> {
        let (mut fit, mut free) = (begin.clone(), None);
        let slack_before = window.has_slack();
        if !slack_before {
            let near = self.nearer(window, layout, settings, false, &begin)?;
            if near.is_none() {
                // before the fit is settled: slack torques begin with these columns again
                self.nuisance_columns(window, layout, settings, false, &mut begin)?;
            }
            fit = self.settle(window, layout, settings, false, near.unwrap_or_else(|| begin.clone()))?;
            free = Some(fit.clone());
        }
        if slack_before || self.astray(layout, &fit) {
            let near = if slack_before { self.nearer(window, layout, settings, true, &begin)? } else { None };
            // from the first guess again: a state that was fitted without slack torques may be far away
            fit = self.settle(window, layout, settings, true, near.unwrap_or(begin))?;
        }
        self.nuisance_columns(window, layout, settings, true, &mut fit)?;
        Ok((fit, free))
    }

    /// What a fit leaves, with the sensitivities to the perturbations.
    fn compared(
        &self,
        window: &Window,
        layout: &Layout,
        point: &[f64],
        perturbations: &[Perturbation],
        fit: Fit,
        free: Option<Fit>,
    ) -> Result<WindowFit, Error> {
        let Fit { start, slack, base, mut cell, .. } = fit;
        // the model itself has no slack torques: what they did is part of the residual
        let missing = &cell.soft * DVector::from_column_slice(&slack);
        cell.residual.iter_mut().zip(missing.iter()).for_each(|(residual, torque)| *residual += torque);
        let pushes = window.pushes(&slack);
        let (from, to) = (window.drive.start(), window.drive.end());
        let mut columns = DMatrix::zeros(layout.len(), perturbations.len());
        for (place, perturbation) in perturbations.iter().enumerate() {
            let candidate = &self.candidates[perturbation.candidate];
            if candidate.side != Side::Plant && self.sees(candidate) {
                let column = self.seen_column(window, layout, &base, place, perturbation.candidate);
                (0..layout.len()).for_each(|row| columns[(row, place)] = column[row]);
            } else if self.sees(candidate) {
                let moved = self.settings(point, Some(*perturbation))?;
                // a value that the plant can't follow has no column
                if let Ok(rows) = self.driven(window, &moved, &start, &pushes) {
                    layout.column(&base, &rows, perturbation.by, &mut columns, place);
                }
            }
        }
        cell.columns = columns;
        self.timestamps(window, layout, &base, &mut cell);
        let mut state = [0.0; 4];
        for row in &base {
            for (sum, value) in state.iter_mut().zip(row) {
                *sum += value / base.len() as f64;
            }
        }
        let block = Block {
            run: window.run,
            from: cell.time.first().copied().unwrap_or(from),
            to,
            cells: vec![cell],
            state,
        };
        Ok(WindowFit { start, slack, block, free })
    }
}

pub(super) fn square(cell: &Cell) -> f64 {
    cell.residual.iter().zip(&cell.sigma).map(|(residual, sigma)| (residual / sigma).powi(2)).sum()
}

/// Start state and slack torques after a Gauss-Newton step; `None` when it moves the rows by less than a tenth of a standard
/// deviation. They are free while they are fitted.
pub(super) fn next(fit: &Fit, slackened: bool) -> Option<(State, Vec<f64>)> {
    let cell = &fit.cell;
    // nothing is a discrepancy yet but the slack torques
    let shift = nuisances(cell, &cell.residual, if slackened { cell.free() } else { 0.0 });
    let hard = cell.hard.ncols();
    let mut moved = &cell.hard * shift.rows(0, hard);
    if slackened {
        moved += &cell.soft * shift.rows(hard, shift.len() - hard);
    }
    let size = moved.iter().zip(&cell.sigma).map(|(moved, sigma)| (moved / sigma).powi(2)).sum::<f64>();
    if size < 0.01 * cell.residual.len() as f64 {
        return None;
    }
    let start = std::array::from_fn(|place| fit.start[place] + shift[place]);
    let mut slack = fit.slack.clone();
    if slackened {
        slack.iter_mut().enumerate().for_each(|(place, torque)| *torque += shift[hard + place]);
    }
    Some((start, slack))
}
