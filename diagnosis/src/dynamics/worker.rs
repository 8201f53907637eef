//! Instances of the units, and one interval on them: set the states, feed, step, read.

use super::linearise::Engine;
use super::machine::{Input, Machine, Reference};
use super::schedule::Piece;
use crate::error::Error;
use crate::statistics::levels::TASK;
use orchestrator::fmu::{Begin, Instance, Status};
use orchestrator::{Kind, Value};
use std::time::Instant;

/// One instance of each unit.
pub struct Worker {
    instances: Vec<Instance>,
    /// Real start values of each unit: references and values, each reference once, filled anew for each interval.
    reals: Vec<(Vec<u32>, Vec<f64>)>,
    /// What else an instance begins with.
    others: Vec<Vec<(u32, Value)>>,
    /// Whether a reset brings an instance back to where it was after instantiation.
    pub resets: bool,
    /// Steps that were made.
    steps: usize,
    /// References that are read or set in one call.
    wanted: Vec<u32>,
}

/// What happens from a row on, over one interval or more.
#[derive(Debug, Clone, Copy)]
pub struct Job<'a> {
    /// Begin, s.
    pub time: f64,
    /// States there.
    pub states: &'a [f64],
    /// Parameters of the units: reference and value, those off their nominal values.
    pub parameters: &'a [(Reference, f64)],
    /// Inputs at each row, the first and the last included.
    pub at_row: &'a [f64],
    /// Where the pieces of each interval begin, and where the last ends.
    pub first: &'a [usize],
    /// Stretches.
    pub pieces: &'a [super::schedule::Piece],
    /// Inputs of each stretch.
    pub fed: &'a [f64],
    /// Channels read within the first interval.
    pub reads: &'a [usize],
    /// Read all channels at the end of each interval, too.
    pub each_row: bool,
}

fn failed(error: impl std::fmt::Display) -> Error {
    Error::Model(error.to_string())
}

/// A number as the type that a variable has.
pub fn typed(kind: Kind, value: f64) -> Value {
    match kind {
        Kind::Integer => Value::Integer(value.round() as i32),
        Kind::Boolean => Value::Boolean(value > 0.5),
        _ => Value::Real(value),
    }
}

/// What to look at where a unit fails: nobody knows whose fault that is.
const USUAL_CAUSE: &str = "where one of these, or what the states begin at, is many times too large or too small, its column has another unit of \
     measurement than dataset.toml says";

/// What was fed, in words.
fn describe_inputs(machine: &Machine, fed: &[f64]) -> String {
    let each = machine.inputs.iter().zip(fed).map(|(input, value)| format!("{} = {value:?}", input.name));
    let each: Vec<String> = each.collect();
    match each.is_empty() {
        true => String::new(),
        false => format!(", fed {}; {USUAL_CAUSE}", each.join(", ")),
    }
}

/// A time on the units' clock.
fn on_clock(machine: &Machine, job: &Job<'_>, time: f64) -> f64 {
    machine.own_clock.map_or(time, |ticks| ((time - job.time) * ticks).round() / ticks)
}

/// Where a piece begins on the units' clock, and how long it is there.
fn placed(machine: &Machine, job: &Job<'_>, piece: Piece) -> (f64, f64) {
    // the unit is a little further already
    let ahead = if piece.from == job.time { machine.first_step } else { 0.0 };
    let from = on_clock(machine, job, piece.from + ahead);
    match machine.own_clock {
        Some(_) => (from, on_clock(machine, job, piece.from + piece.span) - from),
        None => (from, piece.span - ahead),
    }
}

impl Worker {
    /// Fresh instances.
    ///
    /// # Errors
    /// A unit can't be instantiated.
    pub fn new(machine: &Machine) -> Result<Self, Error> {
        let reals = vec![(Vec::new(), Vec::new()); machine.units.len()];
        let others = vec![Vec::new(); machine.units.len()];
        let mut worker =
            Self { instances: Vec::new(), reals, others, resets: true, steps: 0, wanted: Vec::new() };
        worker.renew(machine)?;
        Ok(worker)
    }

