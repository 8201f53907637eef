//! What the actuator makes of the commanded torque, run by run: its lag, delay and rate limit need time to act, and
//! show in no state by itself.

use super::Perturbation;
use super::settings::settings;
use crate::error::Error;
use crate::rigs::acrobot::bench::{Bench, Setting, step};
use crate::rigs::acrobot::candidates::{Attribute, Candidate, Side, names, variable};
use crate::rigs::acrobot::dataset::DataSet;
use crate::rigs::acrobot::residual::policy::RESIDUAL;
use orchestrator::Value;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

/// Parameters of the plant with an attribute.
pub fn references(bench: &Bench, attribute: Attribute) -> Vec<u32> {
    names(attribute).filter_map(|name| bench.reference(variable(name)).ok()).collect()
}

/// What a parameter of the plant is under these settings: that of the nominal model where none says otherwise.
pub fn value(bench: &Bench, settings: &[Setting], reference: u32) -> f64 {
    let given = settings.iter().rev().find(|(own, _)| *own == reference);
    given.and_then(|(_, value)| value.as_f64()).unwrap_or_else(|| bench.nominal(reference))
}

/// All parts of the actuator before gain and bias, as if there were none.
pub fn passing(bench: &Bench) -> impl Iterator<Item = Setting> {
    references(bench, Attribute::InActuator).into_iter().map(|reference| (reference, Value::Real(0.0)))
}

/// Gain and bias, which come after those parts, without effect.
pub fn plain(bench: &Bench) -> impl Iterator<Item = Setting> {
    let all = |attribute: Attribute, value: f64| {
        references(bench, attribute).into_iter().map(move |reference| (reference, Value::Real(value)))
    };
    all(Attribute::Gain, 1.0).chain(all(Attribute::Bias, 0.0))
}

/// Torques behind the actuator's parts that take time, per run: before gain and bias.
#[derive(Debug)]
pub struct Applied {
    runs: Vec<(Vec<f64>, Vec<f64>)>,
}

impl Applied {
    /// Torque of a run at a time, held between readings.
    pub fn at(&self, run: usize, time: f64) -> f64 {
        let (times, values) = &self.runs[run];
        let place = times.partition_point(|t| *t <= time);
        values.get(place).or(values.last()).copied().unwrap_or(0.0)
    }
}

/// Commanded torque in, applied torque out.
pub struct Actuator {
    commands: Vec<Vec<(f64, f64)>>,
    tau: u32,
    applied: u32,
    angle: u32,
    contact: u32,
    known: Mutex<BTreeMap<Vec<u64>, Arc<Applied>>>,
}

impl Actuator {
    /// The commanded torques of all runs.
    ///
    /// # Errors
    /// The unit lacks a variable.
    pub fn new(data: &DataSet, bench: &Bench) -> Result<Self, Error> {
        let commands = (data.runs.iter())
            .map(|run| {
                let Some(log) = &run.controller else { return Vec::new() };
                let tau = log.column("tau").unwrap_or(&[]);
                log.time.iter().copied().zip(tau.iter().copied()).filter(|(_, tau)| tau.is_finite()).collect()
            })
            .collect();
        let reference = |name: &str| bench.reference(name);
        Ok(Self {
            commands,
            tau: reference("tau")?,
            applied: reference("tau_applied")?,
            angle: reference("q2_0")?,
            contact: reference("q2_max")?,
            known: Mutex::default(),
        })
    }

    /// What arrives at a point; `None` where every part of the actuator that takes time is off.
    ///
    /// # Errors
    /// The unit failed.
    pub fn applied(
        &self,
        bench: &Bench,
        candidates: &[Candidate],
        point: &[f64],
        moved: Option<Perturbation>,
    ) -> Result<Option<Arc<Applied>>, Error> {
        let all = settings(bench, candidates, Side::Plant, point, moved)?;
        let now = |reference: u32| value(bench, &all, reference);
        if references(bench, Attribute::OverTime).into_iter().all(|reference| now(reference) == 0.0) {
            return Ok(None);
        }
        let chain = references(bench, Attribute::InActuator).into_iter();
        let own: Vec<Setting> =
            chain.map(|reference| (reference, Value::Real(now(reference)))).chain(plain(bench)).collect();
        let key = key(&own);
        if let Some(known) = self.known.lock().ok().and_then(|known| known.get(&key).cloned()) {
            return Ok(Some(known));
        }
        let runs = self
            .commands
            .par_iter()
            .map(|commands| self.drive(bench, &own, commands))
            .collect::<Result<_, _>>()?;
        let applied = Arc::new(Applied { runs });
        if let Ok(mut known) = self.known.lock() {
            known.insert(key, applied.clone());
        }
        Ok(Some(applied))
    }

    /// Steps the unit through a run's torque. Where its links go meanwhile doesn't matter to the actuator, so they touch
    /// from the start: a state that is held needs no integration.
    fn drive(
        &self,
        bench: &Bench,
        own: &[Setting],
        commands: &[(f64, f64)],
    ) -> Result<(Vec<f64>, Vec<f64>), Error> {
        let Some(first) = commands.first() else { return Ok((Vec::new(), Vec::new())) };
        let mut all = own.to_vec();
        all.push((self.tau, Value::Real(first.1)));
        all.push((self.angle, Value::Real(1.0)));
        all.push((self.contact, Value::Real(0.5)));
        bench.run(&all, first.0, |instance| {
            let failed = |error: orchestrator::Error| Error::Model(error.to_string());
            let (mut times, mut values) = (Vec::new(), Vec::new());
            for pair in commands.windows(2) {
                let ((from, tau), (to, _)) = (pair[0], pair[1]);
                instance.set_real(&[self.tau], &[tau]).map_err(failed)?;
                let count = ((to - from) / RESIDUAL.step).ceil().max(1.0);
                for k in 0..count as usize {
                    let size = (to - from) / count;
                    if size <= 0.0 {
                        continue;
                    }
                    step(instance, from + k as f64 * size, size)?;
                    let mut value = [0.0];
                    instance.get_real(&[self.applied], &mut value).map_err(failed)?;
                    times.push(from + (k + 1) as f64 * size);
                    values.push(value[0]);
                }
            }
            Ok((times, values))
        })
    }
}

/// Settings as something to look up by.
pub fn key(settings: &[Setting]) -> Vec<u64> {
    let words = settings
        .iter()
        .flat_map(|(reference, value)| [u64::from(*reference), value.as_f64().unwrap_or(0.0).to_bits()]);
    words.collect()
}
