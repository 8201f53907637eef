//! Numbers that the search decides by, each with its reason.

use crate::infer::fit::Options;
use crate::rigs::acrobot::policy::POLICY;
use crate::rigs::acrobot::residual::plant::policy::WINDOWS;
use crate::statistics::levels::{CERTAIN, DOUBTED, FAR, FEW, FINE, HALF, MORE, PART, SEVERAL, SLIGHT, SMALL};

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Selection {
    /// Standard deviations by which a step of a candidate must move all rows together to say anything of it.
    pub excited: f64,
    /// The same, where torques are compared: standard deviations by which a step must move all rows together. Nothing was integrated, so
    /// that far less than noise is still no rounding.
    pub excited_torque: f64,
    /// Share of the best hit's gain from which another hit of the screen is refitted, too; at most as many as there may be effects.
    pub worth: f64,
    /// Share of the best hit's gain from which a candidate is refitted that is nonlinear in its size, so that its column says little.
    pub bent_worth: f64,
    /// Times the way to where a column points, at which a second fit of such a candidate begins.
    pub further: f64,
    /// By what share of the best decrease a clock may explain less, where it is known to be off: a shift of tens of milliseconds moves
    /// windows by more than their columns say.
    pub doubted: f64,
    /// Cosine of the angle between two columns from which a fault of the log and an effect resemble each other.
    pub trials_alike: f64,
    /// A share of the residual beyond which an effect is large: columns bend, and what is missing counts as noise, so that
    /// fits are compared. Below it, images are compared by their columns at one and the same pose: the deviances of fits
    /// differ by what the pixel lattice does when the image moves under it.
    pub large: f64,
    /// Decrease of the deviance that an effect must bring which no statistic over blocks shows.
    pub sparse: f64,
    /// Most effects that are tried in that way, those of the largest gain.
    pub sparse_trials: usize,
    /// Decrease of the squares from which an effect of the camera whose column bends is tried although no statistic over blocks shows it.
    /// Seen: 350 to 750 for exposures of 0.25 and 0.4 beside a delay, 21 at most where there is none.
    pub seldom: f64,
    /// Times what its columns predict, from which a step is followed by a longer one (the deviance decreases twice as much along a straight
    /// line): what passes for a discrepancy holds a value back that explains it.
    pub refit_straight: f64,
    /// Times by which that next step is longer.
    pub stretch: f64,
    /// Most linearisations of a fit.
    pub rounds: usize,
    /// A step that predicts less decrease of the sum of squares than this ends the fit.
    pub settled: f64,
    /// One that predicted less than this, a standard error at most, and then didn't keep it ends the fit, too, and so does a shortened
    /// one that predicts no more: chords of windows leave some 5 of deviance more or less from one linearisation to the next, and shorter steps found
    /// nothing there.
    pub refused: f64,
    /// Damping of the first step after a refused one: by 1 it is half as long.
    pub shorter: f64,
    /// That damping where images are compared: the step is three quarters as long. Poses take up a part of each step there, and a
    /// saturation without encoders was found by such steps only.
    pub shorter_seen: f64,
    /// Squares over what noise gives from which a window is one in which the machine ran away.
    pub runaway: f64,
    /// Standard deviations by which noise gives more squares in a window than its freedom, beyond which its start state is doubted.
    pub doubt: f64,
    /// Noise of angles, rad, below which a wrong start within stiction is seen: at twice as much friction was found as well without.
    pub fine: f64,
    /// Times what the next step predicts, by which the deviance of a fit that is nonlinear in its size may still decrease: twice is the
    /// most that was seen.
    pub reach: f64,
    /// Share of the torque that windows lack to which a switch must bring it: 0 to 0.001 where a switch is the truth.
    pub follows: f64,
    /// Factor by which a saturation is tried above and below its best level. Levels are as far apart as that reaches on both sides, or
    /// further where `levels` are not enough.
    pub beside: f64,
    /// Most levels of a saturation. With one a quarter off a machine runs away as it does without.
    pub levels: f64,
    /// Levels in a row at which windows need far more slack torques than at the best one, after which no looser one is tried.
    pub beyond: usize,
    /// Times the slack torques of the best level that are far more.
    pub switched_far: f64,
    /// More effects than this are not a diagnosis any more.
    pub search_most: usize,
    /// Most effects that are accepted in vain, since they turn out superfluous at once or would, before a search ends.
    pub vain: usize,
    /// Decrease of the deviance that a Newton step of the active values predicts at most where they are settled: that of one standard
    /// error.
    pub unsettled: f64,
    /// Most times that active values are settled once more.
    pub again: usize,
    /// An active effect below this many standard errors is dropped again.
    pub keep: f64,
    /// Most rounds of fitting values and nuisances in turns.
    pub settle: usize,
    /// Share of its standard error by which no value may move any more for these rounds to end.
    pub moved: f64,
    /// Deviance that an effect as a whole must take away to be more than rounding.
    pub idle: f64,
    /// By how much another must be better, at the fitted model, to take an effect's place (deviance).
    pub better: f64,
    /// Share of the squares by which two fits differ that are equally good, since the pixel lattice lies otherwise under each image. Seen: 0.011
    /// and 0.014 between a lens of seven terms and one with two that aren't there.
    pub lattice: f64,
    /// Share of the decrease that an effect predicts, which another may miss to be fitted in its place.
    pub forlorn: f64,
    /// Columns of which less than this share is apart are alike enough for a fit to decide.
    pub classes_alike: f64,
    /// That share for an exposure, whose column is that of another blur: slow motion showed 0.05 apart of a delay that was one.
    pub alike_bent: f64,
    /// To what share of itself an image's column is known along what tells it from another: the smooth surface through a
    /// lattice's errors. Fits are no better judges of two that differ by less.
    pub column: f64,
    /// To what share of itself a short exposure's blur is known, which is all that tells it from a delay.
    pub blur: f64,
    /// Steps of a candidate, as far as which the straight line of its column is believed: a tilt by 18 degrees for a k1 of 0.05.
    pub classes_straight: f64,
    /// A fit that loses more than this is far enough not to be settled any further: that took 0.03 away at most on ten sets.
    pub classes_far: f64,
    /// Deviance of a frame that a camera would have lost and the data have: about 2 ln 100, since nobody loses less than one in a hundred.
    pub unseen: f64,
    /// Decrease of the deviance that a torque must bring to be lacking where poses are read off images: the lattice leads poses a little
    /// astray all along. Seen: at most 70 in 40 sets of 60 s without a lacking torque, 20 000 and more with one.
    pub pictured_evidence: f64,
    /// Decrease of the deviance that it must bring there for each part of a window, at least.
    pub pictured_each: f64,
    /// Sizes of discrepancy among which the most likely is taken, each twice the one before; 0 comes first.
    pub sizes: usize,
    /// Smallest of these sizes, in the discrepancy's own unit (N·m), for cells of inertia scale 1.
    pub smallest: f64,
    /// Family-wise error of one screen; a cut is screened once where nothing is missing.
    pub alpha: f64,
    /// Times what the timestamps' scatter gives, up to which a lacking torque is theirs: lateness has a long tail.
    pub stamps: f64,
    /// Decrease of the squares that each effect must bring over those of a search one by one, as one that is found alone must.
    pub together: f64,
}

