//! Master algorithms: in what order units step, and which values they see. One file each; a new one is added to
//! [`ALGORITHMS`].

mod gauss_seidel;
mod jacobi;

use crate::error::Error;
use crate::suggest::nearest;
use crate::system::{Point, System};

type Make = fn() -> Box<dyn Algorithm>;

/// Every algorithm by the name that a scenario uses.
const ALGORITHMS: &[(&str, Make)] =
    &[("gauss-seidel", || Box::new(gauss_seidel::GaussSeidel)), ("jacobi", || Box::new(jacobi::Jacobi))];

/// What is done at a communication point: a time at which the step of at least one unit ends.
pub(crate) trait Algorithm: Send {
    /// Steps the units that are due, so that all values are those at `point`.
    fn step(&mut self, system: &mut System, point: Point) -> Result<(), Error>;

    /// After the values at `point` (the start included) were recorded.
    fn after(&mut self, system: &mut System, point: Point) {
        let _ = (system, point);
    }
}

/// The names of all algorithms.
pub fn names() -> impl Iterator<Item = &'static str> {
    ALGORITHMS.iter().map(|(name, _)| *name)
}

/// An algorithm by name; an error is what would be right.
pub(crate) fn find(name: &str) -> Result<Box<dyn Algorithm>, String> {
    match ALGORITHMS.iter().find(|(known, _)| *known == name) {
        Some((_, make)) => Ok(make()),
        None => Err(nearest(name, names())),
    }
}
