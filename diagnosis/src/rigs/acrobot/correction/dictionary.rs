//! The terms that a correction may have, and what they are along a motion: asked of the residual unit itself.

use crate::error::Error;
use crate::opened::open;
use crate::rigs::acrobot::bench::Bench;
use crate::rigs::acrobot::correction::policy::CORRECTION;
use crate::rigs::acrobot::residual::forced_torques::Pair;
use crate::rigs::acrobot::residual::trajectory::State;
use orchestrator::{UnitPath, Value};
use std::collections::BTreeMap;
use std::path::Path;

/// File of the residual unit.
pub const UNIT: &str = "acrobot_residual.fmu";

/// What a term follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Follows {
    /// Nothing: it is there all the time.
    Nothing,
    /// The angle of its axis.
    Angle,
    /// The rate of its axis.
    Rate,
    /// The rate of its axis where that is small: it stands there once for each rate over which it may fall.
    SmallRate,
}

/// Terms of an axis: stem of the coefficient, its unit, what it follows, and a phrase.
const TERMS: &[(&str, &str, Follows, &str)] = &[
    ("bias", "N·m", Follows::Nothing, "a constant"),
    ("spring", "N·m/rad", Follows::Angle, "in proportion to the angle"),
    ("even", "N·m/rad²", Follows::Angle, "with the square of the angle"),
    ("stiff", "N·m/rad³", Follows::Angle, "with the cube of the angle"),
    ("damp", "N·m·s/rad", Follows::Rate, "in proportion to the rate"),
    ("drag", "N·m·s²/rad²", Follows::Rate, "with the square of the rate and its sign"),
    ("stick", "N·m", Follows::Rate, "with the sign of the rate"),
    ("stribeck", "N·m", Follows::SmallRate, "with the sign of the rate, at small rates only"),
];
const AXES: [(&str, &str, &str); 2] =
    [("roll", "on link 1", "angle q1, rate dq1"), ("joint", "at the joint", "angle q2 - q1, rate dq2 - dq1")];

/// A term of the dictionary.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Its coefficient in the residual unit.
    pub coefficient: String,
    /// Rate over which it falls, with its parameter, where it has one.
    pub slow: Option<(String, f64)>,
    /// It acts at the joint, and follows what the links do against each other; else on link 1.
    pub joint: bool,
    /// What it follows.
    pub follows: Follows,
    /// Unit of the coefficient.
    pub measure: String,
    /// In words.
    pub phrase: String,
}

/// All terms.
pub fn entries() -> Vec<Entry> {
    let mut all = Vec::new();
    for (axis, place, of) in AXES {
        for &(stem, measure, follows, phrase) in TERMS {
            let entry = |slow: Option<f64>| Entry {
                coefficient: format!("{stem}_{axis}"),
                slow: slow.map(|slow| (format!("slow_{axis}"), slow)),
                joint: axis == AXES[1].0,
                follows,
                measure: measure.to_owned(),
                phrase: format!("torque {place} {phrase} ({of})"),
            };
            match follows {
                Follows::SmallRate => all.extend(CORRECTION.slow.map(|slow| entry(Some(slow)))),
                _ => all.push(entry(None)),
            }
        }
    }
    all
}

/// Where angles are measured from, and how far the data went: parameters of the residual unit.
pub fn covered(states: &[Vec<State>]) -> Vec<(String, f64)> {
    let mut all = Vec::new();
    for (axis, of) in [
        ("roll", (|s: &State| (s[0], s[2])) as fn(&State) -> (f64, f64)),
        ("joint", |s: &State| (s[1] - s[0], s[3] - s[2])),
    ] {
        let seen = || states.iter().flatten().map(of);
        let mean = seen().map(|(angle, _)| angle).sum::<f64>() / (seen().count().max(1) as f64);
        // springs of links that are upright or hang: from the nearest upright or hanging angle
        let centre = (mean / std::f64::consts::PI).round() * std::f64::consts::PI;
        let most = |f: &dyn Fn((f64, f64)) -> f64| {
            let most = seen().map(f).fold(0.0, f64::max);
            (most * 1e3).ceil() / 1e3
        };
        all.push((format!("centre_{axis}"), centre));
        all.push((format!("reach_{axis}"), most(&|(angle, _)| (angle - centre).abs())));
        all.push((format!("speed_{axis}"), most(&|(_, rate)| rate.abs())));
    }
    all
}

/// Values of each entry's term along each cell.
///
/// # Errors
/// The residual unit isn't there or failed.
pub fn along(
    entries: &[Entry],
    covered: &[(String, f64)],
    states: &[Vec<State>],
    units: &UnitPath,
) -> Result<Vec<Vec<Vec<Pair>>>, Error> {
    let fixed: BTreeMap<String, Value> =
        covered.iter().map(|(name, value)| (name.clone(), Value::Real(*value))).collect();
    let bench = Bench::new(open(UNIT, Path::new(""), units)?, &fixed)?;
    let inputs = ["q1", "q2", "dq1", "dq2"].map(|name| bench.reference(name));
    let inputs: Vec<u32> = inputs.into_iter().collect::<Result<_, _>>()?;
    let outputs = [bench.reference("roll")?, bench.reference("joint")?];
    let failed = |error: orchestrator::Error| Error::Model(error.to_string());
    let mut all: Vec<Vec<Vec<Pair>>> = vec![Vec::with_capacity(entries.len()); states.len()];
    for entry in entries {
        let mut settings = vec![bench.setting(&entry.coefficient, 1.0)?];
        if let Some((name, slow)) = &entry.slow {
            settings.push(bench.setting(name, *slow)?);
        }
        bench.initialising(&settings, |instance| {
            for (cell, states) in all.iter_mut().zip(states) {
                let mut torques = Vec::with_capacity(states.len());
                for state in states {
                    instance.set_real(&inputs, state).map_err(failed)?;
                    let mut pair = [0.0; 2];
                    instance.get_real(&outputs, &mut pair).map_err(failed)?;
                    torques.push(pair);
                }
                cell.push(torques);
            }
            Ok(())
        })?;
    }
    Ok(all)
}
