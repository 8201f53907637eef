//! What a master needs beside [`Simulation`]'s own calls that runs a scenario inside another system.

use crate::error::Error;
use crate::simulation::{Phase, Simulation};
use crate::time::Rational;
use crate::value::Value;
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

    /// The run ends at a stop of such a master, and not at the scenario's: units that can do so take a shorter last step to it.
    /// False, and nothing is changed, where the stop is no multiple of the tick. To be called before the start.
    pub fn end_at(&mut self, stop: f64) -> bool {
        let Wiring { system, clock, start, told_stop, last_points, .. } = &mut self.wiring;
        let exact = Rational::recover(&Value::Real(stop).to_string());
        let Some(ticks) = exact.and_then(|(exact, _)| clock.ticks(exact)).filter(|ticks| clock.holds(*ticks))
        else {
            return false;
        };
        *told_stop = Some(stop);
        last_points.clear();
        system.stop = ticks;
        let tick = clock.tick();
        for unit in &mut system.units {
            let offset = unit.first.map_or(0, |(offset, _)| offset);
            let run = ticks - start.ticks;
            let odd = if run < offset { run } else { (run - offset) % unit.interval };
            let takes = unit.instance.fmu().description().co_simulation.can_handle_variable_step && odd > 0;
            let size = || {
                Rational::new(i128::from(odd) * i128::from(tick.numerator()), i128::from(tick.denominator()))
            };
            unit.last = takes.then(size).flatten().map(|size| (odd, size.to_f64()));
        }
        self.reset();
        true
    }

    /// The exact time of which all intervals, delays, start and stop are multiples.
    pub fn tick(&self) -> Rational {
        self.wiring.clock.tick()
    }

    /// A connection or source of the scenario drives this input.
    pub fn is_driven(&self, input: &str) -> bool {
        self.wiring.names.named(input).is_ok_and(|variable| self.wiring.driven.contains_key(&variable))
    }

    /// The communication point that comes next, in s; `None` at the end. Initialises the units, if that has not been done.
    ///
    /// # Errors
    /// As [`Simulation::initialize`].
    pub fn next_point(&mut self) -> Result<Option<f64>, Error> {
        self.initialize()?;
        let next = self.wiring.system.next().filter(|_| self.is_running());
        Ok(next.map(|ticks| self.wiring.clock.seconds(ticks)))
    }

    /// Why a start value of this input would count for nothing: what drives it overwrites it before any unit reads it.
    pub fn overwritten(&self, input: &str) -> Option<String> {
        self.wiring.names.named(input).ok().and_then(|variable| self.wiring.overwritten(variable))
    }

    /// It was initialised, and neither an error nor a unit nor [`Simulation::terminate`] has ended it; its stop may be reached.
    pub fn is_running(&self) -> bool {
        self.phase == Phase::Running
    }
}
