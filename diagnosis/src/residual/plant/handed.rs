//! A window that is lost begins anew where the one before it was then.
//!
//! A start state is guessed from few rows: a joint that sticks or slips between two of them has another rate than that, and from
//! there the arm may never come to where it was seen, nor a fit out of that valley. But a window begins before the one before it
//! ends, and where that one follows the log it knows the state.

use super::fitting::{Look, square};
use super::*;

/// A mean square of the whitened rest that no noise gives.
const FAR: f64 = 4.0;
/// The window before says more than this one where it has no more than this share of its squares.
const BETTER: f64 = 0.3;

fn squares(look: &Look) -> f64 {
    look.block.cells.iter().map(square).sum()
}

fn lost(look: &Look) -> bool {
    squares(look) > FAR * look.block.cells.iter().map(|cell| cell.residual.len() as f64).sum::<f64>()
}

impl PlantCut {
    /// Looks again at windows that are lost, those of a run in their order. `found` is what was found at `places`.
    pub(super) fn handed(
        &self,
        places: &[usize],
        point: &[f64],
        probes: &[Probe],
        found: &mut [Result<Look, Error>],
    ) -> Result<(), Error> {
        let settings = self.settings(point, None)?;
        for index in 1..found.len() {
            let [before, here] = [places[index - 1], places[index]].map(|place| &self.windows[place]);
            let (Ok(known), Ok(look)) = (&found[index - 1], &found[index]) else { continue };
            if !lost(look) || squares(known) > BETTER * squares(look) {
                continue;
            }
            let Some(state) = self.state_of(before, known, here, &settings) else { continue };
            // what begins anew and fails leaves what there was
            let Ok(again) = self.window(&here.begun_at(state), point, probes, false) else { continue };
            if squares(&again) < squares(look) {
                found[index] = Ok(again);
            }
        }
        Ok(())
    }

    /// The state of one window where the next begins, if it goes so far.
    fn state_of(&self, before: &Window, known: &Look, next: &Window, settings: &[Setting]) -> Option<State> {
        let (begin, at) = (before.drive.start(), next.drive.start());
        if before.run != next.run || at <= begin || at >= before.drive.end() {
            return None;
        }
        let drive = Drive::new(&self.runs[before.run], begin, &[at], &before.edges);
        let pushes = before.pushes(&known.leads);
        let rows = simulate(&self.bench, &self.ports, settings, &drive, &known.start, &pushes).ok()?;
        rows.last().map(|[q1, q2, dq1, dq2, _]| [*q1, *q2, *dq1, *dq2])
    }
}
