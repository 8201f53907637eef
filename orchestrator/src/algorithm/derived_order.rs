//! Gauss-Seidel in an order that follows from who depends on whom, whatever the order in the scenario.
//!
//! A unit steps after those whose values it hands on in the same instant: connections into inputs on which an output
//! depends directly (`ModelStructure`) come first. As far as these leave a choice, a unit steps after all that it gets
//! values from; and as far as loops leave one still, in the order of the scenario. Connections on which values take time
//! count for nothing. `wiring/order.rs` works it out.

use super::{Algorithm, Needs, Sees};
use crate::error::Error;
use crate::system::{Point, System};

pub(super) struct DerivedOrder;

impl Algorithm for DerivedOrder {
    fn sees(&self) -> Sees {
        Sees::EndInOrder
    }

    fn needs(&self) -> Needs {
        Needs { order: true, ..Needs::default() }
    }

    #[inline(always)]
    fn step(&mut self, system: &mut System, point: Point) -> Result<(), Box<Error>> {
        system.step_ending::<true, true>(point)
    }
}
