//! Images through the camera unit: what it would find in frames taken at given poses.
//!
//! Each frame is a communication interval of its own. A tiny step first puts the arm where the exposure could begin,
//! so that frames need not follow one another; the rest of the interval is the cubic between two states.

use super::trajectory::State;
use crate::error::Error;
use crate::rigs::acrobot::bench::{Bench, Setting, step};
use crate::rigs::acrobot::candidates::{Attribute, name, variable};
use crate::rigs::acrobot::channels::{Channel, File, Measures, compared, count, names, places};
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::parameters;
use crate::rigs::acrobot::residual::policy::RESIDUAL;
use crate::statistics::levels::TASK;
use orchestrator::Value;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Centroids u1, v1, u2, v2, u3, v3 in px, area1, area2, area3 in px, angles q1 and q2 read off them in rad.
pub type Seen = [f64; COLUMNS.len()];
/// Columns of `camera.csv` in that order.
pub const COLUMNS: [&str; CHANNELS.len()] = names(&CHANNELS);
/// What they are.
pub const CHANNELS: [Channel; count(File::Camera)] = compared(File::Camera);
/// Places of the centroids in it.
pub const CENTROIDS: Range<usize> = places(&CHANNELS, Measures::Centroid);
/// Places of the areas among the camera's outputs.
pub const AREAS: Range<usize> = places(&CHANNELS, Measures::Area);
/// Places of the angles that a vision read among them.
pub const ANGLES: Range<usize> = places(&CHANNELS, Measures::VisionAngle);

/// The circle of a signal: of an angle, its link's end.
pub fn circle_of(signal: usize) -> usize {
    match signal {
        _ if CENTROIDS.contains(&signal) => signal / 2,
        _ if AREAS.contains(&signal) => signal - AREAS.start,
        _ => 1 + signal - ANGLES.start,
    }
}

/// A frame to be made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shot {
    /// State where the exposure may begin: one frame interval before.
    pub before: State,
    /// State at the end of the exposure.
    pub end: State,
    /// Whether an interlaced camera takes the field of the odd rows.
    pub odd: bool,
}

impl Shot {
    /// The same shot with its states moved.
    pub fn moved(&self, state: impl Fn(&State) -> State) -> Self {
        Self { before: state(&self.before), end: state(&self.end), odd: self.odd }
    }
}

/// The camera on its bench.
#[derive(Clone)]
pub struct Studio {
    bench: Arc<Bench>,
    inputs: [u32; 4],
    outputs: [u32; COLUMNS.len()],
    valid: u32,
    rate: f64,
    interlaced: bool,
    half_width: f64,
    fixed: Vec<Setting>,
    noiseless: Setting,
    /// One setting of the seed for each image that is averaged.
    seeds: Vec<Setting>,
}

impl Studio {
    /// Sets it up: results at once, nothing lost.
    ///
    /// # Errors
    /// There is no camera unit, or it lacks a variable.
    pub fn new(model: &Model) -> Result<Self, Error> {
        let unseen = || Error::Nominal("it has no unit `camera`".into());
        let bench = model.camera.clone().ok_or_else(unseen)?;
        let mut outputs = [0; COLUMNS.len()];
        for (reference, name) in outputs.iter_mut().zip(COLUMNS) {
            *reference = bench.reference(name)?;
        }
        let inputs = [
            bench.reference("q1")?,
            bench.reference("q2")?,
            bench.reference("dq1")?,
            bench.reference("dq2")?,
        ];
        let gone = [Attribute::ImageDelay, Attribute::LostFrames];
        let off = |attribute| bench.setting(variable(name(attribute)), 0.0);
        let fixed = gone.map(off).into_iter().collect::<Result<Vec<_>, _>>()?;
        let (rate, interlaced) = (model.frame_rate(), model.interlaced());
        let valid = bench.reference("valid")?;
        let half_width = 0.5 * model.number(parameters::WIDTH).unwrap_or(512.0);
        let noisy = model.number(name(Attribute::SensorNoise)).unwrap_or(0.0) > 0.0;
        let seeds = (0..if noisy { RESIDUAL.averaged } else { 1 })
            .map(|k| bench.setting("seed", f64::from(7919 * (k + 1))))
            .collect::<Result<_, _>>()?;
        let noiseless = bench.setting("sigma", 0.0)?;
        Ok(Self { bench, inputs, outputs, valid, rate, interlaced, half_width, fixed, noiseless, seeds })
    }

    /// Frame interval, s.
    pub fn interval(&self) -> f64 {
        1.0 / self.rate
    }

    /// Frames are fields of half the rows.
    pub fn interlaced(&self) -> bool {
        self.interlaced
    }

    /// Half the width of a frame, px: what one unit of u0 and v0 moves the image by.
    pub fn half_width(&self) -> f64 {
        self.half_width
    }

