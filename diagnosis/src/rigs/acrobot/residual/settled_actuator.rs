//! What a slow actuator holds when a window begins. A lag of a twentieth of a second still remembers torques from before the window's
//! preroll, a rate limit from longer ago: the unit's actuator runs alone through them, beside links that are held.

use super::actuator::{key, plain, references, value};
use super::trajectory::{Drive, PREROLL};
use crate::error::Error;
use crate::rigs::acrobot::bench::{Bench, Setting, step};
use crate::rigs::acrobot::candidates::Attribute;
use crate::rigs::acrobot::residual::plant::policy::WINDOWS;
use crate::statistics::levels::ROWS;
use orchestrator::Value;
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Commands before a drive begins, s and N·m, each held to the next; and what actuators were found to hold after them.
#[derive(Debug, Default)]
pub struct Past {
    commands: Vec<(f64, f64)>,
    /// By the actuator's parameters: a search asks for the same ones with each start state and each torque.
    held: Mutex<BTreeMap<Vec<u64>, f64>>,
}

impl Past {
    /// With nothing found yet.
    pub fn of(commands: Vec<(f64, f64)>) -> Self {
        Self { commands, held: Mutex::default() }
    }

    /// What actuators were found to hold.
    fn known(&self) -> MutexGuard<'_, BTreeMap<Vec<u64>, f64>> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl PartialEq for Past {
    fn eq(&self, other: &Self) -> bool {
        self.commands == other.commands
    }
}

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
        let past = &*drive.past;
        if past.commands.is_empty() || !slow {
            return Ok(drive.before);
        }
        let chain: Vec<Setting> =
            self.chain.iter().map(|reference| (*reference, Value::Real(now(*reference)))).collect();
        let key = key(&chain);
        if let Some(torque) = past.known().get(&key) {
            return Ok(*torque);
        }
        let torque = self.run(plant, chain, &past.commands, drive.start())?;
        let mut known = past.known();
        if known.len() >= WINDOWS.remembered {
            known.clear();
        }
        known.insert(key, torque);
        Ok(torque)
    }

    /// Runs an actuator through commands to the end, s.
    fn run(
        &self,
        plant: &Bench,
        chain: Vec<Setting>,
        commands: &[(f64, f64)],
        end: f64,
    ) -> Result<f64, Error> {
        let (first, torque) = commands[0];
        let mut all = chain;
        all.extend(self.plain.iter().cloned().chain(self.held.iter().cloned()));
        all.extend([(self.before, Value::Real(torque)), (self.tau, Value::Real(torque))]);
        plant.run(&all, first, |instance| {
            let failed = |error: orchestrator::Error| Error::Model(error.to_string());
            let ends = commands[1..].iter().map(|(time, _)| *time).chain([end]);
            for ((from, torque), to) in commands.iter().zip(ends) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigs::acrobot::bench::tests::packed_plant;
    use crate::rigs::acrobot::residual::trajectory::Event;
    use std::sync::Arc;

    #[test]
    fn law_what_an_actuator_holds_is_the_same_whatever_was_asked_before() {
        let plant = packed_plant();
        let settling = Settling::of(&plant).expect("a plant");
        let commands = || Past::of(vec![(0.0, 1.0), (0.1, 0.0)]);
        let drive = |past: Past| {
            let event = Event { time: 0.2, tau: 0.0, tau_1: 0.0, rates: [0.0; 2], wanted: true };
            Drive { events: vec![event], before: 0.0, past: Arc::new(past) }
        };
        let lag = |time: f64| [plant.setting("T_act", time).expect("a parameter")];
        let before = |drive: &Drive, time: f64| settling.before(&plant, &lag(time), drive).expect("it steps");
        let kept = drive(commands());
        for time in [0.05, 0.1, 0.05, 0.1] {
            // a lag that stood at 1 has decayed for a tenth of a second; the unit's own exp is good to rounding
            assert!((before(&kept, time) - libm::exp(-0.1 / time)).abs() < 1e-12);
            assert_eq!(before(&kept, time), before(&drive(commands()), time));
        }
        assert_eq!(kept.past.known().len(), 2);
    }
}
