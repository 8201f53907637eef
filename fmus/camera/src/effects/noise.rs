//! Noise: an additive Gaussian term of zero mean and standard deviation σ grey levels (Section 2.2).
//!
//! Drawn by [`crate::photometry::noise`] and [`crate::photometry::tails`] for each (seed, frame, pixel), before
//! quantisation. Off: 0.

use fmi2_export::{unit, variables};

variables! {
    /// Parameter of the noise.
    pub struct Noise {
        effect deviation: f64 = 0.0, "sigma", "σ", unit::GREY_LEVEL,
            "Standard deviation of the additive Gaussian noise (Section 2.2), true to 15 % of what lies beyond any multiple of \
             it up to 6.5, to 5e-4 of the whole.", min = 0.0, max = 100.0;
    }
}
