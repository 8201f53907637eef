//! The running system: instances, their values in flat buffers, and the copies between them. Everything is laid out
//! beforehand (`wiring.rs`), so that a step neither allocates (texts excepted) nor looks anything up.

use crate::blocks::Blocks;
use crate::error::Error;
use crate::fmu::{Instance, Status};
use crate::guard;
use crate::line::Line;
use crate::link::{Conversion, Feed, Link, feed_into};
use crate::recorder::Slot;
use crate::rollback::{By, Rollback};
use crate::text::Text;
use crate::time::Clock;
use crate::value::{Kind, Value};

/// A point in time: exact, and as the units get it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    pub(crate) ticks: i64,
    pub(crate) time: f64,
}

/// The values of all units. Booleans lie among the integers, as in the calls.
#[derive(Debug, Clone, Default)]
pub(crate) struct Values {
    pub(crate) reals: Vec<f64>,
    pub(crate) integers: Vec<i32>,
    pub(crate) strings: Vec<Text>,
}

impl Values {
    pub(crate) fn get(&self, slot: Slot) -> Value {
        match slot {
            Slot::Real(at) => Value::Real(self.reals[at as usize]),
            Slot::Integer(at) => Value::Integer(self.integers[at as usize]),
            Slot::Boolean(at) => Value::Boolean(self.integers[at as usize] != 0),
            Slot::String(at) => Value::String(self.strings[at as usize].as_str().to_owned()),
        }
    }

    /// Writes a value of the slot's type (others are left out: the wiring has checked them).
    pub(crate) fn put(&mut self, slot: Slot, value: &Value) {
        match (slot, value) {
            (Slot::Real(at), Value::Real(value)) => self.reals[at as usize] = *value,
            (Slot::Integer(at), Value::Integer(value)) => self.integers[at as usize] = *value,
            (Slot::Boolean(at), Value::Boolean(value)) => self.integers[at as usize] = i32::from(*value),
            (Slot::String(at), Value::String(value)) => self.strings[at as usize] = value.as_str().into(),
            _ => debug_assert!(false, "{value} in {slot:?}"),
        }
    }
}

/// One unit, ready to step.
pub(crate) struct Unit {
    pub(crate) name: String,
    pub(crate) instance: Instance,
    /// Communication interval in ticks.
    pub(crate) interval: i64,
    /// The same; past every time while the first step is under way, if that is an odd one.
    pub(crate) reach: i64,
    /// The step under way: its ticks, and as the unit gets it. Only the last one may differ from the interval.
    pub(crate) step: i64,
    pub(crate) size: f64,
    /// All steps but perhaps the first and the last; the first one where its points begin later than the start; and the
    /// last one where the unit goes on to a stop between its points.
    pub(crate) whole: f64,
    pub(crate) first: Option<(i64, f64)>,
    pub(crate) last: Option<(i64, f64)>,
    /// Where its next step begins, as the unit gets it.
    pub(crate) begin: f64,
    /// Connections that are no plain copies (these are in `inputs`), lines by number, and signals.
    pub(crate) links: Vec<Link>,
    pub(crate) lines_in: Vec<usize>,
    pub(crate) feeds: Vec<Feed>,
    pub(crate) lines_out: Vec<usize>,
    /// What is set before a step, with the plain copies that lead there, and what is read after it.
    pub(crate) inputs: Blocks,
    pub(crate) outputs: Blocks,
    /// What is read at initialisation only: recorded parameters and unconnected inputs.
    pub(crate) fixed: Blocks,
    /// Reals that go to no other unit and were not finite at some time: reference and what to tell.
    pub(crate) not_finite: Vec<(u32, String)>,
    pub(crate) rollback: Rollback,
    /// Copies are all there is to gather, no state is kept before a step, and no line begins here.
    pub(crate) plain: bool,
}

/// The running system.
pub(crate) struct System {
    pub(crate) units: Vec<Unit>,
    /// Where the next step of each unit ends; past every time if there is none.
    pub(crate) ends: Vec<i64>,
    /// The earliest of these.
    pub(crate) next: i64,
    pub(crate) lines: Vec<Line>,
    pub(crate) values: Values,
    /// Recorded estimates of errors: the place of the output and their own among the reals.
    pub(crate) errors: Vec<(usize, usize)>,
    /// Recorded ages of connected values: the line and the place among the reals.
    pub(crate) ages: Vec<(usize, usize)>,
    /// No unit steps past this.
    pub(crate) stop: i64,
    /// The order in which units step; of the scenario, unless the algorithm asks for another one.
    pub(crate) order: Vec<usize>,
}