    /// Fresh instances; those before them are freed first.
    fn renew(&mut self, machine: &Machine) -> Result<(), Error> {
        self.instances.clear();
        for unit in &machine.units {
            self.instances.push(unit.fmu.instantiate(&unit.name).map_err(failed)?);
        }
        Ok(())
    }

    /// Next states (0 where nothing shows them), outputs at the begin, what is read within the first interval, and where
    /// asked for the outputs at the end of each interval, one behind the other.
    ///
    /// # Errors
    /// A unit refused something.
    pub fn interval(&mut self, machine: &Machine, job: &Job<'_>, out: &mut Vec<f64>) -> Result<(), Error> {
        out.clear();
        out.resize(machine.order(), 0.0);
        self.begin(machine, job)?;
        self.outputs(machine, out)?;
        let width = machine.inputs.len();
        let mut reads = job.reads.iter();
        for interval in 0..job.first.len().saturating_sub(1) {
            let (begin, end) = (job.first[interval] - job.first[0], job.first[interval + 1] - job.first[0]);
            for place in begin..end {
                let piece = job.pieces[place];
                self.feed(machine, &job.fed[place * width..(place + 1) * width])?;
                self.step(
                    machine,
                    placed(machine, job, piece),
                    &job.fed[place * width..(place + 1) * width],
                )?;
                let here = if interval == 0 { piece.reads } else { 0 };
                for channel in reads.by_ref().take(here) {
                    out.push(self.read(machine.channels[*channel].variable)?);
                }
            }
            if interval == 0 {
                self.states(machine, &mut out[..machine.order()])?;
            }
            if job.each_row {
                self.feed(machine, &job.at_row[(interval + 1) * width..(interval + 2) * width])?;
                self.outputs(machine, out)?;
            }
        }
        out.iter().all(|value| value.is_finite()).then_some(()).ok_or_else(|| {
            let (from, fed) = (job.time, describe_inputs(machine, job.at_row));
            Error::Model(format!(
                "a unit gives a value that is not finite in the interval from {from} s{fed}"
            ))
        })
    }

    fn outputs(&mut self, machine: &Machine, out: &mut Vec<f64>) -> Result<(), Error> {
        let from = out.len();
        out.resize(from + machine.channels.len(), 0.0);
        self.read_all(machine.channels.iter().map(|output| Some(output.variable)), &mut out[from..])
    }

    /// What shows the states; 0 where nothing does.
    fn states(&mut self, machine: &Machine, out: &mut [f64]) -> Result<(), Error> {
        out.fill(0.0);
        self.read_all(machine.states.iter().map(|state| state.shows), out)
    }

    /// Reads variables into their places, real ones of a unit that follow each other in one call.
    fn read_all(
        &mut self,
        variables: impl Iterator<Item = Option<Reference>>,
        out: &mut [f64],
    ) -> Result<(), Error> {
        let mut wanted = std::mem::take(&mut self.wanted);
        let (mut begin, mut of) = (0, None);
        for (place, variable) in variables.enumerate() {
            let real = variable.filter(|variable| variable.kind == Kind::Real);
            let instance = real.map(|variable| variable.instance);
            if of != instance {
                self.read_reals(of, &wanted, &mut out[begin..place])?;
                wanted.clear();
                (begin, of) = (place, instance);
            }
            wanted.extend(real.map(|variable| variable.reference));
            if let (None, Some(variable)) = (real, variable) {
                out[place] = self.read(variable)?;
            }
        }
        self.read_reals(of, &wanted, &mut out[begin..])?;
        wanted.clear();
        self.wanted = wanted;
        Ok(())
    }

    fn read_reals(&mut self, instance: Option<usize>, wanted: &[u32], out: &mut [f64]) -> Result<(), Error> {
        let Some(instance) = instance else { return Ok(()) };
        self.instances[instance].get_real(wanted, out).map_err(failed)
    }

