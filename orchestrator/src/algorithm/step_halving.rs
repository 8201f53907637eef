//! Variable steps with error control: all units go from point to point together, in as many steps as the coupling needs.
//!
//! A step of size h is made once whole and, from the same saved states, in two halves. Values are handed on as with Jacobi,
//! which is of first order, so the difference of the two ends is the error of the halves. Where it is below `tolerance`,
//! relative to the larger of value and one, at every connected output, the halves stand; else h is halved. A step that is
//! ten times better than it needs to be is followed by one of twice the size. Each interval begins with the whole of it, so that
//! nothing but the state decides the steps, and a resumed run takes the same ones.
//!
//! Between two points direct connections and sources are read at each step; what comes through a channel (latency,
//! jitter, losses, a linear hold) stays as it was at the point.

use super::options::Known;
use super::{Algorithm, Needs, Options, Sees};
use crate::error::Error;
use crate::rollback::By;
use crate::system::{Point, System, Values};

pub(super) const OPTIONS: &[Known] = &[
    Known { name: "tolerance", default: 1e-4, least: 1e-15, most: 1.0, whole: false },
    Known { name: "halvings", default: 12.0, least: 0.0, most: 40.0, whole: true },
];

/// The error of a first-order scheme goes as the square of a single step, so one of twice the size has four times as much.
const ROOM: f64 = 0.1;

pub(super) struct StepHalving {
    tolerance: f64,
    halvings: u32,
    before: Values,
    whole: Values,
}

/// From one point to the next one.
#[derive(Clone, Copy)]
struct Span {
    /// Where it begins, in ticks and in s.
    begin: Point,
    end: f64,
    size: f64,
    /// Parts of the finest step.
    parts: u64,
}

impl Span {
    fn time(&self, part: u64) -> f64 {
        if part == self.parts { self.end } else { self.begin.time + self.size * self.share(part) }
    }

    fn share(&self, parts: u64) -> f64 {
        parts as f64 / self.parts as f64
    }
}

impl StepHalving {
    pub(super) fn new(options: &Options<'_>) -> Self {
        Self {
            tolerance: options.get("tolerance"),
            halvings: options.get("halvings") as u32,
            before: Values::default(),
            whole: Values::default(),
        }
    }

    /// One step of all units, over so many parts from one on.
    fn go(system: &mut System, span: Span, from: u64, parts: u64) -> Result<(), Box<Error>> {
        let (begin, size) = (span.time(from), span.size * span.share(parts));
        for unit in 0..system.units.len() {
            system.gather(unit, Point { ticks: span.begin.ticks, time: begin });
        }
        for unit in 0..system.units.len() {
            (system.units[unit].begin, system.units[unit].size) = (begin, size);
            system.exchange(unit, span.time(from + parts))?;
        }
        Ok(())
    }

    /// A step whole, whose values are kept aside, and in two halves.
    fn both_ways(&mut self, system: &mut System, span: Span, at: u64, step: u64) -> Result<(), Box<Error>> {
        Self::go(system, span, at, step)?;
        std::mem::swap(&mut self.whole, &mut system.values);
        self.go_back(system)?;
        Self::go(system, span, at, step / 2)?;
        Self::go(system, span, at + step / 2, step / 2)
    }

    /// Back to where the step began.
    fn go_back(&self, system: &mut System) -> Result<(), Box<Error>> {
        system.values.clone_from(&self.before);
        for unit in &mut system.units {
            unit.take_back(By::Algorithm)?;
        }
        Ok(())
    }

    /// The largest difference at a connected output, with its unit and place there; what is recorded of it is kept.
    fn compare(&self, system: &System, errors: &mut [f64]) -> (f64, usize, usize) {
        for (error, (place, _)) in errors.iter_mut().zip(&system.errors) {
            *error = error.max((system.values.reals[*place] - self.whole.reals[*place]).abs());
        }
        let mut worst = (0.0, 0, 0);
        for (number, unit) in system.units.iter().enumerate() {
            let outputs = &unit.outputs;
            let pairs =
                outputs.reals.of(&self.whole.reals).iter().zip(outputs.reals.of(&system.values.reals));
            for (place, (whole, halves)) in pairs.take(outputs.connected).enumerate() {
                let error = (whole - halves).abs() / halves.abs().max(1.0);
                if error > worst.0 {
                    worst = (error, number, place);
                }
            }
        }
        worst
    }

    /// The error where even the finest step leaves `worst`: a difference, its unit and its place among the outputs.
    fn too_coarse(&self, system: &System, time: f64, worst: (f64, usize, usize)) -> Error {
        Error::Coupling {
            variable: system.units[worst.1].output_name(worst.2),
            time,
            change: worst.0,
            tolerance: self.tolerance,
            tried: format!("{} halvings of the step", self.halvings),
            advice: "a smaller interval or a larger tolerance may help",
        }
    }
}

impl Algorithm for StepHalving {
    fn sees(&self) -> Sees {
        Sees::Begin
    }

    fn needs(&self) -> Needs {
        Needs { states: true, any_step: true, one_rate: true, ..Needs::default() }
    }

    fn estimates(&self) -> bool {
        true
    }

    fn step(&mut self, system: &mut System, point: Point) -> Result<(), Box<Error>> {
        let Some(first) = system.units.first() else { return Ok(()) };
        let size = first.size;
        let begin = Point { ticks: point.ticks - first.step, time: first.begin };
        let span = Span { begin, end: point.time, size, parts: 2 << self.halvings };
        let mut errors = vec![0.0; system.errors.len()];
        let (mut at, mut step) = (0, span.parts);
        // What has arrived leaves its line: it must be among the values that are gone back to.
        for unit in 0..system.units.len() {
            system.gather(unit, begin);
        }
        while at < span.parts {
            self.before.clone_from(&system.values);
            for unit in &mut system.units {
                unit.keep(By::Algorithm)?;
            }
            match self.both_ways(system, span, at, step) {
                Ok(()) => {
                    let mut seen = errors.clone();
                    let worst = self.compare(system, &mut seen);
                    if worst.0 <= self.tolerance {
                        (at, errors) = (at + step, seen);
                        // A larger one must begin at one of its own places.
                        let fits = at % (2 * step) == 0 && at + 2 * step <= span.parts;
                        step = if fits && worst.0 <= ROOM * self.tolerance { 2 * step } else { step };
                        continue;
                    }
                    if step == 2 {
                        return Err(Box::new(self.too_coarse(system, span.time(at), worst)));
                    }
                }
                // What a unit refuses or blows up at, a smaller step may mend.
                Err(error)
                    if step > 2 && matches!(*error, Error::Discarded { .. } | Error::NotFinite { .. }) => {}
                Err(error) => return Err(error),
            }
            step /= 2;
            self.go_back(system)?;
        }
        arrive(system, point, size, errors);
        Ok(())
    }
}

/// All units are at the point: hands their values on, and what is recorded of the errors.
fn arrive(system: &mut System, point: Point, size: f64, errors: Vec<f64>) {
    for unit in 0..system.units.len() {
        system.units[unit].size = size;
        system.stepped(unit, point);
        system.send(unit, point);
    }
    for (number, error) in errors.into_iter().enumerate() {
        let (_, place) = system.errors[number];
        system.values.reals[place] = error;
    }
    system.find_next();
}
