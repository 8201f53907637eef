//! Connections become plain copies, links that convert, or lines with samples on their way.

use super::Connection;
use super::names::{Names, Variable};
use super::record::Recorded;
use crate::line::{Chance, Line, Slope};
use crate::link::{Conversion, Link};
use crate::noise::Draw;
use crate::recorder::Slot;
use crate::scenario::{Hold, Scenario};
use crate::system::System;
use crate::time::Clock;
use std::collections::{HashMap, HashSet};

/// Lays plain copies and lines; tells the lines of the connections that have one.
pub(super) fn lay_connections(
    system: &mut System,
    scenario: &Scenario,
    connections: &[Connection],
    slots: &HashMap<Variable, Slot>,
    clock: &Clock,
    recorded: &[Recorded],
) -> HashMap<usize, usize> {
    let mut lines = HashMap::new();
    let aged: HashSet<usize> = recorded.iter().filter_map(Recorded::age).collect();
    for (number, connection) in connections.iter().enumerate() {
        let Connection { from, to, conversion, direct, channel, .. } = connection;
        let link = Link { from: slots[from], to: slots[to], conversion: conversion.clone() };
        if !direct || channel.hold == Hold::Linear || aged.contains(&number) {
            lines.insert(number, system.lines.len());
            system.units[from.0].lines_out.push(system.lines.len());
            system.units[to.0].lines_in.push(system.lines.len());
            let line = line(system, connection, link, &scenario.connections[number].to, scenario.seed, clock);
            system.lines.push(line);
            continue;
        }
        let target = &mut system.units[to.0];
        let inputs = &mut target.inputs;
        match (&link.conversion, link.from, link.to) {
            (Conversion::Same, Slot::Real(from), Slot::Real(to)) => inputs.reals.copy(from, to),
            (Conversion::Same, Slot::Integer(from), Slot::Integer(to)) => inputs.integers.copy(from, to),
            (Conversion::Same, Slot::Boolean(from), Slot::Boolean(to)) => inputs.booleans.copy(from, to),
            (Conversion::Same, Slot::String(from), Slot::String(to)) => inputs.strings.copy(from, to),
            _ => target.links.push(link),
        }
    }
    lines
}

fn line(system: &System, connection: &Connection, link: Link, name: &str, seed: u64, clock: &Clock) -> Line {
    let Connection { from, to, delay, channel, .. } = connection;
    let delay = clock.ticks(*delay).unwrap_or(0); // a multiple: the clock was made from it
    let intervals = (system.units[from.0].interval, system.units[to.0].interval);
    let waiting = usize::try_from((delay + intervals.1) / intervals.0 + 3).unwrap_or(0).min(1 << 16);
    let mut line = Line::new(link, to.0, delay, waiting);
    line.slope = (channel.hold == Hold::Linear).then(Slope::default);
    line.chance = channel.is_random().then(|| Chance {
        draw: Draw::new(channel.seed.unwrap_or(seed), name),
        jitter: channel.jitter.to_f64() / clock.tick().to_f64(),
        drop: channel.drop,
        count: 0,
    });
    line
}

/// Gives the recorded ages their places, after all values of units.
pub(super) fn lay_ages(
    system: &mut System,
    names: &Names,
    connections: &[Connection],
    recorded: &[Recorded],
    lines: &HashMap<usize, usize>,
) -> HashMap<String, Slot> {
    let ages = recorded.iter().filter_map(Recorded::age);
    ages.map(|number| {
        let place = system.values.reals.len();
        system.values.reals.push(0.0);
        system.ages.push((lines[&number], place));
        (names.age(&connections[number]), Slot::Real(place as u32)) // as in the layout
    })
    .collect()
}

/// The same for the recorded estimates of errors.
pub(super) fn lay_errors(
    system: &mut System,
    names: &Names,
    recorded: &[Recorded],
    slots: &HashMap<Variable, Slot>,
    derived: &mut HashMap<String, Slot>,
) {
    for variable in recorded.iter().filter_map(Recorded::error) {
        let Slot::Real(at) = slots[&variable] else { continue };
        let place = system.values.reals.len();
        system.values.reals.push(0.0);
        system.errors.push((at as usize, place));
        derived.insert(names.error(variable), Slot::Real(place as u32));
    }
}
