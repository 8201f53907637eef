//! The nominal model: the scenario that the data set names, with its `[set]`, and the units on the bench.

use crate::error::{Error, Notice};
use crate::opened::{model, open, text};
use crate::rigs::acrobot::bench::Bench;
use crate::rigs::acrobot::candidates::{Attribute, name, names};
use crate::rigs::acrobot::correction::wiring::strip;
use crate::rigs::acrobot::dataset::{DataSet, lines, nominal};
use crate::rigs::acrobot::parameters::{self, MOUNT};
use orchestrator::scenario::{Given, UnitEntry};
use orchestrator::{Fmu, Kind, Place, Scenario, Simulation, UnitPath, Value};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Inertias of links, kg·m², of the arms that steps were chosen with: from a bench-top arm's forearm to the paper's acrobot.
const USUAL: (f64, f64) = (0.02, 0.12);

/// The nominal model.
pub struct Model {
    /// The scenario with `[set]` applied.
    pub scenario: Scenario,
    /// The plant on the bench.
    pub plant: Arc<Bench>,
    /// The camera on the bench, unless nobody looks.
    pub camera: Option<Arc<Bench>>,
    numbers: BTreeMap<String, f64>,
    units: BTreeMap<String, String>,
    /// Residual units of the scenario, which are left out.
    left_out: Vec<String>,
}

impl Model {
    /// Loads the scenario of a data set: a path beside the data set, or the name of a shipped one.
    ///
    /// # Errors
    /// The scenario or a unit can't be loaded, or `[set]` names something that isn't there.
    pub fn load(data: &DataSet, units: &UnitPath) -> Result<Self, Error> {
        let mut scenario = nominal::scenario(&data.path, &data.manifest.scenario)?;
        let file = scenario.origin.clone();
        apply_set(&mut scenario, data)?;
        let left_out = strip(&mut scenario);
        // a value that no unit takes is told now, with its file, and not when the amended scenario is written
        Simulation::new(&scenario, units).map_err(|error| match error {
            orchestrator::Error::Scenario { place: Place::Override(given), what, expected } => {
                let name = given.split('=').next().unwrap_or_default().trim();
                set_error(data, name, format!("{what}: {expected}"))
            }
            other => model(other),
        })?;
        let (mut numbers, mut measures) = (BTreeMap::new(), BTreeMap::new());
        let mut benches = BTreeMap::new();
        for unit in &scenario.units {
            let fmu = open(&unit.fmu.value, file.parent().unwrap_or(Path::new("")), units)?;
            for variable in &fmu.description().variables {
                if let Some(start) = variable.start.as_ref().and_then(Value::as_f64) {
                    numbers.insert(format!("{}.{}", unit.name, variable.name), start);
                }
                if let Some(measure) = variable.unit.as_ref().filter(|measure| *measure != "1") {
                    measures.insert(format!("{}.{}", unit.name, variable.name), measure.clone());
                }
            }
            let values = set_values(unit, &fmu, data)?;
            for (name, value) in &values {
                let number = value.as_f64().map(|number| (format!("{}.{name}", unit.name), number));
                numbers.extend(number);
            }
            let bench = Bench::new(fmu, &values)?;
            bench.begins().map_err(|why| set_error(data, &unit.name, why))?;
            benches.insert(unit.name.clone(), Arc::new(bench));
        }
        let plant = benches
            .remove("plant")
            .ok_or_else(|| Error::Nominal(format!("{} has no unit `plant`", file.display())))?;
        Ok(Self { plant, camera: benches.remove("camera"), scenario, numbers, units: measures, left_out })
    }

    /// What a user should know of the nominal model.
    pub fn notices(&self, data: &DataSet) -> Vec<Notice> {
        let limit = self.number(parameters::LIMIT).filter(|limit| data.contact(*limit) > *limit);
        let beyond = limit.map(|limit| Notice {
            file: "dataset.toml".into(),
            line: 0,
            message: format!(
                "the arm moves on beyond plant.q2_max = {limit} rad, where the model's links touch: taken as no limit in the \
                 comparison (an arm that turns over wants `\"plant.q2_max\" = 1e9` in [set])"
            ),
        });
        self.without_residual(data).into_iter().chain(beyond).collect()
    }

    /// Says that residual units of the scenario are left out, where there are any.
    fn without_residual(&self, data: &DataSet) -> Option<Notice> {
        let message = format!(
            "{} holds the correction of an earlier residual ({}); it is left out of the comparison, and fitted anew if a residual remains",
            data.manifest.scenario,
            self.left_out.join(", ")
        );
        (!self.left_out.is_empty()).then(|| Notice { file: "dataset.toml".into(), line: 0, message })
    }

