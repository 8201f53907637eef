//! Camera sensitivity, (11): I = I₀ cosᵝ(atan(r/f)), r measured from the optical axis in image units.
//!
//! The whole picture darkens, background included. *Deviations*: β may be any nonnegative real. Off: 0.

use fmi2_export::{unit, variables};

variables! {
    /// Parameter of the camera sensitivity.
    pub struct Sensitivity {
        effect exponent: f64 = 0.0, "beta", "β", unit::ONE,
            "Camera sensitivity (11): exponent of the cosine of the angle to the optical axis.", min = 0.0;
    }
}

impl Sensitivity {
    /// I/I₀ at the squared distance r² from the optical axis, with focal length f, both in image units.
    pub fn gain(&self, r2: f64, f: f64) -> f64 {
        // cos(atan(x)) = 1/sqrt(1 + x²)
        libm::pow(1.0 + r2 / (f * f), -0.5 * self.exponent) // (11)
    }
}
