//! Numbers by which images are compared, each with its reason.

use crate::rigs::acrobot::channels::CENTROIDS_APART;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::plant::policy::WINDOWS;
use crate::rigs::acrobot::residual::policy::RESIDUAL;
use crate::statistics::levels::{FAR, FEW, HALF, ROWS, SAMPLE, SEVERAL, SMALL, STEP};

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Images {
    /// Length of a block, s.
    pub image_block: f64,
    /// Angle over which the image's change with pose is taken: not two pixels at the joint.
    pub turn: f64,
    /// Rounds of poses beside the measured ones at which a column is taken.
    pub rounds: u64,
    /// Rounds for a small step of the exposure, whose blur is little beside the lattice's error.
    pub more_rounds: u64,
    /// Most frames at which a column is taken, and at which noise is made. With half of them for columns, be it of candidates alone that are
    /// off, a webcam's lens of seven terms that nearly cancel is *unknown*.
    pub sampled: usize,
    /// Way of a circle of 10 px during the exposure, px, beyond which a blur is more than that. A shorter smear is nearly straight
    /// and keeps the blob's middle: where the circle speeds up by 500 px/s², a third of a 30 Hz interval leaves 0.002 px of it.
    pub blurring: f64,
    /// Share of frames whose circles go that far or less.
    pub usual: f64,
    /// Least step of E_t over which the blur of a short exposure is taken, in frame intervals.
    pub blur_step: f64,
    /// Rounds of poses for that step.
    pub blur_rounds: u64,
    /// Frames to either side over which a change of poses is averaged where a plant smooths them afterwards: a lens or mount that
    /// moves shifts poses smoothly.
    pub poses_beside: usize,
    /// Rounds in which a circle 1 that wasn't measured is put where the angle says, each a sixth as far off as the one before.
    pub rolls: usize,
    /// Angle by which it is rolled to see how far it goes, rad.
    pub rolled: f64,
    /// A change of poses below this moves no pixel that matters, rad.
    pub still: f64,
    /// Highest power of the angles in a surface: cubic lens terms over half an image need four.
    pub degree: usize,
    /// Samples that a surface needs for each of its terms.
    pub each: usize,
    /// Times what scatter alone gives it, from which a surface's mean square makes it one. A lens that only shifts or scales an image turns
    /// no link; but steps that are large against the lattice leave a little of its error.
    pub chance: f64,
    /// Difference of all areas alike up to which no effect is behind it, px: a light or threshold that is a twentieth off makes as much,
    /// and renderers that round grey levels or cut them off a tenth of it. A defocus of 1 makes four times as much.
    pub level: f64,
    /// Difference of all areas alike from which the light is not the nominal one, px, so that noise against it is another one: a light that
    /// is a fiftieth lower makes as much.
    pub unlit: f64,
    /// By how much another light or threshold puts a centroid off at one place on the pixel lattice, px: a thirtieth, five times what right renderers
    /// differ by.
    pub unlit_place: f64,
    /// Realisations of the noise for each frame.
    pub made: i32,
    /// Standard deviation of a pose read off an image and smoothed by the plant, rad.
    pub read: f64,
    /// How far the image may lie from where the model has it, px: an effect of this size would hardly be seen.
    pub noise_beside: f64,
    /// Fewest pairs of neighbouring frames that tell a scatter.
    pub enough: usize,
    /// Rows of one block, whose scatter is independent of the next one's.
    pub noise_block: usize,
    /// Correlation of two circles' changes from frame to frame that is worth a word, where enough frames tell it: a mount that shakes by a
    /// third of what the sensor scatters.
    pub together: f64,
    /// To what share a predicted variance is known: right renderers cut the rim's pixels differently, and one more pixel
    /// near the threshold is a tenth of all that flicker.
    pub known: f64,
    /// Smallest noise that is tried where the nominal sensor has none, grey levels.
    pub least: f64,
    /// Largest ratio to the nominal one, or to the least, that is tried.
    pub most: f64,
    /// Places that are told apart in a pixel along each direction: the difference of two renderers changes from one to the next.
    pub lattice: usize,
    /// Factor to either side of a noise over which the slope is taken that says how well it is known.
    pub beside: f64,
}

/// Those in force.
pub const IMAGES: Images = Images {
    image_block: WINDOWS.window,
    turn: HALF * POLICY.least_motion,
    rounds: 2,
    more_rounds: ROWS as u64,
    sampled: POLICY.most,
    blurring: SEVERAL,
    usual: 1.0 - STEP,
    blur_step: SMALL,
    blur_rounds: RESIDUAL.averaged as u64,
    poses_beside: POLICY.curved,
    rolls: ROWS,
    rolled: POLICY.small_angle,
    still: HALF * POLICY.read,
    degree: 4,
    each: FEW,
    chance: SEVERAL,
    level: 1.0,
    unlit: HALF,
    unlit_place: HALF * FAR * CENTROIDS_APART,
    made: RESIDUAL.averaged,
    read: POLICY.read,
    noise_beside: 2.0 * CENTROIDS_APART,
    enough: SAMPLE,
    noise_block: SAMPLE,
    together: SMALL,
    known: SMALL,
    least: HALF,
    most: FAR * FAR,
    lattice: 20,
    beside: 1.0 + SMALL,
};
