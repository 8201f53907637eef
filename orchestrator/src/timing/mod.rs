//! What a scenario's timing does to its loops: how late a value is once round, and where that comes from; and when which
//! value goes where. Both from the scenario alone: no unit is loaded, and what units delay inside is not in it.

mod budget;
mod diagram;
mod loops;

pub use budget::{Budget, Leg, Terms, budget};
pub use diagram::{Arrow, Diagram, Lane, diagram};

use crate::algorithm::{self, Sees};
use crate::error::Error;
use crate::scenario::{ConnectionEntry, Hold, Scenario};
use crate::wiring::clock;

/// Points and connections of a scenario in ticks.
struct Schedule {
    start: i64,
    stop: i64,
    /// Length of a tick in s.
    tick: f64,
    /// Interval and offset, unit by unit.
    units: Vec<(i64, i64)>,
    ways: Vec<Way>,
    sees: Sees,
}

/// A connection between two units that there are.
#[derive(Clone, Copy)]
struct Way {
    /// Its number in the scenario.
    number: usize,
    from: usize,
    to: usize,
    latency: i64,
    /// Standard deviation of the latency in s.
    jitter: f64,
    drop: f64,
    linear: bool,
}

impl Schedule {
    fn of(scenario: &Scenario) -> Result<Self, Error> {
        let (clock, ticks) = clock(scenario)?;
        let unit = |full: &str| {
            let name = full.split_once('.')?.0;
            scenario.units.iter().position(|unit| unit.name == name)
        };
        let way = |(number, entry): (usize, &ConnectionEntry)| {
            Some(Way {
                number,
                from: unit(&entry.from)?,
                to: unit(&entry.to)?,
                latency: clock.ticks(entry.delay)?,
                jitter: entry.channel.jitter.to_f64(),
                drop: entry.channel.drop,
                linear: entry.channel.hold == Hold::Linear,
            })
        };
        Ok(Self {
            start: ticks.start,
            stop: ticks.stop,
            tick: clock.tick().to_f64(),
            units: ticks.intervals.iter().copied().zip(ticks.offsets.iter().copied()).collect(),
            ways: scenario.connections.iter().enumerate().filter_map(way).collect(),
            // A name that there is not is told when the scenario is built.
            sees: algorithm::sees(&scenario.algorithm.value).unwrap_or(Sees::Begin),
        })
    }

    /// Where a value of the same instant is not sent yet: the other unit steps later.
    fn misses(&self, way: &Way) -> bool {
        self.sees == Sees::EndInOrder && way.latency == 0 && way.jitter == 0.0 && way.from >= way.to
    }
}
