//! A window that is lost, or doubted where the arm sticks, begins anew elsewhere.
//!
//! A start state is guessed from few rows: a joint that sticks or slips between two of them has another rate than that, and from
//! there the arm may never come to where it was seen, nor a fit out of that valley. But a window begins before the one before it
//! ends, and where that one follows the log it knows the state; and a joint that sticks has no rate.

use super::PlantCut;
use super::fitting::{Fit, WindowFit, square};
use super::layout::Layout;
use super::window::Window;
use crate::error::Error;
use crate::rigs::acrobot::bench::Setting;
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::residual::Perturbation;
use crate::rigs::acrobot::residual::plant::policy::WINDOWS;
use crate::rigs::acrobot::residual::trajectory::{Drive, State, simulate, state_of};
use crate::statistics::median::median;
use rayon::prelude::*;

/// Sum of squares of a window's whitened residual.
fn squares(fit: &WindowFit) -> f64 {
    fit.block.cells.iter().map(square).sum()
}

/// Number of a window's rows.
fn rows(fit: &WindowFit) -> f64 {
    fit.block.cells.iter().map(|cell| cell.residual.len() as f64).sum()
}

/// Whether far more is left in a window than noise leaves.
fn is_lost(fit: &WindowFit) -> bool {
    squares(fit) > WINDOWS.far * rows(fit)
}

/// Mean square of the usual window.
fn usual_mean_square(found: &[Result<WindowFit, Error>]) -> f64 {
    let means = found.iter().flatten().map(|fit| squares(fit) / rows(fit));
    median(means.filter(|mean| mean.is_finite())).unwrap_or(f64::INFINITY)
}

/// Whether more is left in a window than in the `usual` one, by more than noise differs from window to window.
fn is_doubted(fit: &WindowFit, usual: f64) -> bool {
    squares(fit) > usual * (rows(fit) + WINDOWS.doubt * (2.0 * rows(fit)).sqrt())
}

impl PlantCut {
    /// Fits windows again that are lost or doubted, those of a run in their order. `found` is what was found at `places`.
    /// Answers whether doubts are worth having: not where nobody who was doubted got a better start, now or `in_vain` before.
    pub(super) fn restart_windows(
        &self,
        places: &[usize],
        point: &[f64],
        perturbations: &[Perturbation],
        found: &mut [Result<WindowFit, Error>],
        in_vain: bool,
    ) -> Result<bool, Error> {
        let (mut doubts, mut helped) = (0, 0);
        let settings = self.settings(point, None)?;
        let sticks = |(candidate, x): (&Candidate, &f64)| candidate.sticks() && candidate.value(*x) > 0.0;
        let asked = !in_vain && self.candidates.iter().zip(point).any(sticks);
        let usual = if asked { usual_mean_square(found) } else { f64::INFINITY };
        for index in 0..found.len() {
            let here = &self.windows[places[index]];
            let Ok(fit) = &found[index] else { continue };
            let before = index
                .checked_sub(1)
                .and_then(|before| Some((&self.windows[places[before]], found[before].as_ref().ok()?)));
            let from_before =
                || before.and_then(|(window, known)| self.state_of(window, known, here, &settings));
            let begun = if is_doubted(fit, usual) {
                let deepest = self.deepest_start(here, fit, from_before(), &settings);
                doubts += 1;
                helped += usize::from(deepest.is_some());
                deepest
            } else {
                let better =
                    |(_, known): (&Window, &WindowFit)| squares(known) <= WINDOWS.better * squares(fit);
                if is_lost(fit) && before.is_some_and(better) { from_before() } else { None }
            };
            let Some(begun) = begun else { continue };
            // what begins anew and fails leaves what there was
            let Ok(again) = self.linearised(&here.started_at(begun), point, perturbations) else { continue };
            if squares(&again) < squares(fit) {
                found[index] = Ok(again);
            }
        }
        Ok(doubts == 0 || helped > 0)
    }

    /// The start state with which an arm that may stick follows the log best, if that is better than what was found.
    fn deepest_start(
        &self,
        here: &Window,
        fit: &WindowFit,
        from_before: Option<State>,
        settings: &[Setting],
    ) -> Option<State> {
        let [q1, q2, dq1, dq2] = fit.start;
        let both = 0.5 * (dq1 + dq2);
        let stuck = [[q1, q2, both, both], [q1, q2, 0.0, dq2], [q1, q2, 0.0, 0.0]];
        let starts: Vec<State> = from_before.into_iter().chain(stuck).collect();
        let layout = Layout::of(self, here);
        let begun = here.started_at(fit.start);
        let near = |start: &State| -> Option<Fit> {
            let fit = self.fit(&begun, &layout, settings, *start, begun.slack.clone()).ok()?;
            self.settle_in(1, &begun, &layout, settings, false, fit).ok()
        };
        // one round tells the valleys apart; the deepest is followed to its ground
        let near: Vec<Fit> = starts.par_iter().filter_map(near).collect();
        let near = near.into_iter().min_by(|a, b| square(&a.cell).total_cmp(&square(&b.cell)))?;
        let best = self.settle(&begun, &layout, settings, false, near).ok()?;
        (square(&best.cell) < WINDOWS.deeper * squares(fit)).then_some(best.start)
    }

    /// The state of one window where the next begins, if it goes so far.
    fn state_of(
        &self,
        before: &Window,
        known: &WindowFit,
        next: &Window,
        settings: &[Setting],
    ) -> Option<State> {
        let (begin, at) = (before.drive.start(), next.drive.start());
        if before.run != next.run || at <= begin || at >= before.drive.end() {
            return None;
        }
        let drive = Drive::new(&self.runs[before.run], begin, &[at], &before.edges);
        let pushes = before.pushes(&known.slack);
        let rows = simulate(&self.bench, &self.ports, settings, &drive, &known.start, &pushes).ok()?;
        rows.last().map(state_of)
    }
}