impl System {
    /// Makes the steps that end at a point, in the order of the scenario, or with `DERIVED` in the derived one; with `GATHER` each unit
    /// gets its inputs from what the others have delivered by now, else they were gathered before. One loop without closures: the
    /// compiler keeps these apart from the loop where they are large, which cost three units 20 ns a point.
    #[inline(always)]
    pub(crate) fn step_ending<const DERIVED: bool, const GATHER: bool>(
        &mut self,
        point: Point,
    ) -> Result<(), Box<Error>> {
        let (values, stop) = (&mut self.values, self.stop);
        let (units, lines) = (self.units.as_mut_slice(), self.lines.as_mut_slice());
        let ends = &mut self.ends[..units.len()];
        let mut next = i64::MAX;
        for place in 0..units.len() {
            let index = if DERIVED { self.order[place] } else { place };
            if ends[index] == point.ticks {
                let unit = &mut units[index];
                if GATHER && !unit.plain {
                    gather_rest(unit, lines, values, point);
                }
                unit.exchange::<GATHER, true>(values, point.time)?;
                ends[index] = unit.end_of_next(point.ticks, stop);
                if !unit.plain {
                    unit.lines_out.iter().for_each(|line| lines[*line].push(values, ends, point.ticks));
                }
            }
            next = next.min(ends[index]);
        }
        self.next = next;
        Ok(())
    }

    /// Gathers the inputs of the units whose steps begin at a point, once the steps that end there were made.
    #[inline(always)]
    pub(crate) fn gather_beginning(&mut self, point: Point) {
        let (values, lines) = (&mut self.values, self.lines.as_mut_slice());
        for (unit, end) in self.units.iter_mut().zip(&self.ends) {
            if *end != i64::MAX && end - unit.step == point.ticks {
                if !unit.plain {
                    gather_rest(unit, lines, values, point);
                }
                unit.inputs.fetch(values);
            }
        }
    }

    /// The next point at which a step of any unit ends.
    #[inline]
    pub(crate) fn next(&self) -> Option<i64> {
        if self.next == i64::MAX { None } else { Some(self.next) }
    }

    /// Works out the recorded ages at a point.
    pub(crate) fn age(&mut self, clock: &Clock, now: i64) {
        for &(line, place) in &self.ages {
            self.values.reals[place] = clock.seconds(now - self.lines[line].sent);
        }
    }

    /// Puts all units at the start.
    pub(crate) fn rewind(&mut self, start: Point) {
        self.ends.clear();
        for unit in &mut self.units {
            unit.begin = start.time;
            self.ends.push(unit.end_of_first(start.ticks, self.stop));
        }
        self.next = self.ends.iter().copied().min().unwrap_or(i64::MAX);
        for line in &mut self.lines {
            line.clear(start.ticks);
            line.push(&self.values, &self.ends, start.ticks);
        }
    }
}

impl Unit {
    /// Sets the inputs, with `FETCH` once the plain copies are made, steps to a time and reads the outputs; with `FINAL` the
    /// unit is never taken back to before the step. The error is boxed, so that it comes back in a register.
    #[inline(always)]
    pub(crate) fn exchange<const FETCH: bool, const FINAL: bool>(
        &mut self,
        values: &mut Values,
        time: f64,
    ) -> Result<(), Box<Error>> {
        let begin = self.begin;
        guard::enter(self.instance.label());
        self.inputs.set::<FETCH>(&mut self.instance, values).map_err(|error| error.during(begin))?;
        let status = self.instance.step(begin, self.size, FINAL);
        if status != Status::Ok {
            not_ok(self, status, values)?;
        }
        if !self.outputs.get(&mut self.instance, values).map_err(|error| error.during(time))? {
            self.not_finite(values, time)?;
        }
        self.begin = time;
        Ok(())
    }
}

impl Unit {
    /// Where the step ends that begins at `from`; never, if that is past the stop.
    #[inline]
    pub(crate) fn end_of_next(&mut self, from: i64, stop: i64) -> i64 {
        // Both lie within half of the range (`wiring::clock`), so that neither difference nor sum overflows.
        if self.reach > stop - from { self.end_of_odd(from, stop) } else { from + self.reach }
    }

    /// Where the very first step ends.
    fn end_of_first(&mut self, start: i64, stop: i64) -> i64 {
        match self.first {
            Some((step, size)) if step <= stop - start => {
                (self.step, self.size, self.reach) = (step, size, i64::MAX);
                start + step
            }
            // Its points begin after the stop.
            Some(_) => self.end_of_last(start, stop),
            None => {
                (self.step, self.size, self.reach) = (self.interval, self.whole, self.interval);
                self.end_of_next(start, stop)
            }
        }
    }

