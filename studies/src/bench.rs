//! What studies measure with: the closed loop in memory, and single units at rest or in motion, all through FMI.

use crate::{Error, Unit};
use orchestrator::{MemoryRecorder, Quiet, Scenario, Simulation, UnitPath};

/// Where the units are, and how to run them.
#[derive(Debug, Clone)]
pub struct Bench {
    units: UnitPath,
}

impl Bench {
    /// A bench with the units of a path.
    pub fn new(units: UnitPath) -> Self {
        Self { units }
    }

    /// A shipped scenario with values that differ from its own.
    pub fn scenario(&self, name: &str, set: &[(&str, &str)]) -> Result<Scenario, Error> {
        let mut scenario = scenarios::load(name)?;
        for (variable, value) in set {
            scenario.set(variable, value)?;
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
        Unit::new(&self.units.open(&path)?)
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
