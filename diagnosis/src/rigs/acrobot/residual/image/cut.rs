//! The images as a cut: what the search asks of them.

use super::super::{Cut, Linearised, Nuisances, Perturbation, Policy, Signal};
use super::{ImageCut, Pose};
use crate::error::Error;
use crate::rigs::acrobot::candidates::{Attribute, Candidate, Side};

impl Cut for ImageCut {
    fn name(&self) -> &'static str {
        match self.pose {
            Pose::Logged(..) => "camera: motion in, image out",
            Pose::Chained | Pose::Free => "camera: image alone, pose free",
        }
    }

    fn signals(&self) -> &[Signal] {
        &self.signals
    }

    fn sees(&self, candidate: &Candidate) -> bool {
        let free = !matches!(self.pose, Pose::Logged(..));
        let seen = matches!(candidate.side, Side::Camera | Side::Timestamps);
        let zero = candidate.side == Side::Zero && !free && self.zeros.is_some();
        zero || seen && !(free && candidate.is(Attribute::ImageDelay))
    }

    fn policy(&self) -> Policy {
        Policy { lattice: true, ..Policy::USUAL }
    }

    fn initial(&self) -> Nuisances {
        Nuisances { frames: Some(self.first.clone()), ..Nuisances::default() }
    }

    fn linearise(
        &mut self,
        at: &[f64],
        perturbations: &[Perturbation],
        from: &Nuisances,
    ) -> Result<Linearised, Error> {
        self.begin_from(from);
        let blocks = self.settle(at, perturbations)?;
        Ok(self.found(blocks, from))
    }

    fn chord(
        &mut self,
        at: &[f64],
        perturbations: &[Perturbation],
        from: &Nuisances,
    ) -> Result<Linearised, Error> {
        self.begin_from(from);
        let blocks = self.step(at, perturbations)?;
        Ok(self.found(blocks, from))
    }
}
