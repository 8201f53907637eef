//! Gauss-Seidel: at each point the units whose step ends there step one after the other, in the order of the
//! scenario. Each gets the newest values of the others that are not later than that point: those at the end of the
//! step from units before it, those of their last point from units after it. Sources are read at the end of the step.

use super::{Algorithm, Sees};
use crate::error::Error;
use crate::system::{Point, System};

pub(super) struct GaussSeidel;

impl Algorithm for GaussSeidel {
    fn sees(&self) -> Sees {
        Sees::EndInOrder
    }

    #[inline(always)]
    fn step(&mut self, system: &mut System, point: Point) -> Result<(), Box<Error>> {
        system.step_ending::<false, true>(point)
    }
}