/// Those in force.
pub const SELECTION: Selection = Selection {
    excited: SLIGHT,
    excited_torque: FINE,
    worth: HALF,
    bent_worth: SMALL,
    further: SEVERAL,
    doubted: PART,
    trials_alike: 1.0 - PART,
    large: SMALL,
    sparse: CERTAIN * CERTAIN,
    sparse_trials: FEW,
    seldom: FAR * CERTAIN * CERTAIN,
    refit_straight: MORE,
    stretch: SEVERAL,
    rounds: Options::USUAL.rounds,
    settled: SLIGHT,
    refused: 1.0,
    shorter: 1.0,
    shorter_seen: PART,
    runaway: SEVERAL * FAR,
    doubt: CERTAIN,
    fine: POLICY.read,
    reach: SEVERAL,
    follows: PART,
    beside: 1.0 + SMALL,
    levels: SEVERAL * FAR,
    beyond: 2,
    switched_far: FAR,
    search_most: 6,
    vain: FEW,
    unsettled: 1.0,
    again: FEW,
    keep: DOUBTED,
    settle: FEW,
    moved: PART,
    idle: FINE,
    better: 2.0,
    lattice: SLIGHT,
    forlorn: PART,
    classes_alike: SLIGHT,
    alike_bent: SMALL,
    column: 0.0025,
    blur: 0.2,
    classes_straight: FAR * FAR,
    classes_far: CERTAIN * CERTAIN,
    unseen: DOUBTED * DOUBTED,
    pictured_evidence: FAR * CERTAIN * CERTAIN,
    pictured_each: HALF,
    sizes: 15,
    smallest: WINDOWS.push,
    alpha: 0.005,
    stamps: SEVERAL,
    together: POLICY.clear * POLICY.clear,
};
