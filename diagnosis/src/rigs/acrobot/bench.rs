//! Instances of one unit on a test bench: set up, driven and read through FMI, reused from a pool.
//!
//! An instance is reset before each use, so results don't depend on which one a thread gets.

use crate::dynamics::worker::typed;
use crate::error::Error;
use orchestrator::fmu::{Instance, Status};
use orchestrator::{Fmu, Kind, Value};
use std::collections::BTreeMap;
use std::sync::Mutex;

/// A unit with the parameters of the nominal model.
pub struct Bench {
    fmu: Fmu,
    nominal: Vec<(u32, Value)>,
    references: BTreeMap<String, (u32, Kind)>,
    pool: Mutex<Vec<Instance>>,
}

/// A parameter value by its reference.
pub type Setting = (u32, Value);

fn failed(error: impl std::fmt::Display) -> Error {
    Error::Model(error.to_string())
}

impl Bench {
    /// A bench for a unit whose parameters differ from their start values by `nominal`.
    ///
    /// # Errors
    /// A name is no variable of the unit.
    pub fn new(fmu: Fmu, nominal: &BTreeMap<String, Value>) -> Result<Self, Error> {
        let references: BTreeMap<String, (u32, Kind)> = fmu
            .description()
            .variables
            .iter()
            .map(|variable| (variable.name.clone(), (variable.reference, variable.kind)))
            .collect();
        let mut bench = Self { fmu, nominal: Vec::new(), references, pool: Mutex::new(Vec::new()) };
        for (name, value) in nominal {
            let reference = bench.reference(name)?;
            bench.nominal.push((reference, value.clone()));
        }
        Ok(bench)
    }

    /// The unit.
    pub fn fmu(&self) -> &Fmu {
        &self.fmu
    }

    /// What is given beside the unit's start values: places in its description, and values.
    pub fn given(&self) -> impl Iterator<Item = (usize, &Value)> {
        let variables = &self.fmu.description().variables;
        let place = |reference: u32, value: &Value| {
            variables.iter().position(|known| known.reference == reference && known.kind == value.kind())
        };
        self.nominal.iter().filter_map(move |(reference, value)| Some((place(*reference, value)?, value)))
    }

    /// Value reference of a variable.
    ///
    /// # Errors
    /// There is no such variable.
    pub fn reference(&self, name: &str) -> Result<u32, Error> {
        self.references
            .get(name)
            .map(|(reference, _)| *reference)
            .ok_or_else(|| Error::Model(format!("{} has no variable `{name}`", self.fmu.path().display())))
    }

    /// A setting in the type that the variable has.
    ///
    /// # Errors
    /// There is no such variable.
    pub fn setting(&self, name: &str, value: f64) -> Result<Setting, Error> {
        let (reference, kind) = self
            .references
            .get(name)
            .ok_or_else(|| Error::Model(format!("{} has no variable `{name}`", self.fmu.path().display())))?;
        Ok((*reference, typed(*kind, value)))
    }

    /// Does something with an instance that stays in initialization mode, where start values and inputs may be set
    /// again and again and outputs follow (FMI 2.0, section 4.2.4).
    ///
    /// # Errors
    /// The unit refused something.
    pub fn initialising<R>(
        &self,
        settings: &[Setting],
        job: impl FnOnce(&mut Instance) -> Result<R, Error>,
    ) -> Result<R, Error> {
        let mut instance = self.instance(settings)?;
        instance.setup_experiment(0.0, None).map_err(failed)?;
        instance.enter_initialization().map_err(failed)?;
        let result = job(&mut instance);
        self.keep(instance, result.is_ok());
        result
    }

    /// Whether the unit begins with the nominal values.
    ///
    /// # Errors
    /// What it says of one that it refuses, or of several together.
    pub fn begins(&self) -> Result<(), String> {
        let begun = self.initialising(&[], |instance| instance.exit_initialization().map_err(failed));
        begun.map_err(|error| if let Error::Model(why) = error { why } else { error.to_string() })
    }