    /// What the variables that show the states say after initialisation.
    ///
    /// # Errors
    /// A unit refused something.
    pub fn shown_states(&mut self, machine: &Machine, job: &Job<'_>) -> Result<Vec<f64>, Error> {
        self.initialise(machine, job)?;
        machine
            .states
            .iter()
            .map(|state| state.shows.map_or(Ok(f64::NAN), |shows| self.read(shows)))
            .collect()
    }

    /// What shows the states at the end of each interval, all gone through without a new start.
    ///
    /// # Errors
    /// A unit refused something.
    pub fn walk(&mut self, machine: &Machine, job: &Job<'_>) -> Result<Vec<Vec<f64>>, Error> {
        self.begin(machine, job)?;
        let width = machine.inputs.len();
        let mut all = Vec::with_capacity(job.first.len());
        for ends in job.first.windows(2) {
            for place in ends[0] - job.first[0]..ends[1] - job.first[0] {
                let (piece, fed) = (job.pieces[place], &job.fed[place * width..(place + 1) * width]);
                self.feed(machine, fed)?;
                self.step(machine, placed(machine, job, piece), fed)?;
            }
            let shown =
                machine.states.iter().map(|state| state.shows.map_or(Ok(f64::NAN), |at| self.read(at)));
            all.push(shown.collect::<Result<_, _>>()?);
        }
        Ok(all)
    }

    /// Reset, start values, initialisation, and a short step where the unit needs one to show its outputs.
    fn begin(&mut self, machine: &Machine, job: &Job<'_>) -> Result<(), Error> {
        self.initialise(machine, job)?;
        if machine.first_step > 0.0 {
            let inputs = &job.at_row[..machine.inputs.len()];
            self.step(machine, (on_clock(machine, job, job.time), machine.first_step), inputs)?;
        }
        Ok(())
    }

    fn initialise(&mut self, machine: &Machine, job: &Job<'_>) -> Result<(), Error> {
        if !self.resets || self.instances.len() < machine.units.len() {
            self.renew(machine)?;
        }
        for (place, unit) in machine.units.iter().enumerate() {
            if self.resets {
                self.instances[place].reset().map_err(failed)?;
            }
            let ((references, values), others) = (&mut self.reals[place], &mut self.others[place]);
            references.clear();
            values.clear();
            others.clear();
            for (reference, value) in &unit.settings {
                // one call sets all real ones
                if let Value::Real(value) = value {
                    references.push(*reference);
                    values.push(*value);
                } else {
                    others.push((*reference, value.clone()));
                }
            }
        }
        let own = if machine.whole { &machine.begins } else { &machine.states };
        let starts = own.iter().map(|state| state.start).zip(job.states.iter().copied());
        for (reference, value) in job.parameters.iter().copied().chain(starts) {
            if reference.kind == Kind::Real {
                self.start_real(reference.instance, reference.reference, value);
            } else {
                self.others[reference.instance].push((reference.reference, typed(reference.kind, value)));
            }
        }
        let start = on_clock(machine, job, job.time);
        let values = self.others.iter().zip(&self.reals);
        for (instance, (settings, (reals, values))) in self.instances.iter_mut().zip(values) {
            instance.begin(start, None, Begin { settings, reals, values }).map_err(failed)?;
        }
        self.feed(machine, &job.at_row[..machine.inputs.len()])?;
        // a chain of links settles after as many passes as units; a loop is the first pass's affair
        for _ in 1..machine.units.len() {
            self.carry(machine, None)?;
        }
        self.instances.iter_mut().try_for_each(|instance| instance.exit_initialization()).map_err(failed)
    }

    /// A real variable of a unit starts at a value, whatever the nominal model says of it.
    fn start_real(&mut self, unit: usize, reference: u32, value: f64) {
        let (references, values) = &mut self.reals[unit];
        match references.iter().position(|known| *known == reference) {
            Some(place) => values[place] = value,
            None => {
                references.push(reference);
                values.push(value);
            }
        }
    }

