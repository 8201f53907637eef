//! Without an encoder: commanded torque in, image out.
//!
//! The image of each frame is turned into a pose (two angles from six coordinates, through the camera unit), and
//! two things are compared: what of the six coordinates the pose leaves over (the lens), and whether the poses, taken
//! at the frames' times less the camera's delay, follow the plant that is driven with the logged torque (plant,
//! delays, and what a wrong mount does to the angles). Noise of the first is orthogonal to noise of the second.

use super::image::{ImageCut, Pose, pose_shift};
use super::plant::policy::WINDOWS;
use super::plant::{PlantCut, Poses, zeros};
use super::trajectory::Motion;
use super::{Block, Cut, Linearised, Nuisances, Perturbation, Policy, Signal};
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Attribute, Candidate, Side, name, place};
use crate::rigs::acrobot::channels::ANGLES_APART;
use crate::rigs::acrobot::dataset::row_times::unevenness;
use crate::rigs::acrobot::dataset::{DataSet, Table};
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::policy::RESIDUAL;
use crate::statistics::linear::Cell;
use nalgebra::DMatrix;
use std::sync::Arc;

fn candidates_step(candidates: &[Candidate]) -> f64 {
    candidates.first().and_then(|candidate| candidate.steps.first()).copied().unwrap_or(1.0)
}

/// Image and torque.
#[derive(Clone)]
pub struct Chain {
    /// The image with free poses.
    pub image: ImageCut,
    plant: PlantCut,
    candidates: Arc<Vec<Candidate>>,
    signals: Vec<Signal>,
    /// Nuisances after a first linearisation at the nominal model.
    first: Nuisances,
}

impl Chain {
    /// `None` where no run has both an image and a torque.
    ///
    /// # Errors
    /// A unit lacks a variable or failed.
    pub fn new(
        data: &DataSet,
        model: &Model,
        candidates: Arc<Vec<Candidate>>,
    ) -> Result<Option<Self>, Error> {
        let most = usize::MAX;
        let Some(image) = ImageCut::new(data, model, candidates.clone(), Pose::Chained, most)? else {
            return Ok(None);
        };
        let mut seen = data.clone();
        for (index, run) in seen.runs.iter_mut().enumerate() {
            let frames: Vec<_> = image.frames.iter().filter(|frame| frame.run == index).collect();
            let column =
                |angle: usize| frames.iter().map(|frame| frame.shot.end[angle]).collect::<Vec<f64>>();
            run.plant = (!frames.is_empty()).then(|| {
                let columns = vec![("q1".to_owned(), column(0)), ("q2".to_owned(), column(1))];
                Table::new(frames.iter().map(|frame| frame.time).collect(), columns)
            });
        }
        seen.manifest.noise.retain(|name, _| !name.starts_with("plant."));
        let Some(mut plant) = PlantCut::new(&seen, model, candidates.clone())? else {
            return Ok(None);
        };
        plant.see_through(model.number(name(Attribute::ImageDelay)).unwrap_or(0.0));
        let mut signals = image.signals().to_vec();
        signals.extend(plant.signals().iter().cloned());
        for signal in signals[image.signals().len()..].iter_mut().take(2) {
            signal.tolerance = if image.read { RESIDUAL.place } else { ANGLES_APART };
        }
        let off: Vec<f64> = candidates.iter().map(|candidate| candidate.off).collect();
        let first = Nuisances { frames: Some(image.state()), ..plant.initial() };
        let mut chain = Self { image, plant, candidates, signals, first };
        let perturbations = [Perturbation { candidate: 0, by: candidates_step(&chain.candidates) }];
        chain.first = chain.linearise(&off, &perturbations, &chain.first.clone())?.nuisances;
        chain.find_jitter(&off)?;
        chain.image.forget();
        Ok(Some(chain))
    }

    /// Finds how much the timestamps of frames scatter, where they stand unevenly: poses are off by their rates times that.
    fn find_jitter(&mut self, point: &[f64]) -> Result<(), Error> {
        let mut timestamps: Vec<Vec<f64>> = Vec::new();
        for frame in &self.image.frames {
            timestamps.resize(timestamps.len().max(frame.run + 1), Vec::new());
            timestamps[frame.run].push(frame.time);
        }
        if timestamps.iter().any(|time| unevenness(time) > WINDOWS.jitter) {
            let from = self.first.clone();
            self.first.windows = self.plant.find_jitter(point, &from)?.windows;
        }
        Ok(())
    }

    /// Puts the frames where the plant that was fitted to them has them, if that is within what an image can tell:
    /// a pose read off one image follows the pixel lattice, and rendered there, areas come out a little wrong.
    fn smooth(&mut self, point: &[f64], read: &[Vec<[f64; 2]>]) -> Result<(), Error> {
        let motions = self.plant.motion_now(point, POLICY.motion_step)?;
        let (delay, interval) = (self.image.delay(point), self.image.interval());
        // circles stand where the links are, and as far beside as their zeros are off
        let off = zeros(&self.candidates, point, None);
        let seen = |motion: &Motion, time: f64| {
            motion.at(time).map(|[q1, q2, dq1, dq2]| [q1 + off[0], q2 + off[1], dq1, dq2])
        };
        let mut rows = vec![0; read.len()];
        for frame in &mut self.image.frames {
            let row = rows[frame.run];
            rows[frame.run] += 1;
            let Some(angles) = read[frame.run].get(row).filter(|angles| angles[0].is_finite()) else {
                continue;
            };
            (frame.shot.end[0], frame.shot.end[1]) = (angles[0], angles[1]);
            let Some(motion) = motions.get(frame.run) else { continue };
            let Some(end) = seen(motion, frame.time - delay) else { continue };
            if (0..2).all(|angle| (end[angle] - frame.shot.end[angle]).abs() < RESIDUAL.near) {
                frame.shot.end = end;
                frame.shot.before = seen(motion, frame.time - delay - interval).unwrap_or(frame.shot.before);
            }
        }
        Ok(())
    }

