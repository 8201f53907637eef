//! What is corrected in the log itself before it is compared: its clock, and the zeros of its angles.

use super::PlantCut;
use crate::rigs::acrobot::candidates::Candidate;
use crate::rigs::acrobot::dataset::Run;
use crate::rigs::acrobot::residual::Perturbation;
use crate::rigs::acrobot::residual::trajectory::Drive;
use std::sync::Arc;

impl PlantCut {
    /// Corrects the log as a point says.
    pub(super) fn correct_log(&mut self, point: &[f64]) {
        if let Some(clock) = self.clock {
            self.shift(point[clock]);
        }
        self.turn(zeros(&self.candidates, point, None));
    }

    /// Moves the log to when the exposures ended.
    pub(super) fn shift(&mut self, delay: f64) {
        let Some(through) = &mut self.through else { return };
        let by = through.delay - delay;
        if by == 0.0 {
            return;
        }
        through.delay = delay;
        for log in Arc::make_mut(&mut self.runs).iter_mut().filter_map(|run| run.plant.as_mut()) {
            log.time.iter_mut().for_each(|time| *time += by);
        }
        for window in &mut self.windows {
            let run = &self.runs[window.run];
            let Some(log) = &run.plant else { continue };
            let times: Vec<f64> = window.rows.iter().map(|row| log.time[*row]).collect();
            window.edges.iter_mut().for_each(|edge| *edge += by);
            window.drive = Drive::new(run, window.drive.start() + by, &times, &window.edges);
        }
    }

    /// Turns the log's angles to where they are if their zeros are off by so much.
    fn turn(&mut self, zeros: [f64; 2]) {
        let by: [f64; 2] = std::array::from_fn(|angle| self.zeros[angle] - zeros[angle]);
        if by == [0.0; 2] {
            return;
        }
        self.zeros = zeros;
        for log in Arc::make_mut(&mut self.runs).iter_mut().filter_map(|run| run.plant.as_mut()) {
            for (name, by) in ["q1", "q2"].iter().zip(by) {
                if let Some(column) = log.column_mut(name) {
                    column.iter_mut().for_each(|value| *value += by);
                }
            }
        }
        for window in &mut self.windows {
            (0..2).for_each(|angle| window.start[angle] += by[angle]);
        }
    }
}

/// How far the zeros of q1 and q2 are off at a point, one candidate moved on, rad.
pub fn zeros(candidates: &[Candidate], point: &[f64], moved: Option<Perturbation>) -> [f64; 2] {
    let mut off = [0.0; 2];
    for (index, candidate) in candidates.iter().enumerate() {
        if let Some(angle) = candidate.zero() {
            let by = moved
                .filter(|perturbation| perturbation.candidate == index)
                .map_or(0.0, |perturbation| perturbation.by);
            off[angle] = (point[index] + by).clamp(candidate.range.0, candidate.range.1);
        }
    }
    off
}

/// Whether a run's torque changes.
pub(super) fn has_changing_torque(run: &Run) -> bool {
    let varies = |name| {
        let values = run.controller.as_ref().and_then(|log| log.column(name)).unwrap_or(&[]);
        let mut known = values.iter().filter(|value| value.is_finite());
        let first = known.next();
        known.any(|value| Some(value) != first)
    };
    varies("tau") || varies("tau_1")
}
