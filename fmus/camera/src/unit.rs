//! The camera as a co-simulation unit: exposes frames when their time has come, looks at them, delivers the results.

use crate::effects::Effects;
use crate::geometry::Projection;
use crate::photometry::{FrameMaker, Shot};
use crate::recording;
use crate::scene::Pose;
use crate::shutter::history::Motion;
use crate::shutter::{FrameClock, History, Queue, Segment, clock, exposure};
use crate::variables::{Inputs, Outputs, Scene, Sensor, Variables};
use crate::vision::{Estimate, Finder, Tracker, View};
use fmi2_export::{
    Dependencies, Description, Experiment, Log, LogCategory, Model, ModelError, Slot, Step, Table,
};
use serde::{Deserialize, Serialize};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Log category of frames in which the circles were not found, and of lost frames.
pub const LOG_VISION: &str = "logVision";

/// The internal state of the unit: small, for frames are functions of (parameters, motion, frame number).
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Camera {
    history: History,
    next_frame: i64,
    in_flight: Queue<Estimate>,
    tracker: Tracker,
    delivered: i32,
    #[serde(skip)]
    workshop: Workshop,
}

/// What is only kept to be fast. Clones share it: nothing that comes out of it depends on what it did before.
#[derive(Debug, Clone, Default)]
struct Workshop(Arc<Mutex<Bench>>);

#[derive(Debug, Default)]
struct Bench {
    maker: Option<FrameMaker>,
    finder: Finder,
    centres_world: Vec<[(f64, f64); 3]>,
}

impl Workshop {
    fn open(&self) -> MutexGuard<'_, Bench> {
        // A panic elsewhere can have left a half-made frame behind, which the next one makes anew.
        self.0.lock().unwrap_or_else(|poisoned: PoisonError<_>| {
            let mut bench = poisoned.into_inner();
            bench.maker = None;
            bench
        })
    }
}

impl Bench {
    /// The frame maker for the parameters as they are now.
    fn maker(&mut self, variables: &Variables) -> Result<&mut FrameMaker, ModelError> {
        let Variables { scene, sensor, effects, .. } = variables;
        let fits = self.maker.as_ref().is_some_and(|maker| maker.is_for(scene, sensor, effects));
        if !fits {
            self.maker = None;
            check(variables)?;
        }
        match &mut self.maker {
            Some(maker) => Ok(maker),
            none => Ok(none.insert(FrameMaker::new(scene, sensor, effects)?)),
        }
    }
}

/// Refuses values outside their declared range, and areas that exclude one another.
pub(crate) fn check(variables: &Variables) -> Result<(), ModelError> {
    for (index, declared) in Variables::variables().iter().enumerate() {
        let value = match variables.get(index) {
            Some(Slot::Real(value)) => *value,
            Some(Slot::Integer(value)) => f64::from(*value),
            _ => continue,
        };
        let expected = match (declared.min, declared.max) {
            _ if !value.is_finite() => "a finite number".to_owned(),
            (Some(min), _) if value < min => format!("at least {min}"),
            (_, Some(max)) if value > max => format!("at most {max}"),
            _ => continue,
        };
        return Err(ModelError::Value { name: declared.name, value: value.to_string(), expected });
    }
    check_tunable(&variables.sensor)
}

/// Refuses what may change at any time without the picture being prepared anew.
fn check_tunable(sensor: &Sensor) -> Result<(), ModelError> {
    if sensor.smallest_area > sensor.largest_area {
        return Err(ModelError::Value {
            name: "N_min",
            value: sensor.smallest_area.to_string(),
            expected: format!("at most N_max = {}", sensor.largest_area),
        });
    }
    if !(sensor.delay >= 0.0 && sensor.delay.is_finite()) {
        return Err(ModelError::Value {
            name: "T_delay",
            value: sensor.delay.to_string(),
            expected: "a finite time of at least 0".to_owned(),
        });
    }
    Ok(())
}

fn check_inputs(variables: &Variables) -> Result<(), ModelError> {
    let inputs = &variables.inputs;
    let values = [
        ("q1", inputs.link1_angle),
        ("q2", inputs.link2_angle),
        ("dq1", inputs.link1_rate),
        ("dq2", inputs.link2_rate),
    ];
    match values.into_iter().find(|(_, value)| !value.is_finite()) {
        Some((name, value)) => {
            Err(ModelError::Value { name, value: value.to_string(), expected: "a finite number".to_owned() })
        }
        None => Ok(()),
    }
}

impl Inputs {
    fn motion(&self, time: f64) -> Motion {
        Motion {
            time,
            pose: Pose { link1_angle: self.link1_angle, link2_angle: self.link2_angle },
            rates: Pose { link1_angle: self.link1_rate, link2_angle: self.link2_rate },
        }
    }
}

impl Outputs {
    fn show(&mut self, estimate: &Estimate, delivered: i32) {
        (self.link1_angle, self.link2_angle) = estimate.angles;
        (self.link1_rate, self.link2_rate) = estimate.rates;
        let [first, second, third] = &estimate.circles;
        (self.u1_px, self.v1_px) = first.centre_px;
        (self.u2_px, self.v2_px) = second.centre_px;
        (self.u3_px, self.v3_px) = third.centre_px;
        (self.area1, self.area2, self.area3) = (first.area_px, second.area_px, third.area_px);
        self.valid = estimate.valid;
        self.frame = delivered;
        self.frame_index = i32::try_from(estimate.number).unwrap_or(i32::MAX);
        self.mid_exposure = estimate.mid_exposure;
    }
}

