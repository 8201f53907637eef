//! Radial distortion, (3) and (4): δu = k₁ u (u² + v²), δv = k₁ v (u² + v²).
//!
//! *Deviations*: the text calls positive k₁ barrel; by the equation points move away from the axis, which is
//! pincushion in the usual sense. The equation decides. Off: 0.

use super::Lens;
use fmi2_export::{unit, variables};

variables! {
    /// Parameter of the radial distortion.
    pub struct Radial {
        effect cubic: f64 = 0.0, "k1", "k₁", unit::PER_IMAGE_UNIT_SQUARED,
            "Radial distortion (3), (4); positive moves points away from the axis.";
    }
}

impl Lens for Radial {
    #[inline]
    fn displacement(&self, u: f64, v: f64) -> (f64, f64) {
        let k1 = self.cubic;
        let r2 = u * u + v * v;
        (
            k1 * u * r2, // (3)
            k1 * v * r2, // (4)
        )
    }
}
