//! Numbers that are searched by, each with its reason.

use crate::statistics::levels::{DOUBTED, FAR, FEW};

/// How much is enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Searching {
    /// Share of data sets of which the model lacks nothing in which a search may find something.
    pub false_alarm: f64,
    /// Beside an unlisted input an effect must be clear by so many times as many standard deviations: the input's form is a guess,
    /// and what it leaves passes for an effect.
    pub guessed: f64,
    /// And it must gain at least this share of what the unlisted input gains: what a guessed form leaves is a share of what it takes.
    /// Pushes at a motor's load left 0.3 % that a gain of the current's sensor seemed to explain.
    pub left: f64,
    /// Process noise must gain so many times what chance gives: two integrators that are both right differ by what long logs show.
    pub integrators: f64,
    /// The truth fits worse than the best of its class by more than this in 0.27 % of data sets: three standard deviations, squared.
    pub class: f64,
    /// Candidates, the best first with the noises as they are, whose gain is computed once more with the noises taken anew: process noise
    /// has taken up a part of what the right one explains, so that a look-alike may come before it.
    pub looked: usize,
    /// Of these so many are fitted, which calls the unit: several, since linear gains of look-alikes are nearly the same. One that was not
    /// fitted may still come in by a swap.
    pub fitted: usize,
    /// Most effects that a model has: each costs a round of fits, and a lab can't look after more names at once. The story says where a search
    /// ended so.
    pub most: usize,
    /// Rounds of the noises' search for a look at a screened effect: most of what it takes over from the process noise it takes at once.
    /// What it ranks is fitted in full. Numerical only.
    pub look_rounds: usize,
    /// Shares of the largest magnitude at which a limit is tried.
    pub limits: [f64; 4],
    /// Rows over which the largest jump is spread where a rate limit is tried.
    pub ramps: [f64; 3],
    /// Rows by which a delay or lag is tried; less follows from the derivative.
    pub late: [f64; 3],
    /// A course follows a variable, or an effect, when that takes away at least this share of its square.
    pub follows: f64,
    /// Each further term must take away at least this share.
    pub further: f64,
    /// Terms that a course is told by, at most.
    pub terms: usize,
}

/// Those in force.
pub(crate) const SEARCHING: Searching = Searching {
    false_alarm: 1e-4,
    guessed: 2.0,
    left: 0.01,
    integrators: 2.0,
    class: DOUBTED * DOUBTED,
    looked: FAR as usize,
    fitted: FEW + 1,
    most: FEW + 2,
    look_rounds: 6,
    limits: [0.4, 0.6, 0.8, 0.92],
    ramps: [2.0, 6.0, 20.0],
    late: [2.0, 5.0, 15.0],
    follows: 0.25,
    further: 0.05,
    terms: FEW,
};
