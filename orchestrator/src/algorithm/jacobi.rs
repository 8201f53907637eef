//! Jacobi: each unit gets the values that are known where its step begins, sources included. The order of the units
//! plays no part.
//!
//! A unit's inputs are gathered when its step begins, but the step is made when it ends: so no value is there before
//! it exists, whatever the intervals.

use super::{Algorithm, Sees};
use crate::error::Error;
use crate::system::{Point, System};

pub(super) struct Jacobi;

impl Algorithm for Jacobi {
    fn sees(&self) -> Sees {
        Sees::Begin
    }

    #[inline(always)]
    fn step(&mut self, system: &mut System, point: Point) -> Result<(), Box<Error>> {
        system.step_ending::<false, false>(point)
    }

    #[inline(always)]
    fn begin(&mut self, system: &mut System, point: Point) {
        system.gather_beginning(point);
    }
}
