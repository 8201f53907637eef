//! Connected Reals that go on along lines instead of standing still over a step: the coupling is then of second order.
//!
//! `extrapolated` takes units as Jacobi does, `interpolated` as Gauss-Seidel. Of each output that varies continuously two
//! samples are kept, or its derivative where the unit gives one (`maxOutputDerivativeOrder`); a unit gets the value at
//! the begin of its step and the slope (`fmi2SetRealInputDerivatives`), where it says `canInterpolateInputs`, else the
//! value in the middle of its step. Where the sender has stepped already, the line lies between two known values.
//! Booleans, Integers, texts, discrete outputs and what comes through a channel are handed on as they are.
//!
//! A unit without `canInterpolateInputs` gets the value at the *end* of its step for an input from which an output that goes to
//! another unit follows at once, by its description: in the middle the output would be half a step late, and the coupling of first
//! order. The middle for the step and then the end for the outputs is not to be had: FMI 2.0 section 4.2.4 forbids reads
//! after writes without a step in between, and a unit may answer with an error or with what it had before.

use super::{Algorithm, Sees};
use crate::error::Error;
use crate::fmu::{Causality, Variability};
use crate::line::Line;
use crate::link::Conversion;
use crate::recorder::Slot;
use crate::system::{Point, System, Unit};
use crate::value::Kind;
use std::collections::{HashMap, HashSet};

#[derive(Default)]
pub(super) struct Extrapolated {
    /// Units step one after the other and see what those before them have reached.
    in_order: bool,
    /// The lines of the connected outputs, by unit.
    senders: Vec<Vec<Output>>,
    receivers: Vec<Receiver>,
}

/// A connected output that varies continuously.
struct Output {
    /// Among all Reals.
    place: usize,
    reference: u32,
    /// The unit tells its derivative.
    derived: bool,
    before: f64,
    slope: f64,
    /// Where its newest sample was taken in s.
    time: f64,
}

/// The inputs of a unit that go on along lines.
#[derive(Default)]
struct Receiver {
    inputs: Vec<Input>,
    /// For a unit that interpolates: references of these, and the slopes of the step under way.
    references: Vec<u32>,
    slopes: Vec<f64>,
    /// Inputs, by their places among all Reals, of which the value at the end of the step is given.
    through: HashSet<usize>,
}

struct Input {
    /// Among all Reals.
    place: usize,
    /// Where in the step its value is taken: 0 at the begin, 2 at the end.
    halves: f64,
    /// The sending unit and the number of its line.
    from: (usize, usize),
    gain: f64,
    bias: f64,
}

impl Extrapolated {
    pub(super) fn new(in_order: bool) -> Self {
        Self { in_order, ..Self::default() }
    }

    /// Inputs of a unit for the step from its begin on.
    fn gather(&mut self, system: &mut System, number: usize, point: Point) {
        system.gather(number, point);
        let unit = &mut system.units[number];
        let (begin, half) = (unit.begin, unit.size / 2.0);
        let receiver = &mut self.receivers[number];
        receiver.slopes.clear();
        for input in &receiver.inputs {
            let line = &self.senders[input.from.0][input.from.1];
            let slope = input.gain * line.slope;
            let at = begin + input.halves * half;
            let newest = input.gain * system.values.reals[line.place] + input.bias;
            system.values.reals[input.place] = newest + slope * (at - line.time);
            receiver.slopes.push(slope);
        }
        for feed in unit.feeds.iter_mut().filter(|feed| !feed.signal.holds()) {
            if let Slot::Real(place) = feed.to {
                let [from, to] = [feed.signal.at(begin), feed.signal.at(begin + 2.0 * half)];
                let through = receiver.through.contains(&(place as usize));
                system.values.reals[place as usize] = if through { to } else { 0.5 * (from + to) };
            }
        }
    }

    /// The step of a unit with the inputs gathered before.
    fn exchange(&mut self, system: &mut System, number: usize, time: f64) -> Result<(), Box<Error>> {
        let receiver = &self.receivers[number];
        if !receiver.references.is_empty() {
            let unit = &mut system.units[number];
            let orders = vec![1; receiver.references.len()];
            unit.instance.set_input_derivatives(&receiver.references, &orders, &receiver.slopes)?;
        }
        let before = system.units[number].begin;
        system.units[number].exchange::<false, true>(&mut system.values, time)?;
        self.sample(system, number, before, time)
    }

    /// Takes the new samples of a unit's outputs, and where they go from there.
    fn sample(
        &mut self,
        system: &mut System,
        number: usize,
        before: f64,
        now: f64,
    ) -> Result<(), Box<Error>> {
        let lines = &mut self.senders[number];
        for line in lines.iter_mut() {
            let value = system.values.reals[line.place];
            line.slope = (value - line.before) / (now - before);
            (line.before, line.time) = (value, now);
        }
        let derived: Vec<usize> = (0..lines.len()).filter(|&line| lines[line].derived).collect();
        if derived.is_empty() {
            return Ok(());
        }
        let references: Vec<u32> = derived.iter().map(|&line| lines[line].reference).collect();
        let mut slopes = vec![0.0; derived.len()];
        let instance = &mut system.units[number].instance;
        instance.get_output_derivatives(&references, &vec![1; derived.len()], &mut slopes)?;
        for (line, slope) in derived.into_iter().zip(slopes) {
            if !slope.is_finite() {
                let unit = &system.units[number];
                let variable = format!("the derivative of {}", unit.named(Kind::Real, lines[line].reference));
                let log = unit.instance.log();
                return Err(Box::new(Error::NotFinite { variable, value: slope, time: now, log }));
            }
            lines[line].slope = slope;
        }
        Ok(())
    }
}

