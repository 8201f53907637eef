//! Numbers that doubts of what was found decide by, each with its reason.

use crate::rigs::acrobot::policy::POLICY;
use crate::statistics::levels::{CERTAIN, FAR, FEW, HALF, MORE, PART, SEVERAL, SLIGHT, SMALL, STEP};

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Check {
    /// Lacking torque over what noise alone gives.
    pub torque_ratio: f64,
    /// Share of what the model lacked to which named effects have the form that the product gives them: 0.7 to 1.3 % stay of dry friction of
    /// a thousand times what can be seen.
    pub form: f64,
    /// Variance of block means over what independent rows would give: 0.7 to 1.6 in sets without a residual, where a block has
    /// so many rows. At a measured motion the means of more rows show more of the motion's own error, which rows share.
    pub means: f64,
    pub rows: f64,
    /// What an image leaves over what noise gives, both root mean square, from which it is no noise: 0.9 to 1.2 on 90 sets in which all that
    /// is there was named, and 2.8 to 9 where a camera swung or repeated frames.
    pub open: f64,
    /// A value changes along the runs if its drift is this many standard errors long and the squares that it explains are so many times
    /// that many: 4.3 and 21 at most on 120 sets of steady values, 5.8 and 90 at least where a light, a mount or a battery drifted.
    pub wanders: f64,
    pub wanders_far: f64,
    /// Frames with so many times the squares of noise are far off; single ones where they hold half of what noise doesn't leave and no more
    /// than two stand side by side.
    pub far_frame: f64,
    /// So many effects on one cut may imitate another one together.
    pub imitators: usize,
    /// They take each other away if their sum's square is below this share of the sum of their squares. Seen: 0.02 where a lens of
    /// fifth order was imitated, 0.35 to 1.5 for effects that are there.
    pub cancelled: f64,
    /// They mend the form of one of them if all the others add less than this to what it explains alone, though each of them is
    /// clearly there, and as many as imitate resemble it by more than that (a correlation), itself among them. Seen: 0.014 to 0.027 and 0.42 to
    /// 0.96 where k1 imitated k2 in noisy images. One that resembles it (0.99) and others that don't (below 0.01) are effects by themselves:
    /// k1, k2 and a friction, or roll, u0 and a delay.
    pub mended: f64,
    pub resembles: f64,
    /// Whom the first needn't resemble: one whose own square is below this share of all. Seen: 0.002 and 0.004 where a lens and a
    /// backlash were imitated by five and four effects.
    pub slight: f64,
    /// Runs differ if values of their own leave no more than this share of what a law leaves that all runs share.
    pub far_less: f64,
}

/// Those in force.
pub const CHECK: Check = Check {
    torque_ratio: MORE,
    form: SLIGHT,
    means: SEVERAL,
    rows: POLICY.curved as f64,
    open: MORE,
    wanders: CERTAIN,
    wanders_far: SEVERAL * CERTAIN * CERTAIN,
    far_frame: FAR,
    imitators: FEW,
    cancelled: SMALL,
    mended: HALF * SMALL,
    resembles: PART,
    slight: STEP,
    far_less: 1.0 - PART,
};
