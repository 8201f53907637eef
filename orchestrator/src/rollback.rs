//! Steps that are taken back, for algorithms that make one more than once and for units that discard one. Nothing of it
//! runs where neither does.

use crate::blocks::Blocks;
use crate::error::Error;
use crate::fmu::{SavedState, Status};
use crate::line::LineState;
use crate::system::{Point, System, Unit, Values, gather_rest};
use crate::value::{Kind, Value};
use std::collections::BTreeSet;

/// Steps of a discarded one that are tried before it counts as an error: each is half as long as the one before.
const HALVINGS: u32 = 20;

/// What a unit is taken back to.
#[derive(Default)]
pub(crate) struct Rollback {
    /// By the algorithm, and by a step that the unit discarded.
    kept: [Kept; 2],
    /// A step that the unit discards is made in shorter ones.
    pub(crate) retry: bool,
    /// How many there were, and when the first one was.
    pub(crate) retried: u64,
    pub(crate) first: f64,
}

/// A state at the begin of a step.
#[derive(Default)]
struct Kept {
    state: Option<SavedState>,
    /// In s.
    begin: f64,
}

/// Who takes a unit back.
#[derive(Debug, Clone, Copy)]
pub(crate) enum By {
    Algorithm,
    Retry,
}

impl Unit {
    /// Keeps the state at the begin of a step.
    pub(crate) fn keep(&mut self, by: By) -> Result<(), Box<Error>> {
        let kept = &mut self.rollback.kept[by as usize];
        kept.begin = self.begin;
        match &mut kept.state {
            Some(state) => self.instance.save_state_again(state)?,
            none => *none = Some(self.instance.save_state()?),
        }
        Ok(())
    }

    /// Back to what was kept.
    pub(crate) fn take_back(&mut self, by: By) -> Result<(), Box<Error>> {
        let kept = &self.rollback.kept[by as usize];
        if let Some(state) = &kept.state {
            self.instance.restore_state(state)?;
        }
        self.begin = kept.begin;
        Ok(())
    }

    /// Gives the memory of kept states back.
    pub(crate) fn forget(&mut self) {
        for kept in &mut self.rollback.kept {
            if let Some(state) = kept.state.take()
                && self.instance.is_stepping()
            {
                // A unit that can't free it keeps it; that changes no result.
                let _ = self.instance.free_state(state);
            }
        }
    }

    /// Makes a discarded step in shorter ones with the same inputs; false if the unit discards the shortest, too.
    pub(crate) fn retry(&mut self, values: &mut Values) -> Result<bool, Box<Error>> {
        if self.rollback.kept[By::Retry as usize].state.is_none() {
            return Ok(false);
        }
        if self.rollback.retried == 0 {
            self.rollback.first = self.begin;
        }
        self.rollback.retried += 1;
        let (begin, size) = (self.begin, self.size);
        let parts = 1u64 << HALVINGS;
        let time = |part: u64| begin + size * (part as f64 / parts as f64);
        let (mut at, mut step) = (0, parts / 2);
        self.take_back(By::Retry)?;
        while at < parts {
            self.inputs.set::<false>(&mut self.instance, values)?;
            let status = self.instance.step(time(at), size * (step as f64 / parts as f64), true);
            match status {
                Status::Ok | Status::Warning => {
                    self.instance.note(status);
                    at += step;
                    while at < parts && at % (2 * step) == 0 && at + 2 * step <= parts {
                        step *= 2;
                    }
                    self.begin = time(at);
                    if at < parts {
                        self.keep(By::Retry)?;
                    }
                }
                Status::Discard if step > 1 && !self.instance.wants_to_end() => {
                    step /= 2;
                    self.take_back(By::Retry)?;
                }
                _ => {
                    self.begin = begin;
                    return Ok(false);
                }
            }
        }
        self.begin = begin;
        Ok(true)
    }

    /// Name of an input, by its place in [`Blocks::all`].
    pub(crate) fn input_name(&self, place: usize) -> String {
        let blocks = &self.inputs;
        let all = [
            (Kind::Real, &blocks.reals.references),
            (Kind::Integer, &blocks.integers.references),
            (Kind::Boolean, &blocks.booleans.references),
            (Kind::String, &blocks.strings.references),
        ];
        let mut references = all.into_iter().flat_map(|(kind, all)| all.iter().map(move |one| (kind, *one)));
        references
            .nth(place)
            .map_or_else(|| self.name.clone(), |(kind, reference)| self.named(kind, reference))
    }

    /// Name of a Real output, by its place.
    pub(crate) fn output_name(&self, place: usize) -> String {
        let reference = self.outputs.reals.references.get(place);
        reference.map_or_else(|| self.name.clone(), |reference| self.named(Kind::Real, *reference))
    }

    /// `unit.variable`. Of several names for one reference the first is as good as any.
    pub(crate) fn named(&self, kind: Kind, reference: u32) -> String {
        let variables = &self.instance.fmu().description().variables;
        let named = variables.iter().find(|v| v.kind == kind && v.reference == reference);
        format!("{}.{}", self.name, named.map_or("?", |v| v.name.as_str()))
    }
}