    /// An instance as it begins: one of the pool, reset, or a new one.
    fn instance(&self, settings: &[Setting]) -> Result<Instance, Error> {
        let kept = self.pool.lock().ok().and_then(|mut pool| pool.pop());
        let mut instance = match kept {
            Some(instance) => instance,
            None => self.fmu.instantiate("bench").map_err(failed)?,
        };
        instance.reset().map_err(failed)?;
        // one call sets all real ones, in their order: the last value of a variable counts
        let (mut references, mut values) = (Vec::new(), Vec::new());
        for (reference, value) in self.nominal.iter().chain(settings) {
            if let Value::Real(value) = value {
                references.push(*reference);
                values.push(*value);
            } else {
                instance.set(*reference, value).map_err(failed)?;
            }
        }
        instance.set_real(&references, &values).map_err(failed)?;
        Ok(instance)
    }

    /// Puts an instance that has not failed back into the pool.
    fn keep(&self, instance: Instance, sound: bool) {
        if sound && let Ok(mut pool) = self.pool.lock() {
            pool.push(instance);
        }
    }

    /// Whether inputs may run along lines within a step.
    pub fn interpolates(&self) -> bool {
        self.fmu.description().co_simulation.can_interpolate_inputs
    }

    /// Nominal value of a real variable; 0 where neither scenario nor unit says.
    pub fn nominal(&self, reference: u32) -> f64 {
        let given = self.nominal.iter().find(|(known, _)| *known == reference).map(|(_, value)| value);
        let start = || {
            let variables = &self.fmu.description().variables;
            variables.iter().find(|v| v.reference == reference && v.kind == Kind::Real)?.start.as_ref()
        };
        given.or_else(start).and_then(Value::as_f64).unwrap_or(0.0)
    }

    /// Runs something on an instance that was set up with the nominal parameters and `settings`, at `start`.
    ///
    /// # Errors
    /// The unit refused something.
    pub fn run<R>(
        &self,
        settings: &[Setting],
        start: f64,
        job: impl FnOnce(&mut Instance) -> Result<R, Error>,
    ) -> Result<R, Error> {
        let mut instance = self.instance(settings)?;
        instance.setup_experiment(start, None).map_err(failed)?;
        instance.enter_initialization().map_err(failed)?;
        instance.exit_initialization().map_err(failed)?;
        let result = job(&mut instance);
        self.keep(instance, result.is_ok());
        result
    }
}

/// A step that must succeed.
///
/// # Errors
/// It didn't.
pub fn step(instance: &mut Instance, from: f64, size: f64) -> Result<(), Error> {
    // a thread that is in steps at every look of half a minute would pass for one that does not come back
    orchestrator::beat();
    match instance.do_step(from, size, true) {
        Status::Ok | Status::Warning => Ok(()),
        status => {
            let said = instance.log().last().map(|line| format!(": {}", line.text)).unwrap_or_default();
            Err(Error::Model(format!("unit step at {from} s of {size} s: {status}{said}")))
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::path::Path;

    /// The plant with its own values, as `cargo xtask pack` makes it.
    pub(in crate::rigs::acrobot) fn packed_plant() -> Bench {
        let packed = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/fmus/acrobot_plant.fmu");
        Bench::new(Fmu::open(packed).expect("it was packed"), &BTreeMap::new()).expect("no names")
    }

    #[test]
    fn law_each_step_says_that_work_goes_on() {
        let bench = packed_plant();
        let said = |instance: &mut Instance| {
            let before = orchestrator::beats();
            (0..7).try_for_each(|k| step(instance, 0.01 * f64::from(k), 0.01))?;
            Ok(orchestrator::beats() - before)
        };
        assert_eq!(bench.run(&[], 0.0, said).expect("it steps"), 7);
    }
}
