//! How else logs can be read: the other unit of time, of measurement (`units.rs`), the other sign, the other column.

use super::kinds;
use super::policy::DOUBTS;
use super::units::{together, units};
use crate::observe::{Affine, Channel, Problem, Role};
use crate::ports::PORTS;
use crate::statistics::levels::ROUNDING;

/// What is otherwise.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Change {
    /// Times are so many times as long.
    Time(f64),
    /// Places of channels whose values are times a factor and plus a summand.
    Values(Vec<(usize, Affine)>),
    /// The numbers of two channels' columns, each converted as the channel says.
    Exchanged(usize, usize),
    /// The rows of a channel stand so much earlier, s.
    Earlier(usize, f64),
}

/// Another way to read a data set.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Way {
    pub(super) change: Change,
    pub(super) line: usize,
    /// What is otherwise, after "only with".
    pub(super) what: String,
    /// What to write.
    pub(super) add: String,
    /// Whether its own number must be the best one, however extreme it is: of many factors, one is near what a machine lacks.
    pub(super) exact: bool,
}

impl Way {
    /// The data set read in this way.
    pub(super) fn read(&self, problem: &Problem) -> Problem {
        match &self.change {
            Change::Time(factor) => {
                let mut other = problem.clone();
                let series = other.runs.iter_mut().flat_map(|run| &mut run.series);
                series.flat_map(|series| &mut series.time).for_each(|time| *time *= factor);
                other
            }
            Change::Values(by) => scaled(problem, by),
            Change::Exchanged(a, b) => exchanged(problem, *a, *b),
            Change::Earlier(place, by) => {
                let mut other = problem.clone();
                let series = other.runs.iter_mut().map(|run| &mut run.series[*place]);
                series.flat_map(|series| &mut series.time).for_each(|time| *time -= by);
                other
            }
        }
    }

    /// Names of the channels whose values are otherwise.
    pub(super) fn channels(&self, problem: &Problem) -> Vec<String> {
        let name = |place: usize| problem.channels[place].name.clone();
        match &self.change {
            Change::Time(_) => Vec::new(),
            Change::Values(by) => by.iter().map(|(place, _)| name(*place)).collect(),
            Change::Exchanged(a, b) => vec![name(*a), name(*b)],
            Change::Earlier(place, _) => vec![name(*place)],
        }
    }

    /// Whether no gain that a machine has is so large or so small.
    pub(super) fn is_extreme(&self) -> bool {
        match &self.change {
            _ if self.exact => false,
            Change::Time(_) | Change::Exchanged(..) | Change::Earlier(..) => true,
            Change::Values(by) => {
                by.iter().any(|(_, affine)| !(PORTS.gain.0..=PORTS.gain.1).contains(&affine.scale.abs()))
            }
        }
    }

    /// Whether it turns signs and nothing else.
    pub(super) fn is_sign(&self) -> bool {
        matches!(&self.change, Change::Values(by) if by.iter().all(|(_, affine)| affine.scale == -1.0))
    }

    /// The same way not quite: a factor that is a fifth smaller and a quarter larger, an offset by a thirtieth, a time by half. A gain, an offset or
    /// another rate that the machine really has is met by these as well; a wrong unit or sign only by its own number.
    pub(super) fn beside(&self, problem: &Problem) -> Vec<Problem> {
        let all = [0.8, 1.25].map(|by| match &self.change {
            Change::Time(factor) => Some(Change::Time(factor * if by < 1.0 { 0.5 } else { 2.0 })),
            Change::Values(list) => Some(Change::Values(
                list.iter()
                    .map(|(place, affine)| {
                        let shifted = (affine.scale - 1.0).abs() < ROUNDING && affine.offset != 0.0;
                        let offset = affine.offset * if shifted { 1.0 + (by - 1.0) / 7.0 } else { 1.0 };
                        (*place, Affine { scale: affine.scale * if shifted { 1.0 } else { by }, offset })
                    })
                    .collect(),
            )),
            Change::Exchanged(..) | Change::Earlier(..) => None,
        });
        let read = |change| Way { change, ..self.clone() }.read(problem);
        all.into_iter().flatten().map(read).collect()
    }
}

/// The same with channels' values times a factor and plus a summand.
fn scaled(problem: &Problem, by: &[(usize, Affine)]) -> Problem {
    let mut other = problem.clone();
    for (place, affine) in by {
        let channel = &mut other.channels[*place];
        // what is written for a further way on the same channel holds both
        channel.conversion = then(channel.conversion, *affine);
        channel.noise = channel.noise.map(|sd| sd * affine.scale.abs());
        for run in &mut other.runs {
            run.series[*place].values.iter_mut().for_each(|value| *value = affine.apply(*value));
        }
    }
    other
}

fn exchanged(problem: &Problem, a: usize, b: usize) -> Problem {
    let mut other = problem.clone();
    let (one, two) = (problem.channels[a].conversion, problem.channels[b].conversion);
    for run in &mut other.runs {
        run.series.swap(a, b);
        let again = |values: &mut Vec<f64>, from: Affine, to: Affine| {
            values.iter_mut().for_each(|value| *value = to.apply((*value - from.offset) / from.scale));
        };
        again(&mut run.series[a].values, two, one);
        again(&mut run.series[b].values, one, two);
    }
    other
}