    /// Where on the lattice each row of a window was read, as far as its angle tells.
    fn lattice(&self, run: usize, cell: &Cell) -> Vec<usize> {
        let frames: Vec<_> = self.image.frames.iter().filter(|frame| frame.run == run).collect();
        let place = |(signal, time): (&usize, &f64)| {
            let next = frames.partition_point(|frame| frame.time < *time).min(frames.len() - 1);
            let angle = frames[next].shot.end[signal % 2];
            (angle.rem_euclid(std::f64::consts::TAU) / RESIDUAL.place) as usize
        };
        cell.signal.iter().zip(&cell.time).map(place).collect()
    }

    /// Poses of all frames from the image, and how each perturbation would move them.
    fn poses(&mut self, blocks: &[Block], perturbations: &[Perturbation]) -> Poses {
        let runs = 1 + self.image.frames.iter().map(|frame| frame.run).max().unwrap_or(0);
        let mut poses = Poses::new(runs);
        let mut cells =
            blocks.iter().flat_map(|block| block.cells.iter().map(move |cell| (block.run, cell))).peekable();
        for frame in &self.image.frames {
            let mut angles = [f64::NAN; 2];
            let mut moves = DMatrix::zeros(2, perturbations.len());
            let here =
                cells.next_if(|(run, cell)| *run == frame.run && cell.time.first() == Some(&frame.time));
            if let Some((shift, map)) = here.and_then(|(_, cell)| pose_shift(cell)) {
                angles = [frame.shot.end[0] + shift[0], frame.shot.end[1] + shift[1]];
                if let Some((_, cell)) = here {
                    moves = &map * &cell.columns;
                }
            }
            poses.push(frame.run, angles, &moves);
        }
        poses
    }
}

impl Chain {
    fn begin_from(&mut self, from: &Nuisances) {
        self.image.begin_from(from);
        self.plant.begin_from(from);
    }

    /// Gives the plant the poses that the images tell, and answers them.
    fn hand_on(
        &mut self,
        blocks: &mut Vec<Block>,
        point: &[f64],
        perturbations: &[Perturbation],
    ) -> Vec<Vec<[f64; 2]>> {
        let poses = self.poses(blocks, perturbations);
        // a frame of two angles is its pose, and says nothing beyond
        for block in blocks.iter_mut() {
            block.cells.retain(|cell| cell.residual.len() > cell.hard.ncols());
        }
        blocks.retain(|block| !block.cells.is_empty());
        let read = poses.angles.clone();
        let delay = place(&self.candidates, Attribute::ImageDelay);
        self.plant.replace(poses, delay.map(|index| (index, point[index])));
        read
    }

    /// What both say, with signals counted on.
    fn both(&self, mut blocks: Vec<Block>, more: Vec<Block>, in_vain: bool) -> Linearised {
        let offset = self.image.signals().len();
        blocks.extend(more.into_iter().map(|block| {
            Block {
                cells: block
                    .cells
                    .into_iter()
                    .map(|cell| Cell {
                        lattice: self.lattice(block.run, &cell),
                        signal: cell.signal.iter().map(|signal| signal + offset).collect(),
                        ..cell
                    })
                    .collect(),
                ..block
            }
        }));
        let nuisances =
            Nuisances { windows: Some(self.plant.state()), frames: Some(self.image.state()), in_vain };
        Linearised { blocks, nuisances, unseen: self.image.unseen() }
    }
}

impl Cut for Chain {
    fn name(&self) -> &'static str {
        "torque in, image out"
    }

    fn signals(&self) -> &[Signal] {
        &self.signals
    }

    fn sees(&self, candidate: &Candidate) -> bool {
        matches!(candidate.side, Side::Plant | Side::Camera | Side::Zero)
    }

    fn policy(&self) -> Policy {
        let plant = self.plant.policy();
        Policy { lattice: true, free_pose: true, reads_angles: self.image.read, clock_doubt: 0.0, ..plant }
    }

    fn initial(&self) -> Nuisances {
        self.first.clone()
    }

    fn linearise(
        &mut self,
        at: &[f64],
        perturbations: &[Perturbation],
        from: &Nuisances,
    ) -> Result<Linearised, Error> {
        self.begin_from(from);
        let mut blocks = self.image.settle(at, perturbations)?;
        let read = self.hand_on(&mut blocks, at, perturbations);
        let (more, in_vain) = self.plant.settle_all(at, perturbations, from.in_vain)?;
        // only where a new linearisation begins: frames that move change the lattice, and comparisons with it
        if !perturbations.is_empty() {
            self.smooth(at, &read)?;
        }
        self.image.mark();
        Ok(self.both(blocks, more, in_vain))
    }

    fn chord(
        &mut self,
        at: &[f64],
        perturbations: &[Perturbation],
        from: &Nuisances,
    ) -> Result<Linearised, Error> {
        self.begin_from(from);
        let mut blocks = self.image.step(at, perturbations)?;
        self.hand_on(&mut blocks, at, perturbations);
        let more = self.plant.step_all(at, perturbations)?;
        Ok(self.both(blocks, more, from.in_vain))
    }
}