    fn feed(&mut self, machine: &Machine, mut values: &[f64]) -> Result<(), Error> {
        let together = |a: &Input, b: &Input| {
            let [a, b] = [a.variable, b.variable];
            (a.kind, b.kind) == (Kind::Real, Kind::Real) && a.instance == b.instance
        };
        for inputs in machine.inputs.chunk_by(together) {
            let (own, others) = values.split_at(inputs.len());
            let Reference { instance, reference, kind } = inputs[0].variable;
            let set = if kind == Kind::Real {
                self.wanted.clear();
                self.wanted.extend(inputs.iter().map(|input| input.variable.reference));
                self.instances[instance].set_real(&self.wanted, own)
            } else {
                self.instances[instance].set(reference, &typed(kind, own[0]))
            };
            set.map_err(failed)?;
            values = others;
        }
        Ok(())
    }

    /// Hands linked values on, to one unit or to all.
    fn carry(&mut self, machine: &Machine, to: Option<usize>) -> Result<(), Error> {
        for link in machine.links.iter().filter(|link| to.is_none_or(|instance| instance == link.to.instance))
        {
            let value = self.instances[link.from.instance]
                .get(link.from.kind, link.from.reference)
                .map_err(failed)?;
            let value = match (link.to.kind, value.as_f64()) {
                (Kind::Real, Some(number)) => Value::Real(link.by.apply(number)),
                (kind, Some(number)) if kind != link.from.kind => typed(kind, number),
                _ => value,
            };
            self.instances[link.to.instance].set(link.to.reference, &value).map_err(failed)?;
        }
        Ok(())
    }

    /// One step of all units, each with what those before it gave at its end.
    fn step(&mut self, machine: &Machine, (from, span): (f64, f64), fed: &[f64]) -> Result<(), Error> {
        // to ask for the time costs as much as a step of a small unit
        let asks = self.steps.is_multiple_of(TASK);
        let is_late = asks && machine.deadline.is_some_and(|deadline| Instant::now() >= deadline);
        if is_late || machine.budget.as_ref().is_some_and(|budget| !budget.take()) {
            return Err(Error::TooSlow);
        }
        self.steps += 1;
        for place in 0..self.instances.len() {
            if !machine.links.is_empty() {
                self.carry(machine, Some(place))?;
            }
            orchestrator::beat();
            match self.instances[place].do_step(from, span, true) {
                Status::Ok | Status::Warning => {}
                status => {
                    let error = self.instances[place].step_error(status, from);
                    let name = machine.units[place].fmu.path().display();
                    let fed = describe_inputs(machine, fed);
                    return Err(Error::Model(format!("{name}, a step of {span} s: {error}{fed}")));
                }
            }
        }
        Ok(())
    }

    fn read(&mut self, variable: Reference) -> Result<f64, Error> {
        let instance = &mut self.instances[variable.instance];
        if variable.kind == Kind::Real {
            let mut value = [0.0];
            instance.get_real(&[variable.reference], &mut value).map_err(failed)?;
            return Ok(value[0]);
        }
        let value = instance.get(variable.kind, variable.reference).map_err(failed)?;
        value.as_f64().ok_or_else(|| Error::Model(format!("{value} is no number")))
    }
}

impl Engine {
    /// Lends a worker.
    ///
    /// # Errors
    /// A unit can't be instantiated.
    pub fn with_worker<R>(&self, job: impl FnOnce(&mut Worker) -> Result<R, Error>) -> Result<R, Error> {
        let kept = self.pool.lock().ok().and_then(|mut pool| pool.pop());
        let mut worker = match kept {
            Some(worker) => worker,
            None => Worker::new(&self.machine)?,
        };
        worker.resets = self.resets;
        let result = job(&mut worker);
        if result.is_ok()
            && let Ok(mut pool) = self.pool.lock()
        {
            pool.push(worker);
        }
        result
    }
}