/// All but those of time, in the order in which they are told where several fit.
pub(super) fn others(problem: &Problem) -> Vec<Way> {
    let all: Vec<usize> = (0..problem.channels.len()).collect();
    let several = signs(problem).into_iter().filter(|way| way.channels(problem).len() > 1);
    let mut ways = single(problem);
    for names in [&["deg", "deg/s"][..], &["degC"], &["K"]] {
        ways.extend(together(problem, &all, names));
        // what is compared was written by one logger, and what is fed may come from elsewhere
        ways.extend(
            together(problem, &fed_and_compared(problem).1, names).filter(|way| ways.last() != Some(way)),
        );
    }
    let new: Vec<Way> = kinds::of_one_kind(problem)
        .into_iter()
        .filter(|way| ways.iter().all(|known| known.change != way.change))
        .collect();
    ways.extend(new);
    ways.extend(pairs(&all).into_iter().map(|(a, b)| columns(problem, a, b)));
    ways.extend(several);
    ways
}

/// The sign of one channel, or its unit of measurement.
pub(super) fn single(problem: &Problem) -> Vec<Way> {
    let mut ways = signs(problem);
    ways.retain(|way| way.channels(problem).len() == 1);
    ways.extend((0..problem.channels.len()).flat_map(|place| units(problem, place)));
    ways
}

/// Turned signs: of each channel, the inputs first; of an axis that runs the other way round, a position and its rate; of all inputs and
/// all outputs.
pub(super) fn signs(problem: &Problem) -> Vec<Way> {
    let (inputs, outputs) = fed_and_compared(problem);
    let mut ways: Vec<Way> = inputs.iter().chain(&outputs).map(|place| turned(problem, &[*place])).collect();
    ways.extend(pairs(&outputs).into_iter().map(|(a, b)| turned(problem, &[a, b])));
    ways.extend(
        [&inputs, &outputs].into_iter().filter(|list| list.len() > 2).map(|list| turned(problem, list)),
    );
    ways
}

/// Channels that are fed, and those that are compared.
pub(super) fn fed_and_compared(problem: &Problem) -> (Vec<usize>, Vec<usize>) {
    let fed = |place: &usize| matches!(problem.channels[*place].role, Role::Fed(_));
    (0..problem.channels.len()).partition(fed)
}

/// Those that are tried.
fn pairs(list: &[usize]) -> Vec<(usize, usize)> {
    let from = |first: usize| list[first + 1..].iter().map(move |second| (list[first], *second));
    (0..list.len()).flat_map(from).take(DOUBTS.pairs).collect()
}

/// Where to write it.
pub(super) fn written(channel: &Channel, line: &str) -> String {
    format!(
        "Write in the [[channel]] of {}, in place of what it says of unit, scale and offset: {line}",
        channel.name
    )
}

pub(super) fn all_written<'a>(lines: impl Iterator<Item = (&'a Channel, String)>) -> String {
    lines.map(|(channel, line)| written(channel, &line)).collect::<Vec<_>>().join(". ")
}

/// What to write in a channel for a conversion, if `unit` doesn't say it.
pub(super) fn numbers(conversion: Affine) -> String {
    let offset =
        if conversion.offset == 0.0 { String::new() } else { format!(" and offset = {}", conversion.offset) };
    format!("scale = {}{offset}", conversion.scale)
}

pub(super) fn then(before: Affine, by: Affine) -> Affine {
    Affine { scale: by.scale * before.scale, offset: by.apply(before.offset) + 0.0 }
}

pub(super) fn list(names: impl Iterator<Item = String>) -> String {
    names.collect::<Vec<_>>().join(" and ")
}

/// The log's own numbers times a factor.
pub(super) fn times_log(channel: &Channel, factor: f64) -> Affine {
    Affine { scale: factor, offset: channel.conversion.offset * (1.0 - factor) }
}

fn turned(problem: &Problem, places: &[usize]) -> Way {
    let channels: Vec<&Channel> = places.iter().map(|place| &problem.channels[*place]).collect();
    let signs = if places.len() > 1 { "signs" } else { "sign" };
    let by = |channel: &Channel| times_log(channel, -1.0);
    let lines = channels.iter().map(|channel| (*channel, numbers(then(channel.conversion, by(channel)))));
    Way {
        change: Change::Values(
            places.iter().zip(&channels).map(|(place, channel)| (*place, by(channel))).collect(),
        ),
        line: channels[0].line,
        what: format!("the {signs} of {} turned", list(channels.iter().map(|channel| named(channel)))),
        add: all_written(lines),
        exact: false,
    }
}

pub(super) fn named(channel: &Channel) -> String {
    format!("{} (column {:?})", channel.name, channel.column)
}

fn columns(problem: &Problem, a: usize, b: usize) -> Way {
    let (one, two) = (&problem.channels[a], &problem.channels[b]);
    Way {
        change: Change::Exchanged(a, b),
        line: one.line,
        what: format!("the columns of {} and {} exchanged", one.name, two.name),
        add: format!(
            "Write in the [[channel]] of {}: column = {:?}, in that of {}: column = {:?}",
            one.name, two.column, two.name, one.column
        ),
        exact: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_all_pairs_of_eight_columns_are_tried_and_no_more() {
        let all = |columns: usize| pairs(&(0..columns).collect::<Vec<_>>());
        assert_eq!((all(2), all(3).len()), (vec![(0, 1)], 3));
        assert_eq!(all(8).last(), Some(&(6, 7)), "each with each");
        assert_eq!(all(9).len(), all(8).len(), "names tell more than so many looks");
    }
}
