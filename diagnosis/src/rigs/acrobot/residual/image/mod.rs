//! The image's cut: measured motion in, centroids and areas out.
//!
//! The frames are rendered again at the measured pose, through the camera unit itself, since the pixel lattice is
//! not noise: against ideal centroids a distortion-free image shows several effects at 16 standard deviations and
//! more. Columns are secants over steps of some pixels, for the same reason.
//!
//! Where no motion was logged, the pose of each frame is free: six coordinates over-determine two angles.

use super::settings::settings;
use super::studio::{CENTROIDS, CHANNELS, COLUMNS, Seen, Shot, Studio};
use super::trajectory::Motion;
use super::{Block, Nuisances, Perturbation, Signal};
use crate::error::Error;
use crate::rigs::acrobot::bench::Setting;
use crate::rigs::acrobot::candidates::{Attribute, Candidate, Side, name, place, variable};
use crate::rigs::acrobot::channels::{Channel, Measures};
use crate::rigs::acrobot::dataset::{DataSet, quantum};
use crate::rigs::acrobot::model::Model;
use crate::rigs::acrobot::parameters;
use crate::rigs::acrobot::residual::policy::RESIDUAL;
use crate::statistics::levels::anywhere_in;
use std::collections::BTreeMap;
use std::sync::Arc;

mod area_level;
mod columns;
mod cut;
mod frame_cache;
mod frames;
mod interlaced_fields;
mod laws;
mod noise;
mod policy;
mod poses;
mod rows;
mod state;
mod surface;
mod together;

use frame_cache::{FrameCache, MadeFrames};
use frames::frames;
pub use laws::Laws;
pub use noise::Noise;
pub(crate) use policy::IMAGES;
pub use poses::pose_shift;
use poses::{back, free_poses, turned};
pub use state::ImageState;
pub use together::Together;

/// A measured frame.
#[derive(Debug, Clone)]
pub struct Frame {
    /// Index of the run.
    pub run: usize,
    /// When it was delivered, s.
    pub time: f64,
    /// What was found; `NaN` where not measured.
    pub seen: Seen,
    /// State at the end of the exposure, and one interval before.
    pub shot: Shot,
    known: bool,
}

/// Where the pose of a frame comes from.
#[derive(Clone)]
pub enum Pose {
    /// A motion per run, and how well it is known (rad).
    Logged(Vec<Motion>, f64),
    /// The image itself, where a plant that is driven by the torque will follow it.
    Chained,
    /// The image alone.
    Free,
}

/// Change of each frame per unit of a candidate.
type Column = Arc<Vec<Option<Seen>>>;

/// Settings of a camera, and its E_t.
type Followed = (Vec<Setting>, f64);

/// Poses, and what they have followed.
type Poses = (Vec<Shot>, Option<Followed>);

/// Motion in, image out.
#[derive(Clone)]
pub struct ImageCut {
    studio: Studio,
    candidates: Arc<Vec<Candidate>>,
    /// Frames in use.
    pub frames: Vec<Frame>,
    pose: Pose,
    delay: Option<usize>,
    exposure: Option<usize>,
    nominal_delay: f64,
    /// By how much the motion's angles were turned back, rad, where it is in question.
    zeros: Option<[f64; 2]>,
    signals: Vec<Signal>,
    /// What the log rounds centroids to, px.
    quantum: f64,
    /// Change of the image with q1 and q2, kept: it hardly depends on small effects.
    turns: Option<Vec<[Option<Seen>; 2]>>,
    kept: BTreeMap<(usize, u64), Column>,
    /// What the columns are over all poses.
    laws: Laws,
    /// Frames that were made lately, with what they were made from: a candidate of the plant leaves them as they are, and a search comes back
    /// to where it was.
    made: FrameCache,
    /// Frames beside the poses, without a candidate moved.
    still: FrameCache,
    /// Settings of the camera that poses read off the image have followed, and its E_t.
    followed: Option<Followed>,
    /// No circle was logged, only angles that were read off them.
    pub read: bool,
    /// Frames in which the camera didn't find its circles, where the data's did.
    unseen: usize,
    /// Poses, and what they had followed, at the last linearisation.
    linearised: Poses,
    /// Poses as the data have them.
    first: Arc<ImageState>,
}

