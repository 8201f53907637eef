//! Poses read off images.

use super::{Frame, ImageCut, Pose};
use crate::error::Error;
use crate::rigs::acrobot::residual::Block;
use crate::rigs::acrobot::residual::image::policy::IMAGES;
use crate::rigs::acrobot::residual::plant::zeros;
use crate::rigs::acrobot::residual::studio::{ANGLES, AREAS, Shot, Studio};
use crate::rigs::acrobot::residual::trajectory::State;
use crate::statistics::linear::Cell;
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

pub(super) fn back(state: &State, by: f64) -> State {
    [state[0] - by * state[2], state[1] - by * state[3], state[2], state[3]]
}

/// A state whose angles are smaller by so much.
pub(super) fn turned(state: &State, off: [f64; 2]) -> State {
    [state[0] - off[0], state[1] - off[1], state[2], state[3]]
}

/// Poses as a person reads them off an image whose mount is turned by so much (rad): the directions from circle to
/// circle; rates from neighbours. An exposure can begin one interval before its end.
///
/// # Errors
/// The camera unit failed.
pub(super) fn free_poses(frames: &mut [Frame], mount: f64, studio: &Studio) -> Result<(), Error> {
    let (sin, cos, interval) = (libm::sin(mount), libm::cos(mount), studio.interval());
    let link = |du: f64, dv: f64| libm::atan2(du * cos + dv * sin, dv * cos - du * sin);
    let circle_1 = |frame: &Frame| frame.seen[..2].iter().all(|at| at.is_finite());
    let drum = if frames.iter().all(circle_1) { None } else { rolling(studio)? };
    let read = |frame: &Frame| {
        let s = &frame.seen;
        if s[ANGLES].iter().all(|angle| angle.is_finite()) {
            return [s[ANGLES.start], s[ANGLES.start + 1]];
        }
        let upper = link(s[4] - s[2], s[5] - s[3]);
        let from = |at: [f64; 2]| link(s[2] - at[0], s[3] - at[1]);
        match drum {
            _ if circle_1(frame) => [from([s[0], s[1]]), upper],
            Some([at, per]) => {
                let again = |q1: f64, _| from([at[0] + q1 * per[0], at[1] + q1 * per[1]]);
                [(0..IMAGES.rolls).fold(0.0, again), upper]
            }
            None => [f64::NAN, upper],
        }
    };
    let poses: Vec<[f64; 2]> = frames.iter().map(read).collect();
    for place in 0..frames.len() {
        let before = if place > 0 && frames[place - 1].run == frames[place].run { place - 1 } else { place };
        let after = if place + 1 < frames.len() && frames[place + 1].run == frames[place].run {
            place + 1
        } else {
            place
        };
        let span = frames[after].time - frames[before].time;
        let rate = |angle: usize| {
            if span > 0.0 { (poses[after][angle] - poses[before][angle]) / span } else { 0.0 }
        };
        let end = [poses[place][0], poses[place][1], rate(0), rate(1)];
        frames[place].shot = Shot { before: back(&end, interval), end, ..frames[place].shot };
        frames[place].known = true;
    }
    Ok(())
}

/// Where circle 1 is at the upright, px, and how far it rolls, px/rad, as the unit has it.
fn rolling(studio: &Studio) -> Result<Option<[[f64; 2]; 2]>, Error> {
    let shot = |q1: f64| Shot { before: [q1, 0.0, 0.0, 0.0], end: [q1, 0.0, 0.0, 0.0], odd: false };
    let made = studio.take(&[], &[shot(0.0), shot(IMAGES.rolled)])?;
    let [Some(here), Some(there)] = made[..] else { return Ok(None) };
    Ok(Some([
        [here[0], here[1]],
        [(there[0] - here[0]) / IMAGES.rolled, (there[1] - here[1]) / IMAGES.rolled],
    ]))
}

impl ImageCut {
    /// Puts the zeros of the motion's angles in question, which it was turned back by so much.
    pub fn doubt_zeros(&mut self, turned: Option<[f64; 2]>) {
        self.zeros = turned;
    }

    /// How much farther a point turns the motion back.
    pub(super) fn turned_back(&self, point: &[f64]) -> [f64; 2] {
        let Some(before) = self.zeros else { return [0.0; 2] };
        let now = zeros(&self.candidates, point, None);
        std::array::from_fn(|angle| now[angle] - before[angle])
    }

