//! What rules work with: the unit, when and how finely it is stepped, and instances of it whose calls are said before they
//! are made.

use super::worker::say_call;
use orchestrator::fmu::{Causality, Description, Initial, Instance, SavedState, Status, Variable};
use orchestrator::{Error, Fmu, Kind, Value};
use std::fmt::Write as _;

/// Why a rule ends early.
pub(super) enum Halt {
    /// A call failed.
    Call(Box<Error>),
    /// A variable can't be read.
    Of(String, Box<Error>),
    /// The unit wants its run to end; that is its right.
    Ended,
}

impl From<Error> for Halt {
    fn from(error: Error) -> Self {
        Self::Call(Box::new(error))
    }
}

/// The unit, and how it is run.
pub(super) struct Bench {
    pub(super) fmu: Fmu,
    /// Begin of the experiment in s.
    pub(super) start: f64,
    /// Communication interval in s.
    pub(super) step: f64,
}

/// Steps of a run that is compared with another one.
pub(super) const STEPS: u64 = 20;

impl Bench {
    pub(super) fn new(fmu: Fmu) -> Self {
        let experiment = fmu.description().default_experiment;
        let start = experiment.start.filter(|start| start.is_finite()).unwrap_or(0.0);
        let span = experiment.stop.map(|stop| stop - start).filter(|span| span.is_finite() && *span > 0.0);
        let said = experiment.step_size.filter(|step| step.is_finite() && *step > 0.0);
        let step = said.unwrap_or_else(|| span.map_or(0.01, |span| span / 100.0));
        // An experiment of few long steps is cut finer, where the unit allows it.
        let fine = span
            .map(|span| span / STEPS as f64)
            .filter(|_| fmu.description().co_simulation.can_handle_variable_step);
        let step = fine.map_or(step, |fine| step.min(fine));
        Self { fmu, start, step }
    }

    pub(super) fn description(&self) -> &Description {
        self.fmu.description()
    }

    /// Variables of a causality.
    pub(super) fn variables(&self, causality: Causality) -> Vec<&Variable> {
        self.description().variables.iter().filter(|variable| variable.causality == causality).collect()
    }

    pub(super) fn outputs(&self) -> Vec<&Variable> {
        self.variables(Causality::Output)
    }

    /// Inputs that are Real.
    pub(super) fn real_inputs(&self) -> Vec<&Variable> {
        let inputs = self.variables(Causality::Input);
        inputs.into_iter().filter(|input| input.kind == Kind::Real).collect()
    }

    /// A new instance.
    pub(super) fn instance(&self, name: &str) -> Result<Subject<'_>, Halt> {
        say_call(&format!("fmi2Instantiate of {name}"));
        let instance = self.fmu.instantiate(name)?;
        Ok(Subject {
            bench: self,
            instance: Some(instance),
            name: name.to_owned(),
            loud: true,
            amplitude: 1.0,
        })
    }

    /// A new instance that is being initialised.
    pub(super) fn initialising(&self, name: &str) -> Result<Subject<'_>, Halt> {
        let mut subject = self.instance(name)?;
        subject.set_up()?;
        Ok(subject)
    }

    /// A new instance that can be stepped.
    pub(super) fn started(&self, name: &str) -> Result<Subject<'_>, Halt> {
        let mut subject = self.initialising(name)?;
        subject.exit_initialization()?;
        Ok(subject)
    }

    /// Whether a declared dependency is this variable, under any of its names.
    pub(super) fn lists(&self, dependencies: &[usize], variable: &Variable) -> bool {
        dependencies.iter().any(|place| {
            let listed = &self.description().variables[*place];
            (listed.kind, listed.reference) == (variable.kind, variable.reference)
        })
    }
}

/// One instance. Each call is said before it is made.
pub(super) struct Subject<'b> {
    bench: &'b Bench,
    instance: Option<Instance>,
    name: String,
    /// Says its calls; one of several threads does not.
    pub(super) loud: bool,
    /// How far inputs go from their start values, in some share of them.
    pub(super) amplitude: f64,
}