    /// The bench, for settings.
    pub fn bench(&self) -> &Bench {
        &self.bench
    }

    /// Makes frames with the sensor's nominal noise and averages a few of each: noise moves the mean of what a
    /// threshold sees. `None` where the circles are not found in one of them.
    ///
    /// # Errors
    /// The unit failed.
    pub fn average(&self, settings: &[Setting], shots: &[Shot]) -> Result<Vec<Option<Seen>>, Error> {
        // a unit that has just made these frames makes them soon under another seed
        let averaged = |shots: &[Shot]| {
            let mut sum: Vec<Option<Seen>> = vec![Some([0.0; COLUMNS.len()]); shots.len()];
            for seed in &self.seeds {
                let mut all = settings.to_vec();
                all.push(seed.clone());
                for (sum, seen) in sum.iter_mut().zip(self.chunk(&all, shots)?) {
                    *sum = sum.zip(seen).map(|(sum, seen)| {
                        std::array::from_fn(|s| sum[s] + seen[s] / self.seeds.len() as f64)
                    });
                }
            }
            Ok(sum)
        };
        let chunks: Vec<_> = shots.par_chunks(TASK).map(averaged).collect::<Result<_, Error>>()?;
        Ok(chunks.concat())
    }

    /// Makes frames with the sensor's noise, one realisation for each `seed`.
    ///
    /// # Errors
    /// The unit failed.
    pub fn noisy(&self, settings: &[Setting], shots: &[Shot], seed: i32) -> Result<Vec<Option<Seen>>, Error> {
        self.shoot(&self.exposed(settings, Some(seed))?, shots)
    }

    /// Makes frames without noise; `None` where the camera doesn't find its three circles.
    ///
    /// # Errors
    /// The unit failed.
    pub fn take(&self, settings: &[Setting], shots: &[Shot]) -> Result<Vec<Option<Seen>>, Error> {
        self.shoot(&self.exposed(settings, None)?, shots)
    }

    /// Settings with the sensor's noise of a `seed`, or without noise.
    ///
    /// # Errors
    /// The unit lacks a variable.
    pub fn exposed(&self, settings: &[Setting], seed: Option<i32>) -> Result<Vec<Setting>, Error> {
        let noise = match seed {
            Some(seed) => self.bench.setting("seed", f64::from(7919 * (seed + 101)))?,
            None => self.noiseless.clone(),
        };
        Ok(settings.iter().cloned().chain([noise]).collect())
    }

    /// Makes frames by a camera with these settings.
    ///
    /// # Errors
    /// The unit failed.
    pub fn shoot(&self, settings: &[Setting], shots: &[Shot]) -> Result<Vec<Option<Seen>>, Error> {
        let chunks: Vec<_> =
            shots.par_chunks(TASK).map(|chunk| self.chunk(settings, chunk)).collect::<Result<_, _>>()?;
        Ok(chunks.concat())
    }

    /// Takes some shots with one instance of the camera, one after the other; `None` where it finds no circles.
    fn chunk(&self, settings: &[Setting], shots: &[Shot]) -> Result<Vec<Option<Seen>>, Error> {
        let mut all = settings.to_vec();
        all.extend(self.fixed.iter().cloned());
        if let Some(first) = shots.first() {
            all.extend(
                self.inputs.iter().zip(first.before).map(|(input, value)| (*input, Value::Real(value))),
            );
        }
        self.bench.run(&all, 0.0, |instance| {
            let failed = |error: orchestrator::Error| Error::Model(error.to_string());
            let mut seen = Vec::with_capacity(shots.len());
            let mut number = 0;
            for shot in shots {
                let time = |number: i32, share: f64| (f64::from(number) + share) / self.rate;
                // the frame at the end of this interval has the next number, and odd numbers odd rows
                if self.interlaced && shot.odd != (number % 2 == 0) {
                    step(instance, time(number, 0.0), time(number + 1, 0.0) - time(number, 0.0))?;
                    number += 1;
                }
                let (from, jumped, to) = (time(number, 0.0), time(number, RESIDUAL.jump), time(number, 1.0));
                number += 1;
                instance.set_real(&self.inputs, &shot.before).map_err(failed)?;
                step(instance, from, jumped - from)?;
                instance.set_real(&self.inputs, &shot.end).map_err(failed)?;
                step(instance, jumped, to - jumped)?;
                let mut found = [0.0; COLUMNS.len()];
                let mut valid = [0];
                instance.get_real(&self.outputs, &mut found).map_err(failed)?;
                instance.get_boolean(&[self.valid], &mut valid).map_err(failed)?;
                seen.push(
                    (valid[0] != 0 && found.iter().all(|value: &f64| value.is_finite())).then_some(found),
                );
            }
            Ok(seen)
        })
    }
}
