//! Thin prism distortion, (7) and (8): δu = s₁ (u² + v²), δv = s₂ (u² + v²). Off: 0.

use super::Lens;
use fmi2_export::{unit, variables};

variables! {
    /// Parameters of the thin prism distortion.
    pub struct ThinPrism {
        effect horizontal: f64 = 0.0, "s1", "s₁", unit::PER_IMAGE_UNIT, "Thin prism distortion (7) along u.";
        effect vertical: f64 = 0.0, "s2", "s₂", unit::PER_IMAGE_UNIT, "Thin prism distortion (8) along v.";
    }
}

impl Lens for ThinPrism {
    #[inline]
    fn displacement(&self, u: f64, v: f64) -> (f64, f64) {
        let r2 = u * u + v * v;
        (
            self.horizontal * r2, // (7)
            self.vertical * r2,   // (8)
        )
    }
}