impl Camera {
    /// Exposes and looks at every frame whose exposure has ended by `now`.
    fn capture_until(
        &mut self,
        now: f64,
        variables: &Variables,
        log: &mut dyn Log,
    ) -> Result<(), ModelError> {
        let clock = FrameClock::new(&variables.sensor);
        while clock::has_come(clock.exposure_end(self.next_frame), now) {
            let k = self.next_frame;
            self.next_frame += 1;
            if variables.effects.loss.takes(variables.sensor.seed, k) {
                log.log(LOG_VISION, &|| format!("frame {k} is lost"));
                continue;
            }
            let estimate = self.look(k, &clock, variables)?;
            if !estimate.valid {
                log.log(LOG_VISION, &|| format!("frame {k}: the circles were not identified"));
            }
            self.in_flight.send(clock.exposure_end(k) + variables.sensor.delay, estimate);
        }
        self.history.forget_before(clock.exposure_end(self.next_frame) - clock.exposure());
        Ok(())
    }

    /// Renders frame `k` and estimates the state from it.
    fn look(&mut self, k: i64, clock: &FrameClock, variables: &Variables) -> Result<Estimate, ModelError> {
        let Variables { scene, sensor, .. } = variables;
        let workshop = self.workshop.clone();
        let mut bench = workshop.open();
        let mut centres = core::mem::take(&mut bench.centres_world);
        let end = clock.exposure_end(k);
        let scale = pixels_per_world(scene, sensor, &variables.effects);
        exposure::sub_frames(&self.history, scene, scale, end - clock.exposure(), end, &mut centres);
        let whole = recording::wants(sensor, k);
        bench.maker(variables)?.render(Shot { k, seed: sensor.seed, centres_world: &centres, whole });
        bench.centres_world = centres;

        let Bench { maker: Some(maker), finder, .. } = &mut *bench else {
            return Err(ModelError::Failed("no frame was made".to_owned()));
        };
        if whole {
            recording::write(sensor, k, maker.picture())?;
        }
        let row_step = if sensor.interlaced { 2 } else { 1 };
        let (picture, mask, windows) = (maker.picture(), maker.mask(), maker.windows());
        let view = View { picture, mask, windows, row_step };
        let features = finder.find(&view, scene, sensor, &variables.effects);
        let estimate = self.tracker.follow(features, clock.mid_exposure(k), scene, sensor);
        Ok(Estimate { number: k, ..estimate })
    }

    /// Writes the newest result that has arrived by `now`.
    fn deliver_until(&mut self, now: f64, outputs: &mut Outputs) {
        while let Some(estimate) = self.in_flight.receive(now) {
            self.delivered += 1;
            outputs.show(&estimate, self.delivered);
        }
    }

    /// The map from the world to pixels for these parameters.
    ///
    /// # Errors
    /// An unusable lens.
    pub fn projection(variables: &Variables) -> Result<Projection, ModelError> {
        Projection::new(&variables.scene, &variables.sensor, &variables.effects)
    }
}

/// Pixels a world unit near the axis.
fn pixels_per_world(scene: &Scene, sensor: &Sensor, effects: &Effects) -> f64 {
    f64::from(sensor.width.max(sensor.height)) / scene.field_of_view * effects.placement.scale
}

impl Model for Camera {
    type Variables = Variables;

    fn description() -> Description {
        Description {
            identifier: "acrobot_camera",
            description: "Camera of Bishop, Hutchinson and Spong: renders frames of the acrobot, estimates its state.",
            version: env!("CARGO_PKG_VERSION"),
            stop_time: 30.0,
            step_size: 1.0 / 600.0,
            provides_derivatives: false,
            log_categories: &[LogCategory {
                name: LOG_VISION,
                description: "Frames that were lost or in which the circles were not identified.",
            }],
        }
    }

    fn dependencies(output: &str) -> Dependencies {
        let while_stepping: &[&str] = match output {
            "frame" | "frame_index" | "t_mid" => &[],
            _ => &["q1", "q2", "dq1", "dq2"],
        };
        Dependencies { while_stepping, at_start: None }
    }

    fn renewed(self) -> Self {
        Self { workshop: self.workshop, ..Self::default() }
    }

    fn initialize(
        &mut self,
        variables: &mut Variables,
        experiment: &Experiment,
        log: &mut dyn Log,
    ) -> Result<(), ModelError> {
        check(variables)?;
        self.workshop.open().maker(variables)?;
        recording::prepare(&variables.sensor)?;
        let start = experiment.start;
        *self = Self {
            history: History::starting(variables.inputs.motion(start)),
            next_frame: FrameClock::new(&variables.sensor).first_frame(start),
            workshop: self.workshop.clone(),
            ..Self::default()
        };
        variables.outputs = Outputs::default();
        self.capture_until(start, variables, log)?;
        self.deliver_until(start, &mut variables.outputs);
        Ok(())
    }

    fn step(
        &mut self,
        variables: &mut Variables,
        step: &Step<'_>,
        log: &mut dyn Log,
    ) -> Result<(), ModelError> {
        check_inputs(variables)?;
        check_tunable(&variables.sensor)?;
        let rates = (step.input_rate("q1"), step.input_rate("q2"));
        let segment = if rates == (None, None) {
            // The inputs hold at the end of the step.
            let from = Motion { time: step.from, ..self.history.newest() };
            Segment { from, to: variables.inputs.motion(step.to) }
        } else {
            // The inputs hold at its beginning, FMI 2.0 section 4.2.1.
            let rates = Pose { link1_angle: rates.0.unwrap_or(0.0), link2_angle: rates.1.unwrap_or(0.0) };
            let from = Motion { rates, ..variables.inputs.motion(step.from) };
            Segment { from, to: Motion { time: step.to, pose: from.extrapolated(step.to), rates } }
        };
        self.history.push(segment);
        self.capture_until(step.to, variables, log)?;
        self.deliver_until(step.to, &mut variables.outputs);
        Ok(())
    }
}