impl Subject<'_> {
    /// Makes a call.
    pub(super) fn call<T>(
        &mut self,
        what: &str,
        call: impl FnOnce(&mut Instance) -> Result<T, Error>,
    ) -> Result<T, Halt> {
        self.say(what);
        match &mut self.instance {
            Some(instance) => Ok(call(instance)?),
            None => Err(Halt::Ended),
        }
    }

    fn say(&self, what: &str) {
        if self.loud {
            say_call(&format!("{what} of {}", self.name));
        }
    }

    /// `fmi2SetupExperiment` and `fmi2EnterInitializationMode`.
    pub(super) fn set_up(&mut self) -> Result<(), Halt> {
        let start = self.bench.start;
        self.call("fmi2SetupExperiment", |instance| instance.setup_experiment(start, None))?;
        self.call("fmi2EnterInitializationMode", Instance::enter_initialization)
    }

    pub(super) fn exit_initialization(&mut self) -> Result<(), Halt> {
        self.call("fmi2ExitInitializationMode", Instance::exit_initialization)
    }

    /// Steps from one time by some interval.
    pub(super) fn step(&mut self, from: f64, size: f64) -> Result<(), Halt> {
        self.say(&format!("fmi2DoStep from {from} s by {size} s"));
        let Some(instance) = &mut self.instance else { return Err(Halt::Ended) };
        match instance.do_step(from, size, false) {
            Status::Ok | Status::Warning => Ok(()),
            Status::Discard if instance.wants_to_end() => Err(Halt::Ended),
            Status::Discard => {
                let (last, log) = (instance.last_successful_time(), instance.log());
                Err(Error::Discarded { unit: self.name.clone(), from, size, last, retried: false, log }
                    .into())
            }
            status => {
                let (unit, log) = (self.name.clone(), instance.log());
                Err(Error::Call { unit, function: "fmi2DoStep", status, time: Some(from), log }.into())
            }
        }
    }

    /// The k-th step of the bench, with inputs for it.
    pub(super) fn advance(&mut self, k: u64) -> Result<(), Halt> {
        self.excite(k)?;
        let (start, step) = (self.bench.start, self.bench.step);
        self.step(start + k as f64 * step, step)
    }

    /// Moves Real inputs a little about their start values, differently in each step.
    pub(super) fn excite(&mut self, k: u64) -> Result<(), Halt> {
        let bench = self.bench;
        let inputs = bench.real_inputs();
        let values: Vec<Value> = inputs
            .iter()
            .map(|input| {
                let start = input.start.as_ref().and_then(Value::as_f64).unwrap_or(0.0);
                let phase = ((k * 7 + 3) % 5) as f64 / 2.0 - 1.0;
                let moved = start + self.amplitude * phase * 0.01 * start.abs().max(1.0);
                Value::Real(within(input, moved))
            })
            .collect();
        self.write(&inputs, &values)
    }

    /// Sets variables, those of a type in one call.
    pub(super) fn write(&mut self, variables: &[&Variable], values: &[Value]) -> Result<(), Halt> {
        let mut reals = (Vec::new(), Vec::new());
        for (variable, value) in variables.iter().zip(values) {
            match value {
                Value::Real(value) => {
                    reals.0.push(variable.reference);
                    reals.1.push(*value);
                }
                _ => self.set(variable, value)?,
            }
        }
        if reals.0.is_empty() {
            return Ok(());
        }
        self.call(&format!("fmi2SetReal{}", named(variables)), |instance| {
            instance.set_real(&reals.0, &reals.1)
        })
    }

    /// Sets a variable.
    pub(super) fn set(&mut self, variable: &Variable, value: &Value) -> Result<(), Halt> {
        let what = format!("fmi2Set{} {} = {value}", variable.kind, variable.name);
        self.call(&what, |instance| instance.set(variable.reference, value))
    }

    /// Reads variables, those of a type in one call.
    pub(super) fn read(&mut self, variables: &[&Variable]) -> Result<Vec<Value>, Halt> {
        let mut values = vec![Value::Real(f64::NAN); variables.len()];
        for kind in [Kind::Real, Kind::Integer, Kind::Boolean, Kind::String] {
            let (places, of_kind): (Vec<usize>, Vec<&Variable>) =
                variables.iter().copied().enumerate().filter(|(_, variable)| variable.kind == kind).unzip();
            if of_kind.is_empty() {
                continue;
            }
            let references: Vec<u32> = of_kind.iter().map(|variable| variable.reference).collect();
            let read = self.call(&format!("fmi2Get{kind}{}", named(&of_kind)), |i| get(i, kind, &references));
            let read = read.map_err(|halt| self.refused(&of_kind, halt))?;
            places.into_iter().zip(read).for_each(|(place, value)| values[place] = value);
        }
        Ok(values)
    }

    /// Which of some variables can't be read, asked for one by one. A unit that answers nothing after an error doesn't tell.
    fn refused(&mut self, variables: &[&Variable], halt: Halt) -> Halt {
        let Halt::Call(error) = halt else { return halt };
        let mut refused = Vec::new();
        for variable in variables {
            let what = format!("fmi2Get{} {}", variable.kind, variable.name);
            if self.call(&what, |instance| instance.get(variable.kind, variable.reference)).is_err() {
                refused.push(variable);
            }
        }
        match refused.first() {
            Some(first) if refused.len() < variables.len() || variables.len() == 1 => {
                Halt::Of(first.name.clone(), error)
            }
            _ => Halt::Call(error),
        }
    }

    /// The outputs after each of some steps.
    pub(super) fn trace(&mut self, steps: std::ops::Range<u64>) -> Result<Vec<Vec<Value>>, Halt> {
        let outputs = self.bench.outputs();
        let rows = steps.map(|k| {
            self.advance(k)?;
            self.read(&outputs)
        });
        rows.collect()
    }

    pub(super) fn save(&mut self) -> Result<SavedState, Halt> {
        self.call("fmi2GetFMUstate", Instance::save_state)
    }

    pub(super) fn restore(&mut self, saved: &SavedState) -> Result<(), Halt> {
        self.call("fmi2SetFMUstate", |instance| instance.restore_state(saved))
    }

    /// Frees a state; whether its pointer is null then.
    pub(super) fn forget(&mut self, saved: SavedState) -> Result<bool, Halt> {
        self.call("fmi2FreeFMUstate", |instance| instance.free_state_seen(saved))
    }
}

