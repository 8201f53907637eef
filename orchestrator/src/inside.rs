//! What a master needs beside [`Simulation`]'s own calls that runs a scenario inside another system.

use crate::simulation::{Phase, Simulation};
use crate::wiring::Wiring;

impl Simulation {
    /// The run goes on past the scenario's stop, for a master above this one that alone knows when it ends; the units are told
    /// that end, if there is one. They make whole steps only. To be called before the start.
    pub fn open_end(&mut self, told: Option<f64>) {
        let Wiring { system, clock, told_stop, last_points, .. } = &mut self.wiring;
        *told_stop = told;
        last_points.clear();
        // Half of the range is left for the sums of a time and a delay or interval (`wiring::clock`).
        system.stop = ((1 << 62) - 1).min(i64::MAX / clock.tick().numerator().max(1));
        system.units.iter_mut().for_each(|unit| unit.last = None);
        self.reset();
    }

    /// The exact time of which all intervals, delays, start and stop are multiples.
    pub fn tick(&self) -> crate::time::Rational {
        self.wiring.clock.tick()
    }

    /// A connection or source of the scenario drives this input.
    pub fn is_driven(&self, input: &str) -> bool {
        self.wiring.names.named(input).is_ok_and(|variable| self.wiring.driven.contains_key(&variable))
    }

    /// It was initialised and can go on: neither is its stop reached, nor did a unit end it.
    pub fn is_running(&self) -> bool {
        self.phase == Phase::Running
    }
}