    /// After an odd first step, or where the next whole one would end past the stop.
    #[cold]
    fn end_of_odd(&mut self, from: i64, stop: i64) -> i64 {
        (self.step, self.size, self.reach) = (self.interval, self.whole, self.interval);
        if self.interval > stop - from { self.end_of_last(from, stop) } else { from + self.interval }
    }

    fn end_of_last(&mut self, from: i64, stop: i64) -> i64 {
        match self.last {
            Some((step, size)) if from < stop => {
                (self.step, self.size) = (step, size);
                stop
            }
            _ => i64::MAX,
        }
    }

    /// Reads what stays as it is while nobody changes a tunable parameter.
    #[cold]
    pub(crate) fn read_fixed(&mut self, values: &mut Values, time: f64) -> Result<(), Box<Error>> {
        match self.fixed.read(&mut self.instance, values)? {
            true => Ok(()),
            false => self.not_finite(values, time),
        }
    }

    /// A real that was read is not finite: an error where it goes to another unit; else it is kept for the notices, once a
    /// variable.
    #[cold]
    pub(crate) fn not_finite(&mut self, values: &Values, time: f64) -> Result<(), Box<Error>> {
        for blocks in [&self.outputs, &self.inputs, &self.fixed] {
            for (place, value) in blocks.reals.of(&values.reals).iter().enumerate() {
                if value.is_finite() {
                    continue;
                }
                let reference = blocks.reals.references[place];
                let name = || self.named(Kind::Real, reference);
                if place < blocks.connected {
                    let (variable, log) = (name(), self.instance.log());
                    return Err(Box::new(Error::NotFinite { variable, value: *value, time, log }));
                }
                if !self.not_finite.iter().any(|(known, _)| *known == reference) {
                    let told = format!("{} is {value} at t = {time} s, for the first time", name());
                    self.not_finite.push((reference, told));
                }
            }
        }
        Ok(())
    }
}

/// What is no plain copy. A function of its own, so that the loop of plain units stays in registers.
pub(crate) fn gather_rest(unit: &mut Unit, lines: &mut [Line], values: &mut Values, point: Point) {
    for link in &unit.links {
        if let (Conversion::Affine { gain, bias }, Slot::Real(from), Slot::Real(to)) =
            (&link.conversion, link.from, link.to)
        {
            values.reals[to as usize] = gain * values.reals[from as usize] + bias;
        } else {
            let value = link.convert(values.get(link.from));
            values.put(link.to, &value);
        }
    }
    for &line in &unit.lines_in {
        lines[line].deliver(values, point.ticks);
    }
    for feed in &mut unit.feeds {
        feed_into(feed, values, point.time);
    }
    if unit.rollback.retry && unit.keep(By::Retry).is_err() {
        // It fails again when the step is to be taken back, if it ever is.
        unit.forget();
    }
}

#[cold]
fn not_ok(unit: &mut Unit, status: Status, values: &mut Values) -> Result<(), Error> {
    if unit.instance.note(status) {
        return Ok(());
    }
    if status == Status::Discard {
        let last = unit.instance.last_successful_time();
        if unit.instance.wants_to_end() {
            // What it reached is the last row.
            unit.outputs.read(&mut unit.instance, values).map_err(|error| *error)?;
            return Err(Error::Terminated { unit: unit.name.clone(), time: last.unwrap_or(unit.begin) });
        }
        if unit.rollback.retry && unit.retry(values).map_err(|error| *error)? {
            return Ok(());
        }
        let log = unit.instance.log();
        return Err(Error::Discarded {
            unit: unit.name.clone(),
            from: unit.begin,
            size: unit.size,
            last,
            retried: unit.rollback.retry,
            log,
        });
    }
    let error = unit.instance.failure("fmi2DoStep", status, Some(unit.begin));
    // Inputs of a unit in another process are sent with the step.
    let (kind, block) = match &error {
        Error::Call { function: "fmi2SetReal", .. } => (Kind::Real, &unit.inputs.reals),
        Error::Call { function: "fmi2SetInteger", .. } => (Kind::Integer, &unit.inputs.integers),
        Error::Call { function: "fmi2SetBoolean", .. } => (Kind::Boolean, &unit.inputs.booleans),
        Error::Call { function: "fmi2SetString", .. } => (Kind::String, &unit.inputs.strings),
        _ => return Err(error),
    };
    Err(unit.instance.about(error, kind, &block.references))
}
