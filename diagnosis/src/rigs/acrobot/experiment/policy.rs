//! Numbers that the next experiment is chosen by, each with its reason.

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Design {
    /// By how much a simulated loss flatters: a lab's model lacks more than one thing, and its noise is not white.
    pub caution: f64,
    /// Certainties that differ by less are equal; the cheaper experiment is taken then.
    pub equal: f64,
    /// Loss that is wished for: one that is expected scatters by twice its root, and of ten such nine stay above `CLASS`.
    pub enough: f64,
    /// A lab records as many times what it did before, but no more.
    pub longest: f64,
    /// How many of the best are simulated with every member as the truth; the rest with the most probable one.
    pub finalists: usize,
    /// How many members besides the most probable one are each the truth there.
    pub truths: usize,
    /// Noise of what was not logged before: good encoders in rad, a torque cell in N·m.
    pub encoder: f64,
    pub torque: f64,
    /// Without a picture in the loop a run of this length, s, is enough: it is logged at a higher rate.
    pub short: f64,
    /// A repeated z_desired is given in straight lines of this length, s.
    pub thinned: f64,
    /// Torque steps of an arm that hangs, s.
    pub held: f64,
    /// Beyond this an arm hangs rather than stands, rad.
    pub hanging: f64,
    /// Frames that are rendered for a prediction: enough to visit the picture, few enough to be quick.
    pub frames: usize,
    /// A tangent in the plant is taken over this share of the step at which a candidate is looked for: far above the
    /// integrator's 1e-9, far below where a window bends.
    pub tangent: f64,
    /// Where poses must be read off frames that are rendered again, a run of this length stands for all, s.
    pub chained: f64,
    /// Rows of the encoders per second where none were logged before.
    pub encoder_rate: f64,
}

/// Those in force.
pub const DESIGN: Design = Design {
    caution: 4.0,
    equal: 0.01,
    enough: 17.0,
    longest: 5.0,
    finalists: 2,
    truths: 3,
    encoder: 2e-4,
    torque: 1e-2,
    short: 10.0,
    thinned: 0.1,
    held: 0.01,
    hanging: 1.6,
    frames: 100,
    tangent: 0.01,
    chained: 8.0,
    encoder_rate: 30.0,
};