impl Drop for Subject<'_> {
    fn drop(&mut self) {
        self.say("the end (fmi2Terminate, fmi2FreeInstance)");
        self.instance = None;
    }
}

/// Some names, for who wants to know the last calls.
fn named(variables: &[&Variable]) -> String {
    let mut text = String::new();
    for variable in variables.iter().take(3) {
        let _ = write!(text, " {}", variable.name);
    }
    if variables.len() > 3 {
        let _ = write!(text, " and {} more", variables.len() - 3);
    }
    text
}

fn get(instance: &mut Instance, kind: Kind, references: &[u32]) -> Result<Vec<Value>, Error> {
    let count = references.len();
    Ok(match kind {
        Kind::Real => {
            let mut values = vec![0.0; count];
            instance.get_real(references, &mut values)?;
            values.into_iter().map(Value::Real).collect()
        }
        Kind::Integer => {
            let mut values = vec![0; count];
            instance.get_integer(references, &mut values)?;
            values.into_iter().map(Value::Integer).collect()
        }
        Kind::Boolean => {
            let mut values = vec![0; count];
            instance.get_boolean(references, &mut values)?;
            values.into_iter().map(|value| Value::Boolean(value != 0)).collect()
        }
        Kind::String => {
            let mut values = vec![String::new(); count];
            instance.get_string(references, &mut values)?;
            values.into_iter().map(Value::String).collect()
        }
    })
}

/// A number put between the limits of a variable.
pub(super) fn within(variable: &Variable, value: f64) -> f64 {
    let value = variable.max.map_or(value, |max| value.min(max));
    variable.min.map_or(value, |min| value.max(min))
}

/// Another legal value near one; `None` where there is none, or the variable is a text.
pub(super) fn moved(variable: &Variable, value: &Value) -> Option<Value> {
    let moved = match value {
        Value::Real(value) => {
            let by = 0.1 * value.abs().max(1.0);
            let up = within(variable, value + by);
            Value::Real(if up == *value { within(variable, value - by) } else { up })
        }
        Value::Integer(value) => match &variable.items {
            Some(items) => Value::Integer(items.iter().find(|(_, item)| item != value)?.1),
            None => {
                let up = within(variable, f64::from(*value) + 1.0);
                let up = if up == f64::from(*value) { within(variable, f64::from(*value) - 1.0) } else { up };
                Value::Integer(up as i32)
            }
        },
        Value::Boolean(value) => Value::Boolean(!value),
        Value::String(_) => return None,
    };
    (!same(&moved, value)).then_some(moved)
}

/// Equal to the last bit.
pub(super) fn same(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Real(a), Value::Real(b)) => a.to_bits() == b.to_bits(),
        (a, b) => a == b,
    }
}

/// A variable that a master may set before initialisation: its start value holds.
pub(super) fn is_exact(variable: &Variable) -> bool {
    let settable = matches!(variable.causality, Causality::Input | Causality::Parameter);
    settable || variable.initial == Some(Initial::Exact)
}

/// The first place at which two traces differ: step, variable, both values.
pub(super) fn difference<'v>(
    outputs: &[&'v Variable],
    a: &[Vec<Value>],
    b: &[Vec<Value>],
) -> Option<(usize, &'v Variable, Value, Value)> {
    for (step, (row, other)) in a.iter().zip(b).enumerate() {
        for ((output, value), other) in outputs.iter().zip(row).zip(other) {
            if !same(value, other) {
                return Some((step, output, value.clone(), other.clone()));
            }
        }
    }
    None
}
