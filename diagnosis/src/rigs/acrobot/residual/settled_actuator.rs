//! What a slow actuator holds when a window begins. A lag of a twentieth of a second still remembers torques from before the window's
//! preroll, a rate limit from longer ago: the unit's actuator runs alone through them, beside links that are held.

use super::actuator::{plain, references, value};
use super::trajectory::{Drive, PREROLL};
use crate::error::Error;
use crate::rigs::acrobot::bench::{Bench, Setting, step};
use crate::rigs::acrobot::candidates::Attribute;
use crate::statistics::levels::ROWS;
use orchestrator::Value;

/// The plant's references that this needs.
#[derive(Debug, Clone)]
pub struct Settling {
    /// All parts of the actuator before gain and bias.
    chain: Vec<u32>,
    /// Parameters of the parts that take time, by reference.
    over_time: Vec<u32>,
    /// Gain and bias, which come after what is held, without effect.
    plain: Vec<Setting>,
    tau: u32,
    applied: u32,
    before: u32,
    /// With the links at an angle beyond their contact they are held, and need no integration.
    held: [Setting; 2],
}

impl Settling {
    /// Looks them up.
    ///
    /// # Errors
    /// The unit lacks one of them.
    pub fn of(plant: &Bench) -> Result<Self, Error> {
        Ok(Self {
            chain: references(plant, Attribute::InActuator),
            over_time: references(plant, Attribute::OverTime),
            plain: plain(plant).collect(),
            tau: plant.reference("tau")?,
            applied: plant.reference("tau_applied")?,
            before: plant.reference("tau_0")?,
            held: [
                (plant.reference("q2_0")?, Value::Real(1.0)),
                (plant.reference("q2_max")?, Value::Real(0.5)),
            ],
        })
    }

    /// The torque at which the actuator stands where a drive begins, N·m.
    ///
    /// # Errors
    /// The unit failed.
    pub fn before(&self, plant: &Bench, settings: &[Setting], drive: &Drive) -> Result<f64, Error> {
        let now = |reference: u32| value(plant, settings, reference);
        // what is quicker has settled in the preroll, to a millionth
        let slow = self.over_time.iter().any(|reference| now(*reference) > PREROLL / ROWS as f64);
        let Some((first, torque)) = drive.history.first().copied().filter(|_| slow) else {
            return Ok(drive.before);
        };
        let mut all: Vec<Setting> =
            self.chain.iter().map(|reference| (*reference, Value::Real(now(*reference)))).collect();
        all.extend(self.plain.iter().cloned().chain(self.held.iter().cloned()));
        all.extend([(self.before, Value::Real(torque)), (self.tau, Value::Real(torque))]);
        plant.run(&all, first, |instance| {
            let failed = |error: orchestrator::Error| Error::Model(error.to_string());
            let ends = drive.history[1..].iter().map(|(time, _)| *time).chain([drive.start()]);
            for ((from, torque), to) in drive.history.iter().zip(ends) {
                instance.set_real(&[self.tau], &[*torque]).map_err(failed)?;
                if to > *from {
                    step(instance, *from, to - from)?;
                }
            }
            let mut held = [0.0];
            instance.get_real(&[self.applied], &mut held).map_err(failed)?;
            Ok(held[0])
        })
    }
}