/// What a log rounds centroids to, px; 0 where it doesn't.
fn quantum_of(frames: &[Frame]) -> f64 {
    let places = frames.iter().flat_map(|frame| &frame.seen[CENTROIDS]);
    quantum(&places.copied().filter(|at| at.is_finite()).collect::<Vec<_>>())
}

/// The camera's signals. Where vision angles are all that was `read`, their circles' places on the lattice aren't known; centroids are
/// known to the `quantum` that they were rounded to, px: of a circle that hardly moves rounding is no noise.
fn signals_of(data: &DataSet, read: bool, quantum: f64) -> Vec<Signal> {
    let signal = |(channel, column): (&Channel, &str)| {
        let name = format!("camera.{column}");
        let known = data.known_noise(&name).filter(|sigma| *sigma > 0.0);
        let noise = channel.noise.unwrap_or_default();
        let unplaced = read && channel.measures == Measures::VisionAngle;
        // a threshold puts circles off by 0.03 px
        let tolerance = if unplaced { RESIDUAL.place } else { noise.tolerance };
        let rounded = if channel.measures == Measures::Centroid { anywhere_in(quantum) } else { 0.0 };
        let tolerance = tolerance.hypot(rounded);
        let sigma = known.unwrap_or(noise.guess);
        Signal {
            name,
            unit: channel.unit,
            measures: channel.measures,
            known,
            sigma,
            least: noise.least,
            tolerance,
        }
    };
    CHANNELS.iter().zip(COLUMNS).map(signal).collect()
}

impl ImageCut {
    /// All frames that say something, at most `most` of them, evenly thinned; `None` if there are none.
    ///
    /// # Errors
    /// The camera unit lacks a variable.
    pub fn new(
        data: &DataSet,
        model: &Model,
        candidates: Arc<Vec<Candidate>>,
        pose: Pose,
        most: usize,
    ) -> Result<Option<Self>, Error> {
        let motion = matches!(pose, Pose::Logged(..));
        let mut frames = frames(data, motion);
        if frames.is_empty() {
            return Ok(None);
        }
        let read = frames.iter().all(|frame| frame.seen[CENTROIDS].iter().all(|at| at.is_nan()));
        let studio = Studio::new(model)?;
        if !motion {
            free_poses(&mut frames, model.number(parameters::MOUNT).unwrap_or(0.0), &studio)?;
        }
        let mut every = frames.len().div_ceil(most.max(1)).max(1);
        if model.interlaced() {
            every |= 1; // fields of both kinds
        }
        let frames: Vec<Frame> = frames.into_iter().step_by(every).collect();
        let delay = place(&candidates, Attribute::ImageDelay);
        let exposure = place(&candidates, Attribute::Exposure);
        let nominal_delay = model.number(name(Attribute::ImageDelay)).unwrap_or(0.0);
        let quantum = quantum_of(&frames);
        let poses: Poses = (frames.iter().map(|frame| frame.shot).collect(), None);
        Ok(Some(Self {
            candidates,
            frames,
            pose,
            delay,
            exposure,
            nominal_delay,
            zeros: None,
            signals: signals_of(data, read, quantum),
            quantum,
            turns: None,
            kept: BTreeMap::new(),
            laws: Laws::default(),
            made: FrameCache::default(),
            still: FrameCache::default(),
            followed: None,
            read,
            unseen: 0,
            first: Arc::new(ImageState { now: poses.clone(), linearised: poses.clone() }),
            linearised: poses,
            studio,
        }))
    }

