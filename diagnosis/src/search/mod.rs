//! Which effects the model lacks: add, drop and swap over one list, with a memory of the models visited.
//!
//! - `trials.rs`: the values of a parameter at which its effect is screened (a derivative; for limits, switches and long delays a chord)
//! - `screen.rs`: what each would gain, on one linearisation, with the noises taken anew
//! - `screened.rs`: fits of what was screened, from where it begins
//! - `late.rs`: delays of sensors, screened along the model's own path
//! - `walk.rs`: the search itself; every model on its way is fitted
//! - `across.rs`: one sensor in the place of several inputs, and the other way round
//! - `pairs.rs`: two effects that only together explain what is left
//! - `class.rs`: what else fits as well in an effect's place
//! - `nearest.rs`: which listed effects do most of what an unlisted input did
//! - `sign.rs`: whether an unlisted input does what an input with its sign turned would
//! - `policy.rs`: the numbers that decide, with their reasons

mod across;
pub mod class;
mod late;
pub mod nearest;
mod pairs;
mod policy;
pub mod screen;
mod screened;
mod sign;
pub mod trials;
pub mod walk;

pub(crate) use policy::SEARCHING;
pub use walk::Search;

/// Numbers of the search. `tests/policy_any.rs` holds `gain` and `unknown` against the null distribution; `most`, `looked` and `fitted`
/// stand with their reasons in `SEARCHING`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Policy {
    /// Deviance that a model must gain by one more effect: what the best of all candidates gains by chance (χ² with one degree of
    /// freedom) in one of `SEARCHING.false_alarm` searches.
    pub gain: f64,
    /// What `gain` is without an unlisted input, whatever it is beside one.
    pub sure: f64,
    /// Deviance that a model must gain by one more effect beside an unlisted input, at least.
    pub beside: f64,
    /// Effects within this deviance of the best one are not told apart.
    pub class: f64,
    /// Number of screened candidates whose gain is computed once more with the noises taken anew.
    pub looked: usize,
    /// Number of these that are fitted.
    pub fitted: usize,
    /// Most effects that a model has.
    pub most: usize,
    /// Deviance that process noise or an unlisted input must gain over none before the verdict is "unknown": two numbers, size and
    /// memory, at the best of all equations (χ² with two degrees of freedom), and twice that, for two integrators that are both right differ by what long logs show.
    pub unknown: f64,
}

impl Policy {
    /// For a search among so many candidates, of a model with so many equations.
    pub fn of(candidates: usize, equations: usize) -> Self {
        let sure = beyond(SEARCHING.false_alarm / candidates.max(1) as f64);
        // of two degrees of freedom the tail is exp(-x/2)
        let chance = -2.0 * libm::log(SEARCHING.false_alarm / equations.max(1) as f64);
        Self {
            gain: sure,
            sure,
            beside: SEARCHING.guessed * SEARCHING.guessed * sure,
            class: SEARCHING.class,
            looked: SEARCHING.looked,
            fitted: SEARCHING.fitted,
            most: SEARCHING.most,
            unknown: SEARCHING.integrators * chance,
        }
    }
}

impl Policy {
    /// These thresholds beside an unlisted input that gains so much deviance.
    pub fn beside(self, unlisted: f64) -> Self {
        Self { gain: self.beside.max(SEARCHING.left * unlisted), ..self }
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
