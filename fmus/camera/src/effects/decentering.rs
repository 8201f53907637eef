//! Decentering, (5) and (6): δu = p₁ (3u² + v²) + 2 p₂ u v, δv = 2 p₁ u v + p₂ (u² + 3v²). Off: 0.

use super::Lens;
use fmi2_export::{unit, variables};

variables! {
    /// Parameters of the decentering distortion.
    pub struct Decentering {
        effect horizontal: f64 = 0.0, "p1", "p₁", unit::PER_IMAGE_UNIT, "Decentering distortion (5), (6) along u.";
        effect vertical: f64 = 0.0, "p2", "p₂", unit::PER_IMAGE_UNIT, "Decentering distortion (5), (6) along v.";
    }
}

impl Lens for Decentering {
    #[inline]
    fn displacement(&self, u: f64, v: f64) -> (f64, f64) {
        let (p1, p2) = (self.horizontal, self.vertical);
        (
            p1 * (3.0 * u * u + v * v) + 2.0 * p2 * u * v, // (5)
            2.0 * p1 * u * v + p2 * (u * u + 3.0 * v * v), // (6)
        )
    }
}
