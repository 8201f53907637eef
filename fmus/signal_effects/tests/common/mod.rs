//! A signal unit driven by hand through [`Model`], for all tests of this crate.
#![allow(dead_code)] // each test file uses its part

use fmi2_export::{Experiment, Log, Model, Step};
use signal_effects::{Effects, SignalEffects, Variables};

/// A master that wants no messages.
pub struct Silence;
impl Log for Silence {
    fn log(&mut self, _: &'static str, _: &dyn Fn() -> String) {}
}

/// A unit, its variables and the time.
#[derive(Clone)]
pub struct Rig {
    pub unit: SignalEffects,
    pub variables: Variables,
    pub time: f64,
}

impl Rig {
    /// Initialised at `start` with `u`, after `change`.
    pub fn new(start: f64, u: f64, change: impl FnOnce(&mut Variables)) -> Rig {
        let mut rig = Rig { unit: SignalEffects::default(), variables: Variables::default(), time: start };
        rig.variables.inputs.value = u;
        change(&mut rig.variables);
        let experiment = Experiment { start, stop: None, tolerance: None };
        rig.unit.initialize(&mut rig.variables, &experiment, &mut Silence).expect("legal");
        rig
    }

    /// Steps to a time with this input; answers the output.
    pub fn step(&mut self, to: f64, u: f64) -> f64 {
        self.step_with(to, u, &[])
    }

    /// The same with rates of the inputs.
    pub fn step_with(&mut self, to: f64, u: f64, input_rates: &[(&'static str, f64)]) -> f64 {
        self.variables.inputs.value = u;
        let step = Step { from: self.time, to, input_rates };
        self.unit.step(&mut self.variables, &step, &mut Silence).expect("legal");
        self.time = to;
        self.y()
    }

    pub fn y(&self) -> f64 {
        self.variables.outputs.value
    }
}

/// All effects at once.
pub fn busy(effects: &mut Effects) {
    effects.delay = 0.0512;
    effects.saturation = 0.7;
    effects.rate_limit = 9.0;
    effects.lag = 0.01;
    effects.gain = 0.9;
    effects.bias = 0.01;
}

/// Numbers of no pattern between −1 and 1.
pub fn scattered(k: u32) -> f64 {
    let mixed = (u64::from(k) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}
