//! What the tests share: a still robot before the camera, and the manifold (13).

use camera::{Camera, Variables};
use fmi2_export::{Experiment, Log, Model, Step};

pub struct Silent;
impl Log for Silent {
    fn log(&mut self, _: &'static str, _: &dyn Fn() -> String) {}
}

pub const EXPERIMENT: Experiment = Experiment { start: 0.0, stop: None, tolerance: None };

/// Sets some variables.
pub type Change = fn(&mut Variables);

/// Fresh variables, changed.
pub fn variables(change: impl Fn(&mut Variables)) -> Variables {
    let mut variables = Variables::default();
    change(&mut variables);
    variables
}

/// Outputs after frame 0 of a robot at rest.
pub fn still(variables: &Variables, q1: f64, q2: f64) -> camera::variables::Outputs {
    let mut variables = variables.clone();
    variables.inputs.link1_angle = q1;
    variables.inputs.link2_angle = q2;
    let mut camera = Camera::default();
    camera.initialize(&mut variables, &EXPERIMENT, &mut Silent).expect("these parameters are legal");
    variables.outputs
}

/// Initialised camera.
pub fn started(variables: &mut Variables) -> Camera {
    let mut camera = Camera::default();
    camera.initialize(variables, &EXPERIMENT, &mut Silent).expect("these parameters are legal");
    camera
}

/// One communication step with the pose at its end.
pub fn step_to(camera: &mut Camera, variables: &mut Variables, from: f64, to: f64, pose: [f64; 4]) {
    let inputs = &mut variables.inputs;
    [inputs.link1_angle, inputs.link2_angle, inputs.link1_rate, inputs.link2_rate] = pose;
    let step = Step { from, to, input_rates: &[] };
    camera.step(variables, &step, &mut Silent).expect("the step is legal");
}

/// q1 on the manifold (13) with the paper's θ9 = 4.779, θ10 = 1.880.
pub fn manifold(q2: f64) -> f64 {
    -(1.880f64 / 4.779 * q2.sin()).asin()
}

/// Errors (actual − estimated) along the manifold: one camera sees `n` poses, a frame each, from the upright to +q2
/// and from the upright to −q2, so that tracking starts where the paper starts. `None` where not valid.
pub fn along_manifold(base: &Variables, n: usize) -> Vec<(f64, Option<(f64, f64)>)> {
    let mut errors = Vec::new();
    for sign in [-1.0, 1.0] {
        let mut variables = base.clone();
        let mut camera = started(&mut variables);
        let period = 1.0 / variables.sensor.frame_rate;
        for i in 0..n {
            let q2 = sign * 2.35 * i as f64 / (n - 1) as f64;
            let q1 = manifold(q2);
            let (from, to) = (i as f64 * period, (i + 1) as f64 * period);
            // At rest during the exposure: the pose is reached at mid-step already.
            step_to(&mut camera, &mut variables, from, from + 0.5 * period, [q1, q2, 0.0, 0.0]);
            step_to(&mut camera, &mut variables, from + 0.5 * period, to, [q1, q2, 0.0, 0.0]);
            let out = &variables.outputs;
            let error = out.valid.then_some((q1 - out.link1_angle, q2 - out.link2_angle));
            errors.push((q2, error));
        }
    }
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    errors
}

pub fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut n) = (0.0, 0);
    for value in values {
        sum += value * value;
        n += 1;
    }
    (sum / f64::from(n)).sqrt()
}

pub fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |a, b| a.max(b.abs()))
}

/// A small random generator for test poses (xorshift), so that the tests need no crate for it.
pub struct Random(pub u64);
impl Random {
    pub fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }
}
