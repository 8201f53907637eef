//! Ground that is not level, and a rig that does not stand level: either falls towards +u.
//!
//! The equations are those of [`mechanics::Incline`]. On inclined ground the drum's path is turned by the angle, and the weight of
//! both links pulls it downhill with θ_slope·sin(slope). An inclined rig takes all with it that its angles are counted from (ground,
//! camera, the zeros of its encoders), so that the weight alone is turned. Source: the Lagrangian of the rolling double pendulum.

use super::{Mechanical, finite};
use fmi2_export::{ModelError, unit, variables};
use mechanics::{Incline, Theta};

variables! {
    /// Ground, and a rig, that are not level.
    pub struct Slope {
        effect angle: f64 = 0.0, "slope", "α", unit::RADIAN,
            "Inclination of the ground, which falls towards +u; off at 0.", min = -1.5, max = 1.5;
        parameter weight: f64 = Theta::THETA_SLOPE, "theta_slope", "θ_s", unit::NEWTON_METRE,
            "(m1 + m2)*g*R, assumed since Table 2 can't tell it; acts only if slope or incline is not 0.";
        effect rig: f64 = 0.0, "incline", "ι", unit::RADIAN,
            "Inclination of all that the rig stands on, with ground, camera and the zeros of its angles, towards +u; off at 0.",
            min = -1.5, max = 1.5;
    }
}

impl Mechanical for Slope {
    fn check(&self) -> Result<(), ModelError> {
        finite("slope", self.angle)?;
        finite("incline", self.rig)?;
        finite("theta_slope", self.weight)
    }

    fn incline(&self) -> Option<Incline> {
        Incline::new(self.angle, self.rig, self.weight)
    }
}
