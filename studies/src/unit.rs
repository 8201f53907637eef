//! One unit driven by itself, through FMI, by the names of its variables.

use crate::Error;
use orchestrator::Value;
use orchestrator::fmu::{Fmu, Instance, Status};

/// An instance of a unit, used again and again: [`Unit::start`] takes it back to the beginning.
pub struct Unit {
    instance: Instance,
    /// Variables that act otherwise than they are set, [`crate::Bench::with_fault`].
    faults: Vec<(String, f64)>,
}

/// A variable that was looked up: reading it costs one call and no search.
#[derive(Debug, Clone, Copy)]
pub struct Signal {
    kind: orchestrator::Kind,
    reference: u32,
}

impl Unit {
    /// A fresh instance.
    ///
    /// # Errors
    /// The unit refuses.
    pub(crate) fn new(fmu: &Fmu, faults: Vec<(String, f64)>) -> Result<Self, Error> {
        let name = &fmu.description().co_simulation.model_identifier;
        Ok(Self { instance: fmu.instantiate(name)?, faults })
    }

    /// Looks up a variable.
    ///
    /// # Errors
    /// The unit has none of that name.
    pub fn signal(&self, name: &str) -> Result<Signal, Error> {
        let description = self.instance.fmu().description();
        let found = description.variables.iter().find(|variable| variable.name == name);
        let variable = found.ok_or_else(|| Error::Variable {
            unit: self.instance.name().to_owned(),
            name: name.to_owned(),
        })?;
        Ok(Signal { kind: variable.kind, reference: variable.reference })
    }

    /// Back to the start values, then these values, then initialised at a time in s.
    ///
    /// # Errors
    /// No such variable, or the unit refuses a value.
    pub fn start(&mut self, time: f64, set: &[(&str, f64)]) -> Result<(), Error> {
        self.instance.reset()?;
        self.instance.setup_experiment(time, None)?;
        for (name, value) in set {
            self.set(name, *value)?;
        }
        self.instance.enter_initialization()?;
        Ok(self.instance.exit_initialization()?)
    }

    /// Sets a variable by its name.
    ///
    /// # Errors
    /// No such variable, or the unit refuses the value.
    pub fn set(&mut self, name: &str, value: f64) -> Result<(), Error> {
        let signal = self.signal(name)?;
        let factors = self.faults.iter().filter(|(faulty, _)| faulty == name).map(|(_, factor)| factor);
        self.write(signal, factors.fold(value, |value, factor| value * factor))
    }

    /// Sets a variable; integers are rounded, Booleans are true unless 0.
    ///
    /// # Errors
    /// The unit refuses the value.
    pub fn write(&mut self, signal: Signal, value: f64) -> Result<(), Error> {
        let value = match signal.kind {
            orchestrator::Kind::Integer => Value::Integer(value.round() as i32),
            orchestrator::Kind::Boolean => Value::Boolean(value != 0.0),
            _ => Value::Real(value),
        };
        Ok(self.instance.set(signal.reference, &value)?)
    }

    /// Reads a variable by its name.
    ///
    /// # Errors
    /// No such variable.
    pub fn get(&mut self, name: &str) -> Result<f64, Error> {
        let signal = self.signal(name)?;
        self.read(signal)
    }

    /// Reads a variable; a Boolean is 0 or 1, a text is no number.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn read(&mut self, signal: Signal) -> Result<f64, Error> {
        Ok(self.instance.get(signal.kind, signal.reference)?.as_f64().unwrap_or(f64::NAN))
    }

    /// One step of `size` s.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn step(&mut self, from: f64, size: f64) -> Result<(), Error> {
        match self.instance.do_step(from, size, true) {
            Status::Ok | Status::Warning => Ok(()),
            status => Err(Error::Step {
                unit: self.instance.name().to_owned(),
                time: from,
                size,
                status: status.to_string(),
                log: self.instance.log().iter().map(|line| line.to_string()).collect(),
            }),
        }
    }
}
