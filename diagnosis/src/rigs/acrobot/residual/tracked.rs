//! A cut together with where its nuisances are: what a search or a fit walks with.

use super::{Block, Cut, Nuisances, Perturbation};
use crate::error::Error;
use std::ops::{Deref, DerefMut};

/// A cut and the nuisances as the last step left them.
#[derive(Debug, Clone)]
pub struct Tracked<C: ?Sized = dyn Cut> {
    /// Where the nuisances are.
    pub nuisances: Nuisances,
    /// Frames in which the data show what the model's camera didn't find at the last step.
    pub unseen: usize,
    cut: C,
}

impl<C: Cut> Tracked<C> {
    /// A cut, with nuisances as the data alone have them.
    pub fn new(cut: C) -> Self {
        Self { nuisances: cut.initial(), unseen: 0, cut }
    }
}

impl<C: Cut + ?Sized> Tracked<C> {
    /// Residuals and sensitivities at a point, nuisances settled there from where they are.
    ///
    /// # Errors
    /// A unit failed; nuisances stay where they were.
    pub fn linearise(&mut self, at: &[f64], perturbations: &[Perturbation]) -> Result<Vec<Block>, Error> {
        let found = self.cut.linearise(at, perturbations, &self.nuisances)?;
        (self.nuisances, self.unseen) = (found.nuisances, found.unseen);
        Ok(found.blocks)
    }

    /// Linearises from where the last linearisation had the nuisances, whatever chord steps did since.
    ///
    /// # Errors
    /// A unit failed.
    pub fn linearise_anew(
        &mut self,
        at: &[f64],
        perturbations: &[Perturbation],
    ) -> Result<Vec<Block>, Error> {
        self.restore_linearised();
        self.linearise(at, perturbations)
    }

    /// Residuals at a point by the sensitivities of the nuisances at the last linearisation.
    ///
    /// # Errors
    /// A unit failed; nuisances stay where they were.
    pub fn chord(&mut self, at: &[f64], perturbations: &[Perturbation]) -> Result<Vec<Block>, Error> {
        let found = self.cut.chord(at, perturbations, &self.nuisances)?;
        (self.nuisances, self.unseen) = (found.nuisances, found.unseen);
        Ok(found.blocks)
    }

    /// Goes back to nuisances that were kept. What was tried in vain since then isn't tried again.
    pub fn restore(&mut self, kept: &Nuisances) {
        let in_vain = self.nuisances.in_vain || kept.in_vain;
        self.nuisances = Nuisances { in_vain, ..kept.clone() };
    }

    /// Goes back to where the last linearisation had the nuisances.
    pub fn restore_linearised(&mut self) {
        self.nuisances = self.nuisances.linearised();
    }

    /// Begins windows from the data again.
    pub fn reset(&mut self) {
        self.nuisances = self.nuisances.reset();
    }
}

impl<C: ?Sized> Deref for Tracked<C> {
    type Target = C;

    fn deref(&self) -> &C {
        &self.cut
    }
}

impl<C: ?Sized> DerefMut for Tracked<C> {
    fn deref_mut(&mut self) -> &mut C {
        &mut self.cut
    }
}
