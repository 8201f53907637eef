//! Jacobi: each unit gets the values that are known where its step begins, sources included. The order of the units
//! plays no part.
//!
//! A unit's inputs are gathered when its step begins, but the step is made when it ends: so no value is there before
//! it exists, whatever the intervals.

use super::Algorithm;
use crate::error::Error;
use crate::system::{Point, System};

pub(super) struct Jacobi;

impl Algorithm for Jacobi {
    #[inline]
    fn step(&mut self, system: &mut System, point: Point) -> Result<(), Error> {
        for unit in 0..system.count() {
            if system.ends_at(unit, point) {
                system.step(unit, point)?;
            }
        }
        Ok(())
    }

    #[inline]
    fn after(&mut self, system: &mut System, point: Point) {
        for unit in 0..system.count() {
            if system.begins_at(unit, point) {
                system.gather(unit, point);
            }
        }
    }
}
