//! Numbers that doubts of what was found decide by, each with its reason.

use crate::rigs::acrobot::policy::POLICY;
use crate::statistics::levels::{CERTAIN, FAR, FEW, HALF, MORE, PART, SEVERAL, SLIGHT, SMALL, STEP};

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Check {
    /// Times what noise alone gives, from which a torque lacks.
    pub torque_ratio: f64,
    /// Share of what the model lacked to which named effects have the form that the product gives them: 0.7 to 1.3 % stay of dry friction of
    /// a thousand times what can be seen. As much of what is left may be a law of place: up to 0.012 where all that is there was named, 0.058 where six
    /// effects stood for a lens.
    pub form: f64,
    /// Variance of block means over what independent rows would give, from which it is no noise: 0.7 to 1.6 in sets without a residual. The same of
    /// coefficients of a law of place: 0.3 to 0.8, and 6.4 of that lens.
    pub means: f64,
    /// Rows of a block in these sets. At a measured motion the means of more rows show more of the motion's own error, which rows share.
    pub rows: f64,
    /// What an image leaves over what noise gives, both root mean square, from which it is no noise: 0.9 to 1.2 on 90 sets in which all that
    /// is there was named, and 2.8 to 9 where a camera swung or repeated frames.
    pub open: f64,
    /// Standard errors from which a drift along the runs is one.
    pub wanders: f64,
    /// Squares that such a drift must explain. Both: 4.3 and 21 at most on 120 sets of steady values, 5.8 and 90 at least where a light, a
    /// mount or a battery drifted.
    pub wanders_far: f64,
    /// Times the squares of noise, from which a frame is far off; single ones are where such frames hold half of what noise doesn't leave
    /// and no more than two stand side by side.
    pub far_frame: f64,
    /// Fewest effects on one cut that may stand for another one together.
    pub confounding: usize,
    /// Share of the sum of their squares below which their sum's square is, where they take each other away. Seen: 0.02 where a lens of
    /// fifth order was confounded with others, 0.35 to 1.5 for effects that are there.
    pub cancelled: f64,
    /// Share of what one of them explains alone, below which all the others together add so little that they only correct its form. Seen:
    /// 0.014 to 0.027 where k1 stood for k2 in noisy images.
    pub refined: f64,
    /// Correlation above which an effect resembles the first one, as all must that only correct its form. Seen: 0.42 to 0.96 there. One
    /// that resembles it (0.99) and others that don't (below 0.01) are effects by themselves: k1, k2 and a friction, or roll, u0 and a
    /// delay.
    pub resembles: f64,
    /// Share of all squares below which an effect's own square is, so that it needn't resemble the first. Seen: 0.002 and 0.004 where a
    /// lens and a backlash were confounded with five and four effects.
    pub slight: f64,
    /// Share of what a law leaves that all runs share, up to which values of their own must leave for runs to differ.
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
    confounding: FEW,
    cancelled: SMALL,
    refined: HALF * SMALL,
    resembles: PART,
    slight: STEP,
    far_less: 1.0 - PART,
};
