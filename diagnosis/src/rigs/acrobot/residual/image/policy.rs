//! Numbers by which images are compared, each with its reason.

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Images {
    /// Length of a block, s.
    pub image_block: f64,
    /// Angle over which the picture's change with pose is taken: two pixels at the joint.
    pub turn: f64,
    /// Rounds of such poses, and for a small step of the exposure, whose blur is little beside the lattice's error.
    pub rounds: u64,
    pub more_rounds: u64,
    /// Most frames at which a column is taken.
    pub sampled: usize,
    /// Way of a circle of 10 px during the exposure, px, beyond which a blur is more than that. A shorter smear is nearly straight
    /// and keeps the blob's middle: where the circle speeds up by 500 px/s², a third of a 30 Hz interval leaves 0.002 px of it.
    pub blurring: f64,
    /// The share of frames whose circles go that far or less.
    pub usual: f64,
    /// Least step of E_t over which the blur of a short exposure is taken, and its rounds.
    pub blur_step: f64,
    pub blur_rounds: u64,
    /// Frames to either side over which a change of poses is averaged where a plant smooths them afterwards: a lens or mount that
    /// moves shifts poses smoothly.
    pub poses_beside: usize,
    /// Rounds in which a circle 1 that wasn't measured is put where the angle says, each a sixth as far off as the one before, and the
    /// angle by which it is rolled to see how far it goes, rad.
    pub rolls: usize,
    pub rolled: f64,
    /// A change of poses below this moves no pixel that matters, rad.
    pub still: f64,
    /// Powers of the angles; cubic lens terms over half a picture need four.
    pub degree: usize,
    /// A fit needs so many samples for each term.
    pub each: usize,
    /// A surface whose mean square is below so many times what scatter alone gives it is none. A lens that only shifts or scales a picture
    /// turns no link; but steps that are large against the lattice leave a little of its error.
    pub chance: f64,
    /// By how much all areas may differ alike, px: one renderer rounds grey levels, another cuts them off, which makes 0.06.
    pub level: f64,
    /// Realisations of the noise for each frame.
    pub made: i32,
    /// Standard deviation of a pose read off a picture and smoothed by the plant, rad.
    pub read: f64,
    /// How far the picture may lie from where the model has it, px: an effect of this size would hardly be seen.
    pub noise_beside: f64,
    /// Neighbours that are needed to speak of scatter.
    pub enough: usize,
    /// Rows of one block, whose scatter is independent of the next one's.
    pub noise_block: usize,
    /// To what share a predicted variance is known: right renderers cut the rim's pixels differently, and one more pixel
    /// near the threshold is a tenth of all that flicker.
    pub known: f64,
    /// Smallest noise that is tried where the nominal sensor has none, grey levels.
    pub least: f64,
    /// Largest ratio to the nominal one, or to the least, that is tried.
    pub most: f64,
    /// Steps of the bisection: 64 in 2^12.
    pub steps: usize,
}

/// Those in force.
pub const IMAGES: Images = Images {
    image_block: 0.5,
    turn: 0.012,
    rounds: 2,
    more_rounds: 8,
    sampled: 720,
    blurring: 3.0,
    usual: 0.99,
    blur_step: 0.08,
    blur_rounds: 4,
    poses_beside: 7,
    rolls: 8,
    rolled: 0.1,
    still: 1e-4,
    degree: 4,
    each: 4,
    chance: 4.0,
    level: 0.12,
    made: 4,
    read: 1.5e-4,
    noise_beside: 0.01,
    enough: 60,
    noise_block: 25,
    known: 0.1,
    least: 0.5,
    most: 64.0,
    steps: 12,
};