    /// How heavy the arm is against those that steps of torques are given for: 1 where the inertia of its lighter link is within
    /// `USUAL`. The same machine with all inertias, torques and weights a thousandth moves in the same way.
    pub fn inertia_scale(&self) -> f64 {
        let inertias = names(Attribute::LinkInertia).filter_map(|name| self.number(name));
        let least = inertias.fold(f64::INFINITY, f64::min);
        if least > 0.0 && least.is_finite() { least / least.clamp(USUAL.0, USUAL.1) } else { 1.0 }
    }

    /// Fastest unstable pole at the upright, 1/s: the square root of the largest eigenvalue of M⁻¹ ∂g/∂q, (12). `None` where there is none. Written
    /// out here since `mechanics` linearises on the balance manifold of an arm with all its θ, which a scenario need not have.
    pub fn growth(&self) -> Option<f64> {
        let theta = |k: usize| self.number(&format!("plant.theta_{k}"));
        let (m11, m12, m22) = (theta(1)? + theta(2)?, theta(7)? + theta(8)?, theta(5)?);
        let (g1, g2) = (theta(9)?, theta(10)?);
        let det = m11 * m22 - m12 * m12;
        let half = 0.5 * (m22 * g1 + m11 * g2) / det;
        let largest = half + libm::sqrt((half * half - g1 * g2 / det).max(0.0));
        (det > 0.0 && largest > 0.0).then(|| libm::sqrt(largest))
    }

    /// Frames a second, or fields where the camera is interlaced.
    pub fn frame_rate(&self) -> f64 {
        self.number(parameters::FRAME_RATE).unwrap_or(30.0) * if self.interlaced() { 2.0 } else { 1.0 }
    }

    /// The camera's frames are fields of half the rows.
    pub fn interlaced(&self) -> bool {
        self.number(parameters::INTERLACED).is_some_and(|value| value > 0.5)
    }

    /// Units of all variables that have one.
    pub fn units(&self) -> &BTreeMap<String, String> {
        &self.units
    }

    /// Nominal value of a variable, as a number.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.numbers.get(name).copied()
    }
}

/// The file that states `[set]`.
fn manifest_of(data: &DataSet) -> PathBuf {
    data.path.join("dataset.toml")
}

/// An error of `[set]`.
fn set_error(data: &DataSet, name: &str, problem: String) -> Error {
    let path = manifest_of(data);
    let line = lines::line_of(&path, &format!("set.{name}"));
    Error::Manifest { path, line, problem: format!("[set] {name}: {problem}") }
}

/// Applies `[set]` of a data set to its scenario.
fn apply_set(scenario: &mut Scenario, data: &DataSet) -> Result<(), Error> {
    let mut set = |name: &str, value: &str| {
        scenario.set(name, value).map_err(|error| set_error(data, name, error.to_string()))
    };
    for (name, value) in &data.manifest.set {
        set(name, &text(value))?;
    }
    // a mount that is said to be turned is one that the vision knows of; what is no angle is refused under its own name
    let angle = |roll: &String| roll.parse::<f64>().is_ok_and(f64::is_finite);
    let roll = data.manifest.set.get(name(Attribute::CameraRoll)).map(text).filter(angle);
    if let (Some(roll), None) = (roll, data.manifest.set.get(MOUNT)) {
        set(MOUNT, &roll)?;
    }
    Ok(())
}

/// The values that the scenario sets in a unit, each of its variable's type.
fn set_values(unit: &UnitEntry, fmu: &Fmu, data: &DataSet) -> Result<BTreeMap<String, Value>, Error> {
    let mut values = BTreeMap::new();
    for (name, given) in &unit.set {
        let variables = &fmu.description().variables;
        let kind = variables.iter().find(|variable| variable.name == *name).map(|variable| variable.kind);
        let full = format!("{}.{name}", unit.name);
        let Some(kind) = kind else {
            return Err(set_error(data, &full, format!("{} has no such variable", unit.fmu.value)));
        };
        let value =
            read(kind, &given.value).ok_or_else(|| set_error(data, &full, format!("not of type {kind}")))?;
        values.insert(name.clone(), value);
    }
    Ok(values)
}

/// A value of a scenario in the type of its variable.
fn read(kind: Kind, given: &Given) -> Option<Value> {
    match given {
        Given::Text(text) => Value::parse(kind, text),
        Given::Toml(value) => match value {
            toml::Value::Float(x) => Value::Real(*x).cast(kind),
            toml::Value::Integer(i) => match kind {
                Kind::Real => Some(Value::Real(*i as f64)),
                _ => Value::Integer(i32::try_from(*i).ok()?).cast(kind),
            },
            toml::Value::Boolean(b) => Value::Boolean(*b).cast(kind),
            toml::Value::String(s) => Some(Value::String(s.clone())),
            _ => None,
        },
    }
}
