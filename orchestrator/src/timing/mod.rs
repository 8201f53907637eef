//! What a scenario's timing does to its loops: how late a value is once round, and where that comes from; and when which
//! value goes where. Both from the scenario alone, apart from an order of stepping that follows from the units' descriptions:
//! what units delay inside is not in it.

mod budget;
mod diagram;
mod loops;

pub use budget::{Budget, Leg, Terms, budget, budget_of};
pub use diagram::{Arrow, Diagram, Lane, diagram, diagram_of};

use crate::algorithm::{self, Sees};
use crate::error::Error;
use crate::scenario::{ConnectionEntry, Hold, Scenario};
use crate::wiring::clock;
use std::collections::HashMap;

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
    /// Values that come directly go on along lines.
    along: bool,
    /// When each unit steps among those of the same instant.
    ranks: Vec<usize>,
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
    direct: bool,
}

impl Schedule {
    /// The units step in an order: their places in the scenario.
    fn of(scenario: &Scenario, order: impl IntoIterator<Item = usize>) -> Result<Self, Error> {
        let (clock, ticks) = clock(scenario)?;
        let places: HashMap<&str, usize> =
            scenario.units.iter().enumerate().map(|(place, unit)| (unit.name.as_str(), place)).collect();
        let unit = |full: &str| places.get(full.split_once('.')?.0).copied();
        let mut ranks = vec![0; scenario.units.len()];
        order.into_iter().enumerate().for_each(|(rank, unit)| ranks[unit] = rank);
        let way = |(number, entry): (usize, &ConnectionEntry)| {
            Some(Way {
                number,
                from: unit(&entry.from)?,
                to: unit(&entry.to)?,
                latency: clock.ticks(entry.delay)?,
                jitter: entry.channel.jitter.to_f64(),
                drop: entry.channel.drop,
                linear: entry.channel.hold == Hold::Linear,
                direct: entry.is_direct() && entry.channel.hold == Hold::Zero,
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
            along: algorithm::along(&scenario.algorithm.value),
            ranks,
        })
    }

    /// Where a value of the same instant is not sent yet: the other unit steps later.
    fn misses(&self, way: &Way) -> bool {
        let later = self.ranks[way.from] >= self.ranks[way.to];
        self.sees == Sees::EndInOrder && way.latency == 0 && way.jitter == 0.0 && later
    }
}
