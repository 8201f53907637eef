//! Where the sensor sits behind the lens: the distorted point times `scale`, plus the principal point (u0, v0).
//!
//! *Deviations*: beyond the paper, for the diagnosis. The optical axis meets the picture at (u0, v0). Off: scale 1,
//! principal point (0, 0).

use fmi2_export::{unit, variables};

variables! {
    /// Parameters of the sensor's placement.
    pub struct Placement {
        effect scale: f64 = 1.0, "scale", "a", unit::ONE,
            "Magnification of the distorted picture about the optical axis.", min = 1e-3, max = 1e3;
        effect centre_u: f64 = 0.0, "u0", "u₀", unit::IMAGE_UNIT,
            "Principal point to the right of the image centre, added after the lens.";
        effect centre_v: f64 = 0.0, "v0", "v₀", unit::IMAGE_UNIT,
            "Principal point above the image centre, added after the lens.";
    }
}

impl Placement {
    /// Image point of a distorted point, in image units.
    #[inline]
    pub fn placed(&self, (u, v): (f64, f64)) -> (f64, f64) {
        (self.scale * u + self.centre_u, self.scale * v + self.centre_v)
    }
}
