//! Radial distortion of the fifth order, the first term that (3) and (4) leave out: δu = k₂ u r⁴, δv = k₂ v r⁴.
//!
//! *Deviations*: beyond the paper, which drops terms above order three (Section 2.1). Off: 0.

use super::Lens;
use fmi2_export::{unit, variables};

variables! {
    /// Parameter of the fifth-order radial distortion.
    pub struct FifthOrder {
        effect quintic: f64 = 0.0, "k2", "k₂", unit::PER_IMAGE_UNIT_FOURTH,
            "Radial distortion of the fifth order, u·r⁴ and v·r⁴.";
    }
}

impl Lens for FifthOrder {
    #[inline]
    fn displacement(&self, u: f64, v: f64) -> (f64, f64) {
        let k2 = self.quintic;
        let r2 = u * u + v * v;
        (k2 * u * r2 * r2, k2 * v * r2 * r2)
    }
}
