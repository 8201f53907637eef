//! A plant driven by hand through [`Model`], for all tests of this crate.

use fmi2_export::{Experiment, Log, Model, ModelError, Step};
use plant::{Plant, Variables};

/// A master that wants no messages.
pub struct Silence;
impl Log for Silence {
    fn log(&mut self, _: &'static str, _: &dyn Fn() -> String) {}
}

/// A master that keeps all messages.
#[derive(Default)]
pub struct Kept(pub Vec<(&'static str, String)>);
impl Log for Kept {
    fn log(&mut self, category: &'static str, message: &dyn Fn() -> String) {
        self.0.push((category, message()));
    }
}

/// Far out of reach.
pub const NO_CONTACT: f64 = 1e9;
/// The start state of reference.py's "wild" runs.
pub const WILD: [f64; 4] = [0.5, -1.0, 1.0, -2.0];

/// A plant and its variables.
#[derive(Clone)]
pub struct Rig {
    pub plant: Plant,
    pub variables: Variables,
    pub time: f64,
}

impl Rig {
    /// Initialised at t = 0 after `change`.
    pub fn new(change: impl FnOnce(&mut Variables)) -> Rig {
        Rig::try_new(change).unwrap()
    }

    pub fn try_new(change: impl FnOnce(&mut Variables)) -> Result<Rig, ModelError> {
        let mut rig = Rig { plant: Plant::default(), variables: Variables::default(), time: 0.0 };
        change(&mut rig.variables);
        let experiment = Experiment { start: 0.0, stop: None, tolerance: None };
        rig.plant.initialize(&mut rig.variables, &experiment, &mut Silence)?;
        Ok(rig)
    }

    /// At a start state, with contact out of reach.
    pub fn at(start: [f64; 4], change: impl FnOnce(&mut Variables)) -> Rig {
        Rig::new(|variables| {
            let parameters = &mut variables.parameters;
            parameters.contact_angle = NO_CONTACT;
            [
                parameters.link1_start,
                parameters.link2_start,
                parameters.link1_start_rate,
                parameters.link2_start_rate,
            ] = start;
            change(variables);
        })
    }

    pub fn step(&mut self, to: f64) {
        self.step_with(to, &[]);
    }

    pub fn step_with(&mut self, to: f64, input_rates: &[(&'static str, f64)]) {
        let step = Step { from: self.time, to, input_rates };
        self.plant.step(&mut self.variables, &step, &mut Silence).unwrap();
        self.time = to;
    }

    /// To `end` in `steps` equal steps.
    pub fn run(&mut self, end: f64, steps: u32) {
        let start = self.time;
        for k in 1..=steps {
            self.step(start + (end - start) * f64::from(k) / f64::from(steps));
        }
    }

    pub fn state(&self) -> [f64; 4] {
        let outputs = &self.variables.outputs;
        [outputs.link1_angle, outputs.link2_angle, outputs.link1_rate, outputs.link2_rate]
    }

    /// Every number that can be seen, as bits.
    pub fn bits(&self) -> Vec<u64> {
        let (outputs, locals) = (&self.variables.outputs, &self.variables.locals);
        let mut seen = self.state().to_vec();
        seen.extend([outputs.applied_torque, outputs.place, locals.energy]);
        seen.extend([locals.link1_acceleration, locals.link2_acceleration]);
        seen.into_iter().map(f64::to_bits).collect()
    }
}

/// The largest difference of two states.
pub fn distance(a: [f64; 4], b: [f64; 4]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Friction, and an actuator with all its effects.
pub fn busy(variables: &mut Variables) {
    let effects = &mut variables.effects;
    effects.viscous.joint = 0.01;
    effects.coulomb.roll = 0.01;
    effects.delay.time = 0.0512;
    effects.saturation.limit = 0.7;
    effects.rate_limit.limit = 9.0;
    effects.lag.time = 0.01;
    effects.gain.factor = 0.9;
    effects.bias.torque = 0.01;
}
