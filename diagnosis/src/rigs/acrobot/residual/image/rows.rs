//! Residuals and columns of the images, frame by frame.

use super::area_level::level;
use super::{Column, Frame, ImageCut, Pose, frames};
use crate::error::Error;
use crate::rigs::acrobot::residual::image::policy::IMAGES;
use crate::rigs::acrobot::residual::studio::{COLUMNS, Seen, circle_of};
use crate::rigs::acrobot::residual::{Block, Cut, Perturbation};
use crate::statistics::linear::{Cell, Drawn};
use nalgebra::DMatrix;

impl ImageCut {
    /// Residuals and sensitivities at the poses as they are.
    pub(super) fn compare(
        &mut self,
        point: &[f64],
        perturbations: &[Perturbation],
    ) -> Result<Vec<Block>, Error> {
        let made = self.base(point)?;
        self.compared(point, perturbations, &made.seen)
    }

    /// The same with what the model's camera makes of the frames.
    pub(super) fn compared(
        &mut self,
        point: &[f64],
        perturbations: &[Perturbation],
        base: &[Option<Seen>],
    ) -> Result<Vec<Block>, Error> {
        let columns = self.image_columns(point, perturbations)?;
        let free = !matches!(self.pose, Pose::Logged(..));
        self.unseen = (self.frames.iter().zip(base))
            .filter(|(frame, here)| (free || frame.known) && here.is_none())
            .count();
        let turns = self.turns.as_deref().unwrap_or(&[]);
        let mut blocks: Vec<Block> = Vec::new();
        for (index, frame) in self.frames.iter().enumerate() {
            let (Some(here), [Some(one), Some(two)]) = (&base[index], &turns[index]) else { continue };
            if !free && !frame.known {
                continue;
            }
            let cell = self.frame_cell(index, here, [one, two], perturbations, &columns);
            match blocks.last_mut() {
                Some(block) if block.run == frame.run && frame.time - block.from < IMAGES.image_block => {
                    block.to = frame.time;
                    block.cells.push(cell);
                }
                _ => blocks.push(Block {
                    run: frame.run,
                    from: frame.time,
                    to: frame.time,
                    cells: vec![cell],
                    state: frame.shot.end,
                }),
            }
        }
        level(&mut blocks);
        if blocks.is_empty() {
            return Err(Error::Model(
                "the camera unit finds its circles in none of the measured poses".into(),
            ));
        }
        Ok(blocks)
    }

    /// What each candidate's step does to the image; `None` for what moves no image, or only its pose.
    fn image_columns(
        &mut self,
        point: &[f64],
        perturbations: &[Perturbation],
    ) -> Result<Vec<Option<Column>>, Error> {
        let mut columns = Vec::with_capacity(perturbations.len());
        for perturbation in perturbations {
            let candidate = &self.candidates[perturbation.candidate];
            let seen = self.sees(candidate);
            let posed = Some(perturbation.candidate) == self.delay || candidate.zero().is_some();
            columns.push(if !seen || posed { None } else { Some(self.column(point, *perturbation)?) });
        }
        Ok(columns)
    }

    /// What a candidate that moves only the pose does to the image of a frame, by its changes with the two angles.
    fn pose_column(&self, candidate: usize, frame: &Frame, turns: [&Seen; 2]) -> Seen {
        let ([one, two], [.., dq1, dq2]) = (turns, frame.shot.end);
        let logged = matches!(self.pose, Pose::Logged(..));
        if Some(candidate) == self.delay && logged {
            return std::array::from_fn(|s| -(one[s] * dq1 + two[s] * dq2));
        }
        if !self.sees(&self.candidates[candidate]) {
            return [0.0; COLUMNS.len()];
        }
        // a reading that is too large has the arm nearer to the upright
        match self.candidates[candidate].zero() {
            Some(0) => one.map(|slope| -slope),
            Some(_) => two.map(|slope| -slope),
            None => [0.0; COLUMNS.len()],
        }
    }

    /// The rows of one frame, which the model's camera makes as `here`: residuals, with the columns of its pose and of the perturbations.
    fn frame_cell(
        &self,
        index: usize,
        here: &Seen,
        [one, two]: [&Seen; 2],
        perturbations: &[Perturbation],
        columns: &[Option<Column>],
    ) -> Cell {
        let frame = &self.frames[index];
        let [.., dq1, dq2] = frame.shot.end;
        let rows: Vec<usize> = (0..COLUMNS.len()).filter(|s| frame.seen[*s].is_finite()).collect();
        let pose = DMatrix::from_fn(rows.len(), 2, |r, c| if c == 0 { one[rows[r]] } else { two[rows[r]] });
        let mut matrix = DMatrix::zeros(rows.len(), perturbations.len());
        for (place, (column, perturbation)) in columns.iter().zip(perturbations).enumerate() {
            let slopes = match column {
                Some(column) => column[index].unwrap_or([0.0; COLUMNS.len()]),
                None => self.pose_column(perturbation.candidate, frame, [one, two]),
            };
            rows.iter().enumerate().for_each(|(r, s)| matrix[(r, place)] = slopes[*s]);
        }
        let none = DMatrix::zeros(rows.len(), 0);
        let (hard, soft, discrepancy) = match self.pose {
            Pose::Logged(_, sigma) => (none, pose * sigma, 2),
            Pose::Chained | Pose::Free => (pose, none, 0),
        };
        Cell {
            residual: rows.iter().map(|s| frames::residual(*s, &frame.seen, here)).collect(),
            sigma: rows.iter().map(|s| self.signals[*s].sigma).collect(),
            time: vec![frame.time; rows.len()],
            hard,
            soft,
            discrepancy,
            inertia_scale: 1.0,
            columns: matrix,
            floor: Vec::new(),
            state: frame.shot.end.to_vec(),
            lattice: rows.iter().map(|s| frames::lattice(&frame.seen, here, *s)).collect(),
            drawn: rows.iter().map(|s| drawn(here, *s, one[*s] * dq1 + two[*s] * dq2)).collect(),
            signal: rows,
        }
    }
}

/// Where a signal's circle was rendered, and how fast the signal changes.
fn drawn(here: &Seen, signal: usize, rate: f64) -> Drawn {
    let circle = circle_of(signal);
    Drawn { place: [here[2 * circle], here[2 * circle + 1]], rate }
}
