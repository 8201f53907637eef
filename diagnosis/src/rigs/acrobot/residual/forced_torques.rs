//! Columns for torques that are no parameter of the plant: given along the measured motion, pushed through the unit.
//!
//! What a correction would do is asked in the same windows or stretches as everything else: first the states along
//! them, then, for torques that somebody computed there, what they change of the residual. The torques act past the
//! actuator, between the ground and link 1 and between the links.

use super::trajectory::State;
use super::{Cut, Nuisances, Tracked};
use crate::error::Error;
use nalgebra::DMatrix;

/// A torque between the ground and link 1, and one at the joint, N·m.
pub type Pair = [f64; 2];

/// A cut through which torques along the motion can be pushed.
pub trait Forced: Cut {
    /// States along each cell, in the order of the blocks' cells, with nuisances `at` where a linearisation at the point left them.
    ///
    /// # Errors
    /// The unit failed.
    fn states(&mut self, point: &[f64], at: &Nuisances) -> Result<Vec<Vec<State>>, Error>;

    /// For each cell a column per torque: the change of the simulated rows. `torques` has, for each cell, each torque
    /// at each of `states`.
    ///
    /// # Errors
    /// The unit failed, or has no input for a torque on link 2.
    fn pushed(
        &mut self,
        point: &[f64],
        at: &Nuisances,
        torques: &[Vec<Vec<Pair>>],
    ) -> Result<Vec<DMatrix<f64>>, Error>;
}

impl<C: Forced + ?Sized> Tracked<C> {
    /// As [`Forced::states`], where the nuisances are.
    ///
    /// # Errors
    /// The unit failed.
    pub fn states(&mut self, point: &[f64]) -> Result<Vec<Vec<State>>, Error> {
        let at = self.nuisances.clone();
        Forced::states(&mut **self, point, &at)
    }

    /// As [`Forced::pushed`], where the nuisances are.
    ///
    /// # Errors
    /// The unit failed, or has no input for a torque on link 2.
    pub fn pushed(&mut self, point: &[f64], torques: &[Vec<Vec<Pair>>]) -> Result<Vec<DMatrix<f64>>, Error> {
        let at = self.nuisances.clone();
        Forced::pushed(&mut **self, point, &at, torques)
    }
}