    /// Delay of the camera at a point, s.
    pub fn delay(&self, point: &[f64]) -> f64 {
        self.delay.map_or(self.nominal_delay, |index| point[index])
    }

    /// Interval between frames, s.
    pub fn interval(&self) -> f64 {
        self.studio.interval()
    }

    /// Forgets kept columns, since the frames have moved.
    pub fn forget(&mut self) {
        self.turns = None;
        self.kept.clear();
        self.laws = Laws::default();
    }

    /// What columns are over all poses, as far as they were asked for.
    pub fn laws(&self) -> &Laws {
        &self.laws
    }

    /// Takes over what columns are known to be.
    pub fn know(&mut self, laws: &Laws) {
        self.laws = laws.clone();
    }

    /// Parameter values of the camera at a point, but for its delay.
    ///
    /// # Errors
    /// The unit lacks a candidate's variable.
    pub fn settings(&self, point: &[f64], moved: Option<Perturbation>) -> Result<Vec<Setting>, Error> {
        let mut all = settings(self.studio.bench(), &self.candidates, Side::Camera, point, moved)?;
        all.extend(settings(self.studio.bench(), &self.candidates, Side::SensorNoise, point, None)?);
        let delay = self.studio.bench().reference(variable(name(Attribute::ImageDelay)))?;
        all.retain(|(reference, _)| *reference != delay);
        Ok(all)
    }

    /// Puts frames at the logged motion, as a camera with this point's delay sees it and angles without their zeros.
    fn place(&mut self, point: &[f64]) {
        let delay = self.delay(point);
        let (interval, off) = (self.studio.interval(), self.turned_back(point));
        if let Pose::Logged(motions, _) = &self.pose {
            for frame in &mut self.frames {
                let motion = &motions[frame.run];
                let end = motion.at(frame.time - delay);
                frame.known = end.is_some();
                if let Some(end) = end {
                    let before =
                        motion.at(frame.time - delay - interval).unwrap_or_else(|| back(&end, interval));
                    let [before, end] = [before, end].map(|state| turned(&state, off));
                    frame.shot = Shot { before, end, ..frame.shot };
                }
            }
        }
    }

    /// Renders at the poses.
    fn base(&mut self, point: &[f64]) -> Result<Arc<MadeFrames>, Error> {
        let settings = self.settings(point, None)?;
        let shots = self.frames.iter().map(|frame| frame.shot).collect();
        let studio = &self.studio;
        let made = self.made.frames(settings, shots, |settings, shots| studio.average(settings, shots))?;
        self.turn(&made.settings, &made.shots)?;
        Ok(made)
    }

    /// Renders at the poses, without the sensor's noise.
    fn noiseless(&mut self, point: &[f64]) -> Result<Vec<Option<Seen>>, Error> {
        let settings = self.settings(point, None)?;
        let shots: Vec<Shot> = self.frames.iter().map(|frame| frame.shot).collect();
        self.turn(&settings, &shots)?;
        self.studio.take(&settings, &shots)
    }

    /// Finds the image's change with the angles, unless it is known.
    fn turn(&mut self, settings: &[Setting], shots: &[Shot]) -> Result<(), Error> {
        if self.turns.is_none() {
            self.turns = Some(self.turned(settings, shots)?);
        }
        Ok(())
    }
}

impl ImageCut {
    /// A linearisation from where the frames are.
    pub(super) fn settle(
        &mut self,
        point: &[f64],
        perturbations: &[Perturbation],
    ) -> Result<Vec<Block>, Error> {
        self.place(point);
        if self.studio.interlaced() {
            self.order(point)?;
        }
        self.follow(point)?;
        self.mark();
        self.compare(point, perturbations)
    }

    /// A chord step from where the frames are.
    pub(super) fn step(
        &mut self,
        point: &[f64],
        perturbations: &[Perturbation],
    ) -> Result<Vec<Block>, Error> {
        self.place(point);
        self.follow(point)?;
        self.compare(point, perturbations)
    }
}