impl Algorithm for Extrapolated {
    fn sees(&self) -> Sees {
        if self.in_order { Sees::EndInOrder } else { Sees::Begin }
    }

    fn along(&self) -> bool {
        true
    }

    fn start(&mut self, system: &mut System) {
        self.senders =
            system.units.iter().map(|unit| outputs(unit, &system.values.reals, self.in_order)).collect();
        let lines: HashMap<usize, (usize, usize)> = (self.senders.iter().enumerate())
            .flat_map(|(unit, lines)| {
                lines.iter().enumerate().map(move |(at, line)| (line.place, (unit, at)))
            })
            .collect();
        self.receivers = system.units.iter().map(|unit| receiver(unit, &system.lines, &lines)).collect();
    }

    fn begin(&mut self, system: &mut System, point: Point) {
        if self.in_order {
            return;
        }
        for number in 0..system.units.len() {
            if system.ends[number] != i64::MAX
                && system.ends[number] - system.units[number].step == point.ticks
            {
                self.gather(system, number, point);
            }
        }
    }

    fn step(&mut self, system: &mut System, point: Point) -> Result<(), Box<Error>> {
        for unit in system.due(point) {
            if self.in_order {
                self.gather(system, unit, point);
            }
            self.exchange(system, unit, point.time)?;
            system.stepped(unit, point);
            system.send(unit, point);
        }
        system.find_next();
        Ok(())
    }

    fn save(&self) -> Vec<f64> {
        self.senders.iter().flatten().flat_map(|line| [line.before, line.slope, line.time]).collect()
    }

    fn restore(&mut self, saved: &[f64]) {
        for (line, saved) in self.senders.iter_mut().flatten().zip(saved.as_chunks::<3>().0) {
            [line.before, line.slope, line.time] = *saved;
        }
    }
}

/// The lines of a unit's connected outputs; a step between two known values is no place for a derivative at its end.
fn outputs(unit: &Unit, reals: &[f64], in_order: bool) -> Vec<Output> {
    let description = unit.instance.fmu().description();
    let continuous: HashSet<u32> = (description.variables.iter())
        .filter(|v| v.kind == Kind::Real && v.causality == Causality::Output)
        .filter(|v| v.variability == Variability::Continuous)
        .map(|v| v.reference)
        .collect();
    let block = &unit.outputs.reals;
    let derived = !in_order && description.co_simulation.max_output_derivative_order > 0;
    let connected = block.references.iter().enumerate().take(unit.outputs.connected);
    let lines = connected.filter(|(_, reference)| continuous.contains(reference)).map(|(at, &reference)| {
        let place = block.at + at;
        Output { place, reference, derived, before: reals[place], slope: 0.0, time: unit.begin }
    });
    lines.collect()
}

/// The inputs of a unit that one of the lines leads to.
fn receiver(unit: &Unit, channels: &[Line], lines: &HashMap<usize, (usize, usize)>) -> Receiver {
    let interpolates = unit.instance.fmu().description().co_simulation.can_interpolate_inputs;
    let through = through(unit);
    let mut inputs = Vec::new();
    let mut add = |from: usize, place: usize, (gain, bias): (f64, f64)| {
        if let Some(&from) = lines.get(&from) {
            let halves = match (interpolates, through.contains(&place)) {
                (true, _) => 0.0,
                (false, true) => 2.0,
                (false, false) => 1.0,
            };
            inputs.push(Input { place, halves, from, gain, bias });
        }
    };
    unit.inputs.reals.copies().for_each(|(from, to)| add(from, to, (1.0, 0.0)));
    // A direct connection of which the age is recorded is a channel that does nothing.
    let channels =
        unit.lines_in.iter().map(|channel| &channels[*channel]).filter(|channel| channel.is_direct());
    for link in unit.links.iter().chain(channels.map(|channel| &channel.link)) {
        if let (Slot::Real(from), Slot::Real(to)) = (link.from, link.to) {
            let scale = match &link.conversion {
                Conversion::Affine { gain, bias } => (*gain, *bias),
                _ => (1.0, 0.0),
            };
            add(from as usize, to as usize, scale);
        }
    }
    let block = &unit.inputs.reals;
    let references =
        inputs.iter().filter(|_| interpolates).map(|input| block.references[input.place - block.at]);
    Receiver { references: references.collect(), slopes: Vec::new(), through, inputs }
}

/// The inputs, by their places among all Reals, from which a Real output that goes to another unit follows at once, as far as the
/// description says so. Of an output that it says nothing of (in the standard's words: it depends on all inputs) most come from states.
fn through(unit: &Unit) -> HashSet<usize> {
    let description = unit.instance.fmu().description();
    let connected = &unit.outputs.reals.references[..unit.outputs.connected];
    let is = |place: usize, causality| {
        let variable = &description.variables[place];
        variable.kind == Kind::Real && variable.causality == causality
    };
    let outputs = (0..description.variables.len())
        .filter(|place| is(*place, Causality::Output))
        .filter(|place| connected.contains(&description.variables[*place].reference));
    let on = outputs.filter_map(|output| description.step_dependencies(output)).flatten();
    let references: HashSet<u32> = (on.filter(|place| is(**place, Causality::Input)))
        .map(|place| description.variables[*place].reference)
        .collect();
    let block = &unit.inputs.reals;
    let places = (block.at..).zip(&block.references);
    places.filter(|(_, reference)| references.contains(reference)).map(|(place, _)| place).collect()
}
