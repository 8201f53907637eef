//! Which effects the model lacks: add, drop and swap over one list, with a memory of the models visited.
//!
//! - `trials.rs`: from where an effect is tried (a derivative; for limits, switches and long delays a chord)
//! - `screen.rs`: what each would gain, on one linearisation, with the noises taken anew
//! - `walk.rs`: the search itself; every model on its way is fitted
//! - `class.rs`: what else fits as well in an effect's place
//! - `nearest.rs`: which listed effects do most of what an unlisted input did

pub mod class;
pub mod nearest;
pub mod screen;
pub mod trials;
pub mod walk;

use crate::statistics::levels::DOUBTED;
pub use walk::{Search, Visited};

/// One search in so many data sets of which the model lacks nothing may find something.
const FALSE_ALARM: f64 = 1e-4;
/// Beside an unlisted input an effect must be clear by so many times as many standard deviations: the input's form is a guess,
/// and what it leaves passes for an effect.
const GUESSED: f64 = 2.0;
/// And it must gain at least this share of what the unlisted input gains: what a guessed form leaves is a share of what it takes.
/// Pushes at a motor's load left 0.3 % that a gain of the current's sensor seemed to explain.
const LEFT: f64 = 0.01;
/// Process noise must gain so many times what chance gives: two honest integrators differ by what long logs show.
const INTEGRATORS: f64 = 2.0;
/// The truth fits worse than the best of its class by more than this in 0.27 % of data sets: three standard deviations, squared.
const CLASS: f64 = DOUBTED * DOUBTED;

/// Numbers of the search; `tests/policy_any.rs` holds them against the null distribution, and fails when one moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Policy {
    /// Deviance that a model must gain by one more effect: what the best of all candidates gains by chance (χ² with one degree of
    /// freedom) in one of `FALSE_ALARM` searches.
    pub gain: f64,
    /// The same, whatever `gain` is beside an unlisted input.
    pub sure: f64,
    /// The same beside an unlisted input.
    pub beside: f64,
    /// Effects within this deviance of the best one are not told apart.
    pub class: f64,
    /// How many of the screened are looked at with the noises taken anew.
    pub looked: usize,
    /// How many of these are fitted.
    pub fitted: usize,
    /// Most effects.
    pub most: usize,
    /// Deviance that process noise or an unlisted input must gain over none before the verdict is "unknown": two numbers, size and
    /// memory, at the best of all equations (χ² with two degrees of freedom), and twice that for honest integrators.
    pub unknown: f64,
}

impl Policy {
    /// For a search among so many candidates, of a model with so many equations.
    pub fn of(candidates: usize, equations: usize) -> Self {
        let sure = beyond(FALSE_ALARM / candidates.max(1) as f64);
        // of two degrees of freedom the tail is exp(-x/2)
        let chance = -2.0 * libm::log(FALSE_ALARM / equations.max(1) as f64);
        Self {
            gain: sure,
            sure,
            beside: GUESSED * GUESSED * sure,
            class: CLASS,
            looked: 10,
            fitted: 4,
            most: 5,
            unknown: INTEGRATORS * chance,
        }
    }
}

impl Policy {
    /// The same beside an unlisted input that gains so much.
    pub fn beside(self, unlisted: f64) -> Self {
        Self { gain: self.beside.max(LEFT * unlisted), ..self }
    }
}

/// What χ² with one degree of freedom exceeds with this probability.
fn beyond(probability: f64) -> f64 {
    // P = erfc(√(x/2)), by bisection: it falls
    let (mut low, mut high): (f64, f64) = (0.0, 1e3);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if libm::erfc((0.5 * middle).sqrt()) > probability { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