impl System {
    /// The units whose steps end at a point.
    pub(crate) fn due(&self, point: Point) -> Vec<usize> {
        (0..self.units.len()).filter(|unit| self.ends[*unit] == point.ticks).collect()
    }

    /// Computes the inputs of a unit from what the others have delivered by now.
    pub(crate) fn gather(&mut self, unit: usize, point: Point) {
        let unit = &mut self.units[unit];
        if !unit.plain {
            gather_rest(unit, &mut self.lines, &mut self.values, point);
        }
        unit.inputs.fetch(&mut self.values);
    }

    /// Makes the step of a unit with the inputs gathered before, and reads the outputs. The unit may be taken back to where
    /// an earlier step began.
    pub(crate) fn exchange(&mut self, unit: usize, time: f64) -> Result<(), Box<Error>> {
        self.units[unit].exchange::<false, false>(&mut self.values, time)
    }

    /// The step of a unit stands: its next one is planned.
    pub(crate) fn stepped(&mut self, unit: usize, point: Point) {
        self.ends[unit] = self.units[unit].end_of_next(point.ticks, self.stop);
    }

    /// Sends what the outputs of a unit are at a point.
    pub(crate) fn send(&mut self, unit: usize, point: Point) {
        for &line in &self.units[unit].lines_out {
            self.lines[line].push(&self.values, &self.ends, point.ticks);
        }
    }

    /// The lines that begin or end at some units, as they are.
    pub(crate) fn lines_of(&self, units: &[usize]) -> Vec<(usize, LineState)> {
        let ends = |unit: &usize| self.units[*unit].lines_in.iter().chain(&self.units[*unit].lines_out);
        let lines: BTreeSet<usize> = units.iter().flat_map(ends).copied().collect();
        lines.into_iter().map(|line| (line, self.lines[line].save())).collect()
    }

    /// Puts lines back, and sends what the outputs of some units are now.
    pub(crate) fn send_anew(&mut self, lines: &[(usize, LineState)], units: &[usize], point: Point) {
        for (line, state) in lines {
            self.lines[*line].restore(state);
        }
        units.iter().for_each(|&unit| self.send(unit, point));
    }

    /// Looks for the next point.
    pub(crate) fn find_next(&mut self) {
        self.next = self.ends.iter().copied().min().unwrap_or(i64::MAX);
    }
}

impl Drop for System {
    fn drop(&mut self) {
        self.units.iter_mut().for_each(Unit::forget);
    }
}

impl Blocks {
    /// All values, type by type.
    pub(crate) fn all(&self, values: &Values) -> Vec<Value> {
        let reals = self.reals.of(&values.reals).iter().map(|value| Value::Real(*value));
        let integers = self.integers.of(&values.integers).iter().map(|value| Value::Integer(*value));
        let booleans = self.booleans.of(&values.integers).iter().map(|value| Value::Boolean(*value != 0));
        let strings =
            self.strings.of(&values.strings).iter().map(|text| Value::String(text.as_str().to_owned()));
        reals.chain(integers).chain(booleans).chain(strings).collect()
    }

    /// Puts them back.
    pub(crate) fn put_all(&self, all: &[Value], values: &mut Values) {
        let mut counts = [self.reals.at, self.integers.at, self.booleans.at, self.strings.at];
        for value in all {
            match value {
                Value::Real(value) => values.reals[counts[0]] = *value,
                Value::Integer(value) => values.integers[counts[1]] = *value,
                Value::Boolean(value) => values.integers[counts[2]] = i32::from(*value),
                Value::String(text) => values.strings[counts[3]] = text.as_str().into(),
            }
            counts[value.kind() as usize] += 1;
        }
    }
}

impl Value {
    /// How much it differs, relative to the larger of it and one; without bounds where it is no Real.
    pub(crate) fn change(&self, before: &Self) -> f64 {
        match (before, self) {
            (Self::Real(before), Self::Real(now)) => (now - before).abs() / now.abs().max(1.0),
            _ if before == self => 0.0,
            _ => f64::INFINITY,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_changes_are_relative_to_what_is_larger_than_one() {
        let change = |before: f64, now: f64| Value::Real(now).change(&Value::Real(before));
        for (before, now, expected) in [
            (0.25, 0.5, 0.25),
            (-0.25, 0.5, 0.75),
            (3.0, 4.0, 0.25),
            (4.0, -8.0, 1.5),
            (2.0, 2.0, 0.0),
            (0.5, 1.0, 0.5),
        ] {
            assert_eq!(change(before, now), expected, "from {before} to {now}");
        }
        assert_eq!(Value::Integer(3).change(&Value::Integer(3)), 0.0);
        assert_eq!(Value::Integer(3).change(&Value::Integer(4)), f64::INFINITY);
        assert_eq!(Value::from("a").change(&Value::from("b")), f64::INFINITY);
    }
}
