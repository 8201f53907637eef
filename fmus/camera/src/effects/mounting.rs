//! A camera that does not look squarely at the scene: rotation of the scene before the lens.
//!
//! The paper's camera looks along the normal of the robot's plane (Section 3.2). Here the axis is first panned
//! towards +u about the vertical, then tilted towards +v about the camera's horizontal, and the picture is rolled
//! counter-clockwise last:
//! x' = x cos α − z sin α, z' = x sin α + z cos α (pan α); y' = y cos τ − z' sin τ, z'' = y sin τ + z' cos τ (tilt τ);
//! then (x', y') is turned by ρ (roll).
//!
//! *Deviations*: beyond the paper, for the diagnosis. Off: 0 rad, at which every rotation is the identity exactly.

use fmi2_export::{unit, variables};

variables! {
    /// Parameters of the mounting.
    pub struct Mounting {
        effect roll: f64 = 0.0, "roll", "ρ", unit::RADIAN,
            "Roll of the mounting; positive turns the picture counter-clockwise.", min = -3.2, max = 3.2;
        effect pan: f64 = 0.0, "pan", "α", unit::RADIAN,
            "Pan of the mounting; positive turns the axis towards +u.", min = -1.2, max = 1.2;
        effect tilt: f64 = 0.0, "tilt", "τ_m", unit::RADIAN,
            "Tilt of the mounting; positive turns the axis towards +v.", min = -1.2, max = 1.2;
    }
}

/// The rotation with its sines and cosines worked out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    roll: (f64, f64),
    pan: (f64, f64),
    tilt: (f64, f64),
}

impl Mounting {
    /// The rotation that this mounting makes.
    pub fn rotation(&self) -> Rotation {
        let pair = |angle| (libm::sin(angle), libm::cos(angle));
        Rotation { roll: pair(self.roll), pan: pair(self.pan), tilt: pair(self.tilt) }
    }
}

impl Rotation {
    /// Camera coordinates of a point given in the coordinates of a squarely mounted camera, in world units.
    #[inline]
    pub fn camera_from_square(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = self.pan;
        let (x, z) = (x * cos - z * sin, x * sin + z * cos);
        let (sin, cos) = self.tilt;
        let (y, z) = (y * cos - z * sin, y * sin + z * cos);
        let (sin, cos) = self.roll;
        [x * cos - y * sin, x * sin + y * cos, z]
    }
}
