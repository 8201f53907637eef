//! Master algorithms: in what order units step, and which values they see. One file each; a new one is added to
//! [`ALGORITHMS`].

mod gauss_seidel;
mod jacobi;

use crate::error::Error;
use crate::suggest::nearest;
use crate::system::{Point, System};
use crate::time::Clock;

type Make = fn() -> Box<dyn Algorithm>;

/// Every algorithm by the name that a scenario uses.
const ALGORITHMS: &[(&str, Make)] =
    &[("gauss-seidel", || Box::new(gauss_seidel::GaussSeidel)), ("jacobi", || Box::new(jacobi::Jacobi))];

/// Which values of other units a unit sees in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sees {
    /// Those at the begin of its step; so with sources.
    Begin,
    /// Those at the end of its step of units that stand before it in the scenario, and of the others those of their last
    /// point before that. Sources are read at the end.
    EndInOrder,
    /// Those at the end of its step, of all units; so with sources.
    End,
}

/// What is done at a communication point: a time at which the step of at least one unit ends.
pub(crate) trait Algorithm: Send {
    /// Which values of others a unit sees.
    fn sees(&self) -> Sees;

    /// Before the values at `point` (the start included) are left.
    fn begin(&mut self, system: &mut System, point: Point) {
        let _ = (system, point);
    }

    /// Steps the units that are due, so that all values are those at `point`.
    fn step(&mut self, system: &mut System, point: Point) -> Result<(), Box<Error>>;

    /// Goes from `now` over the next points, at most so many; tells how many there were. The one place from which an
    /// algorithm steps, and made anew for each: so its steps are part of this loop, and what they look up stays in
    /// registers from point to point where nobody looks at the values in between.
    fn advance(
        &mut self,
        system: &mut System,
        clock: &Clock,
        now: &mut Point,
        most: u32,
    ) -> Result<u32, Box<Error>> {
        for made in 0..most {
            let Some(ticks) = system.next() else { return Ok(made) };
            let point = Point { ticks, time: clock.seconds(ticks) };
            self.begin(system, *now);
            self.step(system, point)?;
            *now = point;
        }
        Ok(most)
    }
}

/// The names of all algorithms.
pub fn names() -> impl Iterator<Item = &'static str> {
    ALGORITHMS.iter().map(|(name, _)| *name)
}

/// Which values of others a unit sees with an algorithm, by its name.
pub fn sees(name: &str) -> Option<Sees> {
    find(name).ok().map(|algorithm| algorithm.sees())
}

/// An algorithm by name; an error is what would be right.
pub(crate) fn find(name: &str) -> Result<Box<dyn Algorithm>, String> {
    match ALGORITHMS.iter().find(|(known, _)| *known == name) {
        Some((_, make)) => Ok(make()),
        None => Err(nearest(name, names())),
    }
}
