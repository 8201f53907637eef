//! Which effects the model lacks: add, drop and swap over one list, with a memory of the models visited.
//!
//! - `trials.rs`: from where an effect is tried (a derivative; for limits, switches and long delays a chord)
//! - `screen.rs`: what each would gain, on one linearisation, with the noises taken anew
//! - `walk.rs`: the search itself; every model on its way is fitted
//! - `class.rs`: what else fits as well in an effect's place

pub mod class;
pub mod screen;
pub mod trials;
pub mod walk;

pub use walk::{Search, Visited};

/// Numbers of the search, each with its source; the tests in `tests/policy_any.rs` fail when one moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Policy {
    /// Deviance that a model must gain by one more effect. 4.5 standard deviations squared: two honest integrators differ by
    /// what long logs show (`statistics::bootstrap`); of 50 candidates none reaches it by chance in 3 000 sets.
    pub gain: f64,
    /// The same beside an unlisted input: twice as many standard deviations, since the input's own form is a guess.
    pub beside: f64,
    /// Effects within this deviance of the best one are not told apart: a likelihood ratio of 90.
    pub class: f64,
    /// How many of the screened are looked at with the noises taken anew.
    pub looked: usize,
    /// How many of these are fitted.
    pub fitted: usize,
    /// Most effects.
    pub most: usize,
    /// Deviance that process noise or an unlisted input must gain over none before the verdict is "unknown": the same evidence
    /// for one more size as for one more effect, twice, since an integrator's error is no unknown.
    pub unknown: f64,
}

impl Default for Policy {
    fn default() -> Self {
        Self { gain: 20.25, beside: 81.0, class: 9.0, looked: 10, fitted: 4, most: 5, unknown: 40.5 }
    }
}
