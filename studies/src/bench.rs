//! What studies measure with: the closed loop in memory, and single units at rest or in motion, all through FMI.

use crate::{Error, Unit};
use orchestrator::{MemoryRecorder, Quiet, Scenario, Simulation, UnitPath};

/// Where the units are, and how to run them.
#[derive(Debug, Clone)]
pub struct Bench {
    units: UnitPath,
    /// `unit.variable`, and the factor by which it acts otherwise than it is set.
    faults: Vec<(String, f64)>,
}

impl Bench {
    /// A bench with the units of a path.
    pub fn new(units: UnitPath) -> Self {
        Self { units, faults: Vec::new() }
    }

    /// A bench with a fault in a unit: `camera.s2` with −1 is a camera whose thin prism acts with the wrong sign. With
    /// it a test shows that a claim can fail; whatever a study gives to that variable is multiplied on its way.
    #[must_use]
    pub fn with_fault(mut self, variable: &str, factor: f64) -> Self {
        self.faults.push((variable.to_owned(), factor));
        self
    }

    /// The factor of a variable: 1 without a fault.
    pub(crate) fn factor(&self, variable: &str) -> f64 {
        self.faults.iter().filter(|(name, _)| name == variable).map(|(_, factor)| factor).product()
    }

    /// A shipped scenario with values that differ from its own.
    pub fn scenario(&self, name: &str, set: &[(&str, &str)]) -> Result<Scenario, Error> {
        let mut scenario = scenarios::load(name)?;
        for (variable, value) in set {
            let factor = self.factor(variable);
            match value.parse::<f64>() {
                Ok(number) if factor != 1.0 => scenario.set(variable, &(factor * number).to_string())?,
                _ => scenario.set(variable, value)?,
            }
        }
        Ok(scenario)
    }

    /// A fresh instance of a unit by itself, e.g. of `acrobot_camera`.
    ///
    /// # Errors
    /// No folder holds it, or it can't be loaded.
    pub fn unit(&self, model: &str) -> Result<Unit, Error> {
        let file = format!("{model}.fmu");
        let folders = self.units.folders();
        let path = folders.iter().map(|folder| folder.join(&file)).find(|path| path.is_file());
        let looked = || folders.iter().map(|f| f.display().to_string()).collect::<Vec<_>>().join(", ");
        let path = path.ok_or_else(|| Error::NoUnit { file: file.clone(), looked: looked() })?;
        let prefix = format!("{}.", model.trim_start_matches("acrobot_"));
        let faults =
            self.faults.iter().filter_map(|(name, factor)| Some((name.strip_prefix(&prefix)?, *factor)));
        Unit::new(&self.units.open(&path)?, faults.map(|(name, factor)| (name.to_owned(), factor)).collect())
    }

    /// A simulation that is ready to run.
    pub fn simulation(&self, scenario: &Scenario) -> Result<Simulation, Error> {
        Ok(Simulation::new(scenario, &self.units)?)
    }

    /// Runs a scenario to its end and keeps every recorded signal.
    pub fn run(&self, scenario: &Scenario) -> Result<MemoryRecorder, Error> {
        let mut results = MemoryRecorder::new();
        self.simulation(scenario)?.run(&mut results, &mut Quiet)?;
        Ok(results)
    }
}
