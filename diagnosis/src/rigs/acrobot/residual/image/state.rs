//! Nuisances of the images: where the poses of all frames are.

use super::{ImageCut, Poses};
use crate::rigs::acrobot::residual::{Block, Linearised, Nuisances};
use std::sync::Arc;

/// Where the poses of all frames are, and where the last linearisation had them.
#[derive(Debug, Clone)]
pub struct ImageState {
    pub(super) now: Poses,
    pub(super) linearised: Poses,
}

impl ImageState {
    pub(in crate::rigs::acrobot::residual) fn linearised(&self) -> Self {
        Self { now: self.linearised.clone(), linearised: self.linearised.clone() }
    }
}

impl ImageCut {
    /// Poses as they are now are those of a linearisation.
    pub(in crate::rigs::acrobot::residual) fn mark(&mut self) {
        self.linearised = self.poses();
    }

    /// Puts the frames where nuisances have them.
    pub(in crate::rigs::acrobot::residual) fn begin_from(&mut self, from: &Nuisances) {
        let state = from.frames.as_ref().unwrap_or(&self.first).clone();
        let (shots, followed) = &state.now;
        self.frames.iter_mut().zip(shots).for_each(|(frame, shot)| frame.shot = *shot);
        self.followed.clone_from(followed);
        self.linearised.clone_from(&state.linearised);
    }

    /// Where the frames are.
    pub(in crate::rigs::acrobot::residual) fn state(&self) -> Arc<ImageState> {
        Arc::new(ImageState { now: self.poses(), linearised: self.linearised.clone() })
    }

    /// Frames in which the data show what the model's camera didn't find at the last step.
    pub(in crate::rigs::acrobot::residual) fn unseen(&self) -> usize {
        self.unseen
    }

    pub(super) fn found(&self, blocks: Vec<Block>, from: &Nuisances) -> Linearised {
        let nuisances = Nuisances { frames: Some(self.state()), ..from.clone() };
        Linearised { blocks, nuisances, unseen: self.unseen }
    }

    pub(super) fn poses(&self) -> Poses {
        (self.frames.iter().map(|frame| frame.shot).collect(), self.followed.clone())
    }
}