    /// Lets poses that were read off the image follow a camera that was moved, so that frames are rendered where this camera
    /// has them: the pixel lattice is part of the model only there.
    pub(super) fn follow(&mut self, point: &[f64]) -> Result<(), Error> {
        if let Pose::Logged(..) = self.pose {
            return Ok(());
        }
        // a delay or a plant that changes leaves the images as they are: such fits are compared to the last bit
        let exposure = |candidate: usize| (point[candidate], self.candidates[candidate].off);
        let (open, off) = self.exposure.map_or((0.0, 0.0), exposure);
        let now = (self.settings(point, None)?, open);
        if self.followed.as_ref() == Some(&now) {
            return Ok(());
        }
        let before = self.followed.replace(now).map_or(off, |(_, before)| before);
        // an image is of the middle of its exposure: that moves with the motion, which no neighbours smooth
        let later = 0.5 * (open - before) * self.interval();
        for frame in self.frames.iter_mut().filter(|_| later != 0.0) {
            frame.shot.end = back(&frame.shot.end, -later);
            frame.shot.before = back(&frame.shot.before, -later);
        }
        // what noise moves a threshold by turns no link: one image of each frame will do
        let made = self.noiseless(point)?;
        let blocks = self.compared(point, &[], &made)?;
        let smooth = self.smoothed(&blocks);
        let size = smooth.iter().flatten().map(|shift| shift * shift).sum::<f64>();
        if size < IMAGES.still * IMAGES.still * smooth.len() as f64 {
            return Ok(());
        }
        for (frame, shift) in self.frames.iter_mut().zip(&smooth) {
            for (angle, by) in shift.iter().enumerate() {
                frame.shot.end[angle] += by;
                frame.shot.before[angle] += by;
            }
        }
        Ok(())
    }

    /// The shift that each frame's residual asks for, averaged with its neighbours' if a plant follows them.
    fn smoothed(&self, blocks: &[Block]) -> Vec<[f64; 2]> {
        let mut cells =
            blocks.iter().flat_map(|block| block.cells.iter().map(move |cell| (block.run, cell))).peekable();
        let shifts: Vec<Option<[f64; 2]>> = (self.frames.iter())
            .map(|frame| {
                let here =
                    cells.next_if(|(run, cell)| *run == frame.run && cell.time.first() == Some(&frame.time));
                here.and_then(|(_, cell)| pose_shift(cell)).map(|(shift, _)| [shift[0], shift[1]])
            })
            .collect();
        let beside = if let Pose::Chained = self.pose { IMAGES.poses_beside } else { 0 };
        let smooth = |place: usize| {
            let run = self.frames[place].run;
            let near = place.saturating_sub(beside)..(place + beside + 1).min(shifts.len());
            let near: Vec<[f64; 2]> = near
                .filter(|other| self.frames[*other].run == run)
                .filter_map(|other| shifts[other])
                .collect();
            [0, 1].map(|angle| near.iter().map(|shift| shift[angle]).sum::<f64>() / near.len().max(1) as f64)
        };
        (0..shifts.len()).map(smooth).collect()
    }
}

/// The pose that a frame's residual asks for: weighted least squares over the centroids or angles. Answers the shift and the
/// matrix that turns changes of the image into changes of the pose.
pub fn pose_shift(cell: &Cell) -> Option<(Vector2<f64>, DMatrix<f64>)> {
    let pose = &cell.hard;
    let mut normal: Matrix2<f64> = Matrix2::zeros();
    let mut weighted = DMatrix::zeros(2, cell.residual.len());
    for row in 0..cell.residual.len() {
        if AREAS.contains(&cell.signal[row]) {
            continue;
        }
        let weight = 1.0 / (cell.sigma[row] * cell.sigma[row]);
        for i in 0..2 {
            weighted[(i, row)] = weight * pose[(row, i)];
            for j in 0..2 {
                normal[(i, j)] += weight * pose[(row, i)] * pose[(row, j)];
            }
        }
    }
    let inverse = normal.try_inverse()?;
    let map = DMatrix::from_fn(2, cell.residual.len(), |i, row| {
        inverse[(i, 0)] * weighted[(0, row)] + inverse[(i, 1)] * weighted[(1, row)]
    });
    let residual = DVector::from_column_slice(&cell.residual);
    let shift: DVector<f64> = &map * residual;
    Some((Vector2::new(shift[0], shift[1]), map))
}
